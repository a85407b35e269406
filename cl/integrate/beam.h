// The exact integral of a beam: the planes through its tip and through the end of its taper cut the ray into stretches,
// each with a closed form (Abe, Watanabe 2010, eq. 10-12). Light is the integral alone; coefficients are in it.

// Where a ray climbs through a height over the plane; one that never does stays on its side.
INLINE floatv climbs_through(const beam_path *const path, const float height, const floatv end) {
    const intv is_level = fabs(path->height_slope) < 1e-30f;
    const floatv slope = select(path->height_slope, splat(1e-30f), is_level);
    return clamp((height - path->height) / slope, 0.0f, end);
}

INLINE floatv exact_beam(const Ray *const ray, const Sources *const sources, const uint index,
                         const Quadrature *const quadrature) {
    const beam_path path = beam_along(ray, sources, index);
    const Decay decay = quadrature->decay;
    const floatv none = splat(0.0f);
    const intv is_rising = path.height_slope > -1e-30f;
    const floatv tip = climbs_through(&path, 0.0f, ray->end);
    const Stretch ahead = evenly_lit(select(none, tip, is_rising), select(tip, ray->end, is_rising));
    const Stretch behind = evenly_lit(select(tip, none, is_rising), select(ray->end, tip, is_rising));

    floatv light = path.line * integral_over(ahead, &path.to_line, path.floor2, decay, path.is_square);
    if (path.per_taper > 0.0f) {
        const floatv taper = climbs_through(&path, -1.0f / path.per_taper, ray->end);
        Stretch fading = {min(tip, taper), max(tip, taper), none, none};
        const floatv growth = path.height_slope * path.per_taper;
        const floatv begun = fma(path.height, splat(path.per_taper), splat(1.0f));
        fading.light_from = clamp(fma(growth, fading.from, begun), 0.0f, 1.0f);
        fading.light_to = clamp(fma(growth, fading.to, begun), 0.0f, 1.0f);
        light += path.line * integral_over(fading, &path.to_line, path.floor2, decay, path.is_square);
    } else {
        light += path.cap * integral_over(behind, &path.to_tip, path.floor2, decay, path.is_square);
    }
    if (path.sphere != 0.0f) {
        const Stretch all = evenly_lit(none, ray->end);
        light += path.sphere * integral_over(all, &path.to_tip, path.floor2, decay, path.is_square);
    }
    return light;
}
