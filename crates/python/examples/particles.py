"""Projects particles, such as those of a simulation of a galaxy, and says how exact every pixel is.

    python particles.py PICTURE.png [COUNT] [SIZE]

100 000 particles, each a ball of light of the radius 0.03 (the cubic kernel (1 - r^2/h^2)^3), in two arms. Beside the
picture: the relative error of its pixels against float64, at a quarter of the size.
"""

import sys
import tempfile
import time
from pathlib import Path

import energywave as ew
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.colors import LogNorm  # noqa: E402


def galaxy(count: int) -> np.ndarray:
    """Returns positions (count, 3) in two arms of a logarithmic spiral, and in a bulge."""
    random = np.random.default_rng(2006)
    radius = random.gamma(2.0, 0.35, count)
    angle = 2.2 * np.log(radius + 0.1) + np.pi * random.integers(0, 2, count) + random.normal(0, 0.35, count)
    height = random.normal(0, 0.05, count) * (1 + np.exp(-4 * radius))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), height], axis=1)


def main(output: Path, count: int, size: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "particles.npy"
        np.save(file, galaxy(count).astype(np.float32))
        scene = ew.Scene(ew.Camera(eye=[0, -3.2, 2.6], target=[0, 0, 0]), ew.Image(width=size, height=size))
        scene.add(ew.Particles(file=file, radius=0.03, kernel="smooth", coefficient=0.6, color=[1.0, 0.72, 0.45]))
        opened = ew.open_scene(scene)
        light = ew.render(opened)  # builds the kernels
        begun = time.perf_counter()
        light = ew.render(opened)
        drawn = time.perf_counter()
        errors = ew.error_map(opened, size=(size // 4, size // 4)).max(axis=2)
        print(
            f"{count} particles, {size}x{size}: {drawn - begun:.3f} s; float64 took {time.perf_counter() - drawn:.1f} s"
        )
    print(f"relative error of a pixel: median {np.median(errors):.1e}, worst {errors.max():.1e}")
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5.4), layout="constrained")
    left.imshow(ew.tone_map(light, exposure=0).pixels)
    left.set_title(f"{count} particles")
    shown = right.imshow(np.maximum(errors, 1e-8), norm=LogNorm(1e-8, 1e-3), cmap="viridis")
    right.set_title("relative error of each pixel")
    figure.colorbar(shown, ax=right)
    for place in (left, right):
        place.axis("off")
    figure.savefig(output, dpi=100)
    assert errors.max() < 1e-2, errors.max()


if __name__ == "__main__":
    main(Path(sys.argv[1]), int((sys.argv[2:3] or [100_000])[0]), int((sys.argv[3:4] or [512])[0]))
