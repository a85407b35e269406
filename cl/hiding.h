// What depths do to the rays of a tile. Only where they end smoothly, all over it, can light be interpolated: every
// pixel is looked at, so that no edge of an occluder passes between the nodes.
#pragma once
#include "tile.h"

// Where the ends of a tile's rays differ from what its nodes tell by more than this, as a parameter s, no source is put
// to the test.
#define MOST_END_ERROR 1e-2f

typedef struct {
    bool is_dark;    // all of every ray is hidden
    float end_error; // by how much a pixel's ray ends before or after what the nodes tell, at most; 0 if nothing is
                     // hidden
} Hiding;

#ifdef DEPTH
// The least and the greatest depth of the tile's pixels.
INLINE float2 depths_of_tile(const Screen *const screen, const TilePass *const pass, const Tile *const tile,
                             const uint end_row, __local float *const low, __local float *const high) {
    const uint width = screen->view->width;
    const uint columns = min(pass->size, width - tile->column), rows = min(pass->size, end_row - tile->row);
    __global const float *line = screen->depths + (tile->row + get_local_id(0)) * width + tile->column;
    float8 least8 = (float8)(INFINITY), greatest8 = (float8)(0.0f);
    for (uint y = get_local_id(0); y < rows; y += TILE_WORKERS, line += TILE_WORKERS * width) {
        uint x = 0;
        for (; x + 8u <= columns; x += 8u) {
            const float8 depths = vload8(0, line + x);
            least8 = min(least8, depths), greatest8 = max(greatest8, depths);
        }
        for (; x < columns; ++x)
            least8 = min(least8, (float8)(line[x])), greatest8 = max(greatest8, (float8)(line[x]));
    }
    const float4 least4 = min(least8.lo, least8.hi), greatest4 = max(greatest8.lo, greatest8.hi);
    meet();
    low[get_local_id(0)] = min(min(least4.x, least4.y), min(least4.z, least4.w));
    high[get_local_id(0)] = max(max(greatest4.x, greatest4.y), max(greatest4.z, greatest4.w));
    meet();
    float2 depths = (float2)(low[0], high[0]);
    for (uint worker = 1; worker < TILE_WORKERS; ++worker)
        depths = (float2)(min(depths.x, low[worker]), max(depths.y, high[worker]));
    return depths;
}

// By how much the ends of the pixels' rays differ from the polynomial through the nodes', at most.
INLINE float end_error_of_tile(const Screen *const screen, const TilePass *const pass, const Tile *const tile,
                               const TileRays *const rays, const uint end_row, __local float *const values) {
    const uint last_column = screen->view->width - 1u;
    meet();
    for (uint round = 0; round < TILE_ROUNDS; ++round)
        show(rays->nodes[round].end, first_ray(round), values);
    meet();
    floatv error = splat(0.0f);
    for (uint y = 0; y < pass->size && tile->row + y < end_row; y += BLOCK_HEIGHT) {
        for (uint round = 0; round < TILE_ROUNDS; ++round) {
            const uintv place = first_ray(round) + LANE_NUMBERS;
            const uintv row = min(tile->row + y + place / BLOCK_WIDTH, (uintv)(end_row - 1u));
            const Basis down = basis_at(pass, row - tile->row);
            floatv ends[NODES_A_SIDE];
            interpolate_down(values, &down, ends);
            for (uint x = 0; x < pass->size && tile->column + x <= last_column; x += BLOCK_WIDTH) {
                const uintv column = min(tile->column + x + place % BLOCK_WIDTH, (uintv)(last_column));
                const Basis across = basis_at(pass, column - tile->column);
                error = max(error, fabs(ray_through(screen, column, row).end - interpolate_across(ends, &across)));
            }
        }
    }
    meet();
    for (uint round = 0; round < TILE_ROUNDS; ++round)
        show(error, first_ray(round), values);
    meet();
    float most = values[0];
    for (uint ray = 1; ray < TILE_RAYS; ++ray)
        most = max(most, values[ray]);
    return most;
}
#endif

INLINE Hiding hiding_of_tile(const Screen *const screen, const TilePass *const pass, const Tile *const tile,
                             const TileRays *const rays, const uint end_row, __local float *const values,
                             __local float *const more_values) {
    Hiding hiding = {false, 0.0f};
#ifdef DEPTH
    const float2 depths = depths_of_tile(screen, pass, tile, end_row, values, more_values);
    hiding.is_dark = depths.y <= screen->view->hides_all;
    if (!hiding.is_dark && depths.x < screen->view->hides_nothing)
        hiding.end_error = end_error_of_tile(screen, pass, tile, rays, end_row, values);
#endif
    return hiding;
}
