// The structs of the metaballs that cross from the host to the device; src/metaball/pack.rs mirrors them.
//
// Positions are seen from the eye, along the axes of the picture: x to the right, y down, z along the view. A ray of an
// eye leaves the axis by its slopes, a ray of parallel ones by an offset: x = x0 + slope z.
#pragma once
#include "../check_size.h"

// The grid of rays, which may be finer than the pixels.
typedef struct {
    float4 right, down, forward; // axes of the picture, world axes, of length 1
    float first_x, first_y;      // slope, or offset, of the first ray
    float step_x, step_y;        // from a ray to the next one to the right, and below
    uint width, height;          // rays in a row, and in a column
    uint across;                 // rays across and down in a pixel
    uint unit;                   // rays across and down that a work-item takes, whole pixels, at most 16
    uint is_parallel;
    uint is_along_axis; // depths are lengths along the axis of view, not along the rays
    uint has_depth;     // something else hides the surfaces
    uint depth_step;    // so many rays across and down have one depth
    uint span_columns;  // squares of rays of which the slabs are known that matter
    uint square;        // rays across and down in such a square
    float skew_x;       // by which a ray lies more to the right than that above it
    uint padding0;
} Sight;
CHECK_SIZE(Sight, SIZEOF_SIGHT);

// A surface, and where its particles and cells are in the lists of all surfaces.
typedef struct {
    float4 origin, origin_rest; // from where its particles are given to the eye, world axes
    float4 color;
    float radius; // the greatest of its particles, times `wider`
    float threshold;
    float first_z, thickness; // of the slabs
    uint slab_count;
    uint reach; // a particle's field ends within so many slabs before and behind its own
    uint first_slab;
    uint first_point, point_count;
    uint is_smooth;    // the kernel: (1 - r^2/h^2)^3, else (1 - r/h)^2
    uint has_normals;  // the shading: the normal as a colour
    uint samples;      // method sampling; 0: exact
    uint refinements;  // of sampling
    float interval;    // of sampling
    uint first_square; // in the list of what slabs matter
    float wider;       // within so many radii of a ray particles matter to it
} Surface;
CHECK_SIZE(Surface, SIZEOF_SURFACE);

// A slab of depths: a grid of cells, squares of rays, with a border of cells for what lies beside the picture.
typedef struct {
    uint first_cell;
    uint columns, rows;       // 1: there is one cell, next to the eye
    float inverse_width;      // of a cell, which is so many rays wide
    float beside_x, beside_y; // rays on the axis of view to which the radius of the surface reaches, at most
} Slab;
CHECK_SIZE(Slab, SIZEOF_SLAB);

// A particle as the host gives it, from its surface's origin along the axes of the world.
typedef struct {
    float4 place; // the position in float32, and the radius
    float4 rest;  // what that leaves of the position, and the weight
} Point;
CHECK_SIZE(Point, SIZEOF_POINT);

// A particle in its cell.
typedef struct {
    float x, y, z;
    float radius, inverse_radius;
    float weight;
    float growth; // what the bound of the field's growth is multiplied with
    uint padding;
} Particle;
CHECK_SIZE(Particle, SIZEOF_PARTICLE);

// No cell: the particle is seen by no ray.
#define NO_CELL 0xffffffffu
