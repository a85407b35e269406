"""Makes truth/NAME.npy: of 2000 pixels of each scene, chosen by a seeded generator, number, red, green and blue.

The values are float64, by energywave's reference (adaptive quadrature to 1e-10), asked along single rays through the
library for C: `crates/capi/install PREFIX`, then `ENERGYWAVE_LIBRARY=PREFIX/lib/libenergywave_c.so.1 make_truth.py`.
"""

import numpy as np

from library import Library
from scene import HERE, Scene, names

COUNT = 2000


def main() -> None:
    library = Library()
    for seed, name in enumerate(names()):
        scene = Scene.open(name)
        origins, directions = scene.rays()
        chosen = np.sort(np.random.default_rng(seed).choice(len(origins), COUNT, replace=False))
        starts = origins[chosen]
        ends = starts + directions[chosen] * scene.ray_length
        light = library.integrate("reference", scene.path, starts, ends)
        table = np.column_stack([chosen, light])
        (HERE / "truth").mkdir(exist_ok=True)
        np.save(HERE / "truth" / f"{name}.npy", table)
        print(f"{name}: {COUNT} pixels, {light.min():.3e} to {light.max():.3e}")


if __name__ == "__main__":
    main()
