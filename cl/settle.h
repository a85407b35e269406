// The light of one source at the nodes of a tile, given to the tile's light if it is smooth there. Whether it is.
// Included once for each FIELD.
INLINE bool JOIN(settle_, FIELD)(const TileTask *const task, const TileRays *const rays, const uint index,
                                 __local TileMemory *const memory, uint *const integrals) {
    meet();
    for (uint round = 0; round < TILE_ROUNDS; ++round) {
        const Ray *const ray = &rays->nodes[round];
        const floatv clearance2 = JOIN(FIELD, _clearance2)(ray, task->sources, index, task->pass->pixel_step);
        floatv integral = splat(NAN);
        if (!any_lane(clearance2 < least_clearance2(task->pass))) {
            integral = JOIN(exact_, FIELD)(ray, task->sources, index, task->quadrature);
            *integrals += LANES;
        }
        show(integral, first_ray(round), memory->integrals);
    }
    meet();
    if (!seems_smooth(task->pass, memory->integrals))
        return false;
    for (uint round = 0; round < TILE_ROUNDS; ++round) {
        const floatv truth = JOIN(exact_, FIELD)(&rays->tests[round], task->sources, index, task->quadrature);
        const floatv seen = interpolate(memory->integrals, &rays->down[round], &rays->across[round]);
        show(fabs(seen - truth) - MOST_ERROR(task->pass) * fabs(truth), first_ray(round), memory->excess);
        *integrals += LANES;
    }
    meet();
    if (!none_is_positive(memory->excess))
        return false;
    const float4 emission = JOIN(FIELD, _emission)(task->sources, index);
    for (uint round = 0; round < TILE_ROUNDS; ++round)
        add_light(emission, shown(first_ray(round), memory->integrals), first_ray(round), memory->light);
    return true;
}
