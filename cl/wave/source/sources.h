// Gathers the lists of sources that a scene has on the device, one for each kind in KINDS, the table that kinds.h
// brings: X(kind, Type, number) for every kind that the scene has, in the order of the whole table.
//
// Every source has an emission, colour times coefficient, linear RGB (times |E - S| where light is measured by length),
// and a falloff, which says how its field falls off with the distance.
#pragma once
#include "../types.h"

// A list as a kernel's parameter, as a field of Sources, and as that field's initial value.
#define SOURCE_PARAMETER(kind, Type, number) __global const Type *const restrict kind##_list,
#define SOURCE_LIST(kind, Type, number) __global const struct Type *kind##_list;
#define SOURCE_VALUE(kind, Type, number) kind##_list,

// All that a scene holds on the device: sphere_list, torus_list and so on.
typedef struct {
    KINDS(SOURCE_LIST)
    __global const float4 *rows; // of numbers, to which sources refer: pieces of series, corners of paths
} Sources;
