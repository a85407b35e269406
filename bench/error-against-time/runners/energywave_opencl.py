"""energywave on the best OpenCL device: the Python package if it is installed, else the library for C. The tolerance is
the knob."""

import numpy as np

from runner import Runner as Base

try:
    import energywave as package
except ImportError:
    package = None
    from library import Library


class Runner(Base):
    name = "energywave"
    sampling = "tiles"

    def __init__(self):
        if package is None:
            self.library = Library()
            self.renderer = self.library.renderer(None)
        else:
            self.renderer = package.Renderer()

    def settings(self, scene):
        return [0.3, 0.1, 0.03, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 1e-6]

    def prepare(self, scene, setting):
        light = np.empty((scene.height, scene.width, 4), np.float32)
        values = {"tolerance": setting, "sampling": self.sampling}
        if package is None:
            opened = self.library.scene(scene.path, **values)

            def draw():
                self.library.render(self.renderer, opened, light)
                return light[..., :3]
        else:
            opened = package.open_scene(str(scene.path))

            def draw():
                self.renderer.render_into(opened, light, **values)
                return light[..., :3]

        return draw
