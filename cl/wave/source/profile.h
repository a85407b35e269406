// How a field falls off with the distance to its core: 1 over the distance, or over its square (Sakai 2006). Only
// programs for scenes with inverse squares contain them.
#pragma once
#include "../../lanes.h"

#ifdef INVERSE_SQUARES
#define IS_SQUARE(source) ((source)->is_square)
#else
#define IS_SQUARE(source) 0u
#endif

// Returns the field, from 1 over the distance.
floatv profiled(const floatv per_distance, const uint is_square) {
    return is_square ? per_distance * per_distance : per_distance;
}
