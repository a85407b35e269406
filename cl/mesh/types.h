// The structs of meshes that cross from the host to the device; src/mesh/pack.rs mirrors them.
//
// Positions are seen from the tree's origin, along the axes of the world.
#pragma once
#include "../check_size.h"

// A box of the tree, and what is in it: two boxes, one behind the other, or triangles.
typedef struct {
    float low_x, low_y, low_z;
    uint first; // its first box, or its first triangle
    float high_x, high_y, high_z;
    uint count; // triangles; 0: there are two boxes
} TreeNode;
CHECK_SIZE(TreeNode, SIZEOF_TREENODE);

// A triangle, in the order of the tree.
typedef struct {
    float a_x, a_y, a_z;
    uint mesh; // whose it is
    float b_x, b_y, b_z;
    uint normal; // in 32 bits, see normal_of
    float c_x, c_y, c_z;
    uint padding;
} MeshTriangle;
CHECK_SIZE(MeshTriangle, SIZEOF_MESHTRIANGLE);

// The grid of rays, which may be finer than the pixels. A ray of an eye leaves the axis of view by its slopes, a ray of
// parallel ones by an offset; what lies along it is measured along that axis, which need not be perpendicular to rows
// and columns.
typedef struct {
    float4 eye, eye_rest;                 // from the tree's origin
    float4 right, down, forward;          // axes of the picture: along rows, along columns, along the view, of length 1
    float4 to_right, to_down, to_forward; // what gives a place, seen from the eye, along those axes
    float first_x, first_y;               // slope, or offset, of the first ray
    float step_x, step_y;                 // from a ray to the next one to the right, and below
    uint width, height;                   // rays in a row, and in a column
    uint across;                          // rays across and down in a pixel
    uint is_parallel;
    uint has_depth;     // something else hides the meshes
    uint is_along_axis; // those depths are lengths along the axis of view, not along the rays
    uint depth_step;    // so many rays across and down have one depth
    float axis_length;  // a depth along that axis times so much is one along `forward`
    float margin;       // boxes are so much wider: rounding loses no triangle
    uint padding0, padding1, padding2;
} MeshSight;
CHECK_SIZE(MeshSight, SIZEOF_MESHSIGHT);

// The light on meshes.
typedef struct {
    float4 lamp;    // where it is, world axes, of length 1
    float4 ambient; // what comes from all around
    float4 sun;     // what the lamp gives what faces it
} MeshLight;
CHECK_SIZE(MeshLight, SIZEOF_MESHLIGHT);

// No triangle.
#define NOTHING 0xffffffffu
