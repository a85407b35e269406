// Random numbers that are functions of what they belong to, the same on every device: the hash PCG-RXS-M-XS (O'Neill
// 2014) in the form of Jarzynski and Olano 2020, "Hash functions for GPU rendering".
#pragma once
#include "lanes.h"

uintv hash_of(const uintv value) {
    const uintv state = value * 747796405u + 2891336453u;
    const uintv word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// Returns a number in [0,1) of 24 bits for the number in each lane; every seed gives others.
floatv random_of(const uintv number, const uint seed) {
    return to_floatv(hash_of(hash_of(number) + seed) >> 8u) * (1.0f / 16777216.0f);
}
