// What depths do to the rays of a tile. Only where they are as smooth as the light that is interpolated, all over the
// tile, can its nodes tell the rest: every pixel's depth is looked at, so that no edge passes between the nodes.
#pragma once
#include "tile.h"

// Where the ends of a tile's rays differ from what its nodes tell by more than this, as a parameter s, no source is put
// to the test.
#ifndef MOST_END_ERROR
#define MOST_END_ERROR 1e-2f
#endif

typedef struct {
    bool is_dark;    // all of every ray is hidden
    float end_error; // by how much a pixel's ray ends before or after what the nodes tell, at most, as a parameter s; 0
                     // if nothing is hidden
} Hiding;

#ifdef DEPTH
#define END_MARGIN 1e-3f

// The tile's pixels that the image has, from a corner of its depths.
typedef struct {
    __global const float *corner;
    uint width, columns, rows;
} TileDepths;

// Loads LANES consecutive depths of a row; the tile's last one stands for those beyond.
floatv depths_from(const TileDepths *const depths, const uint x, const uint y) {
    __global const float *const row = depths->corner + y * depths->width;
    if (x + LANES <= depths->columns)
        return load_lanes(row + x);
    return gather(row, as_intv(min(x + LANE_NUMBERS, (uintv)(depths->columns - 1u))));
}

// The least and the greatest depth of this work-item's rows.
typedef struct {
    floatv least, greatest;
} DepthRange;

INLINE DepthRange range_of_depths(const TileDepths *const depths) {
    DepthRange range = {splat(INFINITY), splat(0.0f)};
    for (uint y = get_local_id(0); y < depths->rows; y += TILE_WORKERS) {
        for (uint x = 0; x < depths->columns; x += LANES) {
            const floatv depth = depths_from(depths, x, y);
            range.least = min(range.least, depth), range.greatest = max(range.greatest, depth);
        }
    }
    return range;
}

// A polynomial of degree 3 in each lane, from its values at -1, -q, q and 1.
typedef struct {
    floatv c0, c1, c2, c3;
} Cubic;

Cubic cubic_through(const float q, const floatv v0, const floatv v1, const floatv v2, const floatv v3) {
    const float scale = 1.0f / (1.0f - q * q);
    const floatv outer_even = 0.5f * (v0 + v3), inner_even = 0.5f * (v1 + v2);
    const floatv outer_odd = 0.5f * (v3 - v0), inner_odd = (0.5f / q) * (v2 - v1);
    const floatv c2 = scale * (outer_even - inner_even), c3 = scale * (outer_odd - inner_odd);
    const Cubic cubic = {outer_even - c2, outer_odd - c3, c2, c3};
    return cubic;
}

// Returns by how much depths differ from the polynomial through the nodes', at most, in this work-item's rows.
INLINE floatv error_of_depths(const TilePass *const pass, const TileDepths *const depths,
                              __local const float *const nodes) {
    floatv error = splat(0.0f);
    for (uint x = 0; x < depths->columns; x += LANES) {
        const Basis across = basis_at(pass, min(x + LANE_NUMBERS, (uintv)(depths->columns - 1u)));
        floatv rows[NODES_A_SIDE];
        for (uint i = 0; i < NODES_A_SIDE; ++i) {
            rows[i] = splat(0.0f);
            for (uint j = 0; j < NODES_A_SIDE; ++j)
                rows[i] = fma(across.weight[j], splat(nodes[NODES_A_SIDE * i + j]), rows[i]);
        }
        const Cubic down = cubic_through(inner_place(pass), rows[0], rows[1], rows[2], rows[3]);
        for (uint y = get_local_id(0); y < depths->rows; y += TILE_WORKERS) {
            const floatv t = splat(2.0f * (float)y / (float)(pass->size - 1u) - 1.0f);
            const floatv seen = fma(fma(fma(down.c3, t, down.c2), t, down.c1), t, down.c0);
            error = max(error, fabs(depths_from(depths, x, y) - seen));
        }
    }
    return error;
}

// Where the rays through a tile's nodes would end without depths, as depths, and by how much s grows with depth.
typedef struct {
    floatv end, growth;
} DepthScale;

DepthScale depth_scale(const View *const view, const Ray *const ray) {
    const floatv to_plane = ray->length * inverse(ray->stretch);
    const floatv per_length = inverse(ray->length);
    const float near = view->near_plane;
    if (view->is_parallel) {
        const DepthScale even = {near + ray->length, per_length};
        return even;
    }
    const bool is_along_ray = near == 0.0f;
    const DepthScale scale = {is_along_ray ? to_plane + ray->length : near * fma(ray->length, inverse(to_plane), 1.0f),
                              is_along_ray ? per_length : to_plane * per_length * (1.0f / near)};
    return scale;
}

// Returns the least of what the work-items of a group show.
float least_shown(const floatv value, __local float *const values) {
    meet();
    show(value, first_ray(0), values);
    meet();
    float least = values[0];
    for (uint ray = 1; ray < ROUND_RAYS; ++ray)
        least = min(least, values[ray]);
    return least;
}
#endif

INLINE Hiding hiding_of_tile(const Screen *const screen, const TilePass *const pass, const Tile *const tile,
                             const TileRays *const rays, const uint end_row, __local float *const nodes,
                             __local float *const values) {
    Hiding hiding = {false, 0.0f};
#ifdef DEPTH
    const View *const view = screen->view;
    const TileDepths depths = {screen->depths + tile->row * view->width + tile->column, view->width,
                               min(pass->size, view->width - tile->column), min(pass->size, end_row - tile->row)};
    floatv first_end = splat(INFINITY), last_end = splat(0.0f), growth = splat(0.0f);
    for (uint round = 0; round < TILE_ROUNDS; ++round) {
        const DepthScale scale = depth_scale(view, &rays->rays[round]);
        first_end = min(first_end, scale.end), last_end = max(last_end, scale.end), growth = max(growth, scale.growth);
    }
    const DepthRange range = range_of_depths(&depths);
    const float nearest = least_shown(range.least, values), farthest = -least_shown(-range.greatest, values);
    const float margin = END_MARGIN * view->ray_length;
    hiding.is_dark = farthest <= view->hides_all;
    if (hiding.is_dark || nearest >= margin - least_shown(-last_end, values))
        return hiding;
    // Rays that end at a depth and rays that end by themselves meet in a kink.
    hiding.end_error = 1.0f;
    if (farthest >= least_shown(first_end, values) - margin)
        return hiding;
    for (uint round = 0; round < TILE_ROUNDS && is_node(first_ray(round)); ++round) {
        const uintv ray = first_ray(round) + LANE_NUMBERS;
        const uintv column = tile->column + node_place(pass, ray & 3u), row = tile->row + node_place(pass, ray >> 2u);
        show(depth_of_pixel(screen, column, row), first_ray(round), nodes);
    }
    meet();
    const float error = -least_shown(-error_of_depths(pass, &depths, nodes), values);
    hiding.end_error = error * -least_shown(-growth, values);
#endif
    return hiding;
}
