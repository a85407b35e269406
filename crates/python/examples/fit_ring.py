"""Finds the radius and the coefficient of a ring from an 8-bit picture of it, by scipy.optimize.

    python fit_ring.py

The picture is drawn first, as any renderer or camera would give it: 256x256, sRGB, rounded to 8 bits. What is fitted is
drawn with 16 bits, so that small changes show.
"""

import time

import energywave as ew
import numpy as np
from scipy.optimize import least_squares

TRUE_RADIUS, TRUE_COEFFICIENT = 0.8437, 0.0352
GUESS = [0.7, 0.05]


def ring(radius: float, coefficient: float, bits: int) -> ew.Scene:
    """A ring that is seen from above, at a slant."""
    scene = ew.Scene(ew.Camera(eye=[0, -3, 2.5], target=[0, 0, 0]), ew.Image(width=256, height=256))
    scene.add(ew.Torus(major_radius=radius, coefficient=coefficient, color=[0.2, 0.5, 1.0]))
    scene.display = ew.Display(exposure=0, tone_map="reinhard", bits=bits)
    return scene


def picture(radius: float, coefficient: float, bits: int) -> np.ndarray:
    """Returns values from 0 to 1."""
    scene = ew.open_scene(ring(radius, coefficient, bits))
    return ew.tone_map(ew.render(scene, tolerance=1e-5), scene).pixels / (2.0**bits - 1)


def main() -> None:
    seen = picture(TRUE_RADIUS, TRUE_COEFFICIENT, 8)
    begun = time.perf_counter()
    # The logarithm of the coefficient is as well-behaved as the radius.
    found = least_squares(
        lambda it: (picture(it[0], np.exp(it[1]), 16) - seen).ravel(),
        [GUESS[0], np.log(GUESS[1])],
        diff_step=1e-3,
        loss="soft_l1",
        f_scale=0.02,
    )
    took = time.perf_counter() - begun
    radius, coefficient = found.x[0], np.exp(found.x[1])
    errors = abs(radius - TRUE_RADIUS), abs(coefficient / TRUE_COEFFICIENT - 1)
    print(f"radius {radius:.6f}, off by {errors[0]:.1e}; coefficient {coefficient:.6f}, off by {errors[1]:.1e} of it")
    print(f"{found.nfev} steps in {took:.2f} s")
    assert errors[0] < 1e-4 and errors[1] < 1e-3, errors


if __name__ == "__main__":
    main()
