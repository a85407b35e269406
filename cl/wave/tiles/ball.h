// Where no light of a source can be: every source whose light ends has a ball that holds all of it. A ball is tested
// against a cone around the rays through some pixels, from the eye; of parallel rays against a cylinder.
#pragma once
#include "../../view.h"
#include "clearance.h"
#include "tile.h"

// Some pixels' cone: its axis goes through the middle of the pixels, and holds a ball of a radius around that point.
// Lengths are those on the projection plane, over the distance of a tile from the eye. Of parallel rays it is a
// cylinder: its axis has length 1 and begins in the middle of the pixels.
typedef struct {
    float4 axis;
    float radius;
    float length2;  // squared, of the axis
    float tangent2; // the squared length of a tangent from the eye to that ball; 0 if the eye lies within
    bool is_parallel;
    float4 begin; // of a cylinder's axis
} Cone;

// By how much a cone is widened, of its radius, to hold what is rounded.
#ifndef CONE_MARGIN // a test spoils it
#define CONE_MARGIN 1.01f
#endif

// Returns the radius that so many columns and rows of pixels need, whose sides may be askew.
float radius_of_pixels(const View *const view, const uint columns, const uint rows) {
    const float across = 0.5f * (float)(columns - 1u) + SEEN_BEYOND, down = 0.5f * (float)(rows - 1u) + SEEN_BEYOND;
    const float right2 = dot(view->column_step, view->column_step), below2 = dot(view->row_step, view->row_step);
    const float askew = fabs(dot(view->column_step, view->row_step));
    return CONE_MARGIN * sqrt(across * across * right2 + down * down * below2 + 2.0f * across * down * askew);
}

// Returns the middle of so many columns and rows of pixels of a tile, from its first one on.
float4 middle_of_pixels(const View *const view, const Tile *const tile, const uint columns, const uint rows) {
    const float column = (float)tile->column + 0.5f * (float)(columns - 1u);
    const float row = (float)tile->row + 0.5f * (float)(rows - 1u);
    return view->first_pixel + column * view->column_step + row * view->row_step;
}

// By how much float32 may put a cylinder beside its pixels, of their distance from the eye.
#define CYLINDER_ROUNDED 1e-6f

// Returns the factor by which a cone of this middle is smaller than on the projection plane.
float scale_of_cone(const View *const view, const float4 middle) {
    return view->is_parallel ? 1.0f : 1.0f / sqrt(dot(middle, middle));
}

INLINE Cone cone_around(const View *const view, const float4 middle, const float radius) {
    const float length2 = dot(middle, middle);
    if (view->is_parallel) {
        const float4 axis = view->toward * (1.0f / sqrt(dot(view->toward, view->toward)));
        const Cone cylinder = {axis, fma(CYLINDER_ROUNDED, sqrt(length2), radius), 1.0f, 1.0f, true, middle};
        return cylinder;
    }
    const Cone cone = {middle, radius, length2, max(length2 - radius * radius, 0.0f), false, (float4)(0.0f)};
    return cone;
}

INLINE Cone cone_of_tile(const View *const view, const Tile *const tile, const uint size) {
    const float4 middle = middle_of_pixels(view, tile, size, size);
    const float scale = scale_of_cone(view, middle);
    return cone_around(view, scale * middle, scale * radius_of_pixels(view, size, size));
}

// What the cones of a tile's blocks have in common, with the middle of the first, and the steps from pixel to pixel.
typedef struct {
    float4 middle, right, below;
    float radius;
    const View *view;
} BlockCones;

INLINE BlockCones cones_of_blocks(const View *const view, const Tile *const tile) {
    const float4 middle = middle_of_pixels(view, tile, BLOCK_WIDTH, BLOCK_HEIGHT);
    const float scale = scale_of_cone(view, middle);
    const BlockCones cones = {scale * middle, scale * view->column_step, scale * view->row_step,
                              scale * radius_of_pixels(view, BLOCK_WIDTH, BLOCK_HEIGHT), view};
    return cones;
}

// Returns the cone of the block that begins at a column and row of the tile.
INLINE Cone cone_of_block(const BlockCones *const cones, const uint column, const uint row) {
    const float4 middle = cones->middle + (float)column * cones->right + (float)row * cones->below;
    return cone_around(cones->view, middle, cones->radius);
}

// Returns whether a ball (centre and radius; of a negative radius: all of space) lies beside a cone.
INLINE bool is_beside(const float4 ball, const Cone *const cone) {
    const float4 axis = cone->axis;
    const float4 center = cone->is_parallel ? ball - cone->begin : ball;
    const float x = center.y * axis.z - center.z * axis.y, y = center.z * axis.x - center.x * axis.z,
                z = center.x * axis.y - center.y * axis.x;
    const float ahead = center.x * axis.x + center.y * axis.y + center.z * axis.z;
    const float from_axis2 = x * x + y * y + z * z;
    const float growth = cone->is_parallel ? 1.0f : max(ahead, 0.0f);
    const float most = ball.w * cone->length2 + growth * cone->radius;
    return ball.w >= 0.0f && from_axis2 * cone->tangent2 > most * most;
}
