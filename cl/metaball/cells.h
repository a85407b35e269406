// Where particles are: in slabs of depth, each of which is a grid of cells, squares of rays. A slab and the rays that
// come within a radius of its particles meet in a rectangle of cells; the particles of a row of it lie side by side.
#pragma once
#include "../lanes.h"
#include "types.h"

// Returns a position seen from the eye, along the axes of the picture.
INLINE float3 seen_from_eye(const Sight *const sight, __global const Surface *const surface,
                            __global const Point *const point) {
    const float4 from_eye = (point->place - surface->origin) + (point->rest - surface->origin_rest);
    const float3 p = from_eye.xyz;
    return (float3)(dot(p, sight->right.xyz), dot(p, sight->down.xyz), dot(p, sight->forward.xyz));
}

INLINE uint slab_at(__global const Surface *const surface, const float z) {
    const float slab = (z - surface->first_z) / surface->thickness;
    return (uint)clamp(slab, 0.0f, (float)(surface->slab_count - 1u));
}

float slab_begin(__global const Surface *const surface, const uint slab) {
    return fma((float)slab, surface->thickness, surface->first_z);
}

// Returns the column, or row, of cells that a place in rays lies in; the first and the last are the border.
INLINE uint cell_at(const float place, const float inverse_width, const uint count) {
    return (uint)clamp(floor(place * inverse_width) + 1.0f, 0.0f, (float)(count - 1u));
}

// Says whether a position is more than a radius away from all rays: from the planes of the outermost.
INLINE bool is_beside(const Sight *const sight, __global const Surface *const surface, const float3 p) {
    const float z = sight->is_parallel ? 1.0f : p.z;
    const float skew = (float)(sight->height - 1u) * sight->skew_x;
    const float2 begin = (float2)(sight->first_x, sight->first_y);
    const float2 first = begin + (float2)(min(skew, 0.0f), 0.0f);
    const float2 last =
        fma((float2)(sight->step_x, sight->step_y), (float2)((float)(sight->width - 1u), (float)(sight->height - 1u)),
            begin + (float2)(max(skew, 0.0f), 0.0f));
    const float most = 1.0001f * surface->radius;
    const float2 before = first * z - p.xy, beyond = p.xy - last * z;
    const float2 at_first = sight->is_parallel ? (float2)(most) : most * sqrt(fma(first, first, 1.0f));
    const float2 at_last = sight->is_parallel ? (float2)(most) : most * sqrt(fma(last, last, 1.0f));
    return any(before > at_first) || any(beyond > at_last);
}

INLINE uint cell_of(const Sight *const sight, __global const Surface *const surface, __global const Slab *const slabs,
                    const float3 p) {
    // What lies farther behind the eye, or beside the picture, reaches no ray.
    if (p.z < -surface->radius || is_beside(sight, surface, p))
        return NO_CELL;
    __global const Slab *const slab = slabs + surface->first_slab + slab_at(surface, p.z);
    const float scale = sight->is_parallel ? 1.0f : 1.0f / p.z; // a slab next to the eye has one cell
    const float row = (p.y * scale - sight->first_y) / sight->step_y;
    const float column = (p.x * scale - fma(row, sight->skew_x, sight->first_x)) / sight->step_x;
    return slab->first_cell + cell_at(row, slab->inverse_width, slab->rows) * slab->columns +
           cell_at(column, slab->inverse_width, slab->columns);
}

// A rectangle of rays, by the centres of the outermost, and by how much farther a radius reaches beside its steepest
// rays than beside the axis of view: what is seen at a slant is seen wider.
typedef struct {
    float left, right, top, bottom;
    float slant_x, slant_y;
    float steepest2; // the squared slope of the steepest ray, at most
} Block;

Block block_of(const Sight *const sight, const uint column, const uint row, const uint columns, const uint rows) {
    Block block;
    block.left = (float)column;
    block.top = (float)row;
    block.right = (float)min(column + columns - 1u, sight->width - 1u);
    block.bottom = (float)min(row + rows - 1u, sight->height - 1u);
    block.slant_x = block.slant_y = 1.0f;
    block.steepest2 = 0.0f;
    if (sight->is_parallel)
        return block;
    const float2 first = (float2)(sight->first_x, sight->first_y), step = (float2)(sight->step_x, sight->step_y);
    const float2 skew = sight->skew_x * (float2)(block.top, block.bottom);
    const float2 low = fma((float2)(block.left, block.top), step, first + (float2)(min(skew.x, skew.y), 0.0f));
    const float2 high = fma((float2)(block.right, block.bottom), step, first + (float2)(max(skew.x, skew.y), 0.0f));
    const float2 steepest = max(fabs(low), fabs(high));
    const float2 slant = sqrt(fma(steepest, steepest, 1.0f));
    // A column of rays that leans is seen at both slants.
    block.slant_x = sight->skew_x == 0.0f ? slant.x : max(slant.x, slant.y);
    block.slant_y = slant.y;
    block.steepest2 = dot(steepest, steepest);
    return block;
}

// Cells of a slab.
typedef struct {
    uint left, right, top, bottom;
} Cells;

// Rays by which rectangles are wider than they need to be, so that rounding loses no particle.
#define ROUNDING 0.01f

// Returns the cells of a slab in which particles are that come within a radius of a ray of a block: of the plane of a
// column of rays, by whose slope the distance to it is seen.
Cells cells_near(__global const Slab *const slab, const Block *const block) {
    float beside_x = fma(slab->beside_x, block->slant_x, ROUNDING);
    float beside_y = fma(slab->beside_y, block->slant_y, ROUNDING);
#ifdef NARROW_CELLS
    // Spoiled.
    beside_x -= 1.0f / slab->inverse_width, beside_y -= 1.0f / slab->inverse_width;
#endif
    const float inverse_width = slab->inverse_width;
    const Cells cells = {cell_at(block->left - beside_x, inverse_width, slab->columns),
                         cell_at(block->right + beside_x, inverse_width, slab->columns),
                         cell_at(block->top - beside_y, inverse_width, slab->rows),
                         cell_at(block->bottom + beside_y, inverse_width, slab->rows)};
    return cells;
}

// Where the particles of a cell begin: `ends` tells where those of each end.
uint cell_begin(__global const uint *const ends, const uint cell) {
    return cell > 0u ? ends[cell - 1u] : 0u;
}
