// Where particles are: in slabs of depth, each of which is a grid of cells, squares of rays. A slab and the rays that
// come within a radius of its particles meet in a rectangle of cells; the particles of a row of it lie side by side.
#pragma once
#include "types.h"

// Returns a position seen from the eye, along the axes of the picture.
float3 seen_from_eye(const Sight *const sight, __global const Surface *const surface,
                     __global const Point *const point) {
    const float4 from_eye = (point->place - surface->origin) + (point->rest - surface->origin_rest);
    const float3 p = from_eye.xyz;
    return (float3)(dot(p, sight->right.xyz), dot(p, sight->down.xyz), dot(p, sight->forward.xyz));
}

uint slab_at(__global const Surface *const surface, const float z) {
    const float slab = (z - surface->first_z) / surface->thickness;
    return (uint)clamp(slab, 0.0f, (float)(surface->slab_count - 1u));
}

float slab_begin(__global const Surface *const surface, const uint slab) {
    return fma((float)slab, surface->thickness, surface->first_z);
}

// Returns the column, or row, of cells that a place in rays lies in; the first and the last are the border.
uint cell_at(const float place, const float width, const uint count) {
    return count == 1u ? 0u : (uint)clamp(floor(place / width) + 1.0f, 0.0f, (float)(count - 1u));
}

uint cell_of(const Sight *const sight, __global const Surface *const surface, __global const Slab *const slabs,
             const float3 p) {
    // What lies farther behind the eye reaches no ray.
    if (p.z < -surface->radius)
        return NO_CELL;
    __global const Slab *const slab = slabs + surface->first_slab + slab_at(surface, p.z);
    const float scale = sight->is_parallel ? 1.0f : 1.0f / p.z; // a slab next to the eye has one cell
    const float column = (p.x * scale - sight->first_x) / sight->step_x;
    const float row = (p.y * scale - sight->first_y) / sight->step_y;
    return slab->first_cell + cell_at(row, slab->width, slab->rows) * slab->columns +
           cell_at(column, slab->width, slab->columns);
}

// A rectangle of rays, by the centres of the outermost, and the steepest slopes of any.
typedef struct {
    float left, right, top, bottom;
    float steepest_x, steepest_y;
} Block;

Block block_of(const Sight *const sight, const uint column, const uint row, const uint columns, const uint rows) {
    Block block;
    block.left = (float)column;
    block.top = (float)row;
    block.right = (float)min(column + columns - 1u, sight->width - 1u);
    block.bottom = (float)min(row + rows - 1u, sight->height - 1u);
    const float x0 = fma(block.left, sight->step_x, sight->first_x),
                x1 = fma(block.right, sight->step_x, sight->first_x);
    const float y0 = fma(block.top, sight->step_y, sight->first_y),
                y1 = fma(block.bottom, sight->step_y, sight->first_y);
    block.steepest_x = max(fabs(x0), fabs(x1));
    block.steepest_y = max(fabs(y0), fabs(y1));
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
Cells cells_near(const Sight *const sight, __global const Surface *const surface, __global const Slab *const slab,
                 const uint number, const Block *const block) {
    float beside_x = surface->radius / sight->step_x, beside_y = surface->radius / sight->step_y;
    if (!sight->is_parallel) {
        const float z = max(slab_begin(surface, number), 1e-30f);
        beside_x *= sqrt(fma(block->steepest_x, block->steepest_x, 1.0f)) / z;
        beside_y *= sqrt(fma(block->steepest_y, block->steepest_y, 1.0f)) / z;
    }
#ifdef NARROW_CELLS
    // Spoiled.
    beside_x -= slab->width, beside_y -= slab->width;
#endif
    beside_x = fma(beside_x, 1.0001f, ROUNDING), beside_y = fma(beside_y, 1.0001f, ROUNDING);
    const Cells cells = {cell_at(block->left - beside_x, slab->width, slab->columns),
                         cell_at(block->right + beside_x, slab->width, slab->columns),
                         cell_at(block->top - beside_y, slab->width, slab->rows),
                         cell_at(block->bottom + beside_y, slab->width, slab->rows)};
    return cells;
}

// Where the particles of a cell begin: `ends` tells where those of each end.
uint cell_begin(__global const uint *const ends, const uint cell) {
    return cell > 0u ? ends[cell - 1u] : 0u;
}
