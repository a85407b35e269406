// Where no light of a source can be: every source whose light ends has a ball that holds all of it. A ball is tested
// against a cone around the rays through some pixels, from the eye.
#pragma once
#include "../../view.h"
#include "tile.h"

// Some pixels' cone: its axis goes through the middle of the pixels, and holds a ball of a radius around that point.
// Lengths are those on the projection plane, over the distance of a tile from the eye.
typedef struct {
    float4 axis;
    float radius;
    float length2;  // squared, of the axis
    float tangent2; // the squared length of a tangent from the eye to that ball; 0 if the eye lies within
} Cone;

// By how much a cone is widened, of its radius, to hold what is rounded.
#ifndef CONE_MARGIN // a test spoils it
#define CONE_MARGIN 1.01f
#endif

// Returns the radius that so many columns and rows of pixels need.
float radius_of_pixels(const View *const view, const uint columns, const uint rows) {
    const float across = 0.5f * (float)(columns - 1u), down = 0.5f * (float)(rows - 1u);
    const float right2 = dot(view->column_step, view->column_step), below2 = dot(view->row_step, view->row_step);
    return CONE_MARGIN * sqrt(across * across * right2 + down * down * below2);
}

// Returns the middle of so many columns and rows of pixels of a tile, from its first one on.
float4 middle_of_pixels(const View *const view, const Tile *const tile, const uint columns, const uint rows) {
    const float column = (float)tile->column + 0.5f * (float)(columns - 1u);
    const float row = (float)tile->row + 0.5f * (float)(rows - 1u);
    return view->first_pixel + column * view->column_step + row * view->row_step;
}

INLINE Cone cone_around(const float4 axis, const float radius) {
    const float length2 = dot(axis, axis);
    const Cone cone = {axis, radius, length2, max(length2 - radius * radius, 0.0f)};
    return cone;
}

INLINE Cone cone_of_tile(const View *const view, const Tile *const tile, const uint size) {
    const float4 middle = middle_of_pixels(view, tile, size, size);
    const float per_length = 1.0f / sqrt(dot(middle, middle));
    return cone_around(per_length * middle, per_length * radius_of_pixels(view, size, size));
}

// What the cones of a tile's blocks have in common, with the axis of the first, and the steps from pixel to pixel.
typedef struct {
    float4 axis, right, below;
    float radius;
} BlockCones;

INLINE BlockCones cones_of_blocks(const View *const view, const Tile *const tile) {
    const float4 middle = middle_of_pixels(view, tile, BLOCK_WIDTH, BLOCK_HEIGHT);
    const float per_length = 1.0f / sqrt(dot(middle, middle));
    const BlockCones cones = {per_length * middle, per_length * view->column_step, per_length * view->row_step,
                              per_length * radius_of_pixels(view, BLOCK_WIDTH, BLOCK_HEIGHT)};
    return cones;
}

// Returns the cone of the block that begins at a column and row of the tile.
INLINE Cone cone_of_block(const BlockCones *const cones, const uint column, const uint row) {
    return cone_around(cones->axis + (float)column * cones->right + (float)row * cones->below, cones->radius);
}

// Returns whether a ball (centre and radius; of a negative radius: all of space) lies beside a cone.
INLINE bool is_beside(const float4 ball, const Cone *const cone) {
    const float4 axis = cone->axis;
    const float x = ball.y * axis.z - ball.z * axis.y, y = ball.z * axis.x - ball.x * axis.z,
                z = ball.x * axis.y - ball.y * axis.x;
    const float ahead = ball.x * axis.x + ball.y * axis.y + ball.z * axis.z;
    const float from_axis2 = x * x + y * y + z * z;
    const float most = ball.w * cone->length2 + max(ahead, 0.0f) * cone->radius;
    return ball.w >= 0.0f && from_axis2 * cone->tangent2 > most * most;
}
