// All that a scene holds on the device.
#pragma once
#include "types.h"

typedef struct {
    __global const Sphere *spheres;
    __global const Cylinder *cylinders;
    __global const Beam *beams;
    __global const Torus *tori;
    __global const Curve *curves;
    __global const SplinePiece *spline_pieces;
} Sources;

float4 sphere_emission(const Sources *const sources, const uint index) {
    return sources->spheres[index].emission;
}

float4 cylinder_emission(const Sources *const sources, const uint index) {
    return sources->cylinders[index].emission;
}

float4 beam_emission(const Sources *const sources, const uint index) {
    return sources->beams[index].emission;
}

float4 torus_emission(const Sources *const sources, const uint index) {
    return sources->tori[index].emission;
}

float4 curve_emission(const Sources *const sources, const uint index) {
    return sources->curves[index].emission;
}
