"""Mitsuba 3 (Dr.Jit on LLVM): the light of a cube of space on a grid (`gridvolume`), marched along every ray by its
midpoints. Cells along an edge are the knob; a march takes two steps a cell.

Mitsuba's media do not emit, so the march is this file's; the grid and its interpolation are Mitsuba's. A cell has what
all sources emit at its middle, and the grid covers all that any ray passes.
"""

import os
from pathlib import Path

import numpy as np

from runner import Runner as Base
from scene import distance2

libraries = sorted(Path("/usr/lib").glob("*/libLLVM-[0-9][0-9].so"))  # where Dr.Jit does not look
if libraries:
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", str(libraries[-1]))

import drjit as dr  # noqa: E402
import mitsuba as mi  # noqa: E402


class Runner(Base):
    name = "Mitsuba, grid"

    def __init__(self):
        mi.set_variant("llvm_ad_rgb")
        dr.eval(mi.Float(1.0) + 1.0)

    def settings(self, scene):
        return [16, 32, 64, 128]

    def prepare(self, scene, setting):
        starts, directions = scene.rays()
        ends = starts + scene.ray_length * directions
        low, high = np.minimum(starts, ends).min(0), np.maximum(starts, ends).max(0)
        volume = grid(scene, low, high, setting)
        origin, direction = (mi.Point3f(it.T.astype(np.float32)) for it in (starts, directions))
        steps = 2 * setting
        step = scene.ray_length / steps

        @dr.freeze
        def march(origin, direction):
            light = mi.Color3f(0.0)
            index = mi.UInt32(0)
            while dr.hint(index < steps, mode="symbolic"):
                t = (mi.Float(index) + 0.5) * step
                at = dr.zeros(mi.Interaction3f, dr.width(origin))
                at.p = origin + t * direction
                weight = mi.Float(step)
                if scene.decay is not None:
                    s = t / scene.ray_length
                    weight = weight * scene.decay[0] / dr.square(s + scene.decay[1])
                light += weight * volume.eval(at)
                index += 1
            return light

        scale = np.float32(1.0 if scene.measures_length else 1.0 / scene.ray_length)

        def draw():
            light = march(origin, direction)
            return (np.array(light).T * scale).reshape(scene.height, scene.width, 3)

        return draw


def grid(scene, low, high, cells):
    """Returns the light that all sources emit, at the middles of so many cells each way between two corners."""
    axes = [low[i] + (np.arange(cells) + 0.5) / cells * (high[i] - low[i]) for i in range(3)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).transpose(2, 1, 0, 3)  # z, y, x
    data = np.zeros((*points.shape[:3], 3))
    for kind, sources in scene.kinds.items():
        rows = zip(sources.shape, sources.color, sources.radius, sources.is_squared, strict=True)
        for shape, color, radius, squared in rows:
            q2 = distance2(kind, shape, points) + radius**2
            data += (1.0 / q2 if squared else 1.0 / np.sqrt(q2))[..., None] * color
    to_world = mi.ScalarTransform4f().translate(low.tolist()).scale((high - low).tolist())
    given = mi.VolumeGrid(data.astype(np.float32))
    return mi.load_dict({"type": "gridvolume", "grid": given, "to_world": to_world, "raw": True})
