"""A million sparks that turn about a core: arrays of NumPy, which are others in every frame; the scene is read once.

    python sparks.py PICTURE.png [COUNT] [FRAMES]

Says how long each frame took: to move all sparks, and to draw them. The picture is the last one.
"""

import sys
import time
from pathlib import Path
from typing import Tuple

import energywave as ew
import numpy as np


class Sparks:
    """Two arms about a core; multiples of irrational numbers lie evenly."""

    def __init__(self, count: int) -> None:
        numbers = np.arange(count)
        self.radius = 2.2 * (numbers + 0.5) / count
        aside = 1.6 * (numbers * 0.618034 % 1 - 0.5) / (0.3 + self.radius)
        self.angle = np.pi * (numbers % 2) + 2 * self.radius + aside
        self.positions = np.empty((count, 4), np.float32)
        self.positions[:, 2] = 0.15 * (numbers * 0.414214 % 1 - 0.5) * (1 - 0.3 * self.radius)
        heat = 1 / (1 + 3 * self.radius**2)
        self.lights = np.stack([0.25 + heat, 0.35 + 0.6 * heat, heat**0, heat], axis=1).astype(np.float32)

    def move(self, seconds: float) -> Tuple[np.ndarray, np.ndarray]:
        """Returns where they are, and their light."""
        angle = self.angle + seconds / (0.2 + self.radius)
        self.positions[:, 0] = self.radius * np.cos(angle)
        self.positions[:, 1] = self.radius * np.sin(angle)
        return self.positions, self.lights


def main(output: Path, count: int, frames: int) -> None:
    # A pixel has many sparks: what a single ray sees of them is as good as a mean over the pixel, and sooner there. All
    # that light together is a veil: dark enough, only the arms and the core are left.
    scene = ew.Scene(
        ew.Camera(eye=[0, -4.5, 2.6], target=[0, 0, 0]),
        ew.Image(width=960, height=540),
        ew.Integration(antialias="none"),
        ew.Display(exposure=-4.6, tone_map="aces"),
    )
    opened, renderer = ew.open_scene(scene), ew.Renderer()
    sparks, light = Sparks(count), np.empty((540, 960, 4), np.float32)
    for frame in range(frames):
        begun = time.perf_counter()
        points = ew.HostPoints(*sparks.move(0.04 * frame), coefficient=1 / count)
        moved = time.perf_counter()
        renderer.render_into(opened, light, points=points)
        drawn = time.perf_counter()
        print(f"{count} sparks moved in {1e3 * (moved - begun):.0f} ms, drawn in {1e3 * (drawn - moved):.0f} ms")
    ew.save(output, light, opened)


if __name__ == "__main__":
    main(Path(sys.argv[1]), int((sys.argv[2:3] or [1_000_000])[0]), int((sys.argv[3:4] or [3])[0]))
