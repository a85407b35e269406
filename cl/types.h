// Every struct that crosses from the host to the device, and nothing else. src/pack/layout.rs mirrors this file in the
// same order; the host passes each size as -D SIZEOF_X, checked below at every program build.
//
// Positions are seen from the eye (world axes, world units): float32 then resolves best where the rays are. What
// float32 leaves of a number stands in a field named `rest` (fine.h).
#pragma once

// The pixel grid on the projection plane, the length of the rays that begin there, and what is integrated along them.
typedef struct {
    float4 first_pixel; // from the eye to the centre of the pixel in column 0, row 0
    float4 column_step; // from a pixel to its right neighbour
    float4 row_step;    // from a pixel to the one below
    float4 first_pixel_rest, column_step_rest, row_step_rest;
    float ray_length;                       // |E - S|
    float softening2;                       // squared softening radius
    float decay_strength;                   // alpha / beta; 1 without decay
    float decay_beta;                       // 0 without decay
    float decay_per_beta;                   // 1 / beta; 0 without decay
    float torus_threshold, curve_threshold; // method exact: how large unresolved coefficients may be, of the integral
    uint width;                             // pixels in a row
    uint height;
    float near_plane, near_plane_rest; // where depths are taken along the axis of view, the eye's distance from the
                                       // projection plane; 0: they are taken along the ray
    float hides_all;                   // a depth up to here hides all of any ray
} View;

// One launch: which pixels (or rays), and which part of each list of sources.
typedef struct {
    uint first;      // index of the first pixel, row by row from the top left
    uint count;      // pixels
    uint slot;       // where in the output buffer the first pixel goes, in pixels
    uint accumulate; // 0: overwrite the output; 1: add to it
    uint node_count; // nodes of the quadrature
    uint sphere_begin, sphere_end;
    uint cylinder_begin, cylinder_end;
    uint torus_begin, torus_end;
    uint curve_begin, curve_end;
    uint beam_begin, beam_end;
    uint is_last; // 1: no launch adds to these pixels any more
} Launch;

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
    float pixel_step;         // from a pixel to its neighbour, world units on the projection plane
    float most_odd;   // how large an odd and an even highest coefficient of an interpolation may be, of the least
    float most_even;  // value; else it is not put to the test
    float most_error; // and how large its relative error in the test
} TilePass;

// A ray that is no pixel's: origin S, span E - S.
typedef struct {
    float4 origin, origin_rest;
    float4 span, span_rest;
} RayRecord;

// A quadrature node: parameter s, and its weight times the decay zeta(s).
typedef struct {
    float s;
    float weight;
} Node;

// In all sources, emission is colour times coefficient, linear RGB (times |E - S| where light is measured by length).
typedef struct {
    float4 center, center_rest;
    float4 emission;
    uint is_square; // in all sources: 1 if the field is 1 over the squared distance
    uint padding_0, padding_1, padding_2;
} Sphere;

typedef struct {
    float4 point, point_rest;         // the point of the line nearest to the eye
    float4 direction, direction_rest; // unit
    float4 emission;
    uint is_square;
    uint padding_0, padding_1, padding_2;
} Cylinder;

typedef struct {
    float4 tip, tip_rest;
    float4 point, point_rest;         // the point of the line nearest to the eye
    float4 direction, direction_rest; // unit
    float4 emission;                  // colour alone, times |E - S| where light is measured by length
    float line, cap, sphere;         // coefficients: of the line ahead of the tip, of the point behind it, of the point
                                     // everywhere
    float per_taper, per_taper_rest; // 1 over the length of the taper behind the tip; 0 without
    uint is_square;
    uint padding_0, padding_1;
} Beam;

typedef struct {
    float4 center, center_rest;
    float4 axis, axis_rest; // unit
    float4 emission;
    float major_radius, major_radius_rest;
    uint is_square;
    uint padding;
} Torus;

// C(t) - C(1/2) = along * (velocity_along x) + across * (velocity_across x + bend x^2), with x = t - 1/2.
typedef struct {
    float4 middle, middle_rest;     // C(1/2)
    float4 velocity, velocity_rest; // C'(1/2)
    float4 second, second_rest;     // C2: C(t) = C(1/2) + C'(1/2) x + C2 x^2
    float4 along;                   // unit, in the plane of the curve, perpendicular to C2
    float4 across;                  // unit, in the plane of the curve, along C2
    float4 normal;                  // unit, perpendicular to the plane
    float4 emission;
    float velocity_along;
    float velocity_across;
    float bend;        // |C2|
    float vertex;      // x of the parabola's vertex, negated
    uint is_straight;  // 1: so straight that the cubic for the nearest point degenerates
    uint spline_begin; // first of its pieces in the list of spline pieces
    uint spline_count; // pieces of its local-intensity series; 0: intensity 1
    uint is_square;
} Curve;

// One piece of a quadratic B-spline: S = c0 + c1 x + c2 x^2, x in [0,1] over the piece.
typedef struct {
    float c0, c1, c2;
    float padding;
} SplinePiece;

#define CHECK_SIZE(type, size) typedef char type##_has_the_size_that_the_host_expects[sizeof(type) == (size) ? 1 : -1]
CHECK_SIZE(View, SIZEOF_VIEW);
CHECK_SIZE(Launch, SIZEOF_LAUNCH);
CHECK_SIZE(TilePass, SIZEOF_TILEPASS);
CHECK_SIZE(RayRecord, SIZEOF_RAYRECORD);
CHECK_SIZE(Node, SIZEOF_NODE);
CHECK_SIZE(Sphere, SIZEOF_SPHERE);
CHECK_SIZE(Cylinder, SIZEOF_CYLINDER);
CHECK_SIZE(Beam, SIZEOF_BEAM);
CHECK_SIZE(Torus, SIZEOF_TORUS);
CHECK_SIZE(Curve, SIZEOF_CURVE);
CHECK_SIZE(SplinePiece, SIZEOF_SPLINEPIECE);
