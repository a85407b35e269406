// Draws a volume, LANES pixels side by side: the light that its cells give off, interpolated linearly or by Catmull and
// Rom (1974), summed along rays. By rays the part of each in the box is divided evenly; by slices (Sakai 2006) the
// places are those where it meets planes perpendicular to the view, at equal distances within the ball around the box.
#include "../film.h"
#include "../roots.h"
#include "cells.h"
#include "types.h"

// Places of a piece of a ray at which the quadratic through three reciprocals is summed.
#define PLACES 16

// Cells along an edge of a brick; pieces that are taken together.
#define BRICK 8u

// What light may fade over the length of a brick where two points stand for it.
#define MOST_FADING 0.5f

// Where the first of two points of Gauss and Legendre is, of 0 to 2.
#ifndef FIRST_POINT
#define FIRST_POINT 0.42264973f
#endif

// Where the middle of a piece is.
#ifndef MIDDLE
#define MIDDLE 0.5f
#endif

// Returns the emission that is stored so.
INLINE floatv emission_of(const TextureVolume *const volume, const floatv stored) {
    if (volume->power == 0u)
        return max(stored, 0.0f);
    const floatv reciprocal = max(fabs(stored), volume->floor);
    return volume->power == 1u ? inverse(reciprocal) : 0.5f * twice_inverse_sqrt(reciprocal);
}

// The places of a ray that are summed: from the ray's beginning on, in world units.
typedef struct {
    float3v origin, span; // in cells, and a world unit along the ray
    floatv begin, step;   // of pieces
    floatv low, high;     // where the ray is in the box, and not behind what hides it
} Course;

INLINE float3v place_at(const Course *const course, const floatv t) {
    return fma3(course->span, t, course->origin);
}

// Returns the mean emission of a piece, of the quadratic through the reciprocals at its far end, middle and near end.
INLINE floatv mean_of_piece(const TextureVolume *const volume, const floatv far, const floatv at, const floatv near) {
    const floatv slope = 0.5f * (near - far), bend = 0.5f * (near + far) - at;
    floatv sum = splat(0.0f);
    if (any_lane(fabs(slope) + fabs(bend) > 0.5f * at)) {
        for (int i = 0; i < PLACES; ++i) {
            const float u = ((float)i + 0.5f) * (2.0f / PLACES) - 1.0f;
            sum += emission_of(volume, fma(fma(bend, splat(u), slope), splat(u), at));
        }
        return (1.0f / PLACES) * sum;
    }
    // Where it changes little, the points of Gauss and Legendre: two leave 4e-5 of it, four of half of it 1e-5.
    if (!any_lane(fabs(slope) + fabs(bend) > 0.2f * at)) {
        const floatv even = fma(bend, splat(1.0f / 3.0f), at), odd = 0.57735027f * slope;
        return 0.5f * (emission_of(volume, even + odd) + emission_of(volume, even - odd));
    }
    const float points[2] = {0.86113631f, 0.33998104f}, weights[2] = {0.17392742f, 0.32607258f};
    for (int i = 0; i < 2; ++i) {
        const floatv even = fma(bend, splat(points[i] * points[i]), at), odd = points[i] * slope;
        sum = fma(splat(weights[i]), emission_of(volume, even + odd) + emission_of(volume, even - odd), sum);
    }
    return sum;
}

INLINE floatv light_of_piece(const TextureVolume *const volume, const bool has_ends, const floatv far, const floatv at,
                             const floatv near) {
    return has_ends ? mean_of_piece(volume, far, at, near) : emission_of(volume, at);
}

// Returns what fading leaves of light after a length.
INLINE floatv left_after(const TextureView *const view, const floatv t) {
    floatv left = splat(view->scale);
    if (view->power > 0u) {
        const floatv base = 1.0f / fma(t, splat(view->per_length), splat(view->beta));
        for (uint i = 0; i < view->power; ++i)
            left *= base;
    }
    return view->absorbed > 0.0f ? left * exp2(-view->absorbed * t) : left;
}

// Narrows a stretch of a ray to where it is between two faces.
INLINE void clip(const floatv origin, const floatv span, const uint count, floatv *const low, floatv *const high) {
    const floatv safe = select(span, splat(1e-20f), fabs(span) < 1e-20f);
    const floatv one = (-0.5f - origin) / safe, other = ((float)count - 0.5f - origin) / safe;
    *low = max(*low, min(one, other));
    *high = min(*high, max(one, other));
}

INLINE float3v to_cells(const TextureVolume *const volume, const float3v v, const float one) {
    const float4 x = volume->to_x, y = volume->to_y, z = volume->to_z;
    const float3v cells = {fma(v.x, splat(x.x), fma(v.y, splat(x.y), fma(v.z, splat(x.z), splat(one * x.w)))),
                           fma(v.x, splat(y.x), fma(v.y, splat(y.y), fma(v.z, splat(y.z), splat(one * y.w)))),
                           fma(v.x, splat(z.x), fma(v.y, splat(z.y), fma(v.z, splat(z.z), splat(one * z.w))))};
    return cells;
}

// Returns where the rays of pixels run in the box, and how many pieces each has.
INLINE Course course_of(const TextureView *const view, const TextureVolume *const volume, const uintv pixel,
                        __global const float *const depths, floatv *const count) {
    const uintv last = (uintv)(view->width * view->height - 1u);
    const uintv index = min(pixel, last);
    const floatv column = to_floatv(index % view->width), row = to_floatv(index / view->width);
    float3v origin = uniform3(view->first_pixel);
    origin = fma3(uniform3(view->column_step), column, origin);
    origin = fma3(uniform3(view->row_step), row, origin);
    const float3v toward = view->is_parallel ? uniform3(view->toward) : origin;
    const floatv inverse = rsqrt(dot3(toward, toward));
    const float3v direction = scale3(toward, inverse);
    const floatv to_plane = 1.0f / inverse; // of rays from an eye
    const floatv per_axis = view->is_parallel ? splat(1.0f) : to_plane * (1.0f / view->near);
    floatv end = splat(view->ray_length);
    if (view->has_depth) {
        const floatv depth = min(gather(depths, as_intv(index)), 1e30f);
        const bool is_along_axis = view->is_along_axis || view->is_parallel;
        end = min(end, is_along_axis ? (depth - view->near) * per_axis : depth - to_plane);
    }
    Course course;
    course.origin = to_cells(volume, origin, 1.0f), course.span = to_cells(volume, direction, 0.0f);
    course.low = splat(0.0f), course.high = end;
    clip(course.origin.x, course.span.x, volume->columns, &course.low, &course.high);
    clip(course.origin.y, course.span.y, volume->rows, &course.low, &course.high);
    clip(course.origin.z, course.span.z, volume->layers, &course.low, &course.high);
    const floatv chord = max(course.high - course.low, 0.0f);
    if (volume->slices > 0u) {
        course.step = per_axis * (2.0f * volume->radius / (float)volume->slices);
        course.begin = per_axis * (volume->middle - volume->radius - view->near);
        *count = select(splat((float)volume->slices), splat(0.0f), chord <= 0.0f);
        return course;
    }
    const floatv cells = chord * sqrt(dot3(course.span, course.span));
    *count = min(ceil(cells * (1.0f / volume->step)), 65536.0f);
    if (volume->has_bricks)
        *count = (float)BRICK * ceil(*count * (1.0f / BRICK));
    course.begin = course.low, course.step = chord / max(*count, 1.0f);
    return course;
}

INLINE float most_of(const floatv value) {
    float lanes[LANES], most = 0.0f;
    scatter(value, lanes);
    for (uint lane = 0; lane < LANES; ++lane)
        most = max(most, lanes[lane]);
    return most;
}

// What of a ray is summed.
typedef struct {
    const TextureView *view;
    const TextureVolume *volume;
    __global const float *values, *coarse, *bricks;
    Course course;
    floatv count;
    float3v sum;
    float3v far; // of reciprocals, at the far end of the next piece
    bool are_there;
} March;

INLINE void add_light(March *const march, const floatv left, const float3v light) {
    march->sum.x = fma(left, light.x, march->sum.x);
    march->sum.y = fma(left, light.y, march->sum.y);
    march->sum.z = fma(left, light.z, march->sum.z);
}

// Adds the light of a piece of every ray.
INLINE void add_piece(March *const march, const uint number AND_VALUES) {
    const TextureVolume *const volume = march->volume;
    const Course *const course = &march->course;
    const floatv middle = fma(splat((float)number + MIDDLE), course->step, course->begin);
    const intv is_outside = ((float)number >= march->count) | (middle < course->low) | (middle > course->high);
    const floatv left = select(course->step * left_after(march->view, middle), splat(0.0f), is_outside);
    if (!any_lane(left != 0.0f)) {
        march->are_there = false;
        return;
    }
    // Of reciprocals all ends of pieces are looked at, too; the near one is the next one's far end.
    const bool has_ends = volume->power > 0u && volume->slices == 0u;
    float3v at = uniform3((float4)(0.0f)), near = at, far = march->far;
    for (uint place = has_ends && !march->are_there ? 0u : 1u; place < (has_ends ? 3u : 2u); ++place) {
        const floatv t = fma((1.0f - (float)place) * 0.5f, course->step, middle);
#ifdef CELLS_IN_IMAGES
        const float3v stored = stored_at(volume, place_at(course, t) PASS_VALUES);
#else
        const float3v stored = stored_at(volume, march->values, place_at(course, t));
#endif
        if (place == 0u)
            far = stored;
        else if (place == 1u)
            at = stored;
        else
            near = stored;
    }
    march->far = near;
    float3v light = at;
    light.x = light_of_piece(volume, has_ends, far.x, at.x, near.x);
    light.y = light.z = light.x;
    if (volume->channels == 3u) {
        light.y = light_of_piece(volume, has_ends, far.y, at.y, near.y);
        light.z = light_of_piece(volume, has_ends, far.z, at.z, near.z);
    }
    add_light(march, left, light);
    march->are_there = has_ends;
}

INLINE floatv coarse_place(const floatv place, const uint count) {
    return 0.5f * (clamp(place, splat(0.0f), splat((float)(count - 1u))) - 0.5f);
}

// Adds the light at a point of Gauss and Legendre, from the coarse grid.
INLINE void add_coarse(March *const march, const floatv t, const floatv width) {
    const TextureVolume *const volume = march->volume;
    const float3v place = place_at(&march->course, t);
    const uint3 count = ((uint3)(volume->columns, volume->rows, volume->layers) + 1u) / 2u;
    const floatv x = coarse_place(place.x, volume->columns), y = coarse_place(place.y, volume->rows);
    const floatv z = coarse_place(place.z, volume->layers);
    const floatv cx = clamp(floor(x), splat(0.0f), splat((float)(count.x - 2u)));
    const floatv cy = clamp(floor(y), splat(0.0f), splat((float)(count.y - 2u)));
    const floatv cz = clamp(floor(z), splat(0.0f), splat((float)(count.z - 2u)));
    const floatv fx = x - cx, fy = y - cy, fz = z - cz;
    const Grid grid = {march->coarse, volume->channels, volume->coarse_line, volume->coarse_sheet};
    const Weights weights = {{1.0f - fx, fx}, {1.0f - fy, fy}, {1.0f - fz, fz}, first_cell(&grid, cx, cy, cz), 1u, 1u};
    float3v light = weighed_rows(&grid, &weights, 2u);
    light.x = max(light.x, 0.0f), light.y = max(light.y, 0.0f), light.z = max(light.z, 0.0f);
    add_light(march, width * left_after(march->view, t), light);
}

// Returns how many points the pieces of a brick's length take, 0 where no ray meets light; BRICK: each piece is taken.
INLINE uint points_of(const March *const march, const uint first) {
    const TextureVolume *const volume = march->volume;
    const Course *const course = &march->course;
    const floatv begin = fma(splat((float)first), course->step, course->begin);
    const floatv length = (float)BRICK * course->step;
    const float3v place = place_at(course, fma(splat(0.5f), length, begin));
    const uint3 count = ((uint3)(volume->columns, volume->rows, volume->layers) + (BRICK - 1u)) / BRICK;
    const floatv x = clamp((place.x + 0.5f) * (1.0f / BRICK), splat(0.0f), splat((float)(count.x - 1u)));
    const floatv y = clamp((place.y + 0.5f) * (1.0f / BRICK), splat(0.0f), splat((float)(count.y - 1u)));
    const floatv z = clamp((place.z + 0.5f) * (1.0f / BRICK), splat(0.0f), splat((float)(count.z - 1u)));
    const intv brick = ((to_intv_down(z) * (int)count.y + to_intv_down(y)) * (int)count.x + to_intv_down(x)) * 2;
    const intv is_outside = (float)first >= march->count;
    floatv bend, fourth;
    gather_pairs(march->bricks, brick, &bend, &fourth);
    bend = select(bend, splat(-1.0f), is_outside), fourth = select(fourth, splat(-1.0f), is_outside);
    if (!any_lane(bend >= 0.0f))
        return 0u;
    // What fading changes over the length.
    const TextureView *const view = march->view;
    const floatv fades = length * (view->absorbed + (float)view->power * view->per_length /
                                                        fma(begin, splat(view->per_length), splat(view->beta)));
    if (!any_lane((max(bend + fourth, 0.0f) > volume->most_left) | (fades > MOST_FADING)))
        return 2u;
    const floatv halved = fma(0.7f, bend, (1.0f / 16.0f) * fourth);
    return any_lane((halved > volume->most_left) | (fades > 2.0f * MOST_FADING)) ? BRICK : 4u;
}

INLINE void add_pieces(March *const march, const uint first, const uint count AND_VALUES) {
    for (uint i = 0; i < count; ++i)
        add_piece(march, first + count - 1u - i PASS_VALUES);
}

INLINE void add_points(March *const march, const uint first, const uint points) {
    const Course *const course = &march->course;
    const floatv width = (float)(BRICK / points) * course->step;
    const intv is_outside = (float)first >= march->count;
    for (uint i = 0; i < points; ++i) {
        const float share = (float)(i / 2u * 2u) + (i % 2u > 0u ? 2.0f - FIRST_POINT : FIRST_POINT);
        const floatv t = fma(splat(share), width, fma(splat((float)first), course->step, course->begin));
        add_coarse(march, t, select(width, splat(0.0f), is_outside));
    }
}

__kernel void draw_texture(const FilmPart part, const TextureView view, const TextureVolume volume, VALUES values,
                           __global const float *const restrict coarse, __global const float *const restrict bricks,
                           __global const float *const restrict depths, FILM_PARAMETER) {
    const uint begin = get_global_id(0) * LANES;
    if (begin >= part.count)
        return;
    float3v light = gathered_light(&part, begin, pixels);
    March march = {.view = &view, .volume = &volume, .coarse = coarse, .bricks = bricks};
#ifndef CELLS_IN_IMAGES
    march.values = values;
#endif
    march.course = course_of(&view, &volume, part.first + begin + LANE_NUMBERS, depths, &march.count);
    march.sum = march.far = uniform3((float4)(0.0f)), march.are_there = false;
    const uint most = (uint)most_of(march.count);
    // From far to near, as slices are blended; by bricks there are as many pieces as those have cells, or none.
    for (uint end = most; end > 0u;) {
        const uint first = volume.has_bricks ? end - BRICK : end - 1u;
        const uint points = volume.has_bricks ? points_of(&march, first) : BRICK;
        if (points == BRICK)
            add_pieces(&march, first, end - first PASS_VALUES);
        else {
            march.are_there = false;
            add_points(&march, first, points);
        }
        end = first;
    }
    light.x = fma(march.sum.x, splat(volume.red), light.x);
    light.y = fma(march.sum.y, splat(volume.green), light.y);
    light.z = fma(march.sum.z, splat(volume.blue), light.z);
    store_pixels(&part, begin, light, FILM_ARGUMENT);
}
