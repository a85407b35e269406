"""Simpson's rule along every ray in numpy, float64, all rays at a node at once. The number of divisions is the knob."""

import numpy as np

from runner import Runner as Base
from scene import distance2


class Runner(Base):
    name = "numpy, Simpson"

    def settings(self, scene):
        return [8, 16, 32, 64, 128, 256]

    def prepare(self, scene, setting):
        starts, directions = scene.rays()
        length = scene.ray_length

        def draw():
            light = np.zeros_like(starts)
            for node in range(setting + 1):
                s = node / setting
                weight = 1.0 if node in (0, setting) else 4.0 if node % 2 else 2.0
                points = starts + s * length * directions
                sample = np.zeros_like(starts)
                for kind, sources in scene.kinds.items():
                    for shape, color, radius, squared in zip(
                        sources.shape, sources.color, sources.radius, sources.is_squared, strict=True
                    ):
                        q2 = distance2(kind, shape, points) + radius**2
                        sample += (1.0 / q2 if squared else 1.0 / np.sqrt(q2))[:, None] * color
                zeta = 1.0 if scene.decay is None else scene.decay[0] / (s + scene.decay[1]) ** 2
                light += weight * zeta * sample
            scale = length if scene.measures_length else 1.0
            return (light * scale / (3 * setting)).reshape(scene.height, scene.width, 3)

        return draw
