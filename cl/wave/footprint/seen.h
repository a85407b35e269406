#pragma each_kind
// The mean of the light of a KIND over the pixels of rays.

PER_RAY floatv KIND_seen(const View *const view, const Ray *const ray, const Sources *const sources, const uint index,
                         const Quadrature *const quadrature) {
    const Closest closest = KIND_closest(ray, sources, index);
    const Footprint footprint = footprint_of(view, ray, &closest, &sources->JOIN(KIND, _list)[index].falloff);
    floatv light = splat(0.0f);
    for (uint k = 0; k < footprint.count; ++k) {
        const Ray moved = footprint.is_center ? *ray : moved_ray(view, ray, footprint.right[k], footprint.below[k]);
        const floatv integral = KIND_integral(&moved, sources, index, quadrature);
        light = fma(footprint.weight[k], integral, light);
    }
    return light;
}
