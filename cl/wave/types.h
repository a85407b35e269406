// The structs of the wave that cross from the host to the device and are not a kind's own; those are in the kinds'
// headers. src/wave/pack/layout.rs mirrors them.
//
// Positions are seen from the eye (world axes, world units): float32 then resolves best where the rays are. What
// float32 leaves of a number stands in a field named `rest` (fine.h).
#pragma once
#include "../check_size.h"

// What is integrated along every ray, and how well.
typedef struct {
    float softening2;       // squared softening radius
    float decay_strength;   // alpha / beta, with a power m alpha beta^(1 - m); 1 without decay
    float decay_beta;       // 0 without decay
    float decay_per_beta;   // 1 / beta; 0 without decay
    float smooth_threshold; // method exact: how large unresolved coefficients may be, of the integral,
    float kinked_threshold; // and where the field along a ray has kinks
    uint node_count;        // nodes of the quadrature
    float absorption;       // a binary logarithm per world unit
    uint seed;              // method jittered: chooses the random numbers
} Integrand;
CHECK_SIZE(Integrand, SIZEOF_INTEGRAND);

// How a source's field falls off.
typedef struct {
    uint profile;  // 0: 1/q, 1: 1/q^2, 2: 1/q^3, of q^2 = d^2 + radius^2; 3: a Gaussian of d, 4: 1/d smeared by it,
                   // 5: 1/q of every point of the core, added up
    float radius2; // squared radius of the core; 0: it has none
    float reach2;  // squared distance at which the light ends; 0: nowhere
    float reach2_rest;
} Falloff;
CHECK_SIZE(Falloff, SIZEOF_FALLOFF);

// Which part of each list of sources a launch takes, and where it counts. A kind has the same number here and in
// kinds.h.
typedef struct {
    uint begin[KIND_COUNT], end[KIND_COUNT];
    uint first_ball[KIND_COUNT]; // -D ENDS: where among the rows the balls around a kind's sources begin
    uint first_count;            // of its own in the list of counts
} Launch;
CHECK_SIZE(Launch, SIZEOF_LAUNCH);

// One pass over tiles of one size, squares of pixels. The first has the largest, each of the others what the one before
// left open, in quarters.
typedef struct {
    uint size;                // of a tile, pixels
    uint inner, parent_inner; // nodes are the pixels 0, inner, size - 1 - inner and size - 1 of its rows and columns
    uint level;               // 0: the first pass
    uint is_last;             // 1: what is still open is computed pixel by pixel
    uint columns, tile_count; // first pass: tiles in a row of tiles, and in all
    uint read_from;           // where the list of open tiles has those of the pass before
    uint write_to;            // where it gets this one's
    uint word_count;          // words of 32 sources
    uint from, to;            // which of the pass' tiles a launch takes, in shares of 1 / TILE_SHARES
    float pixel_step;         // from a pixel to its neighbour, world units on the projection plane
    float most_odd;    // how large an odd and an even highest coefficient of an interpolation may be, of the least
    float most_even;   // value; else it is not put to the test
    float most_error;  // and how large its relative error in the test;
    float least_light; // what is less counts as this much in both, linear light
} TilePass;
CHECK_SIZE(TilePass, SIZEOF_TILEPASS);

// A ray that is no pixel's: origin S, span E - S.
typedef struct {
    float4 origin, origin_rest;
    float4 span, span_rest;
} RayRecord;
CHECK_SIZE(RayRecord, SIZEOF_RAYRECORD);

// Cells of a grid, some of its layers.
typedef struct {
    float4 first;  // the lowest corner, seen from the middle of the grid
    float step;    // the edge of a cell
    float floor2;  // no squared distance to a core is taken below this
    float share;   // of a place in its cell
    uint parts;    // places along an edge of a cell, in the middles of as many pieces
    uint columns;  // cells of a row
    uint rows;     // rows of a layer
    uint count;    // rows in all
    uint stride;   // from a row to the next
    uint plane;    // from a channel to the next
    uint channels; // 3; 6 with those of the light of all but the strongest source
    uint padding0, padding1;
} Cells;
CHECK_SIZE(Cells, SIZEOF_CELLS);

// A quadrature node: parameter s, and its weight times the decay zeta(s).
typedef struct {
    float s;
    float weight;
} Node;
CHECK_SIZE(Node, SIZEOF_NODE);
