// Draws a volume, LANES pixels side by side: the light that its cells give off, interpolated linearly or by Catmull and
// Rom (1974), summed along rays. By rays the part of each in the box is divided evenly; by slices (Sakai 2006) the
// places are those where it meets planes perpendicular to the view, at equal distances within the ball around the box.
#include "../film.h"
#include "../roots.h"
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

// Along an axis: the first of the cells around a place, in the grid, and what the next ones weigh.
INLINE floatv first_of(const floatv place, const uint count, const uint around) {
    const float last = count > around ? (float)(count - around) : 0.0f;
    return clamp(floor(place) - (float)(around / 2u - 1u), splat(0.0f), splat(last));
}

// How far from its first cell each further one is along an axis whose cells are `stride` apart: the grid may be
// smaller.
INLINE uint apart(const uint number, const uint count, const uint stride) {
    return min(number, count - 1u) * stride;
}

INLINE intv first_cell(const TextureVolume *const volume, const floatv x, const floatv y, const floatv z) {
    const intv sheet = to_intv_down(z) * (int)volume->sheet;
    return sheet + to_intv_down(y) * (int)volume->line + to_intv_down(x);
}

// Returns what is between a cell and the next one along x.
INLINE floatv mix_pair(const uint columns, __global const float *const values, const intv first, const floatv fx) {
    floatv low, high;
    if (columns > 1u)
        gather_pairs(values, first, &low, &high);
    else
        low = high = gather(values, first);
    return fma(fx, high - low, low);
}

INLINE floatv mix_lines(const Cells *const cells, const intv first, const floatv fx, const floatv fy, const uint up) {
    const uint columns = cells->volume->columns;
    const floatv low = mix_pair(columns, cells->values, first, fx);
    return fma(fy, mix_pair(columns, cells->values + up, first, fx) - low, low);
}

INLINE floatv linear_at(const Cells *const cells, const float3v place) {
    const TextureVolume *const volume = cells->volume;
    const uint columns = volume->columns, rows = volume->rows, layers = volume->layers;
    const floatv x = first_of(place.x, columns, 2u), y = first_of(place.y, rows, 2u), z = first_of(place.z, layers, 2u);
    // Beyond the middles of the outermost cells it is theirs.
    const floatv fx = clamp(place.x - x, splat(0.0f), splat(1.0f));
    const floatv fy = clamp(place.y - y, splat(0.0f), splat(1.0f));
    const floatv fz = clamp(place.z - z, splat(0.0f), splat(1.0f));
    const intv first = first_cell(volume, x, y, z);
    const uint up = apart(1u, rows, volume->line), on = apart(1u, layers, volume->sheet);
    const floatv near = mix_lines(cells, first, fx, fy, up);
    const Cells farther = {volume, cells->values + on};
    return fma(fz, mix_lines(&farther, first, fx, fy, up) - near, near);
}

// Returns the four weights of Catmull and Rom for the cells from the first on. At the grid's faces those beyond it are
// the outermost, whose weights add.
INLINE void weigh(const floatv place, const floatv first, const uint count, floatv *const weights) {
    const floatv x = floor(place), f = place - x, f2 = f * f, f3 = f2 * f;
    weights[0] = -0.5f * f3 + f2 - 0.5f * f;
    weights[1] = 1.5f * f3 - 2.5f * f2 + 1.0f;
    weights[2] = -1.5f * f3 + 2.0f * f2 + 0.5f * f;
    weights[3] = 0.5f * (f3 - f2);
    if (!any_lane((x - 1.0f != first) | (first + 3.0f > (float)(count - 1u))))
        return;
    floatv moved[4] = {splat(0.0f), splat(0.0f), splat(0.0f), splat(0.0f)};
    for (int i = 0; i < 4; ++i) {
        const floatv cell = clamp(x + (float)(i - 1), splat(0.0f), splat((float)(count - 1u))) - first;
        for (int j = 0; j < 4; ++j)
            moved[j] += select(splat(0.0f), weights[i], cell == (float)j);
    }
    for (int j = 0; j < 4; ++j)
        weights[j] = moved[j];
}

INLINE floatv cubic_at(const Cells *const cells, const float3v place) {
    const TextureVolume *const volume = cells->volume;
    const uint columns = volume->columns, rows = volume->rows, layers = volume->layers;
    const floatv x = first_of(place.x, columns, 4u), y = first_of(place.y, rows, 4u), z = first_of(place.z, layers, 4u);
    floatv wx[4], wy[4], wz[4];
    weigh(place.x, x, columns, wx), weigh(place.y, y, rows, wy), weigh(place.z, z, layers, wz);
    const intv first = first_cell(volume, x, y, z);
    floatv sum = splat(0.0f);
    for (uint k = 0; k < 4u; ++k) {
        floatv sheet = splat(0.0f);
#pragma unroll
        for (uint j = 0; j < 4u; ++j) {
            const uint offset = apart(k, layers, volume->sheet) + apart(j, rows, volume->line);
            __global const float *const row = cells->values + offset;
            floatv a, b, c, d;
            if (columns > 3u)
                gather_pairs(row, first, &a, &b), gather_pairs(row + 2, first, &c, &d);
            else {
                a = gather(row, first), b = gather(row + apart(1u, columns, 1u), first);
                c = gather(row + apart(2u, columns, 1u), first), d = splat(0.0f);
            }
            sheet = fma(wy[j], fma(wx[0], a, fma(wx[1], b, fma(wx[2], c, wx[3] * d))), sheet);
        }
        sum = fma(wz[k], sheet, sum);
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
    // Where it changes little, the points of Gauss and Legendre.
    const float points[2] = {0.86113631f, 0.33998104f}, weights[2] = {0.17392742f, 0.32607258f};
    for (int i = 0; i < 2; ++i) {
        const floatv even = fma(bend, splat(points[i] * points[i]), at), odd = points[i] * slope;
        sum = fma(splat(weights[i]), emission_of(volume, even + odd) + emission_of(volume, even - odd), sum);
    }
    return sum;
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
    // Of reciprocals all ends of pieces are looked at, too; the near one is the next one's far end.
    const bool has_ends = volume.power > 0u && volume.slices == 0u;
    floatv fars[3];
    bool are_there = false;
    for (uint i = 0; i < most; ++i) {
        // From far to near, as slices are blended.
        const floatv number = splat((float)(most - 1u - i));
        const floatv middle = fma(number + MIDDLE, course.step, course.begin);
        const intv is_outside = (number >= count) | (middle < course.low) | (middle > course.high);
        const floatv left = select(course.step * left_after(&view, middle), splat(0.0f), is_outside);
        if (!any_lane(left != 0.0f)) {
            are_there = false;
            continue;
        }
        for (uint channel = 0; channel < volume.channels; ++channel) {
            const Cells cells = {&volume, values + (size_t)channel * volume.sheet * volume.layers};
            floatv at = splat(0.0f), near = at, far = are_there ? fars[channel] : at;
            const uint end = has_ends ? 3u : 2u;
            for (uint place = has_ends && !are_there ? 0u : 1u; place < end; ++place) {
                const floatv t = fma((1.0f - (float)place) * 0.5f, course.step, middle);
                const floatv stored = stored_at(&cells, place_at(&course, t));
                far = place == 0u ? stored : far;
                at = place == 1u ? stored : at;
                near = place == 2u ? stored : near;
            }
            fars[channel] = near;
            const floatv it = left * (has_ends ? mean_of_piece(&volume, far, at, near) : emission_of(&volume, at));
            sum.x += channel == 0u ? it : splat(0.0f);
            sum.y += channel == 1u || volume.channels == 1u ? it : splat(0.0f);
            sum.z += channel == 2u || volume.channels == 1u ? it : splat(0.0f);
        }
        are_there = has_ends;
    }
    light.x = fma(sum.x, splat(volume.red), light.x);
    light.y = fma(sum.y, splat(volume.green), light.y);
    light.z = fma(sum.z, splat(volume.blue), light.z);
    store_pixels(&part, begin, light, FILM_ARGUMENT);
}
