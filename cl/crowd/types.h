// What the kernels of the crowd are given. Places are pixels of a square grid around the image, whose cells of 8 pixels
// have Morton codes; a cell of level k has 8 * 2^k pixels a side. src/crowd/pack.rs has the same structs.
#pragma once
#include "../check_size.h"
#include "../lanes.h"

// Levels of cells and tiles, at most.
#define MOST_LEVELS 8u

// Nodes of a cell along a side, and in depth, at most.
#define MOST_NODES 6u
#define MOST_DEPTHS 16u

typedef struct {
    float first_u,
        first_v;          // slope at the corner of the grid: x, y over z, seen from the eye along the axes of the image
    float step_u, step_v; // from a pixel to the next
    float near_plane;
    float ray_length;
    float nearness;     // beta / (1 + beta): what decay leaves of the light at the end of a ray; 1 without
    float advance;      // of v along a ray, see cl/wave/quadrature/decay.h
    float pole;         // beta times the length of rays
    float scale;        // of all light
    float tolerance;    // of a pixel
    float floor2;       // no squared distance is taken below it
    uint is_square;     // the light of a source falls off with the square of the distance
    uint nodes, depths; // of a cell: nodes^2 depths
    uint top, base;     // the highest level, and the lowest with depths
    uint width, height;
    uint left, above;   // where the image lies in the grid, pixels
    uint sources, rest; // in the grid, and beside it
    uint roots;         // tiles of the highest level
    uint tile_columns;  // tiles of 8 pixels in a row of the image
    uint has_near_form; // sources next to a pixel have the form of one that is near
    float thickness;    // of a core as pixels see it that are means over their squares, a slope; 0 where they are not
    uint across;        // cells of the highest level in a row, a power of 2
    uint block;         // cells on each side of a tile that belong to what lies around it
    uint shallow;       // levels below it have limits
    uint is_along_axis; // depths are lengths along the axis of view
    float slab_begin;   // the share of rays at which slabs begin
    float per_slab;     // slabs by the share
    uint whole_depths;  // of a cell, for whole rays
} CrowdView;
CHECK_SIZE(CrowdView, SIZEOF_CROWDVIEW);

// A source in the grid: its place from the middle of its cell of 8 pixels, z, and light; along a ray that passes it
// at a small angle it gives `peak` times core_of(angle), plus `level`; once cells are summed, `level` is the least
// square of a sine.
typedef struct {
    float x, y, z;
    float red, green, blue;
    float peak, level;
} CrowdSource;
CHECK_SIZE(CrowdSource, SIZEOF_CROWDSOURCE);

// An open or finished tile: its Morton code, the slot of the tile that it is a quarter of, its level, and which of its
// rays need more light than the tile has: whole ones, and those that are cut.
typedef struct {
    uint code, parent, level, is_open;
} CrowdTile;
CHECK_SIZE(CrowdTile, SIZEOF_CROWDTILE);

#define WHOLE_OPEN 1u
#define CUT_OPEN 2u

// Numbers that all kernels look up: nodes, then factors of the weights, each of a tile, a cell, and depths.
#define TILE_NODES 0u
#define CELL_NODES 8u
#define DEPTH_NODES 16u
#define FACTORS 32u
#define WHOLE_NODES 96u
#define DEPTH_WEIGHTS 112u  // [one for whole rays][MOST_DEPTHS]
#define QUARTER_WEIGHTS 64u // [side of the parent][node of the tile][node of the parent]

// Counts: of the tiles of each level, and of what they looked at.
#define COUNTED_CELLS 16u
#define COUNTED_LIMITS 17u
#define COUNTED_PAIRS 18u
#define COUNTED_END 20u

// Returns where the middle of the cell of a source is, from what says which column and row of cells it is in.
float middle_x_of(const uint cell) {
    return (float)(8u * (cell & 0xffffu) + 4u);
}

float middle_y_of(const uint cell) {
    return (float)(8u * (cell >> 16) + 4u);
}

// Returns the columns of a cell, or rows, in a Morton code shifted by one.
uint every_other(uint code) {
    code &= 0x55555555u;
    code = (code | code >> 1) & 0x33333333u;
    code = (code | code >> 2) & 0x0f0f0f0fu;
    code = (code | code >> 4) & 0x00ff00ffu;
    return (code | code >> 8) & 0x0000ffffu;
}

uint spread_bits(uint number) {
    number = (number | number << 8) & 0x00ff00ffu;
    number = (number | number << 4) & 0x0f0f0f0fu;
    number = (number | number << 2) & 0x33333333u;
    return (number | number << 1) & 0x55555555u;
}

uint code_of(const uint column, const uint row) {
    return spread_bits(column) | spread_bits(row) << 1;
}

// Returns how many cells all levels below one have.
uint cells_below(const CrowdView *const view, const uint level) {
    const uint all = view->across * view->across << (2u * view->top);
    return level == 0u ? 0u : (4u * all - (4u * all >> (2u * level))) / 3u;
}

// Returns how many numbers say where the depths of a cell are: the middle and the half of the range of ln z, z at the
// depths for cut rays, and at those for whole ones.
uint planes_of_cell(const CrowdView *const view) {
    return 2u + view->depths + view->whole_depths;
}

// Returns cells of a level in a row.
uint cells_across(const CrowdView *const view, const uint level) {
    return view->across << (view->top - level);
}

// Returns how many cells of a level may have limits on nodes: those of more sources than nodes.
uint limits_in(const CrowdView *const view, const uint level) {
    const uint across = cells_across(view, level);
    return min(across * across, view->sources / (view->nodes * view->nodes + 1u) + 1u);
}

// Returns which of all limits a cell has, whose sources begin at one: no two such cells begin within so many sources.
uint limits_of_cell(const CrowdView *const view, const uint level, const uint cell, const uint first) {
    const uint across = cells_across(view, level), count = limits_in(view, level);
    uint at = count == across * across ? cell : first / (view->nodes * view->nodes + 1u);
    for (uint below = 0u; below < level; ++below)
        at += limits_in(view, below);
    return at;
}
