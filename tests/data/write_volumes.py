"""Writes dense.vdb, sparse.vdb, half.vdb, color.vdb and level.vdb by OpenVDB, and beside each its cells as text, a line
for each active one: x, y and z of its middle in the world, and its light.

Arguments: the folder.
"""

import sys
from pathlib import Path

import numpy

try:
    import pyopenvdb as openvdb
except ImportError:
    print("skipped: pyopenvdb")
    sys.exit(0)

folder = Path(sys.argv[1])
random = numpy.random.default_rng(7)


def save(name, grids, lights):
    openvdb.write(str(folder / f"{name}.vdb"), grids=grids)
    with (folder / f"{name}.txt").open("w") as file:
        for cell, light in lights:
            place = grids[0].transform.indexToWorld(cell)
            print(*place, *light, file=file)
    print("written:", name)


def active(grid, times=lambda cell: (1.0,)):
    for item in grid.citerOnValues():
        low, high = numpy.array(item.min), numpy.array(item.max)
        for offset in numpy.ndindex(*(high - low + 1)):
            cell = tuple(int(it) for it in low + offset)
            yield cell, [item.value * it for it in times(cell)]


values = numpy.zeros((20, 9, 11), "f4")
values[3:15, 2:7, 1:10] = random.random((12, 5, 9))
dense = openvdb.FloatGrid()
dense.name = "density"
dense.copyFromArray(values, (-3, 5, 2))
dense.transform = openvdb.createLinearTransform([[0.25, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 0.125, 0], [1, 2, 3, 1]])
save("dense", [dense], active(dense))

# Far cells, single ones, tiles of leaves, and inactive cells that hold other values.
sparse = openvdb.FloatGrid(2.5)
sparse.name = "fire"
sparse.transform = openvdb.createLinearTransform(0.1)
sparse.fill((-16, 0, 8), (15, 15, 31), 0.5, True)
sparse.fill((-3, 3, 9), (4, 4, 12), 0.75, False)
sparse.fill((20, 1, 9), (22, 2, 9), 0.25, True)
sparse.getAccessor().setValueOn((40, 150, -20), 1.5)
save("sparse", [sparse], active(sparse))

half = dense.deepCopy()
half.saveFloatAsHalf = True
save("half", [half], active(half))

color = openvdb.Vec3SGrid()
color.name = "color"
color.transform = dense.transform
for number, item in enumerate(dense.citerOnValues()):
    color.getAccessor().setValueOn(item.min, (1.0, number % 7 / 7.0, 0.5))
lookup = color.getConstAccessor()
save("color", [dense, color], active(dense, lambda cell: lookup.getValue(cell)))

level = openvdb.createLevelSetSphere(radius=2.0, voxelSize=0.5)
save("level", [level], [])
