"""Closed forms of points and lines of inverse squares, compiled by numba for all cores: float64, one setting.

Along a ray at the distance h from a point, 1 / (h^2 + t^2) has the integral atan(t / h) / h. A finite line is a point
at each end, beyond the planes through them; between those its squared distance is a quadratic of t.
"""

import math

import numpy as np
from numba import njit, prange

from runner import Runner as Base
from runners.marching_numba import packed


@njit(fastmath=True)
def of_quadratic(a, b, c, low, high):
    """The integral of 1 / (a t^2 + 2 b t + c), which is positive, from low to high."""
    if high <= low:
        return 0.0
    if a < 1e-12:
        return (high - low) / c
    root = math.sqrt(max(a * c - b * b, 1e-300))
    return (math.atan((a * high + b) / root) - math.atan((a * low + b) / root)) / root


@njit(fastmath=True)
def of_point(x, y, z, dx, dy, dz, radius, low, high):
    """`x`, `y`, `z`: from the point to where the ray begins."""
    return of_quadratic(1.0, x * dx + y * dy + z * dz, x * x + y * y + z * z + radius * radius, low, high)


@njit(fastmath=True)
def of_line(a, x, y, z, dx, dy, dz, radius, length):
    u, v, w = a[3] - a[0], a[4] - a[1], a[5] - a[2]
    size = math.sqrt(u * u + v * v + w * w)
    u, v, w = u / size, v / size, w / size
    begin, slope = x * u + y * v + z * w, dx * u + dy * v + dz * w  # the place along the line: begin + slope t
    if abs(slope) < 1e-12:
        inside = 0.0 <= begin <= size
        first, last = (0.0 if inside else length), length
        first_end = begin < 0.0
    else:
        first, last = sorted2(-begin / slope, (size - begin) / slope)
        first, last = min(max(first, 0.0), length), min(max(last, 0.0), length)
        first_end = slope > 0.0
    px, py, pz = x - begin * u, y - begin * v, z - begin * w
    ex, ey, ez = dx - slope * u, dy - slope * v, dz - slope * w
    middle = of_quadratic(
        ex * ex + ey * ey + ez * ez,
        px * ex + py * ey + pz * ez,
        px * px + py * py + pz * pz + radius * radius,
        first,
        last,
    )
    fx, fy, fz = x - size * u, y - size * v, z - size * w
    if first_end:
        before = of_point(x, y, z, dx, dy, dz, radius, 0.0, first)
        behind = of_point(fx, fy, fz, dx, dy, dz, radius, last, length)
    else:
        before = of_point(fx, fy, fz, dx, dy, dz, radius, 0.0, first)
        behind = of_point(x, y, z, dx, dy, dz, radius, last, length)
    return before + middle + behind


@njit(fastmath=True)
def sorted2(a, b):
    return (a, b) if a <= b else (b, a)


@njit(fastmath=True, parallel=True)
def integrate(starts, directions, length, kinds, shapes, colors, radii, light):
    for pixel in prange(len(starts)):
        sx, sy, sz = starts[pixel]
        dx, dy, dz = directions[pixel]
        red = green = blue = 0.0
        for i in range(len(kinds)):
            a = shapes[i]
            x, y, z = sx - a[0], sy - a[1], sz - a[2]
            if kinds[i] == 0:
                value = of_point(x, y, z, dx, dy, dz, radii[i], 0.0, length)
            else:
                value = of_line(a, x, y, z, dx, dy, dz, radii[i], length)
            red += value * colors[i, 0]
            green += value * colors[i, 1]
            blue += value * colors[i, 2]
        light[pixel, 0], light[pixel, 1], light[pixel, 2] = red, green, blue


class Runner(Base):
    name = "numba, closed forms"

    def refuses(self, scene):
        if "torus" in scene.kinds:
            return "rings have no closed form"
        is_plain = scene.decay is None and scene.measures_length
        is_squared = all(sources.is_squared.all() for sources in scene.kinds.values())
        return None if is_plain and is_squared else "only inverse squares without a decay"

    def settings(self, scene):
        return ["float64"]

    def prepare(self, scene, setting):
        starts, directions = scene.rays()
        kinds, shapes, colors, radii, _ = packed(scene, float)
        light = np.empty_like(starts)

        def draw():
            integrate(starts, directions, scene.ray_length, kinds, shapes, colors, radii, light)
            return light.reshape(scene.height, scene.width, 3)

        return draw
