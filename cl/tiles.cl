// The image by tiles. A source whose light is smooth on a tile is computed at the tile's nodes and interpolated; where
// it is not, the next pass looks at the tile's quarters, and the last one at each pixel. So every source costs most
// next to its core, whatever the others do.
#include "clearance.h"
#include "radiance.h"
#include "store.h"
#include "tile.h"

// Tiles that a pass leaves open, for the next one. Of each: its column and row, a bit for each source that is not yet
// in its light, and the light of all others at its nodes.
#define OPEN_TILE_PLACE 2u
#define LIGHT_OF_TILE (3u * TILE_RAYS)

// Closer to a core than this many times a tile's side its light is taken for rough without a look.
#ifndef LEAST_CLEARANCE
#define LEAST_CLEARANCE 0.5f
#endif

// What an interpolation may be off by where it is tested; a test of the test gives up on it.
#ifndef MOST_ERROR
#define MOST_ERROR pass->most_error
#endif

// What a group of work-items holds of a tile.
typedef struct {
    float integrals[TILE_RAYS]; // of one source at the nodes
    float excess[TILE_RAYS];    // of the error where it is tested
    float light[LIGHT_OF_TILE]; // red, green, blue of all settled sources at the nodes
    uint open[MOST_WORDS];
    uint slot;
} TileMemory;

// A bit for each of the sources that are left, at most 32.
uint first_bits(const uint left) {
    return left < 32u ? (1u << left) - 1u : ~0u;
}

uint lowest_bit(const uint bits) {
    return bits & -bits;
}

uint bit_number(const uint bit) {
    return 31u - clz(bit);
}

// The light of one source at the nodes, given to the tile's light if it is smooth on the tile. Whether it is.
#define DEFINE_SETTLE(kind, list)                                                                                      \
    INLINE bool settle_##kind(const TileRays *const rays, const TilePass *const pass, const Sources *const sources,    \
                              const uint index, const Quadrature *const quadrature, __local TileMemory *const memory,  \
                              uint *const integrals) {                                                                 \
        meet();                                                                                                        \
        for (uint round = 0; round < TILE_ROUNDS; ++round) {                                                           \
            const Ray *const ray = &rays->nodes[round];                                                                \
            const floatv clearance2 = kind##_clearance2(ray, sources, index, pass->pixel_step);                        \
            const bool is_near = any_lane(clearance2 < least_clearance2(pass));                                        \
            *integrals += is_near ? 0 : LANES;                                                                         \
            show(is_near ? splat(NAN) : exact_##kind(ray, sources, index, quadrature), first_ray(round),               \
                 memory->integrals);                                                                                   \
        }                                                                                                              \
        meet();                                                                                                        \
        if (!seems_smooth(pass, memory->integrals))                                                                    \
            return false;                                                                                              \
        for (uint round = 0; round < TILE_ROUNDS; ++round) {                                                           \
            const floatv truth = exact_##kind(&rays->tests[round], sources, index, quadrature);                        \
            const floatv seen = interpolate(memory->integrals, &rays->down[round], &rays->across[round]);              \
            *integrals += LANES;                                                                                       \
            show(fabs(seen - truth) - MOST_ERROR * fabs(truth), first_ray(round), memory->excess);                     \
        }                                                                                                              \
        meet();                                                                                                        \
        if (!none_is_positive(memory->excess))                                                                         \
            return false;                                                                                              \
        const float4 emission = sources->list[index].emission;                                                         \
        for (uint round = 0; round < TILE_ROUNDS; ++round)                                                             \
            add_light(emission, shown(first_ray(round), memory->integrals), first_ray(round), memory->light);          \
        return true;                                                                                                   \
    }

// All sources of one kind that are open in the tile.
#define SETTLE(kind)                                                                                                   \
    for (uint begin = launch->kind##_begin; begin < launch->kind##_end; begin += 32u, ++word) {                        \
        uint left = parent_open ? parent_open[word] : first_bits(launch->kind##_end - begin), open = 0;                \
        for (; left != 0; left &= left - 1u) {                                                                         \
            const uint bit = lowest_bit(left), i = begin + bit_number(bit);                                            \
            if (!settle_##kind(&rays, pass, sources, i, quadrature, memory, &integrals))                               \
                open |= bit;                                                                                           \
        }                                                                                                              \
        if (get_local_id(0) == 0)                                                                                      \
            memory->open[word] = open;                                                                                 \
        is_open |= open;                                                                                               \
    }

// The light of the sources of one kind that stayed open.
#define ADD_OPEN(kind, list)                                                                                           \
    for (uint begin = launch->kind##_begin; begin < launch->kind##_end; begin += 32u, ++word) {                        \
        for (uint left = memory->open[word]; left != 0; left &= left - 1u) {                                           \
            const uint i = begin + bit_number(lowest_bit(left));                                                       \
            const floatv integral = exact_##kind(&ray, sources, i, quadrature);                                        \
            radiance = fma3(uniform3(sources->list[i].emission), integral, radiance);                                  \
            integrals += LANES;                                                                                        \
        }                                                                                                              \
    }

// The rays of a tile: through its nodes, and through the points where interpolation is tested, with the weights of the
// nodes there.
typedef struct {
    Ray nodes[TILE_ROUNDS], tests[TILE_ROUNDS];
    Basis across[TILE_ROUNDS], down[TILE_ROUNDS];
} TileRays;

INLINE TileRays rays_of_tile(const View *const view, const TilePass *const pass, const Tile *const tile) {
    TileRays rays;
    for (uint round = 0; round < TILE_ROUNDS; ++round) {
        const uintv ray = first_ray(round) + LANE_NUMBERS, column = ray & 3u, row = ray >> 2u;
        rays.nodes[round] =
            ray_through(view, tile->column + node_place(pass, column), tile->row + node_place(pass, row));
        const uintv test_column = test_place(pass, column), test_row = test_place(pass, row);
        rays.tests[round] = ray_through(view, tile->column + test_column, tile->row + test_row);
        rays.across[round] = basis_at(pass, test_column);
        rays.down[round] = basis_at(pass, test_row);
    }
    return rays;
}

float least_clearance2(const TilePass *const pass) {
    const float least_clearance = LEAST_CLEARANCE * (float)pass->size;
    return least_clearance * least_clearance;
}

// Red, green and blue of some rays of a tile.
void show_light(const float3v light, const uint ray, __local float *const all) {
    show(light.x, ray, all);
    show(light.y, ray, all + TILE_RAYS);
    show(light.z, ray, all + 2u * TILE_RAYS);
}

void add_light(const float4 emission, const floatv integral, const uint ray, __local float *const all) {
    const float3v before = {shown(ray, all), shown(ray, all + TILE_RAYS), shown(ray, all + 2u * TILE_RAYS)};
    show_light(fma3(uniform3(emission), integral, before), ray, all);
}

#ifdef SPHERES
DEFINE_SETTLE(sphere, spheres)
#endif
#ifdef CYLINDERS
DEFINE_SETTLE(cylinder, cylinders)
#endif
#ifdef TORI
DEFINE_SETTLE(torus, tori)
#endif
#ifdef CURVES
DEFINE_SETTLE(curve, curves)
#endif

// The light at the nodes of a tile, from that at the nodes of the tile that it is a quarter of.
INLINE void inherit_light(const TilePass *const pass, const Tile *const tile, const Tile *const parent,
                          __local float *const light) {
    TilePass of_parent = *pass;
    of_parent.size = 2u * pass->size;
    of_parent.inner = pass->parent_inner;
    float3v inherited[TILE_ROUNDS];
    for (uint round = 0; round < TILE_ROUNDS; ++round) {
        const uintv ray = first_ray(round) + LANE_NUMBERS;
        const uintv column = node_place(pass, ray & 3u) + (tile->column - parent->column);
        const uintv row = node_place(pass, ray >> 2u) + (tile->row - parent->row);
        const Basis across = basis_at(&of_parent, column), down = basis_at(&of_parent, row);
        inherited[round].x = interpolate(light, &down, &across);
        inherited[round].y = interpolate(light + TILE_RAYS, &down, &across);
        inherited[round].z = interpolate(light + 2u * TILE_RAYS, &down, &across);
    }
    meet();
    for (uint round = 0; round < TILE_ROUNDS; ++round)
        show_light(inherited[round], first_ray(round), light);
}

// Gives every source that is smooth on the tile to its light. Whether any is not.
INLINE bool settle_sources(const View *const view, const Launch *const launch, const TilePass *const pass,
                           const Sources *const sources, const Quadrature *const quadrature, const Tile *const tile,
                           __global const uint *const parent_open, __local TileMemory *const memory) {
    const TileRays rays = rays_of_tile(view, pass, tile);
    uint word = 0, is_open = 0, integrals = 0;
#ifdef SPHERES
    SETTLE(sphere)
#endif
#ifdef CYLINDERS
    SETTLE(cylinder)
#endif
#ifdef TORI
    SETTLE(torus)
#endif
#ifdef CURVES
    SETTLE(curve)
#endif
    meet();
    atomic_add(quadrature->counts + COUNT_INTEGRALS, integrals);
    return is_open != 0;
}

// Writes the tile's pixels: its light interpolated, and the light of the sources that are still open.
INLINE void paint_tile(const View *const view, const Launch *const launch, const TilePass *const pass,
                       const Sources *const sources, const Quadrature *const quadrature, const Tile *const tile,
                       const bool is_open, __local const TileMemory *const memory, __global float4 *const image) {
    const uint end_row = (launch->first + launch->count) / view->width;
    uint integrals = 0;
    for (uint y = 0; y < pass->size && tile->row + y < end_row; y += BLOCK_HEIGHT) {
        for (uint round = 0; round < TILE_ROUNDS; ++round) {
            const uintv ray_number = first_ray(round) + LANE_NUMBERS;
            const uintv row = y + ray_number / BLOCK_WIDTH;
            const Basis down = basis_at(pass, row);
            floatv red[NODES_A_SIDE], green[NODES_A_SIDE], blue[NODES_A_SIDE];
            interpolate_down(memory->light, &down, red);
            interpolate_down(memory->light + TILE_RAYS, &down, green);
            interpolate_down(memory->light + 2u * TILE_RAYS, &down, blue);
            for (uint x = 0; x < pass->size && tile->column + x < view->width; x += BLOCK_WIDTH) {
                const uintv column = x + ray_number % BLOCK_WIDTH;
                const Basis across = basis_at(pass, column);
                float3v radiance = {interpolate_across(red, &across), interpolate_across(green, &across),
                                    interpolate_across(blue, &across)};
                if (is_open) {
                    const Ray ray = ray_through(view, tile->column + column, tile->row + row);
                    uint word = 0;
#ifdef SPHERES
                    ADD_OPEN(sphere, spheres)
#endif
#ifdef CYLINDERS
                    ADD_OPEN(cylinder, cylinders)
#endif
#ifdef TORI
                    ADD_OPEN(torus, tori)
#endif
#ifdef CURVES
                    ADD_OPEN(curve, curves)
#endif
                }
                const uint corner = (tile->row + y) * view->width + tile->column + x;
                store_block(image + launch->slot + (corner - launch->first), first_ray(round), view->width,
                            view->width - tile->column - x, end_row - tile->row - y, radiance, launch->accumulate);
            }
        }
    }
    atomic_add(quadrature->counts + COUNT_INTEGRALS, integrals);
}

// The tile of a number: in the first pass tiles come row by row, in the others four for each open tile.
Tile tile_of(const TilePass *const pass, const Launch *const launch, const uint width, const Tile *const parent,
             const uint number) {
    Tile tile;
    if (pass->level == 0) {
        tile.column = number % pass->columns * pass->size;
        tile.row = launch->first / width + number / pass->columns * pass->size;
    } else {
        tile.column = parent->column + (number & 1u) * pass->size;
        tile.row = parent->row + (number >> 1u & 1u) * pass->size;
    }
    return tile;
}

// Keeps a tile for the next pass.
INLINE void leave_open(const TilePass *const pass, const Tile *const tile, __global uint *const counts,
                       __local TileMemory *const memory, __global uint *const open_tiles,
                       __global float *const open_light) {
    if (get_local_id(0) == 0)
        memory->slot = pass->write_to + atomic_inc(counts + COUNT_OPEN_TILES + pass->level);
    meet();
    __global uint *const mine = open_tiles + memory->slot * (OPEN_TILE_PLACE + pass->word_count);
    mine[0] = tile->column;
    mine[1] = tile->row;
    for (uint word = get_local_id(0); word < pass->word_count; word += TILE_WORKERS)
        mine[OPEN_TILE_PLACE + word] = memory->open[word];
    for (uint k = get_local_id(0); k < LIGHT_OF_TILE; k += TILE_WORKERS)
        open_light[memory->slot * LIGHT_OF_TILE + k] = memory->light[k];
}

__kernel __attribute__((reqd_work_group_size(TILE_WORKERS, 1, 1))) void
tiles(const View view, const Launch launch, __global const Node *const restrict nodes,
      __global const Sphere *const restrict spheres, __global const Cylinder *const restrict cylinders,
      __global const Torus *const restrict tori, __global const Curve *const restrict curves,
      __global const SplinePiece *const restrict spline_pieces, __global uint *const restrict counts,
      __global float4 *const restrict image, const TilePass pass, __global uint *const restrict open_tiles,
      __global float *const restrict open_light) {
    __local TileMemory memory;
    const Sources sources = {spheres, cylinders, tori, curves, spline_pieces};
    const Quadrature quadrature = {nodes, 0, decay_of(&view), view.torus_threshold, view.curve_threshold, counts};
    const uint count = pass.level == 0 ? pass.tile_count : 4u * counts[COUNT_OPEN_TILES + pass.level - 1u];
    const uint end_row = (launch.first + launch.count) / view.width;
    for (uint number = get_group_id(0); number < count; number += get_num_groups(0)) {
        Tile parent = {0, 0};
        __global const uint *parent_open = 0;
        __global const float *parent_light = 0;
        if (pass.level > 0) {
            const uint slot = pass.read_from + number / 4u;
            __global const uint *const place = open_tiles + slot * (OPEN_TILE_PLACE + pass.word_count);
            parent.column = place[0], parent.row = place[1];
            parent_open = place + OPEN_TILE_PLACE;
            parent_light = open_light + slot * LIGHT_OF_TILE;
        }
        const Tile tile = tile_of(&pass, &launch, view.width, &parent, number);
        if (tile.column >= view.width || tile.row >= end_row)
            continue;
        meet();
        for (uint k = get_local_id(0); k < LIGHT_OF_TILE; k += TILE_WORKERS)
            memory.light[k] = parent_light ? parent_light[k] : 0.0f;
        meet();
        if (parent_light)
            inherit_light(&pass, &tile, &parent, memory.light);
        const bool is_open = settle_sources(&view, &launch, &pass, &sources, &quadrature, &tile, parent_open, &memory);
        if (is_open && !pass.is_last)
            leave_open(&pass, &tile, counts, &memory, open_tiles, open_light);
        else
            paint_tile(&view, &launch, &pass, &sources, &quadrature, &tile, is_open, &memory, image);
    }
}
