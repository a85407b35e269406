#pragma each_kind
// The mean of the light of a KIND over the pixels of rays.

// Returns the light of a square of a ray's pixel. What the core is like there, its closest point tells that the
// square's centre sees, and those that two places along the core see: where it bends or ends, they differ.
INLINE SquareLight KIND_through(const View *const view, const Ray *const ray, const Square *const square,
                                const Sources *const sources, const uint index, const Quadrature *const quadrature) {
    Surroundings around;
    MeanLight middle, mean = {splat(0.0f), splat(0.0f)};
    floatv core_light = splat(0.0f), along_right = splat(0.0f), along_below = splat(0.0f);
    uint places = 1;
    for (uint k = 0; k < places; ++k) {
        const float step = square->side * (k == 0 ? 0.0f : k == 1 ? -PLACE_ASIDE : PLACE_ASIDE);
        const Ray passing = moved_ray(view, ray, fma(splat(step), along_right, splat(square->right)),
                                      fma(splat(step), along_below, splat(square->below)));
        const Closest closest = KIND_closest(&passing, sources, index);
        if (k == 0) {
            around = surroundings_of(view, square, &passing, &closest, &sources->JOIN(KIND, _list)[index].falloff);
            if (!any_lane(around.is_near))
                break;
            along_right = around.core.along_right, along_below = around.core.along_below;
            core_light = closest.light * decay_at(quadrature->decay, closest.s);
            places = any_lane(around.is_close) ? 3 : 1;
        }
        const MeanLight here = mean_at_place(&around, &closest);
        middle = k == 0 ? here : middle;
        mean = add_share(mean, here, k == 0 ? SHARE_OF_MIDDLE : SHARE_ASIDE);
    }
    floatv bend = splat(0.0f);
    Footprint footprint = center_of(square);
    if (any_lane(around.is_near)) {
        mean = select_mean(middle, mean, around.is_close);
        bend = select(difference_of(mean, middle), splat(0.0f), around.core.is_point);
        footprint = footprint_of(square, &around, mean);
    }
    floatv integrals[FOOTPRINT_RAYS];
    for (uint k = 0; k < footprint.count; ++k) {
        const Ray passing = moved_ray(view, ray, footprint.right[k], footprint.below[k]);
        integrals[k] = KIND_integral(&passing, sources, index, quadrature);
    }
    return light_of_square(&footprint, integrals, core_light, bend);
}

PER_RAY floatv KIND_seen(const View *const view, const Ray *const ray, const Sources *const sources, const uint index,
                         const Quadrature *const quadrature) {
    floatv light = splat(0.0f), halved = splat(0.0f), quartered = splat(0.0f);
    // The pixel as it is, then where it is in doubt by 2 and by 4 squares a side: in every lane by its own.
    for (uint cuts = 1; cuts <= 4; cuts *= 2) {
        const floatv share = cuts == 1 ? splat(1.0f) : cuts == 2 ? halved : quartered;
        const intv is_cut = (share > 0.0f) & ((cuts == 2 ? quartered : splat(0.0f)) < 1.0f);
        if (!any_lane(is_cut))
            continue;
        floatv sum = splat(0.0f);
        for (uint k = 0; k < cuts * cuts; ++k) {
            const Square square = part_of_pixel(k, cuts);
            const SquareLight seen = KIND_through(view, ray, &square, sources, index, quadrature);
            sum += seen.light;
            if (cuts == 1) {
                halved = share_of_cuts(seen.doubt, HALVED_FROM);
                quartered = share_of_cuts(seen.doubt, QUARTERED_FROM);
            }
        }
        light = select(light, fma(share, sum * (1.0f / (float)(cuts * cuts)) - light, light), is_cut);
    }
    return light;
}
