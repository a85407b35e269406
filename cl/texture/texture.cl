// Draws a volume, LANES pixels side by side: the light that its cells give off, interpolated linearly or by Catmull and
// Rom (1974), summed along rays. By rays the part of each in the box is divided evenly; by slices (Sakai 2006) the
// places are those where it meets planes perpendicular to the view, at equal distances within the ball around the box.
#include "../film.h"
#include "types.h"

// Places of a piece of a ray at which the quadratic through three reciprocals is summed.
#define PLACES 16

// Where the middle of a piece is.
#ifndef MIDDLE
#define MIDDLE 0.5f
#endif

// The cells of a channel, and a place among them: 0 is the middle of the first.
typedef struct {
    const TextureVolume *volume;
    __global const float *values;
} Cells;

INLINE intv clamped(const floatv place, const uint count) {
    return to_intv_down(clamp(place, splat(0.0f), splat((float)(count - 1u))));
}

INLINE floatv linear_at(const Cells *const cells, const float3v place) {
    const TextureVolume *const volume = cells->volume;
    const floatv x = floor(place.x), y = floor(place.y), z = floor(place.z);
    const floatv fx = place.x - x, fy = place.y - y, fz = place.z - z;
    const intv x0 = clamped(x, volume->columns), x1 = clamped(x + 1.0f, volume->columns);
    floatv sum = splat(0.0f);
    for (uint side = 0; side < 4u; ++side) {
        const bool is_upper = (side & 1u) != 0u, is_farther = (side & 2u) != 0u;
        const floatv weight = (is_upper ? fy : 1.0f - fy) * (is_farther ? fz : 1.0f - fz);
        const intv row = clamped(is_upper ? y + 1.0f : y, volume->rows);
        const intv layer = clamped(is_farther ? z + 1.0f : z, volume->layers);
        const intv first = (layer * (int)volume->rows + row) * (int)volume->columns;
        const floatv low = gather(cells->values, first + x0), high = gather(cells->values, first + x1);
        sum = fma(weight, fma(fx, high - low, low), sum);
    }
    return sum;
}

// Returns the four weights of Catmull and Rom.
INLINE void weigh(const floatv f, floatv *const weights) {
    const floatv f2 = f * f, f3 = f2 * f;
    weights[0] = -0.5f * f3 + f2 - 0.5f * f;
    weights[1] = 1.5f * f3 - 2.5f * f2 + 1.0f;
    weights[2] = -1.5f * f3 + 2.0f * f2 + 0.5f * f;
    weights[3] = 0.5f * (f3 - f2);
}

INLINE floatv cubic_at(const Cells *const cells, const float3v place) {
    const TextureVolume *const volume = cells->volume;
    const floatv x = floor(place.x), y = floor(place.y), z = floor(place.z);
    floatv wx[4], wy[4], wz[4];
    weigh(place.x - x, wx), weigh(place.y - y, wy), weigh(place.z - z, wz);
    intv columns[4];
    for (int i = 0; i < 4; ++i)
        columns[i] = clamped(x + (float)(i - 1), volume->columns);
    floatv sum = splat(0.0f);
    for (int k = 0; k < 16; ++k) {
        const intv row = clamped(y + (float)(k % 4 - 1), volume->rows);
        const intv layer = clamped(z + (float)(k / 4 - 1), volume->layers);
        const intv first = (layer * (int)volume->rows + row) * (int)volume->columns;
        floatv of_row = splat(0.0f);
        for (int i = 0; i < 4; ++i)
            of_row = fma(wx[i], gather(cells->values, first + columns[i]), of_row);
        sum = fma(wy[k % 4] * wz[k / 4], of_row, sum);
    }
    return sum;
}

INLINE floatv stored_at(const Cells *const cells, const float3v place) {
    return cells->volume->is_cubic ? cubic_at(cells, place) : linear_at(cells, place);
}

// Returns the emission that is stored so.
INLINE floatv emission_of(const TextureVolume *const volume, const floatv stored) {
    if (volume->power == 0u)
        return max(stored, 0.0f);
    const floatv inverse = max(fabs(stored), volume->floor);
    return volume->power == 1u ? 1.0f / inverse : rsqrt(inverse);
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

// Returns the mean emission of a piece: that in its middle; of reciprocals that of the quadratic through three.
INLINE floatv mean_of_piece(const Cells *const cells, const Course *const course, const floatv middle) {
    const TextureVolume *const volume = cells->volume;
    const floatv at = stored_at(cells, place_at(course, middle));
    if (volume->power == 0u || volume->slices > 0u)
        return emission_of(volume, at);
    const floatv half_step = 0.5f * course->step;
    const floatv before = stored_at(cells, place_at(course, middle - half_step));
    const floatv after = stored_at(cells, place_at(course, middle + half_step));
    const floatv slope = 0.5f * (after - before), bend = 0.5f * (after + before) - at;
    floatv sum = splat(0.0f);
    for (int i = 0; i < PLACES; ++i) {
        const float u = ((float)i + 0.5f) * (2.0f / PLACES) - 1.0f;
        sum += emission_of(volume, fma(fma(bend, splat(u), slope), splat(u), at));
    }
    return (1.0f / PLACES) * sum;
}

// Returns what fading leaves of light after a length.
INLINE floatv left_after(const TextureView *const view, const floatv t) {
    floatv left = splat(view->scale);
    const floatv base = 1.0f / fma(t, splat(view->per_length), splat(view->beta));
    for (uint i = 0; i < view->power; ++i)
        left *= base;
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

__kernel void draw_texture(const FilmPart part, const TextureView view, const TextureVolume volume,
                           __global const float *const restrict values, __global const float *const restrict depths,
                           FILM_PARAMETER) {
    const uint begin = get_global_id(0) * LANES;
    if (begin >= part.count)
        return;
    float3v light = gathered_light(&part, begin, pixels);
    floatv count;
    const Course course = course_of(&view, &volume, part.first + begin + LANE_NUMBERS, depths, &count);
    float3v sum = uniform3((float4)(0.0f));
    const uint most = (uint)most_of(count);
    for (uint i = 0; i < most; ++i) {
        // From far to near, as slices are blended.
        const floatv number = splat((float)(most - 1u - i));
        const floatv middle = fma(number + MIDDLE, course.step, course.begin);
        const intv is_outside = (number >= count) | (middle < course.low) | (middle > course.high);
        const floatv left = select(course.step * left_after(&view, middle), splat(0.0f), is_outside);
        if (!any_lane(left != 0.0f))
            continue;
        for (uint channel = 0; channel < volume.channels; ++channel) {
            const Cells cells = {&volume, values + channel * volume.plane};
            const floatv it = left * mean_of_piece(&cells, &course, middle);
            sum.x += channel == 0u ? it : splat(0.0f);
            sum.y += channel == 1u || volume.channels == 1u ? it : splat(0.0f);
            sum.z += channel == 2u || volume.channels == 1u ? it : splat(0.0f);
        }
    }
    light.x = fma(sum.x, splat(volume.red), light.x);
    light.y = fma(sum.y, splat(volume.green), light.y);
    light.z = fma(sum.z, splat(volume.blue), light.z);
    store_pixels(&part, begin, light, FILM_ARGUMENT);
}
