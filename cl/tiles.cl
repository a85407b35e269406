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
#define LIGHT_OF_TILE (3u * TILE_LANES)

// Closer to a core than this many times a tile's side its light is taken for rough without a look.
#define LEAST_CLEARANCE 0.5f

// What a group of work-items holds of a tile.
typedef struct {
    float integrals[TILE_LANES];
    float light[LIGHT_OF_TILE]; // red, green, blue
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

// The sources of one kind that are open in the tile: those smooth on it give their light at its nodes.
#define SETTLE(kind, list)                                                                                             \
    for (uint begin = launch->kind##_begin; begin < launch->kind##_end; begin += 32u, ++word) {                        \
        uint left = parent_open ? parent_open[word] : first_bits(launch->kind##_end - begin), open = 0;                \
        for (; left != 0; left &= left - 1u) {                                                                         \
            const uint bit = lowest_bit(left), i = begin + bit_number(bit);                                            \
            const floatv clearance2 = kind##_clearance2(&ray, sources, i, pass->pixel_step);                           \
            floatv integral = splat(NAN);                                                                              \
            if (!any_lane(clearance2 < least_clearance2)) {                                                            \
                integral = exact_##kind(&ray, sources, i, quadrature);                                                 \
                integrals += LANES;                                                                                    \
            }                                                                                                          \
            meet();                                                                                                    \
            share(integral, memory->integrals + get_local_id(0) * LANES);                                              \
            meet();                                                                                                    \
            if (is_smooth(pass, memory->integrals))                                                                    \
                light = fma3(uniform3(sources->list[i].emission), integral, light);                                    \
            else                                                                                                       \
                open |= bit;                                                                                           \
        }                                                                                                              \
        memory->open[word] = open;                                                                                     \
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

// Linear RGB at the nodes, from the tile that this one is a quarter of.
INLINE float3v inherited_light(const TilePass *const pass, const Tile *const tile, const Tile *const parent,
                               __local const float *const light) {
    TilePass of_parent = *pass;
    of_parent.size = 2u * pass->size;
    of_parent.inner = pass->parent_inner;
    const uintv node = lanes_in_group();
    const Basis across = basis_at(&of_parent, node_place(pass, node & 3u) + (tile->column - parent->column));
    const Basis down = basis_at(&of_parent, node_place(pass, node >> 2u) + (tile->row - parent->row));
    floatv red[NODES_A_SIDE], green[NODES_A_SIDE], blue[NODES_A_SIDE];
    interpolate_down(light, &down, red);
    interpolate_down(light + TILE_LANES, &down, green);
    interpolate_down(light + 2u * TILE_LANES, &down, blue);
    const float3v inherited = {interpolate_across(red, &across), interpolate_across(green, &across),
                               interpolate_across(blue, &across)};
    return inherited;
}

// Gives every source that is smooth on the tile to its light. Whether any is not.
INLINE bool settle_sources(const View *const view, const Launch *const launch, const TilePass *const pass,
                           const Sources *const sources, const Quadrature *const quadrature, const Tile *const tile,
                           __global const uint *const parent_open, const float3v inherited,
                           __local TileMemory *const memory) {
    const uintv node = lanes_in_group();
    const uintv column = tile->column + node_place(pass, node & 3u), row = tile->row + node_place(pass, node >> 2u);
    const Ray ray = ray_through(view, column, row);
    const float least_clearance = LEAST_CLEARANCE * (float)pass->size;
    const float least_clearance2 = least_clearance * least_clearance;
    float3v light = inherited;
    uint word = 0, is_open = 0, integrals = 0;
#ifdef SPHERES
    SETTLE(sphere, spheres)
#endif
#ifdef CYLINDERS
    SETTLE(cylinder, cylinders)
#endif
#ifdef TORI
    SETTLE(torus, tori)
#endif
#ifdef CURVES
    SETTLE(curve, curves)
#endif
    __local float *const mine = memory->light + get_local_id(0) * LANES;
    share(light.x, mine);
    share(light.y, mine + TILE_LANES);
    share(light.z, mine + 2u * TILE_LANES);
    meet();
    atomic_add(quadrature->counts + COUNT_INTEGRALS, integrals);
    return is_open != 0;
}

// Writes the tile's pixels: its light interpolated, and the light of the sources that are still open.
INLINE void paint_tile(const View *const view, const Launch *const launch, const TilePass *const pass,
                       const Sources *const sources, const Quadrature *const quadrature, const Tile *const tile,
                       const bool is_open, __local const TileMemory *const memory, __global float4 *const image) {
    const uintv lane = lanes_in_group();
    const uint rows = launch->first / view->width, end_row = rows + launch->count / view->width;
    uint integrals = 0;
    for (uint y = 0; y < pass->size && tile->row + y < end_row; y += BLOCK_HEIGHT) {
        const uintv in_rows = y + lane / BLOCK_WIDTH;
        const Basis down = basis_at(pass, in_rows);
        floatv red[NODES_A_SIDE], green[NODES_A_SIDE], blue[NODES_A_SIDE];
        interpolate_down(memory->light, &down, red);
        interpolate_down(memory->light + TILE_LANES, &down, green);
        interpolate_down(memory->light + 2u * TILE_LANES, &down, blue);
        for (uint x = 0; x < pass->size && tile->column + x < view->width; x += BLOCK_WIDTH) {
            const uintv in_columns = x + lane % BLOCK_WIDTH;
            const Basis across = basis_at(pass, in_columns);
            float3v radiance = {interpolate_across(red, &across), interpolate_across(green, &across),
                                interpolate_across(blue, &across)};
            if (is_open) {
                const Ray ray = ray_through(view, tile->column + in_columns, tile->row + in_rows);
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
            const uint pixel = (tile->row + y) * view->width + tile->column + x;
            store_block(image + launch->slot + (pixel - launch->first), view->width, view->width - tile->column - x,
                        end_row - tile->row - y, radiance, launch->accumulate);
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

__kernel __attribute__((reqd_work_group_size(TILE_WORKERS, 1, 1))) void tiles(
    const View view, const Launch launch, __global const Node *const restrict nodes,
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
        float3v inherited = uniform3((float4)(0.0f));
        if (parent_light) {
            for (uint k = get_local_id(0); k < LIGHT_OF_TILE; k += TILE_WORKERS)
                memory.light[k] = parent_light[k];
            meet();
            inherited = inherited_light(&pass, &tile, &parent, memory.light);
            meet();
        }
        const bool is_open = settle_sources(&view, &launch, &pass, &sources, &quadrature, &tile, parent_open, inherited,
                                            &memory);
        if (is_open && !pass.is_last)
            leave_open(&pass, &tile, counts, &memory, open_tiles, open_light);
        else
            paint_tile(&view, &launch, &pass, &sources, &quadrature, &tile, is_open, &memory, image);
    }
}
