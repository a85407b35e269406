"""What can go wrong: exceptions with a code, a place and a remedy, and two warnings.

Every exception derives from :class:`Error` and from the built-in class that Python's users catch for such a fault.
"""

from __future__ import annotations

import os
import sys
import warnings
from typing import Any, Optional, Tuple


class Error(Exception):
    """A fault of energywave.

    Attributes:
        code: a name of the kind of fault that never changes, such as ``"scene"`` or ``"no-such-device"``.
        place: where: ``"scene.toml:3:9"``, the key of a scene (``"torus[0].axis"``), a file, a device; or None.
        remedy: what to do.
    """

    code: str = "error"
    place: Optional[str] = None
    remedy: str = ""

    def __reduce__(self) -> Tuple[Any, ...]:
        # So that it comes whole out of another process.
        return make, (self.code, str(self), self.place, self.remedy)


class SceneError(Error, ValueError):
    """A scene holds a value that cannot be drawn, or its file cannot be understood. Code ``scene``."""


class InputError(Error, OSError):
    """An input file cannot be read. Code ``input``."""


class UnsupportedError(Error, ValueError):
    """The device, this build or an argument lacks what is asked for. Code ``unsupported``."""


class DeviceError(Error, RuntimeError):
    """A device fails. Codes ``device``, ``build``, ``self-test``."""


class NoSuchDeviceError(DeviceError, LookupError):
    """No device answers to the choice, or more than one. Code ``no-such-device``."""


class HostError(Error, ValueError):
    """An object of pyopencl's does not fit; nothing was enqueued. Code ``host``."""


class OutOfMemoryError(Error, MemoryError):
    """The device or the machine has too little memory. Code ``out-of-memory``."""


class OutputError(Error, OSError):
    """A file cannot be written; nothing is left behind. Codes ``output``, ``output-format``."""


class SceneWarning(UserWarning):
    """Something in a scene that was hardly meant."""


class NoDeviceWarning(RuntimeWarning):
    """There is no OpenCL device: the built-in reference draws, hundreds of times slower."""


_CLASSES = {
    "scene": SceneError,
    "input": InputError,
    "unsupported": UnsupportedError,
    "no-such-device": NoSuchDeviceError,
    "build": DeviceError,
    "self-test": DeviceError,
    "device": DeviceError,
    "host": HostError,
    "out-of-memory": OutOfMemoryError,
    "output": OutputError,
    "output-format": OutputError,
}


def make(code: str, message: str, place: Optional[str], remedy: str) -> Error:
    """Makes the exception of a kind of fault."""
    error = _CLASSES.get(code, Error)(message)
    error.code, error.place, error.remedy = code, place, remedy
    return error


def warn(category: str, message: str) -> None:
    """Warns of something where the user's code calls the package."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == os.path.dirname(__file__):
        level, frame = level + 1, frame.f_back
    warnings.warn(message, {"SceneWarning": SceneWarning, "NoDeviceWarning": NoDeviceWarning}[category], level + 1)
