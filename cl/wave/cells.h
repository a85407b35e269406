#pragma each_kind
// Adds the light of a source to a row of cells along x: emission times field, at places that lie evenly in each cell.

INLINE void KIND_add_to_row(const Cells *const cells, const Ray *const ray, const Sources *const sources,
                            const uint index, __global float *const restrict row) {
    const KIND_path path = KIND_along(ray, sources, index);
    const float4 emission = cells->share * KIND_emission(sources, index);
    const float per_row = 1.0f / (float)cells->columns, per_part = 1.0f / (float)cells->parts;
    for (uint x = 0; x < cells->stride; x += LANES) {
        const floatv cell = to_floatv(x + LANE_NUMBERS);
        floatv light = splat(0.0f);
        for (uint part = 0; part < cells->parts; ++part) {
            const floatv s = per_row * (cell + per_part * ((float)part + 0.5f));
            light += KIND_field(&path, s);
        }
        if (!any_lane(light != 0.0f)) // beyond its reach
            continue;
        add_to_cells(cells, row + x, emission.x * light);
        add_to_cells(cells, row + x + cells->plane, emission.y * light);
        add_to_cells(cells, row + x + 2 * cells->plane, emission.z * light);
    }
}
