"""The same, every integral taken at every pixel: nothing is interpolated."""

from runners.energywave_opencl import Runner as Tiles


class Runner(Tiles):
    name = "energywave, every pixel"
    sampling = "pixels"
