// Panels that are still to be integrated: of a vector every lane has its own, and takes the last one first. What one
// lane has to cut then keeps no other waiting.
#pragma once
#include "../../lanes.h"

// Panels that a ray is cut into at first, at most, and that a lane may have open at once.
#define FIRST_PANELS 5
#define MOST_PANELS 24

typedef struct {
    floatv from[MOST_PANELS], to[MOST_PANELS];
    intv count;
    uint height; // the greatest count
} OpenPanels;

INLINE void open_none(OpenPanels *const open) {
    open->count = (intv)(0);
    open->height = 0;
}

// Opens a panel in these lanes.
INLINE void open_panel(OpenPanels *const open, const floatv from, const floatv to, const intv counts) {
#if LANES == 1
    if (!counts)
        return;
    open->from[open->count] = from, open->to[open->count] = to;
    ++open->count;
#else
    if (!any_lane(counts))
        return;
    for (uint k = 0; k < open->height; ++k) {
        const intv is_here = counts & (open->count == (intv)((int)k));
        open->from[k] = select(open->from[k], from, is_here), open->to[k] = select(open->to[k], to, is_here);
    }
    if (any_lane(counts & (open->count == (intv)((int)open->height)))) {
        open->from[open->height] = from, open->to[open->height] = to;
        ++open->height;
    }
    open->count -= counts;
#endif
}

// Takes the next panel in these lanes, and returns which of them have one; others keep what they have.
INLINE intv next_panel(OpenPanels *const open, const intv wants, floatv *const from, floatv *const to) {
#if LANES == 1
    if (!wants || open->count == 0)
        return 0;
    --open->count;
    *from = open->from[open->count], *to = open->to[open->count];
    return -1;
#else
    const intv has_one = wants & (open->count > 0);
    for (uint k = 0; k < open->height; ++k) {
        const intv is_here = has_one & (open->count == (intv)((int)k + 1));
        *from = select(*from, open->from[k], is_here), *to = select(*to, open->to[k], is_here);
    }
    open->count += has_one;
    while (open->height > 0 && !any_lane(open->count == (intv)((int)open->height)))
        --open->height;
    return has_one;
#endif
}
