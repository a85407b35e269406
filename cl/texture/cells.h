// What cells store at a place between them: interpolated linearly, or by Catmull and Rom (1974). Cells lie in a buffer,
// or in a 3D image. In a buffer those of one channel are numbers, those of three are fours with one to spare: a row of
// the cells around a place is then one load, of all channels, lane by lane. CPUs gather several times as slowly.
#pragma once
#include "../lanes.h"
#include "types.h"

// The cells of a grid in a buffer.
typedef struct {
    __global const float *values;
    uint channels, line, sheet; // between a row and the next, and a layer and the next: cells
} Grid;

// What the cells around a place weigh along each axis, and the first of them.
typedef struct {
    floatv x[4], y[4], z[4];
    intv first;
    uint up, on; // rows and layers beyond the first that there are
} Weights;

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

INLINE intv first_cell(const Grid *const grid, const floatv x, const floatv y, const floatv z) {
    return to_intv_down(z) * (int)grid->sheet + to_intv_down(y) * (int)grid->line + to_intv_down(x);
}

// Returns the same of numbers by two along each axis, which gathers of pairs are as quick for.
INLINE floatv weighed_pairs(const Grid *const grid, const Weights *const weights) {
    floatv sum = splat(0.0f), low, high;
    for (uint k = 0; k < 2u; ++k)
        for (uint j = 0; j < 2u; ++j) {
            const size_t cell = min(k, weights->on) * (size_t)grid->sheet + min(j, weights->up) * grid->line;
            gather_pairs(grid->values + cell, weights->first, &low, &high);
            sum = fma(weights->z[k] * weights->y[j], fma(weights->x[0], low, weights->x[1] * high), sum);
        }
    return sum;
}

// Sums the cells around places, `width` of them along each axis: 2 or 4. Rows have at least four cells.
INLINE float3v weighed_rows(const Grid *const grid, const Weights *const weights, const uint width) {
    if (width == 2u && grid->channels == 1u) {
        const floatv one = weighed_pairs(grid, weights);
        return (float3v){one, one, one};
    }
    float of_rows[16][LANES], of_columns[4][LANES] = {{0.0f}}, found[3][LANES];
    size_t rows[16];
    int firsts[LANES];
    const uint each = grid->channels == 1u ? 1u : 4u;
    for (uint row = 0; row < width * width; ++row) {
        const uint k = row / width, j = row % width;
        scatter(weights->z[k] * weights->y[j], of_rows[row]);
        rows[row] = each * (min(k, weights->on) * (size_t)grid->sheet + min(j, weights->up) * grid->line);
    }
    for (uint column = 0; column < width; ++column)
        scatter(weights->x[column], of_columns[column]);
    STORE_LANES(weights->first, firsts);
    for (uint lane = 0; lane < LANES; ++lane) {
        __global const float *const first = grid->values + (size_t)firsts[lane] * each;
        const float x = of_columns[0][lane], y = of_columns[1][lane], z = of_columns[2][lane], w = of_columns[3][lane];
        if (each == 1u) {
            float4 sum = (float4)(0.0f);
#pragma unroll
            for (uint row = 0; row < width * width; ++row)
                sum = fma((float4)(of_rows[row][lane]), vload4(0, first + rows[row]), sum);
            found[0][lane] = fma(sum.x, x, sum.y * y) + fma(sum.z, z, sum.w * w);
            continue;
        }
        float4 light;
        if (width == 4u) {
            float16 sum = (float16)(0.0f);
#pragma unroll
            for (uint row = 0; row < width * width; ++row)
                sum = fma((float16)(of_rows[row][lane]), vload16(0, first + rows[row]), sum);
            light = fma(sum.lo.lo, x, sum.lo.hi * y) + fma(sum.hi.lo, z, sum.hi.hi * w);
        } else {
            float8 sum = (float8)(0.0f);
#pragma unroll
            for (uint row = 0; row < width * width; ++row)
                sum = fma((float8)(of_rows[row][lane]), vload8(0, first + rows[row]), sum);
            light = fma(sum.lo, x, sum.hi * y);
        }
        found[0][lane] = light.x, found[1][lane] = light.y, found[2][lane] = light.z;
    }
    const floatv one = LOAD_LANES(found[0]);
    if (grid->channels == 1u)
        return (float3v){one, one, one};
    return (float3v){one, LOAD_LANES(found[1]), LOAD_LANES(found[2])};
}

#ifndef CELLS_IN_IMAGES
INLINE float3v linear_at(const TextureVolume *const volume, const Grid *const grid, const float3v place) {
    const uint columns = volume->columns, rows = volume->rows, layers = volume->layers;
    const floatv x = first_of(place.x, columns, 2u), y = first_of(place.y, rows, 2u), z = first_of(place.z, layers, 2u);
    // Beyond the middles of the outermost cells it is theirs.
    const floatv fx = clamp(place.x - x, splat(0.0f), splat(1.0f));
    const floatv fy = clamp(place.y - y, splat(0.0f), splat(1.0f));
    const floatv fz = clamp(place.z - z, splat(0.0f), splat(1.0f));
    const Weights weights = {{1.0f - fx, fx},           {1.0f - fy, fy}, {1.0f - fz, fz},
                             first_cell(grid, x, y, z), rows - 1u,       layers - 1u};
    return weighed_rows(grid, &weights, 2u);
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

INLINE float3v cubic_at(const TextureVolume *const volume, const Grid *const grid, const float3v place) {
    const uint columns = volume->columns, rows = volume->rows, layers = volume->layers;
    const floatv x = first_of(place.x, columns, 4u), y = first_of(place.y, rows, 4u), z = first_of(place.z, layers, 4u);
    Weights weights = {.first = first_cell(grid, x, y, z), .up = rows - 1u, .on = layers - 1u};
    weigh(place.x, x, columns, weights.x), weigh(place.y, y, rows, weights.y), weigh(place.z, z, layers, weights.z);
    return weighed_rows(grid, &weights, 4u);
}

INLINE float3v stored_at(const TextureVolume *const volume, __global const float *const values, const float3v place) {
    const Grid grid = {values, volume->channels, volume->line, volume->sheet};
    return volume->is_cubic ? cubic_at(volume, &grid, place) : linear_at(volume, &grid, place);
}
#else
// Texels beyond the faces are the outermost.
__constant sampler_t NEAREST = CLK_NORMALIZED_COORDS_FALSE | CLK_ADDRESS_CLAMP_TO_EDGE | CLK_FILTER_NEAREST;

#ifndef NEXT_TEXEL // a test spoils it
#define NEXT_TEXEL 0
#endif

// In an image channels stand behind each other: `first_layer` is that of one.
INLINE floatv texel(const TextureVolume *const volume, const int first_layer, const intv x, const intv y,
                    const intv z AND_VALUES) {
    const intv layer = clamp(z, (intv)(0), (intv)((int)volume->layers - 1)) + first_layer;
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
INLINE floatv weighed(const TextureVolume *const volume, const int first_layer, const float3v first, const uint count,
                      const floatv weights[3][4] AND_VALUES) {
    const intv x = to_intv_down(first.x) + NEXT_TEXEL, y = to_intv_down(first.y), z = to_intv_down(first.z);
    floatv sum = splat(0.0f);
    for (uint k = 0; k < count; ++k)
        for (uint j = 0; j < count; ++j) {
            const floatv weight = weights[2][k] * weights[1][j];
            for (uint i = 0; i < count; ++i) {
                const floatv it = texel(volume, first_layer, x + (int)i, y + (int)j, z + (int)k PASS_VALUES);
                sum = fma(weight * weights[0][i], it, sum);
            }
        }
    return sum;
}

INLINE float3v stored_at(const TextureVolume *const volume, const float3v place AND_VALUES) {
    const float3v cell = {floor(place.x), floor(place.y), floor(place.z)};
    const floatv x = place.x - cell.x, y = place.y - cell.y, z = place.z - cell.z;
    floatv weights[3][4] = {{1.0f - x, x}, {1.0f - y, y}, {1.0f - z, z}};
    if (volume->is_cubic)
        weigh_evenly(x, weights[0]), weigh_evenly(y, weights[1]), weigh_evenly(z, weights[2]);
    const float back = volume->is_cubic ? 1.0f : 0.0f;
    const float3v first = {cell.x - back, cell.y - back, cell.z - back};
    floatv found[3];
    for (uint channel = 0; channel < volume->channels; ++channel)
        found[channel] =
            weighed(volume, (int)(channel * volume->layers), first, volume->is_cubic ? 4u : 2u, weights PASS_VALUES);
    if (volume->channels == 1u)
        return (float3v){found[0], found[0], found[0]};
    return (float3v){found[0], found[1], found[2]};
}
#endif
