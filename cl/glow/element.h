// The light of a ball, or of a stretch of a streak, along rays.
//
// With x = 1 - d^2/h^2, t = sqrt x, D = 1 - x and A = artanh t the moments of (1 - r/h)^2 about the place where a ray
// is closest to a ball are h F0, h^3 F2, h^5 F4:
//   F0 = 2 t - (4/3) t^3 - 2 D A = sum_{k>=2} 4 t^(2k+1) / ((2k-1)(2k+1)), and F2, F4 alike;
// those of (1 - r^2/h^2)^3 are (32/35) t^7, (32/315) t^9, (32/1155) t^11. A decay alpha/(s + beta)^2 far from its pole,
// W away, gives alpha L^2/W^2 (M0 + 3 M2/W^2 + 5 M4/W^4). Whatever is cut, near the pole, or no ball is summed by
// panels of Gauss and Legendre that begin where the ray is closest, in y, the root of the share of the panel.
#pragma once
#include "rays.h"

// A panel ends where the decay's argument has grown to so many times itself, or has shrunk to that part.
#define MOST_GROWTH 3.0f

// Beyond this share of the way to the decay's pole moments do not tell enough: they leave 5e-6 there.
#ifdef MOMENTS_EVERYWHERE
#define MOMENTS_END 1e9f // spoiled
#else
#define MOMENTS_END 0.2f
#endif

#define NODES 10u
__constant float NODE[NODES] = {1.702173135e-04f, 4.551973752e-03f, 2.569455622e-02f, 8.026019485e-02f,
                                1.811037227e-01f, 3.299780617e-01f, 5.136555890e-01f, 7.051041245e-01f,
                                8.696153404e-01f, 9.740767458e-01f};
__constant float WEIGHT[NODES] = {8.698434107e-04f, 1.008323095e-02f, 3.511849577e-02f, 7.628388168e-02f,
                                  1.257641256e-01f, 1.697600992e-01f, 1.929828376e-01f, 1.839678667e-01f,
                                  1.393681182e-01f, 6.580150090e-02f};

// A piece of an element along a ray: at lengths u from a place on the ray the way from the core is from + step u, and
// the radius h + slope u.
typedef struct {
    float3v from, step;
    floatv h, slope;
    floatv behind; // the place's length behind the projection plane
    bool is_smooth;
} Piece;

INLINE floatv root(const floatv x) {
    return 0.5f * x * twice_inverse_sqrt_(max(x, splat(TINY)));
}

// Sums a panel from `u` on, of this length, which may be negative.
INLINE floatv panel(const GlowView *const view, const Piece *const piece, const floatv u, const floatv length) {
    floatv sum = splat(0.0f);
    const bool fades = view->power > 0u || view->absorbed > 0.0f;
    for (uint node = 0u; node < NODES; ++node) {
        const floatv at = fma(length, splat(NODE[node]), u);
        const float3v way = fma3(piece->step, at, piece->from);
        const floatv r2 = dot3(way, way);
        const floatv h = fma(piece->slope, at, piece->h);
        // 1 - r/h without cancellation at the rim.
        const floatv r = root(r2), left = (h - r) * (h + r);
        floatv light;
        if (piece->is_smooth) {
            const floatv share = max(left * inverse(max(h * h, splat(TINY))), splat(0.0f));
            light = share * share * share;
        } else {
            const floatv share = max(left * inverse(max(h * (h + r), splat(TINY))), splat(0.0f));
            light = share * share;
        }
        if (fades)
            light *= fading(view, max(piece->behind + at, 0.0f));
        sum = fma(light, splat(WEIGHT[node]), sum);
    }
    return sum * fabs(length) * (fades ? 1.0f : view->scale);
}

// Sums from `from` to `to` by as many panels as the decay asks for.
INLINE floatv panels(const GlowView *const view, const Piece *const piece, const floatv from, const floatv to) {
    floatv sum = splat(0.0f), at = from;
    intv goes_on = to != from;
    while (any_lane(goes_on)) {
        floatv next = to;
        if (view->power > 0u) {
            const floatv argument = max(piece->behind + at + view->beta, view->beta);
            next = min(next, fma(argument, splat(MOST_GROWTH - 1.0f), at));
            next = select(next, max(to, fma(argument, splat(1.0f / MOST_GROWTH - 1.0f), at)), to < at);
        }
        if (view->absorbed > 0.0f) {
            const float most = 3.0f / view->absorbed;
            next = clamp(next, at - most, at + most);
        }
        const floatv part = panel(view, piece, at, next - at);
        sum += select(splat(0.0f), part, goes_on);
        goes_on &= (next != to) & (next != at);
        at = next;
    }
    return sum;
}

// Sums a piece over [low, high], lengths from its place.
INLINE floatv piece_light(const GlowView *const view, Piece *const piece, floatv low, floatv high) {
    // From where the ray is closest on: lengths are small there.
    const floatv steepness = dot3(piece->step, piece->step);
    const floatv closest = clamp(-dot3(piece->from, piece->step) / max(steepness, splat(TINY)), low, max(low, high));
    piece->from = fma3(piece->step, closest, piece->from);
    piece->h = fma(piece->slope, closest, piece->h);
    piece->behind += closest;
    low -= closest, high -= closest;
    // Where the distance is the radius: a u^2 + 2 b u + c = 0.
    const floatv a = fma(-piece->slope, piece->slope, steepness);
    const floatv b = fma(-piece->h, piece->slope, dot3(piece->from, piece->step));
    const floatv c = fma(-piece->h, piece->h, dot3(piece->from, piece->from));
    const floatv inside = fma(b, b, -a * c);
    intv meets = (low < high) & (inside > 0.0f);
    if (!any_lane(meets))
        return splat(0.0f);
    const floatv square = sqrt(max(inside, 0.0f));
    const floatv q = -(b + copysign(square, b));
    const floatv one = q / select(a, copysign(splat(TINY), a), fabs(a) < TINY);
    const floatv other = c / select(q, copysign(splat(TINY), q), fabs(q) < TINY);
    const floatv first = min(one, other), last = max(one, other);
    // Along a cone that opens faster than the ray leaves its axis, the ray stays inside.
    const intv is_open = a < 0.0f;
    const intv opens = piece->slope > 0.0f;
    low = max(low, select(first, select(splat(-INFINITY), last, opens), is_open));
    high = min(high, select(last, select(first, splat(INFINITY), opens), is_open));
    meets &= low < high;
    if (!any_lane(meets))
        return splat(0.0f);
    low = select(splat(0.0f), low, meets), high = select(splat(0.0f), high, meets);
    const floatv from = clamp(splat(0.0f), low, high);
    return panels(view, piece, from, high) + panels(view, piece, from, low);
}

// What a ray is to an element's middle.
typedef struct {
    floatv at;   // where it is closest, a length along the ray
    float3v way; // from the middle to there
    floatv d2;   // its square
} Passing;

// Returns how rays pass a point. Their points at the point's depth are close to it, so nothing cancels: of
// |p|^2 - (p D)^2 float32 keeps little.
INLINE Passing passing(const Block *const block, const float x, const float y, const float z) {
    Passing it;
    const floatv aside_x = fma(block->slope_x, splat(z), block->offset_x - x);
    const floatv aside_y = fma(block->slope_y, splat(z), block->offset_y - y);
    const floatv along = fma(aside_x, block->toward.x, aside_y * block->toward.y);
    it.at = fma(splat(z), block->per_z, -along);
#ifdef SQUARED_DISTANCE
    // Spoiled.
    const floatv px = x - block->offset_x, py = y - block->offset_y;
    const floatv to = px * block->toward.x + py * block->toward.y + z * block->toward.z;
    it.d2 = max(px * px + py * py + z * z - to * to, 0.0f);
    it.way.x = sqrt(it.d2), it.way.y = it.way.z = splat(0.0f);
#else
    it.d2 = max(fma(aside_x, aside_x, fma(aside_y, aside_y, -along * along)), splat(0.0f));
    it.way.x = fma(-along, block->toward.x, aside_x);
    it.way.y = fma(-along, block->toward.y, aside_y);
    it.way.z = -along * block->toward.z;
#endif
    return it;
}

// Factors of the powers of x in F0/t^5, F2/t^7 and F4/t^9, the highest last.
__constant float OF_F0[9] = {2.666666667e-01f, 1.142857143e-01f, 6.349206349e-02f, 4.040404040e-02f, 2.797202797e-02f,
                             2.051282051e-02f, 1.568627451e-02f, 1.238390093e-02f, 1.002506266e-02f};
__constant float OF_F2[6] = {3.809523810e-02f, 1.269841270e-02f, 5.772005772e-03f,
                             3.108003108e-03f, 1.864801865e-03f, 1.206636501e-03f};
__constant float OF_F4[5] = {1.269841270e-02f, 3.463203463e-03f, 1.332001332e-03f, 6.216006216e-04f, 3.290826820e-04f};

// Returns a polynomial of so many factors.
#define POLYNOMIAL(result, factors, count)                                                                             \
    floatv result = splat(factors[count - 1]);                                                                         \
    _Pragma("unroll") for (int power = count - 2; power >= 0; --power) result = fma(result, x, splat(factors[power]))

// The moments of a ball about the place where the ray is closest, in radii.
typedef struct {
    floatv zeroth, second, fourth;
} Moments;

INLINE Moments moments(const floatv x, const bool is_smooth, const bool fades) {
    Moments result = {splat(0.0f), splat(0.0f), splat(0.0f)};
    const floatv t = root(x), x2 = x * x;
    if (is_smooth) {
        const floatv t7 = x2 * x * t;
        result.zeroth = (32.0f / 35.0f) * t7;
        result.second = (32.0f / 315.0f) * t7 * x;
        result.fourth = (32.0f / 1155.0f) * t7 * x2;
        return result;
    }
    const intv is_short = x < 0.3f; // where the closed forms lose digits
    if (any_lane(is_short)) {
        const floatv t5 = x2 * t;
        POLYNOMIAL(zeroth, OF_F0, 9);
        result.zeroth = t5 * zeroth;
        if (fades) {
            POLYNOMIAL(second, OF_F2, 6);
            POLYNOMIAL(fourth, OF_F4, 5);
            result.second = t5 * x * second;
            result.fourth = t5 * x2 * fourth;
        }
    }
    if (any_lane(~is_short)) {
        const floatv d = max(1.0f - x, splat(0.0f));
        const floatv above = 1.0f + t;
        const floatv artanh = (0.5f * LN_2) * binary_logarithm(above * above * inverse(max(d, splat(TINY))));
        const floatv t3 = x * t, d_artanh = d * artanh;
        const floatv zeroth = fma(t3, splat(-4.0f / 3.0f), 2.0f * t) - 2.0f * d_artanh;
        result.zeroth = select(zeroth, result.zeroth, is_short);
        if (fades) {
            const floatv t5 = t3 * x;
            const floatv r2 = 0.25f * t - 0.125f * d * (t + d_artanh);
            const floatv r4 = t3 * (1.0f / 6.0f) - 0.5f * d * r2;
            const floatv second = 2.0f * (t3 * (1.0f / 3.0f) - 2.0f * r2 + t5 * 0.2f + d * t3 * (1.0f / 3.0f));
            const floatv fourth = 2.0f * (t5 * 0.2f - 2.0f * r4 + t5 * x * (1.0f / 7.0f) + d * t5 * 0.2f);
            result.second = select(second, result.second, is_short);
            result.fourth = select(fourth, result.fourth, is_short);
        }
    }
    return result;
}

// Returns the light of a ball of emission 1.
INLINE floatv ball_light(const GlowView *const view, const Block *const block, __global const Element *const element) {
    const Passing it = passing(block, element->x, element->y, element->z);
    const float h = element->radius;
    const floatv chord2 = fma(splat(h), splat(h), -it.d2);
    const floatv half_chord = root(max(chord2, splat(0.0f)));
    const floatv low = block->begin - it.at, high = block->end - it.at;
    const intv meets = (chord2 > 0.0f) & (half_chord > low) & (-half_chord < high) & (low < high);
    if (!any_lane(meets))
        return splat(0.0f);
    const bool is_smooth = (element->form & IS_SMOOTH) != 0u;
    const bool has_decay = view->power == 2u && !(view->absorbed > 0.0f);
    const bool is_plain = has_decay || (view->power == 0u && !(view->absorbed > 0.0f));
#ifdef NEVER_CUT
    const intv is_cut = (intv)(0); // spoiled
#else
    const intv is_cut = (-half_chord < low) | (half_chord > high);
#endif
    const floatv to_pole = view->beta - low;
    const intv is_near = has_decay ? h > MOMENTS_END * to_pole : (intv)(0);
    const intv by_panels = meets & (is_plain ? is_cut | is_near : (intv)(-1));
    floatv light = splat(0.0f);
    if (any_lane(meets & ~by_panels)) {
        const Moments sum = moments(clamp(chord2 * (1.0f / (h * h)), 0.0f, 1.0f), is_smooth, has_decay);
        light = sum.zeroth * (h * view->scale);
        if (has_decay) {
            const floatv share = 1.0f / to_pole, step = h * share, step2 = step * step;
            const floatv more = fma(step2, 5.0f * sum.fourth, 3.0f * sum.second);
            const floatv w = view->ray_length * share;
            light = fma(step2, more, sum.zeroth) * (h * view->scale) * w * w;
        }
        light = select(splat(0.0f), light, meets & ~by_panels);
    }
    if (any_lane(by_panels)) {
        Piece piece = {it.way, block->toward, splat(h), splat(0.0f), it.at - block->begin, is_smooth};
        const floatv part = piece_light(view, &piece, low, select(low, high, by_panels));
        light += select(splat(0.0f), part, by_panels);
    }
    return light;
}

// Returns the light of a stretch of a streak of emission 1: of its sides, and of the caps that it has.
INLINE floatv stretch_light(const GlowView *const view, const Block *const block,
                            __global const Element *const element) {
    const Passing it = passing(block, element->x, element->y, element->z);
    const float4 half_axis = (float4)(element->axis_x, element->axis_y, element->axis_z, 0.0f);
    const float half_length = length(half_axis);
    const float4 axis = half_axis / half_length;
    const float3v toward = block->toward;
    const bool is_smooth = (element->form & IS_SMOOTH) != 0u;
    const float3v axes = uniform3(axis);
    const floatv along = dot3(it.way, axes), cosine = dot3(toward, axes);
    const floatv slant = select(cosine, copysign(splat(1e-12f), cosine), fabs(cosine) < 1e-12f);
    const floatv low = block->begin - it.at, high = block->end - it.at, behind = it.at - block->begin;
    // Where the ray passes the planes of the ends.
    const floatv at_begin = (-half_length - along) / slant, at_end = (half_length - along) / slant;
    const float slope = element->growth / half_length;
    Piece sides = {fma3(axes, -along, it.way),
                   fma3(axes, -cosine, toward),
                   fma(along, splat(slope), splat(element->radius)),
                   cosine * slope,
                   behind,
                   is_smooth};
    floatv light = piece_light(view, &sides, max(low, min(at_begin, at_end)), min(high, max(at_begin, at_end)));
    const intv is_forward = slant > 0.0f;
    if (element->form & HAS_FIRST_CAP) {
        Piece cap = {fma3(axes, splat(half_length), it.way),
                     toward,
                     splat(element->radius - element->growth),
                     splat(0.0f),
                     behind,
                     is_smooth};
        light += piece_light(view, &cap, select(max(low, at_begin), low, is_forward),
                             select(high, min(high, at_begin), is_forward));
    }
    if (element->form & HAS_LAST_CAP) {
        Piece cap = {fma3(axes, splat(-half_length), it.way),
                     toward,
                     splat(element->radius + element->growth),
                     splat(0.0f),
                     behind,
                     is_smooth};
        light += piece_light(view, &cap, select(low, max(low, at_end), is_forward),
                             select(min(high, at_end), high, is_forward));
    }
    return light;
}
