// All that a scene holds on the device.
#pragma once
#include "types.h"

typedef struct {
    __global const Sphere *spheres;
    __global const Cylinder *cylinders;
    __global const Torus *tori;
    __global const Curve *curves;
    __global const SplinePiece *spline_pieces;
} Sources;
