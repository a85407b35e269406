// The exact integral of the field named by FIELD, whose squared distance along a ray is a quadratic: in closed form.
// Included once for every such field.

INLINE floatv JOIN(exact_, FIELD)(const Ray *const ray, const Sources *const sources, const uint index,
                                  const Quadrature *const quadrature) {
    const JOIN(FIELD, _path) path = JOIN(FIELD, _along)(ray, sources, index);
    const Stretch all = evenly_lit(splat(0.0f), ray->end);
    return integral_over(all, &path.distance2, path.floor2, quadrature->decay, path.is_square);
}
