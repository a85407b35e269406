#pragma each_kind
// Composite Simpson rule (Watanabe, Abe, Konno 2015, eq. 23) over the field of a KIND: the sum of weight times field
// over the nodes. The host tabulates the nodes over a whole ray, with the decay in their weights; where depths end the
// rays (-D DEPTH), over a part of one, without it; so they do where light fades otherwise than by its decay (-D
// FADING), and where nodes are the beginnings of strata, in each of which the sample is as far on (-D JITTERED).

// The sum is taken in blocks: rounding then grows with the block, not with up to 65537 nodes.
#ifndef SIMPSON_BLOCK
#define SIMPSON_BLOCK 256u
#endif

INLINE floatv KIND_simpson(const Ray *const ray, const Sources *const sources, const uint index,
                           const Quadrature *const quadrature) {
    __global const Node *const nodes = quadrature->nodes;
    const uint node_count = quadrature->node_count;
    const KIND_path path = KIND_along(ray, sources, index);
    floatv integral = splat(0.0f);
    for (uint begin = 0; begin < node_count; begin += SIMPSON_BLOCK) {
        const uint end = min(begin + SIMPSON_BLOCK, node_count);
        floatv block = splat(0.0f);
        for (uint k = begin; k < end; ++k) {
#if defined(DEPTH) || defined(FADING) || defined(JITTERED)
#ifdef JITTERED
            const floatv s = ray->end * (nodes[k].s + quadrature->beyond);
#else
            const floatv s = ray->end * nodes[k].s;
#endif
            const floatv weight = ray->end * nodes[k].weight * decay_at(quadrature->decay, s);
#else
            const floatv s = splat(nodes[k].s), weight = splat(nodes[k].weight);
#endif
            block = fma(weight, summand_of(KIND_field(&path, s)), block);
        }
        integral += block;
    }
    return integral;
}
