"""Is the truth true? Closed forms know what points and lines give; and a spoiled scene must be found out."""

import numpy as np

from run import errors
from runners.analytic import Runner
from scene import Scene

# What atan and sums of 32 sources in float64, and a quadrature to 1e-10, may miss.
TOLERANCE = 1e-9


def main() -> None:
    for name in ("points", "lines"):
        scene = Scene.open(name)
        found = errors(scene, Runner().prepare(scene, "float64")())
        print(f"{name}: the worst of 2000 pixels misses its closed form by {found['worst']:.1e}")
        assert found["worst"] < TOLERANCE, found
        kind = next(iter(scene.kinds.values()))
        kind.radius *= 1.0 + 1e-6
        spoiled = errors(scene, Runner().prepare(scene, "float64")())
        assert spoiled["worst"] > TOLERANCE, spoiled
        pixels, truth = scene.truth()
        assert len(np.unique(pixels)) == len(truth) == 2000


if __name__ == "__main__":
    main()
