// Adds the light of a picture to a film's: pixel = what is there + share * light. Frames for hosts are put together by
// it, of surfaces, and of what is seen before each depth of a pixel.
#include "film.h"

// `shares` has one for each pixel; where it is 0, the light may be anything. Spoiled by -D ALL_SHARES, for tests.
__kernel void add_light(__global const float4 *const restrict light, __global const float *const restrict shares,
                        const uint has_shares, const FilmPart part, FILM_PARAMETER) {
    const uint index = get_global_id(0);
    if (index >= part.count)
        return;
    const float4 before = part.adds ? pixels[part.slot + index] : (float4)(0.0f);
#ifdef ALL_SHARES
    const float share = 1.0f;
#else
    const float share = has_shares ? shares[index] : 1.0f;
#endif
    const float4 given = share > 0.0f ? share * light[index] : (float4)(0.0f);
    store_pixel(&part, index, before + given, FILM_ARGUMENT);
}
