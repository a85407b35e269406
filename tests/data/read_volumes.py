"""Reads ring.raw, and what other programs find in ring.vdb, half.vdb, ring.nrrd and ring.vti, and compares the cells;
so with white.raw and white.vdb, of light of one colour.

Arguments: the folder; anything more, and the cells that are compared are not those of the volume.
"""

import json
import sys
from pathlib import Path

import numpy

folder = Path(sys.argv[1])
sheet = json.loads((folder / "ring.json").read_text())
columns, rows, layers = sheet["cells"]
cells = numpy.fromfile(folder / "ring.raw", "<f4").reshape(layers, rows, columns, 3).transpose(2, 1, 0, 3)
if sys.argv[2:] != [""] and len(sys.argv) > 2:
    cells = cells[::-1]
middle = numpy.array(sheet["low"]) + sheet["cell"] / 2
failed = False


def compare(name, found, limit, cells=cells):
    global failed
    error = float(numpy.abs(found - cells).max() / cells.max())
    print(f"read: {name}: {error:.1e}")
    failed |= not error <= limit


try:
    import pyopenvdb as openvdb
except ImportError:
    print("skipped: ring.vdb")
else:
    for name, limit in [("ring.vdb", 1e-6), ("half.vdb", 2e-3)]:
        grids, _ = openvdb.readAll(str(folder / name))
        found = {grid.name: grid for grid in grids}
        density, color = found["density"], found["color"]
        values = numpy.zeros((columns, rows, layers), "f4")
        density.copyToArray(values)
        colors = numpy.zeros((columns, rows, layers, 3), "f4")
        color.copyToArray(colors)
        compare(name, values[..., None] * colors, limit)
        place = numpy.array(density.transform.indexToWorld((0, 0, 0)))
        step = numpy.array(density.transform.indexToWorld((1, 1, 1))) - place
        failed |= bool(numpy.abs(place - middle).max() > 1e-9 or numpy.abs(step - sheet["cell"]).max() > 1e-9)
        failed |= density.metadata["class"] != "fog volume" or density.metadata["error"] != sheet["error"]
        failed |= density.activeVoxelCount() != int((cells.max(axis=3) > 0).sum())

    density, color = sorted(openvdb.readAll(str(folder / "white.vdb"))[0], key=lambda grid: grid.name == "color")
    density.copyToArray(values)
    color.copyToArray(colors)
    cells_of_white = numpy.fromfile(folder / "white.raw", "<f4").reshape(layers, rows, columns, 1).transpose(2, 1, 0, 3)
    compare("white.vdb", values[..., None] * colors, 1e-6, cells_of_white)

try:
    import nrrd
except ImportError:
    print("skipped: ring.nrrd")
else:
    found, header = nrrd.read(str(folder / "ring.nrrd"))
    compare("ring.nrrd", numpy.moveaxis(found, 0, 3), 0.0)
    failed |= bool(numpy.abs(header["space origin"] - middle).max() > 1e-9)

try:
    import pyvista
except ImportError:
    print("skipped: ring.vti")
else:
    image = pyvista.read(str(folder / "ring.vti"))
    found = numpy.asarray(image.cell_data["emission"]).reshape(layers, rows, columns, 3).transpose(2, 1, 0, 3)
    compare("ring.vti", found, 0.0)
    failed |= bool(numpy.abs(numpy.array(image.origin) - sheet["low"]).max() > 1e-9)

sys.exit(int(failed))
