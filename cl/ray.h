// View rays: L(s) = S + s (E - S), s in [0,1] (Watanabe, Abe, Konno 2015, eq. 19), one in every lane.
#pragma once
#include "lanes.h"
#include "roots.h"
#include "types.h"

typedef struct {
    float3v origin;    // S, seen from the eye
    float3v span;      // E - S
    floatv softening2; // added to every squared distance
    floatv floor2;     // no squared distance is taken below this: rays through a core stay finite
} Ray;

Ray make_ray(const float3v origin, const float3v span, const float softening2) {
    const float floor2 = CORE_FLOOR * CORE_FLOOR;
    const Ray ray = {origin, span, splat(softening2), floor2 * dot3(span, span)};
    return ray;
}

// The rays through the centres of LANES consecutive pixels from this index on, row by row from the top left. One
// division serves all lanes; those beyond the row's end wrap round to the next row.
Ray pixel_ray(const View *const view, const uint first) {
    uintv row = (uintv)(first / view->width);
    uintv column = first - row * view->width + LANE_NUMBERS;
    while (any_lane(column >= view->width)) {
        row = select(row, row + 1, column >= view->width);
        column = select(column, column - view->width, column >= view->width);
    }
    const float3v in_row = fma3(uniform3(view->row_step), to_floatv(row), uniform3(view->first_pixel));
    const float3v origin = fma3(uniform3(view->column_step), to_floatv(column), in_row);
    const float3v span = scale3(origin, 0.5f * view->ray_length * twice_inverse_sqrt_(dot3(origin, origin)));
    return make_ray(origin, span, view->softening2);
}
