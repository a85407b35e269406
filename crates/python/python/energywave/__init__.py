"""Volumetric energy effects - beams, rings, curves of light - integrated along every view ray on any OpenCL device.

>>> import energywave as ew
>>> scene = ew.Scene(ew.Camera(eye=[0, -4, 2], target=[0, 0, 0]))
>>> scene.torus.append(ew.Torus(major_radius=0.9, coefficient=0.01, color=[0.15, 0.35, 1.0]))
>>> light = ew.render(scene, size=(640, 360))
>>> ew.save("ring.png", light, scene)

Scenes are paths, dictionaries or :class:`Scene`; light is NumPy's, float32 (height, width, 4), linear RGBA. Without
OpenCL the built-in float64 reference draws, and a :class:`NoDeviceWarning` says so.
"""

from ._energywave import OpenedScene
from ._animation import Animation
from ._devices import Device, Devices, devices
from ._errors import (
    ArgumentError,
    DeviceError,
    Error,
    HostError,
    InputError,
    NoDeviceWarning,
    NoSuchDeviceError,
    NoSuchFileError,
    OutOfMemoryError,
    OutputError,
    SceneError,
    SceneWarning,
    UnsupportedError,
)
from ._host import HostDepth, HostPoints
from ._picture import Picture, save, tone_map
from ._render import (
    Renderer,
    animate,
    error_map,
    integrate,
    irradiance,
    rays,
    render,
)
from ._scene import Scene, open_scene
from ._tables import *  # noqa: F403
from ._tables import Table
from ._tables import __all__ as _tables_all

__version__ = "0.1.0"

__all__ = [
    "Animation", "ArgumentError", "Device", "DeviceError", "Devices", "Error", "HostDepth", "HostError",
    "HostPoints", "InputError", "NoDeviceWarning", "NoSuchDeviceError", "NoSuchFileError", "OpenedScene",
    "OutOfMemoryError", "OutputError", "Picture", "Renderer", "Scene", "SceneError", "SceneWarning", "Table",
    "UnsupportedError", "animate", "devices", "error_map", "integrate", "irradiance", "open_scene", "rays", "render",
    "save", "tone_map",
]  # fmt: skip
__all__ += _tables_all
