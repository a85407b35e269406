#pragma each_kind
// Settles the light of one source of a KIND on a tile: whether it is smooth there, so that its values at the nodes tell
// all others.

#ifdef DEPTH
// Returns what is summed of the field where the ray ends.
INLINE floatv KIND_at_end(const Ray *const ray, const Sources *const sources, const uint index) {
    const KIND_path path = KIND_along(ray, sources, index);
    return summand_of(KIND_field(&path, ray->end));
}
#endif

// Adds the light of one source at the nodes of a tile to the tile's light if it is smooth there, and returns whether it
// is.
INLINE bool KIND_settle(const TileTask *const task, const TileRays *const rays, const float end_error, const uint index,
                        __local TileMemory *const memory, uint *const integrals) {
    meet();
    for (uint round = 0; round < TILE_ROUNDS && is_node(first_ray(round)); ++round) {
        const Clearance clearance = KIND_clearance(&rays->rays[round], task->sources, index, task->pass->pixel_step);
        const float least = LEAST_CLEARANCE * (float)task->pass->size;
        show(least * least - clearance.distance2, first_ray(round), memory->excess);
#ifdef SHAPES
        show(clearance.to_light, first_ray(round), memory->to_light);
#endif
#if KIND_HAS(parts)
        for (uint k = 0; k < PLACES_SEEN; ++k)
            show(clearance.seen[k], first_ray(round), memory->seen[k]);
#endif
    }
    meet();
#ifdef SHAPES
    // Beyond its reach a source adds nothing; where light ends, neighbours differ.
    const float nearest = least_of(memory->to_light);
    if (nearest > MOST_BETWEEN * (float)task->pass->size)
        return true;
    if (nearest > 0.0f || greatest_of(memory->to_light) > 0.0f)
        return false;
#endif
    if (!none_is_positive(memory->excess))
        return false;
#if KIND_HAS(parts)
    if (!all_see_one_part(memory->seen))
        return false;
#endif
    meet();
    const float4 emission = KIND_emission(task->sources, index);
    const float least_light = task->pass->least_light / max(largest(emission), 1e-30f);
    for (uint round = 0; round < ROUNDS; ++round) {
        const Ray *const ray = &rays->rays[round];
        const floatv integral = KIND_integral(ray, task->sources, index, task->quadrature);
        show(reduced(integral), first_ray(round), memory->integrals);
        *integrals += LANES;
#ifdef DEPTH
        if (end_error > 0.0f && round < TILE_ROUNDS && is_node(first_ray(round))) {
            const floatv at_end = KIND_at_end(ray, task->sources, index);
            const floatv light_at_end = at_end * decay_at(task->quadrature->decay, ray->end);
            const floatv excess =
                fma(splat(END_ERROR_WEIGHT * end_error), fabs(light_at_end), -MOST_ERROR(task->pass) * fabs(integral));
            show(excess, first_ray(round), memory->excess);
        }
#endif
        if (round != TILE_ROUNDS - 1u)
            continue;
        meet();
#ifdef DEPTH
        if (end_error > 0.0f && !none_is_positive(memory->excess))
            return false;
        meet_again();
#endif
        if (!seems_smooth(task->pass, least_light, memory->integrals))
            return false;
    }
    for (uint round = 0; round < TILE_ROUNDS; ++round) {
        const uint first = first_ray(round + FIRST_TEST_ROUND);
        const floatv truth = shown(first, memory->integrals);
        const floatv seen = interpolate(memory->integrals, &rays->down[round], &rays->across[round]);
        if (first >= TILE_RAYS)
            show(fabs(seen - truth) - MOST_ERROR(task->pass) * max(fabs(truth), splat(least_light)), first - TILE_RAYS,
                 memory->excess);
    }
    meet();
    if (!none_is_positive(memory->excess))
        return false;
    for (uint round = 0; round < TILE_ROUNDS && is_node(first_ray(round)); ++round)
        add_light(emission, shown(first_ray(round), memory->integrals), first_ray(round), memory->light);
    return true;
}
