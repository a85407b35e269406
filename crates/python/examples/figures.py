"""Draws figures of the papers with matplotlib, and how far Simpson's rule is from the integral on one of them.

    python figures.py SCENES FIGURES.png [WIDTH]

SCENES is the folder `scenes` of energywave, WIDTH that of each picture in pixels.
"""

import sys
from pathlib import Path

import energywave as ew
import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

FIGURES = {
    "figure-08": "2015, figure 8",
    "figure-10": "2015, figure 10",
    "figure-14": "2015, figure 14",
    "2010-figure-11": "2010, figure 11",
    "2008-figure-08-a": "2008, figure 8 a",
    "2013-figure-4-3-left": "2013, figure 4.3",
}
DIVISIONS = [8, 32, 128]


def main(scenes: Path, output: Path, width: int) -> None:
    figure, axes = plt.subplots(2, 4, figsize=(14, 7), layout="constrained")
    places = list(axes.flat)
    for place, (name, title) in zip(places, FIGURES.items()):
        scene = ew.open_scene(scenes / f"{name}.toml")
        columns, rows = scene.size()
        light = ew.render(scene, size=(width, max(1, width * rows // columns)))
        place.imshow(ew.tone_map(light, scene).pixels)
        place.set_title(title)
        place.axis("off")

    # Light and errors along the middle row of the first.
    scene = ew.open_scene(scenes / "figure-08.toml")
    size = dict(size=(width, width), antialias="none")
    exact = ew.render(scene, tolerance=1e-5, **size)[width // 2, :, :3].sum(axis=1)
    places[6].semilogy(exact, color="black", label="exact")
    for divisions in DIVISIONS:
        simpson = ew.render(scene, divisions=divisions, **size)[width // 2, :, :3].sum(axis=1)
        places[6].semilogy(simpson, label=f"{divisions} divisions", lw=1)
        error = np.abs(simpson - exact) / exact
        places[7].semilogy(np.maximum(error, 1e-7), label=f"{divisions} divisions", lw=1)
    for place, title in zip(places[6:], ["light of the middle row", "relative error"]):
        place.set_title(title)
        place.set_xlabel("column")
        place.legend(fontsize="small")
    figure.savefig(output, dpi=100)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), int(sys.argv[3]) if len(sys.argv) > 3 else 320)
