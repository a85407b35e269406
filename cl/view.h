// Sends rays through pixels: L(s) = S + s (E - S), s in [0,1] (Watanabe, Abe, Konno 2015, eq. 19), one in every lane,
// and ends them where depths hide what lies beyond. Every engine sees the image this way.
//
// Positions are seen from the eye (world axes, world units); what float32 leaves of a number is its rest (fine.h).
#pragma once
#include "check_size.h"
#include "fine.h"
#include "lanes.h"
#include "roots.h"

// The pixel grid on the projection plane, and the length of the rays that begin there.
typedef struct {
    float4 first_pixel; // from the eye to the centre of the pixel in column 0, row 0
    float4 column_step; // from a pixel to its right neighbour
    float4 row_step;    // from a pixel to the one below
    float4 first_pixel_rest, column_step_rest, row_step_rest;
    float4 toward, toward_rest;        // the direction of all rays, if they are parallel; very long beside a ray, so
                                       // that pixels seem to grow no wider along it
    float ray_length;                  // |E - S|
    float near_plane, near_plane_rest; // where depths are taken along the axis of view, the eye's distance from the
                                       // projection plane; 0: they are taken along the ray
    float hides_all;                   // a depth up to here hides all of any ray
    uint width;                        // pixels in a row
    uint height;
    uint is_parallel; // whether all rays are; depths are then taken along the axis of view
    uint padding;
} View;
CHECK_SIZE(View, SIZEOF_VIEW);

typedef struct {
    float3v origin;     // S, seen from the eye
    float3v span;       // E - S
    fine3v fine_origin; // S with more digits
    fine3v fine_toward; // so is the direction: E - S = toward * stretch
    floatv stretch;
    floatv length;     // |E - S|
    floatv softening2; // added to every squared distance
    floatv floor2;     // no squared distance is taken below this: rays through a core stay finite
    floatv end;        // where something hides the light, as a parameter s; 1 where nothing does
} Ray;

INLINE Ray make_ray(const fine3v origin, const fine3v toward, const floatv stretch, const floatv length,
                    const float softening2) {
    Ray ray;
    ray.origin = from_fine3(origin);
    ray.span = scale3(from_fine3(toward), stretch);
    ray.fine_origin = origin;
    ray.fine_toward = toward;
    ray.stretch = stretch;
    ray.length = length;
    ray.softening2 = splat(softening2);
    ray.floor2 = CORE_FLOOR * CORE_FLOOR * length * length;
    ray.end = splat(1.0f);
    return ray;
}

// The pixels and what their rays end at.
typedef struct {
    const View *view;
    __global const float *depths; // of every pixel, row by row
    float softening2;             // squared softening radius of what the rays pass
} Screen;

// Returns the depths of pixels; those beside the image take the depth of the nearest one in it.
floatv depth_of_pixel(const Screen *const screen, const uintv column, const uintv row) {
    const View *const view = screen->view;
    const uintv inside = min(row, (uintv)(view->height - 1u)) * view->width + min(column, (uintv)(view->width - 1u));
    return gather(screen->depths, as_intv(inside));
}

// Beyond every ray; pairs of float32 know no infinity.
#define MOST_DEPTH 1e30f

// Returns where the depth of a pixel ends its ray (Abe, Watanabe 2010, eq. 13, 14): depths begin at the eye, s at the
// projection plane.
INLINE floatv end_by_depth(const View *const view, const Ray *const ray, const floatv pixel_depth) {
    const finev depth = to_finev(min(pixel_depth, MOST_DEPTH));
    // |S - eye|, improved by a Newton step: little is left of a ray that ends next to the plane.
    const floatv to_plane = ray->length * inverse(ray->stretch);
    const finev guess = to_finev(to_plane);
    const finev missing = fine_fma(fine_negate(guess), guess, fine_dot3(ray->fine_origin, ray->fine_origin));
    const finev distance = fine_add(guess, fine_multiply(missing, to_finev(0.5f * inverse(to_plane))));
    const finev near_plane = uniform_fine(view->near_plane, view->near_plane_rest);
    const floatv beyond = view->is_parallel         ? from_finev(fine_subtract(depth, near_plane))
                          : view->near_plane > 0.0f ? from_finev(fine_subtract(depth, near_plane)) *
                                                          from_finev(distance) * (1.0f / view->near_plane)
                                                    : from_finev(fine_subtract(depth, distance));
    const floatv s = beyond * (1.0f / view->ray_length);
    return clamp(s, 0.0f, 1.0f);
}

// Returns the rays that begin at points of the plane.
INLINE Ray ray_from(const View *const view, const fine3v origin, const float softening2) {
    const fine3v toward = view->is_parallel ? fine3(view->toward, view->toward_rest) : origin;
    const float3v direction = from_fine3(toward);
    const floatv stretch = 0.5f * view->ray_length * twice_inverse_sqrt_(dot3(direction, direction));
    return make_ray(origin, toward, stretch, splat(view->ray_length), softening2);
}

// Returns the rays through the centres of pixels, whatever hides their light.
INLINE Ray open_ray(const Screen *const screen, const uintv column, const uintv row) {
    const View *const view = screen->view;
    const fine3v first = fine3(view->first_pixel, view->first_pixel_rest);
    const fine3v row_step = fine3(view->row_step, view->row_step_rest);
    const fine3v column_step = fine3(view->column_step, view->column_step_rest);
    const fine3v in_row = fine_fma3(row_step, count_to_finev(row), first);
    const fine3v origin = fine_fma3(column_step, count_to_finev(column), in_row);
    return ray_from(view, origin, screen->softening2);
}

// Returns rays that begin so many pixels farther right and below, and end where the others do.
INLINE Ray moved_ray(const View *const view, const Ray *const ray, const floatv right, const floatv below) {
    const fine3v row_step = fine3(view->row_step, view->row_step_rest);
    const fine3v column_step = fine3(view->column_step, view->column_step_rest);
    const fine3v aside = fine_fma3(column_step, to_finev(right), ray->fine_origin);
    const fine3v origin = fine_fma3(row_step, to_finev(below), aside);
    Ray moved = ray_from(view, origin, 0.0f);
    moved.softening2 = ray->softening2;
    moved.end = ray->end;
    return moved;
}

// Returns the rays through the centres of pixels.
INLINE Ray ray_through(const Screen *const screen, const uintv column, const uintv row) {
    Ray ray = open_ray(screen, column, row);
#ifdef DEPTH
    ray.end = end_by_depth(screen->view, &ray, depth_of_pixel(screen, column, row));
#endif
    return ray;
}

// Returns the rays of LANES consecutive pixels from this index on, row by row from the top left. Lanes beyond a row's
// end wrap round to the next one.
INLINE Ray pixel_ray(const Screen *const screen, const uint first) {
    const View *const view = screen->view;
    const uint first_row = first / view->width;
    uintv row = (uintv)(first_row);
    uintv column = first - first_row * view->width + LANE_NUMBERS;
    while (any_lane(column >= view->width)) {
        const uintv is_beyond = select((uintv)(0), (uintv)(1), column >= view->width);
        row += is_beyond;
        column -= is_beyond * view->width;
    }
    Ray ray = open_ray(screen, column, row);
#ifdef DEPTH
    const uint left = view->width * view->height - first;
    const floatv depth = left < LANES ? depth_of_pixel(screen, column, row) : load_lanes(screen->depths + first);
    ray.end = end_by_depth(view, &ray, depth);
#endif
    return ray;
}

// Returns L(s) - M. Panels that meet in s meet here too: s is not rounded again.
INLINE fine3v fine_from(const Ray *const ray, const floatv s, const fine3v m) {
    const fine3v from_m = fine_subtract3(ray->fine_origin, m);
    return fine_fma3(ray->fine_toward, fine_multiply(to_finev(s), to_finev(ray->stretch)), from_m);
}

// Returns the same, with M given in two parts.
INLINE fine3v fine_between(const Ray *const ray, const floatv s, const float4 m, const float4 m_rest) {
    return fine_from(ray, s, fine3(m, m_rest));
}
