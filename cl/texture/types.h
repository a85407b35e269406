// The structs that the host fills in: src/texture/pack.rs has them in the same order. Vectors are seen from the eye,
// world axes and units.
#pragma once
#include "../check_size.h"

// The rays of the picture, and what light becomes along them.
typedef struct {
    float4 first_pixel, column_step, row_step;
    float4 toward;                 // of all rays, if they are parallel
    float near, ray_length;        // of the projection plane; from there on
    float scale, beta, per_length; // scale / (beta + per_length t)^power
    float absorbed;                // light halves so often in a unit
    uint power, width, height;
    uint is_parallel, has_depth, is_along_axis;
} TextureView;
CHECK_SIZE(TextureView, SIZEOF_TEXTUREVIEW);

// A volume.
typedef struct {
    float4 to_x, to_y, to_z; // from a place to cells: 0 is the middle of the first
    float red, green, blue;
    float floor;                       // no reciprocal is below
    uint columns, rows, layers, sheet; // cells; what is between values of one layer and the next
    uint channels, power, is_cubic;    // power: 0 of emission, 1 or 2 of reciprocals
    uint slices;                       // 0: by rays
    float step;                        // cells
    float middle, radius;              // along the view, and of the ball around the box
    uint line;                         // what is between values of one row and the next
    uint coarse_line, coarse_sheet;    // the same of the coarse grid
    float most_left;                   // what long steps may leave, relative
    uint has_bricks;
} TextureVolume;
CHECK_SIZE(TextureVolume, SIZEOF_TEXTUREVOLUME);
