// Local intensity S(t): a clamped uniform quadratic B-spline (Watanabe, Abe, Konno 2015, eq. 14-16), which the host
// cuts into its polynomial pieces: rows of c0, c1 and c2, S = c0 + c1 x + c2 x^2, x in [0,1] over the piece. Only
// programs for scenes with such a series contain it.
#pragma once
#include "../../lanes.h"
#include "../types.h"

#ifdef SERIES
#define SERIES_LENGTH(source) ((source)->spline_count)
#else
#define SERIES_LENGTH(source) 0u
#endif

// Of so few pieces, every lane picks its own; loads from many places take longer.
#define PICKED_PIECES 8

floatv spline_at(__global const float4 *const pieces, const uint count, const floatv t) {
    const floatv scaled = clamp(t, splat(0.0f), splat(1.0f)) * (float)count;
    const intv piece = clamp(to_intv_down(scaled), (intv)(0), (intv)((int)count - 1));
    const floatv x = scaled - to_floatv(piece);
#if LANES > 1
    if (count <= PICKED_PIECES) {
        floatv c0 = splat(pieces[0].x), c1 = splat(pieces[0].y), c2 = splat(pieces[0].z);
        for (uint k = 1; k < count; ++k) {
            const intv is_here = piece == (intv)((int)k);
            c0 = select(c0, splat(pieces[k].x), is_here);
            c1 = select(c1, splat(pieces[k].y), is_here);
            c2 = select(c2, splat(pieces[k].z), is_here);
        }
        return fma(fma(c2, x, c1), x, c0);
    }
#endif
    __global const float *const values = (__global const float *)pieces;
    const floatv c0 = gather(values, 4 * piece);
    const floatv c1 = gather(values, 4 * piece + 1);
    const floatv c2 = gather(values, 4 * piece + 2);
    return fma(fma(c2, x, c1), x, c0);
}
