// What cells store at a place between them: interpolated linearly, or by Catmull and Rom (1974). Cells lie in a buffer,
// or in a 3D image.
#pragma once
#include "../lanes.h"
#include "types.h"

// The cells of a channel, and a place among them: 0 is the middle of the first.
typedef struct {
    const TextureVolume *volume;
    __global const float *values;
    int first_layer; // in an image, where channels stand behind each other
} Cells;

// With -D CELLS_IN_IMAGES cells are texels of a 3D image. They are read one by one and interpolated here: the filters
// of GPUs have weights of 8 bits.
#ifdef CELLS_IN_IMAGES
#define VALUES __read_only image3d_t
#define AND_VALUES , __read_only image3d_t values
#define PASS_VALUES , values
#else
#define VALUES __global const float *const restrict
#define AND_VALUES
#define PASS_VALUES
#endif

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

#ifndef CELLS_IN_IMAGES
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
    const Cells farther = {volume, cells->values + on, 0};
    return fma(fz, mix_lines(&farther, first, fx, fy, up) - near, near);
}
#endif

// Returns the four weights of Catmull and Rom, of a share of the way to the next cell.
INLINE void weigh_evenly(const floatv f, floatv *const weights) {
    const floatv f2 = f * f, f3 = f2 * f;
    weights[0] = -0.5f * f3 + f2 - 0.5f * f;
    weights[1] = 1.5f * f3 - 2.5f * f2 + 1.0f;
    weights[2] = -1.5f * f3 + 2.0f * f2 + 0.5f * f;
    weights[3] = 0.5f * (f3 - f2);
}

#ifndef CELLS_IN_IMAGES
// Returns them for the cells from the first on. At the grid's faces those beyond it are the outermost, whose weights
// add.
INLINE void weigh(const floatv place, const floatv first, const uint count, floatv *const weights) {
    const floatv x = floor(place);
    weigh_evenly(place - x, weights);
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
#else
// Texels beyond the faces are the outermost.
__constant sampler_t NEAREST = CLK_NORMALIZED_COORDS_FALSE | CLK_ADDRESS_CLAMP_TO_EDGE | CLK_FILTER_NEAREST;

#ifndef NEXT_TEXEL // a test spoils it
#define NEXT_TEXEL 0
#endif

INLINE floatv texel(const Cells *const cells, const intv x, const intv y, const intv z AND_VALUES) {
    const intv layer = clamp(z, (intv)(0), (intv)((int)cells->volume->layers - 1)) + cells->first_layer;
#if LANES == 1
    return read_imagef(values, NEAREST, (int4)(x, y, layer, 0)).x;
#else
    int at[3][LANES];
    float found[LANES];
    JOIN(vstore, LANES)(x, 0, at[0]), JOIN(vstore, LANES)(y, 0, at[1]), JOIN(vstore, LANES)(layer, 0, at[2]);
    for (uint lane = 0; lane < LANES; ++lane)
        found[lane] = read_imagef(values, NEAREST, (int4)(at[0][lane], at[1][lane], at[2][lane], 0)).x;
    return JOIN(vload, LANES)(0, found);
#endif
}

// Sums cells around a place, `count` along each axis from `first` on, by their weights.
INLINE floatv weighed(const Cells *const cells, const float3v first, const uint count,
                      const floatv weights[3][4] AND_VALUES) {
    const intv x = to_intv_down(first.x) + NEXT_TEXEL, y = to_intv_down(first.y), z = to_intv_down(first.z);
    floatv sum = splat(0.0f);
    for (uint k = 0; k < count; ++k)
        for (uint j = 0; j < count; ++j) {
            const floatv weight = weights[2][k] * weights[1][j];
            for (uint i = 0; i < count; ++i) {
                const floatv it = texel(cells, x + (int)i, y + (int)j, z + (int)k PASS_VALUES);
                sum = fma(weight * weights[0][i], it, sum);
            }
        }
    return sum;
}

INLINE floatv linear_at(const Cells *const cells, const float3v place AND_VALUES) {
    const float3v first = {floor(place.x), floor(place.y), floor(place.z)};
    const floatv x = place.x - first.x, y = place.y - first.y, z = place.z - first.z;
    const floatv weights[3][4] = {{1.0f - x, x}, {1.0f - y, y}, {1.0f - z, z}};
    return weighed(cells, first, 2u, weights PASS_VALUES);
}

INLINE floatv cubic_at(const Cells *const cells, const float3v place AND_VALUES) {
    const float3v cell = {floor(place.x), floor(place.y), floor(place.z)};
    floatv weights[3][4];
    weigh_evenly(place.x - cell.x, weights[0]);
    weigh_evenly(place.y - cell.y, weights[1]);
    weigh_evenly(place.z - cell.z, weights[2]);
    const float3v first = {cell.x - 1.0f, cell.y - 1.0f, cell.z - 1.0f};
    return weighed(cells, first, 4u, weights PASS_VALUES);
}
#endif

INLINE floatv stored_at(const Cells *const cells, const float3v place AND_VALUES) {
    return cells->volume->is_cubic ? cubic_at(cells, place PASS_VALUES) : linear_at(cells, place PASS_VALUES);
}
