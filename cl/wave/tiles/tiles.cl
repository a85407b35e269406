// The image by tiles. A source whose light is smooth on a tile is computed at the tile's nodes and interpolated; where
// it is not, the next pass looks at the tile's quarters, and the last one at each pixel. So every source costs most
// next to its core, whatever the others do.
#include "../../film.h"
#include "../radiance.h"
#include "ball.h"
#include "clearance.h"
#include "hiding.h"
#include "smoothness.h"
#include "tile.h"

// What all tiles of a pass have in common.
typedef struct {
    const Screen *screen;
    const FilmPart *part;
    const Launch *launch;
    const TilePass *pass;
    const Sources *sources;
    const Quadrature *quadrature;
    uint end_row; // of the pixels to paint
} TileTask;

// What a group of work-items holds of a tile. Light is red, green and blue at 16 nodes.
#define LIGHT_OF_TILE (3u * TILE_RAYS)
typedef struct {
    float seen[PLACES_SEEN][TILE_RAYS]; // of one source at the nodes,
    float integrals[ALL_RAYS];          // and along all rays
    float excess[ALL_RAYS];             // of what is tested over what is allowed; 16 of it
#ifdef SHAPES
    float to_light[TILE_RAYS]; // of one source at the nodes, pixels
#endif
    float light[LIGHT_OF_TILE]; // of all sources that are smooth on the tile
    uint open[MOST_WORDS];      // a bit for each source that is not
    uint slot;
} TileMemory;

// The list of tiles that a pass leaves open has, for each, its column and row, its open sources, and its light.
#define OPEN_TILE_PLACE 2u
typedef struct {
    __global uint *tiles;
    __global float *light;
} OpenTiles;

// Shows the group red, green and blue of some rays of a tile.
void show_light(const float3v light, const uint ray, __local float *const all) {
    show(light.x, ray, all);
    show(light.y, ray, all + TILE_RAYS);
    show(light.z, ray, all + 2u * TILE_RAYS);
}

void add_light(const float4 emission, const floatv integral, const uint ray, __local float *const all) {
    const float3v before = {shown(ray, all), shown(ray, all + TILE_RAYS), shown(ray, all + 2u * TILE_RAYS)};
    show_light(fma3(uniform3(emission), integral, before), ray, all);
}

#include "settle.h" // sphere_settle and so on

// Returns a bit for each of the sources that are left, at most 32.
uint first_bits(const uint left) {
    return left < 32u ? (1u << left) - 1u : ~0u;
}

// Returns the number of the lowest bit.
uint lowest_bit(const uint bits) {
    return 31u - clz(bits & -bits);
}

#ifdef ENDS
// Whether a ball holds all light of a source, and whether that lies beside a cone.
#define BALL_OF(number, index) (task->sources->rows[task->launch->first_ball[number] + (index)])
#define HAS_BALL(number, index) (BALL_OF(number, index).w >= 0.0f)
#define PASSES_BY(number, index, cone) is_beside(BALL_OF(number, index), cone)

// Returns true if any of the sources of one kind may light a cone; `bits` has those of a word that count.
#define LIGHTS(number, bits)                                                                                           \
    for (uint begin = launch->begin[number]; begin < launch->end[number]; begin += 32u, ++word) {                      \
        for (uint left = bits; left != 0; left &= left - 1u) {                                                         \
            if (!PASSES_BY(number, begin + lowest_bit(left), cone))                                                    \
                return true;                                                                                           \
        }                                                                                                              \
    }
#define LIGHTS_TILE(kind, Type, number)                                                                                \
    LIGHTS(number, parent_open ? parent_open[word] : first_bits(launch->end[number] - begin))
#define LIGHTS_BLOCK(kind, Type, number) LIGHTS(number, memory->open[word])

// Returns whether any source may light a tile, of those that are open in the tile that it is a quarter of, or of all.
bool may_light_tile(const TileTask *const task, const Cone *const cone, __global const uint *const parent_open) {
    const Launch *const launch = task->launch;
    uint word = 0;
    KINDS(LIGHTS_TILE)
    return false;
}

// Returns whether any source that is open may light a block.
bool may_light_block(const TileTask *const task, const Cone *const cone, __local const TileMemory *const memory) {
    const Launch *const launch = task->launch;
    uint word = 0;
    KINDS(LIGHTS_BLOCK)
    return false;
}

// Returns whether a tile has no light to interpolate.
bool is_black(__local const float *const light) {
    uint bits = 0;
    for (uint k = 0; k < LIGHT_OF_TILE; ++k)
        bits |= as_uint(light[k]);
    return bits == 0u;
}
#else
#define HAS_BALL(number, index) false
#define PASSES_BY(number, index, cone) false
#define may_light_tile(task, cone, parent_open) true
#define may_light_block(task, cone, memory) true
#define is_black(light) false
#endif

// Settles the sources of one kind that are open in the tile this one is a quarter of, or all of them.
#define SETTLE(kind, Type, number)                                                                                     \
    for (uint begin = launch->begin[number]; begin < launch->end[number]; begin += 32u, ++word) {                      \
        uint open = 0;                                                                                                 \
        const uint all = parent_open ? parent_open[word] : first_bits(launch->end[number] - begin);                    \
        for (uint left = hiding.is_dark ? 0u : all; left != 0; left &= left - 1u) {                                    \
            const uint bit = lowest_bit(left);                                                                         \
            if (PASSES_BY(number, begin + bit, &cone))                                                                 \
                continue;                                                                                              \
            if (hiding.end_error > MOST_END_ERROR ||                                                                   \
                !kind##_settle(task, &rays, hiding.end_error, begin + bit, memory, &integrals)) {                      \
                open |= 1u << bit;                                                                                     \
                is_slow |= !(kind##_is_quick && HAS_BALL(number, begin + bit));                                        \
            }                                                                                                          \
        }                                                                                                              \
        if (get_local_id(0) == 0)                                                                                      \
            memory->open[word] = open;                                                                                 \
        is_open |= open;                                                                                               \
    }

// What becomes of a tile: it is painted as it is, or pixel by pixel, or left to the next pass.
#define ALL_SETTLED 0u
#define BY_PIXELS 1u
#define LEFT_OPEN 2u

// Tiles of this side are not cut further for what ends and is quick: their blocks are tested one by one.
#define QUICK_SIZE 16u

// Settles the sources on the tile, and returns what becomes of it.
INLINE uint settle_sources(const TileTask *const task, const Tile *const tile, __global const uint *const parent_open,
                           __local TileMemory *const memory) {
    const Launch *const launch = task->launch;
    const Cone cone = cone_of_tile(task->screen->view, tile, task->pass->size);
    if (!may_light_tile(task, &cone, parent_open)) {
        meet();
        return ALL_SETTLED;
    }
    const TileRays rays = rays_of_tile(task->screen, task->pass, tile);
    const Hiding hiding =
        hiding_of_tile(task->screen, task->pass, tile, &rays, task->end_row, memory->integrals, memory->excess);
    uint word = 0, is_open = 0, integrals = 0;
    bool is_slow = false;
    KINDS(SETTLE)
    meet();
    atomic_add(task->quadrature->counts + COUNT_INTEGRALS, integrals);
    if (is_open == 0u)
        return ALL_SETTLED;
    const bool is_cut = is_slow || task->pass->size > QUICK_SIZE;
    return is_cut && !task->pass->is_last ? LEFT_OPEN : BY_PIXELS;
}

// Adds the light of the sources of one kind that stayed open.
#define ADD_OPEN(kind, Type, number)                                                                                   \
    for (uint begin = launch->begin[number]; begin < launch->end[number]; begin += 32u, ++word) {                      \
        for (uint left = memory->open[word]; left != 0; left &= left - 1u) {                                           \
            const uint i = begin + lowest_bit(left);                                                                   \
            if (PASSES_BY(number, i, cone))                                                                            \
                continue;                                                                                              \
            const floatv light = LIGHT_OF(kind, task->screen->view, ray, task->sources, i, task->quadrature);          \
            radiance = fma3(uniform3(kind##_emission(task->sources, i)), light, radiance);                             \
            *integrals += LANES;                                                                                       \
        }                                                                                                              \
    }

// Returns the light of all sources that stayed open, along rays within a cone.
INLINE float3v open_light_along(const TileTask *const task, const Ray *const ray, const Cone *const cone,
                                __local const TileMemory *const memory, uint *const integrals) {
    const Launch *const launch = task->launch;
    float3v radiance = uniform3((float4)(0.0f));
    uint word = 0;
    KINDS(ADD_OPEN)
    return radiance;
}

// Writes the tile's pixels, in blocks of 16: its light interpolated, and that of the sources that are still open.
INLINE void paint_tile(const TileTask *const task, const Tile *const tile, const bool is_open,
                       __local const TileMemory *const memory, FILM_PARAMETER) {
    const TilePass *const pass = task->pass;
    const uint width = task->screen->view->width;
    uint integrals = 0;
    const bool is_dark = is_black(memory->light);
    const BlockCones cones = cones_of_blocks(task->screen->view, tile);
    for (uint y = 0; y < pass->size && tile->row + y < task->end_row; y += BLOCK_HEIGHT) {
#if TILE_WORKERS > 1
        mem_fence(CLK_LOCAL_MEM_FENCE); // else compilers keep all of the tile's light in registers, 48 of them
#endif
        for (uint round = 0; round < BLOCK_ROUNDS; ++round) {
            const uintv place = first_ray(round) + LANE_NUMBERS, row = y + place / BLOCK_WIDTH;
            floatv red[NODES_A_SIDE], green[NODES_A_SIDE], blue[NODES_A_SIDE];
            if (!is_dark) {
                const Basis down = basis_at(pass, row);
                interpolate_down(memory->light, &down, red);
                interpolate_down(memory->light + TILE_RAYS, &down, green);
                interpolate_down(memory->light + 2u * TILE_RAYS, &down, blue);
            }
            for (uint x = 0; x < pass->size && tile->column + x < width; x += BLOCK_WIDTH) {
                const uintv column = x + place % BLOCK_WIDTH;
                float3v radiance = uniform3((float4)(0.0f));
                if (!is_dark) {
                    const Basis across = basis_at(pass, column);
                    radiance.x = interpolate_across(red, &across);
                    radiance.y = interpolate_across(green, &across);
                    radiance.z = interpolate_across(blue, &across);
                    if (pass->least_light > 0.0f) // errors may be larger than light
                        radiance = positive3(radiance);
                }
                const Cone cone = cone_of_block(&cones, x, y);
                if (is_open && may_light_block(task, &cone, memory)) {
                    const Ray ray = ray_through(task->screen, tile->column + column, tile->row + row);
                    radiance = add3(radiance, open_light_along(task, &ray, &cone, memory, &integrals));
                }
                const uint corner = (tile->row + y) * width + tile->column + x;
                store_block(task->part, corner - task->part->first, first_ray(round), width - tile->column - x,
                            task->end_row - tile->row - y, radiance, FILM_ARGUMENT);
            }
        }
    }
    atomic_add(task->quadrature->counts + COUNT_INTEGRALS, integrals);
}

// Takes over the light of all sources that are smooth on the tile that this one is a quarter of, at the nodes of this
// one.
INLINE void inherit_light(const TilePass *const pass, const Tile *const tile, const Tile *const parent,
                          __local float *const light) {
    TilePass of_parent = *pass;
    of_parent.size = 2u * pass->size;
    of_parent.inner = pass->parent_inner;
    float3v inherited[TILE_ROUNDS];
    for (uint round = 0; round < TILE_ROUNDS; ++round) {
        const uintv ray = (first_ray(round) & (TILE_RAYS - 1u)) + LANE_NUMBERS;
        const uintv column = node_place(pass, ray & 3u) + (tile->column - parent->column);
        const uintv row = node_place(pass, ray >> 2u) + (tile->row - parent->row);
        const Basis across = basis_at(&of_parent, column), down = basis_at(&of_parent, row);
        inherited[round].x = interpolate(light, &down, &across);
        inherited[round].y = interpolate(light + TILE_RAYS, &down, &across);
        inherited[round].z = interpolate(light + 2u * TILE_RAYS, &down, &across);
    }
    meet();
    for (uint round = 0; round < TILE_ROUNDS && is_node(first_ray(round)); ++round)
        show_light(inherited[round], first_ray(round), light);
}

// Keeps a tile for the next pass.
INLINE void leave_open(const TileTask *const task, const Tile *const tile, __local TileMemory *const memory,
                       const OpenTiles open) {
    const TilePass *const pass = task->pass;
    if (get_local_id(0) == 0)
        memory->slot = pass->write_to + atomic_inc(task->quadrature->counts + COUNT_OPEN_TILES + pass->level);
    meet();
    __global uint *const mine = open.tiles + memory->slot * (OPEN_TILE_PLACE + pass->word_count);
    if (get_local_id(0) == 0)
        mine[0] = tile->column, mine[1] = tile->row;
    for (uint word = get_local_id(0); word < pass->word_count; word += TILE_WORKERS)
        mine[OPEN_TILE_PLACE + word] = memory->open[word];
    for (uint k = get_local_id(0); k < LIGHT_OF_TILE; k += TILE_WORKERS)
        open.light[memory->slot * LIGHT_OF_TILE + k] = memory->light[k];
}

// Renders a tile, or leaves it open. In the first pass tiles come row by row, in the others four for each open tile.
INLINE void render_tile(const TileTask *const task, const uint number, const OpenTiles open,
                        __local TileMemory *const memory, FILM_PARAMETER) {
    const TilePass *const pass = task->pass;
    const uint width = task->screen->view->width;
    const bool has_parent = pass->level > 0;
    const uint slot = pass->read_from + number / 4u;
    __global const uint *const parent_place = open.tiles + slot * (OPEN_TILE_PLACE + pass->word_count);
    Tile parent = {0, 0};
    Tile tile = {number % pass->columns * pass->size, task->part->first / width + number / pass->columns * pass->size};
    if (has_parent) {
        parent.column = parent_place[0], parent.row = parent_place[1];
        tile.column = parent.column + (number & 1u) * pass->size;
        tile.row = parent.row + (number >> 1u & 1u) * pass->size;
    }
    if (tile.column >= width || tile.row >= task->end_row)
        return;
    meet();
    for (uint k = get_local_id(0); k < LIGHT_OF_TILE; k += TILE_WORKERS)
        memory->light[k] = has_parent ? open.light[slot * LIGHT_OF_TILE + k] : 0.0f;
    meet();
    if (has_parent)
        inherit_light(pass, &tile, &parent, memory->light);
    const uint fate = settle_sources(task, &tile, has_parent ? parent_place + OPEN_TILE_PLACE : 0, memory);
    if (fate == LEFT_OPEN)
        leave_open(task, &tile, memory, open);
    else
        paint_tile(task, &tile, fate == BY_PIXELS, memory, FILM_ARGUMENT);
}

// Returns the first of so many tiles that lies after a share of them.
uint share_of(const uint count, const uint share) {
    return (uint)((ulong)count * share / TILE_SHARES);
}

__kernel __attribute__((reqd_work_group_size(TILE_WORKERS, 1, 1))) void
tiles(const View view, const FilmPart part, const Integrand integrand, const Launch launch,
      __global const Node *const restrict nodes, KINDS(SOURCE_PARAMETER) __global const float4 *const restrict rows,
      __global uint *const restrict counts, __global const float *const restrict depths, FILM_PARAMETER,
      const TilePass pass, __global uint *const restrict open_tiles, __global float *const restrict open_light) {
    __local TileMemory memory;
    const Sources sources = {KINDS(SOURCE_VALUE) rows};
    const Quadrature quadrature = quadrature_of(&integrand, nodes, counts + launch.first_count, splat(view.ray_length),
                                                (uintv)(0)); // rays of a tile have no numbers
    const OpenTiles open = {open_tiles, open_light};
    const Screen screen = {&view, depths, integrand.softening2};
    const uint end_row = (part.first + part.count) / view.width;
    const TileTask task = {&screen, &part, &launch, &pass, &sources, &quadrature, end_row};
    const uint count = pass.level == 0 ? pass.tile_count : 4u * quadrature.counts[COUNT_OPEN_TILES + pass.level - 1u];
    const uint end = share_of(count, pass.to);
    for (uint number = share_of(count, pass.from) + get_group_id(0); number < end; number += get_num_groups(0))
        render_tile(&task, number, open, &memory, FILM_ARGUMENT);
}
