// The struct of what casts light that crosses from the host to the device; src/light/pack.rs mirrors it. Places are
// relative to an origin that surfaces share, world units.
#pragma once
#include "../check_size.h"

// A part of a core. Its light is RGB, of a point its intensity, else one per length: light + (slope + bend s) s, s from
// 0 to 1 over its parameter.
typedef struct {
    float4 place; // the point; of a line that of the parameter 0; the centre of a ring; of a curve where it begins;
                  // last, the squared radius within which light grows no more
    float4 along; // a line's direction; where a ring has the angle 0, of length 1, and its radius; of a curve what t is
                  // multiplied with
    float4 across; // where a ring has a quarter of a turn, of length 1; of a curve what t^2 is multiplied with
    float4 last;   // of a curve what t^3 is multiplied with
    float4 light, slope, bend;
    float from, to; // of its parameter: lengths, which may be infinite; angles of a ring; 0 and 1 of a curve
    uint form;
    uint padding;
} CastLight;
CHECK_SIZE(CastLight, SIZEOF_CASTLIGHT);

// Forms.
#define POINT_FORM 0u
#define LINE_FORM 1u
#define RING_FORM 2u
#define CURVE_FORM 3u
