// The structs of particles as light that cross from the host to the device; src/glow/pack.rs and src/glow/along.rs
// mirror them.
//
// Positions of a picture are seen from the eye, along the axes of the picture: x to the right, y down, z along the
// view. A ray of an eye leaves the axis by its slopes, a ray of parallel ones by an offset: x = x0 + slope z. For
// listed rays positions are seen from the middle of all that shines, along the axes of the world.
#pragma once
#include "../check_size.h"

// The grid of rays, and what light becomes along them.
typedef struct {
    float first_x, first_y; // slope, or offset, of the first ray
    float step_x, step_y;   // from a ray to the next one to the right, and below
    float near;             // from the eye to the projection plane, along the axis of view
    float ray_length;       // from the plane, along a ray
    float scale;            // what the integral over length is multiplied with, the decay's alpha included
    float beta;             // of the decay, a length
    float absorbed;         // binary logarithm of what is absorbed, per length
    uint power;             // of the decay; 0: there is none
    uint width, height;     // pixels
    uint is_parallel;
    uint has_depth, is_along_axis; // whether depths end rays, and whether they are lengths along the axis of view
    uint tile;                     // pixels across and down in a tile
    uint tile_columns;
    float skew_x; // by which a ray lies more to the right than that above it
    uint padding0, padding1;
} GlowView;
CHECK_SIZE(GlowView, SIZEOF_GLOWVIEW);

// A ball, or a stretch of a streak along which the radius changes evenly.
typedef struct {
    float x, y, z; // its middle
    float radius;  // of the ball, or of the stretch at its middle
    float red, green, blue;
    uint form;
    float axis_x, axis_y, axis_z; // of a stretch: from its middle to its end
    float growth;                 // by which the radius is greater at that end than in the middle
    float inverse_radius;
    float rest_x, rest_y, rest_z; // what float32 leaves of the middle, where rays are listed
} Element;
CHECK_SIZE(Element, SIZEOF_ELEMENT);

// Forms.
#define IS_SMOOTH 1u     // the kernel: (1 - r^2/h^2)^3, else (1 - r/h)^2
#define IS_STRETCH 2u    // no ball
#define HAS_FIRST_CAP 4u // a stretch with half a ball at its begin,
#define HAS_LAST_CAP 8u  // and at its end
#define IS_CLEAR 16u     // a ball that no begin or end of rays cuts, and far from a decay's pole

// A listed ray. Lengths are counted from its place next to the middle of all that shines.
typedef struct {
    float place[3], place_rest[3];
    float toward[3], toward_rest[3]; // the direction, of length 1
    float begin, end, begin_rest, end_rest;
    float length;
    float beta; // of the decay, a length
} GlowRay;
CHECK_SIZE(GlowRay, SIZEOF_GLOWRAY);

// A box around elements. Boxes follow each other as one walks down a tree: those within a box follow it.
typedef struct {
    float low_x, low_y, low_z;
    uint next; // where to go on if no ray meets it; of a leaf: its first element
    float high_x, high_y, high_z;
    uint count; // elements of a leaf; else 0
} GlowBox;
CHECK_SIZE(GlowBox, SIZEOF_GLOWBOX);
