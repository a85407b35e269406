// The exact integral of a beam: the planes through its tip and through the end of its taper cut the ray into stretches,
// each with a closed form (Abe, Watanabe 2010, eq. 10-12). Light is the integral alone; coefficients are in it.

// Where a ray climbs through height 0; one that never does stays on its side.
INLINE floatv climbs_through(const floatv height, const floatv height_slope, const floatv end) {
    const floatv slope = select(height_slope, splat(1e-30f), fabs(height_slope) < 1e-30f);
    return clamp(-height / slope, 0.0f, end);
}

INLINE floatv exact_beam(const Ray *const ray, const Sources *const sources, const uint index,
                         const Quadrature *const quadrature) {
    const beam_path path = beam_along(ray, sources, index);
    const Decay decay = quadrature->decay;
    const floatv none = splat(0.0f);
    const intv is_rising = path.height_slope > -1e-30f;
    const floatv tip = climbs_through(path.height, path.height_slope, ray->end);
    const Stretch ahead = evenly_lit(select(none, tip, is_rising), select(tip, ray->end, is_rising));
    const Stretch behind = evenly_lit(select(tip, none, is_rising), select(ray->end, tip, is_rising));

    floatv light = path.line * integral_over(ahead, &path.to_line, path.floor2, decay, path.is_square);
    if (path.has_taper) {
        const floatv taper = climbs_through(path.taper, path.taper_slope, ray->end);
        Stretch fading = {min(tip, taper), max(tip, taper), none, none};
        fading.light_from = clamp(fma(path.taper_slope, fading.from, path.taper), 0.0f, 1.0f);
        fading.light_to = clamp(fma(path.taper_slope, fading.to, path.taper), 0.0f, 1.0f);
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
