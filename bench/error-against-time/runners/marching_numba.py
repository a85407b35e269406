"""Simpson's rule along every ray, compiled by numba for all cores: float32, with fast mathematics. The number of
divisions is the knob."""

import math

import numpy as np
from numba import njit, prange

from runner import Runner as Base


@njit(fastmath=True, inline="always")
def field(q2, squared):
    return np.float32(1.0) / q2 if squared else np.float32(1.0) / math.sqrt(q2)


@njit(fastmath=True, inline="always")
def distance2(kind, a, x, y, z):
    """The squared distance to a core; `a` is a row of scene.Sources.shape."""
    x, y, z = x - a[0], y - a[1], z - a[2]
    if kind == 0:
        return x * x + y * y + z * z
    if kind == 1:
        u, v, w = a[3] - a[0], a[4] - a[1], a[5] - a[2]
        at = (x * u + y * v + z * w) / (u * u + v * v + w * w)
        at = min(max(at, np.float32(0.0)), np.float32(1.0))
        x, y, z = x - at * u, y - at * v, z - at * w
        return x * x + y * y + z * z
    height = x * a[3] + y * a[4] + z * a[5]
    across = math.sqrt(max(x * x + y * y + z * z - height * height, np.float32(0.0))) - a[6]
    return across * across + height * height


@njit(fastmath=True, parallel=True)
def march(starts, directions, length, divisions, decay, kinds, shapes, colors, radii, squared, light):
    for pixel in prange(len(starts)):
        sx, sy, sz = starts[pixel]
        dx, dy, dz = directions[pixel]
        red = green = blue = np.float32(0.0)
        for node in range(divisions + 1):
            s = np.float32(node) / np.float32(divisions)
            weight = np.float32(1.0 if node == 0 or node == divisions else 4.0 if node % 2 else 2.0)
            if decay[0] > 0.0:
                weight *= decay[0] / ((s + decay[1]) * (s + decay[1]))
            t = s * length
            x, y, z = sx + t * dx, sy + t * dy, sz + t * dz
            for i in range(len(kinds)):
                q2 = distance2(kinds[i], shapes[i], x, y, z) + radii[i] * radii[i]
                value = weight * field(q2, squared[i])
                red += value * colors[i, 0]
                green += value * colors[i, 1]
                blue += value * colors[i, 2]
        light[pixel, 0], light[pixel, 1], light[pixel, 2] = red, green, blue


def packed(scene, dtype):
    """Returns all sources in one list: kinds (0 sphere, 1 segment, 2 torus), shapes, colours, radii, profiles."""
    numbers = {"sphere": 0, "segment": 1, "torus": 2}
    kinds, shapes, colors, radii, squared = [], [], [], [], []
    for kind, sources in scene.kinds.items():
        for row in sources.shape:
            kinds.append(numbers[kind])
            shapes.append(np.pad(row, (0, 7 - len(row))))
        colors.append(sources.color)
        radii.append(sources.radius)
        squared.append(sources.is_squared)
    floats = [np.array(shapes), np.concatenate(colors), np.concatenate(radii)]
    return np.array(kinds), *(it.astype(dtype) for it in floats), np.concatenate(squared)


class Runner(Base):
    name = "numba, Simpson"

    def settings(self, scene):
        return [8, 16, 32, 64, 128, 256, 512, 1024]

    def prepare(self, scene, setting):
        starts, directions = (it.astype(np.float32) for it in scene.rays())
        decay = np.array(scene.decay or (0.0, 0.0), np.float32)
        sources = packed(scene, np.float32)
        light = np.empty_like(starts)
        scale = np.float32((scene.ray_length if scene.measures_length else 1.0) / (3 * setting))

        def draw():
            march(starts, directions, np.float32(scene.ray_length), setting, decay, *sources, light)
            return (light * scale).reshape(scene.height, scene.width, 3)

        return draw
