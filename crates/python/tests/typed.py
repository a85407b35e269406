"""What type checkers must accept, and, where a line says so, refuse: `mypy --strict tests/typed.py`."""

import energywave as ew
import numpy as np
from numpy.typing import NDArray

scene = ew.Scene(ew.Camera(eye=[0, -4, 2], target=(0, 0, 0)), sphere=[{"center": [0, 0, 1]}])
scene.add(ew.Torus(major_radius=ew.Track(times=[0, 1], values=[0.5, 1.5]), color=np.ones(3), profile="inverse"))
light: NDArray[np.float32] = ew.render(scene, size=(32, 24), tolerance=1e-2, t=0.5)
rays: NDArray[np.float64] = ew.integrate(scene, [0, -4, 2], np.zeros((10, 3)), reference=True)
for frame in ew.animate(scene, fps=24, frames=3, size=(32, 24)):
    light = frame
sparks = ew.HostPoints(np.zeros((10, 4), np.float32), color=(1, 0.5, 0.2), profile="inverse")
light = ew.render(scene, points=[sparks, ew.HostPoints(np.zeros((10, 3)))], size=(32, 24))
light = ew.Renderer(reference=True).render(scene, points=sparks)
trails = ew.HostPoints(np.ones((10, 3)), previous=np.zeros((10, 3)), profile="inverse")
light = ew.render(scene, points=[trails, ew.HostPoints(np.ones((10, 3)), profile="smeared", radius=0.1)])
picture: ew.Picture = ew.tone_map(light, scene, exposure="auto")
names: list[str] = [device.name for device in ew.devices()]

ew.Torus(major_radius="large")  # type: ignore[arg-type]
ew.Torus(radius=1)  # type: ignore[call-arg]
ew.Torus(major_radius=1, profile="cubic")  # type: ignore[arg-type]
ew.render(scene, widht=3)  # type: ignore[call-arg]
ew.render(scene, points=3)  # type: ignore[arg-type]
ew.HostPoints(np.zeros((10, 4)), size=1.0)  # type: ignore[call-arg]
ew.HostPoints(np.zeros((10, 4)), radius="large")  # type: ignore[arg-type]
