"""What can go wrong: exceptions with a code, a place and a remedy, and two warnings.

Every exception derives from :class:`Error` and from the built-in class that Python's users catch for such a fault.
"""

from __future__ import annotations

import errno
import os
import sys
import warnings
from typing import Any, Optional, Tuple, Type


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
        return _remake, (type(self), str(self), self.code, self.place, self.remedy)


def _remake(kind: Type[Error], message: str, code: str, place: Optional[str], remedy: str) -> Error:
    error = kind(message)
    error.code, error.place, error.remedy = code, place, remedy
    return error


class SceneError(Error, ValueError):
    """A scene holds a value that cannot be drawn, or its file cannot be understood. Code ``scene``."""


class InputError(Error, OSError):
    """An input file cannot be read. Code ``input``."""


class NoSuchFileError(InputError, FileNotFoundError):
    """An input file is not there. Code ``input``."""


class UnsupportedError(Error, ValueError):
    """The device, this build or an argument lacks what is asked for. Code ``unsupported``."""


class ArgumentError(UnsupportedError, TypeError):
    """What no call takes: an unknown keyword, a thing of another type. Code ``bad-argument``."""


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
    "bad-argument": ArgumentError,
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
    kind = _CLASSES.get(code, Error)
    if kind is InputError and place and not os.path.lexists(place):
        kind = NoSuchFileError
    error = kind(message)
    if isinstance(error, NoSuchFileError):
        error.errno = errno.ENOENT
    error.code, error.place, error.remedy = code, place, remedy
    return error


def mistype(place: str, reason: str, remedy: str) -> Error:
    """Makes the exception of what no call takes."""
    return make("bad-argument", f"{place}: {reason}; {remedy}", place, remedy)


def misuse(place: str, reason: str, remedy: str) -> Error:
    """Makes the exception of what a call takes, and not such a one."""
    return make("unsupported", f"{place}: {reason}; {remedy}", place, remedy)


def warn(category: str, message: str) -> None:
    """Warns of something where the user's code calls the package."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back is not None and os.path.dirname(frame.f_code.co_filename) == os.path.dirname(__file__):
        level, frame = level + 1, frame.f_back
    warnings.warn(message, {"SceneWarning": SceneWarning, "NoDeviceWarning": NoDeviceWarning}[category], level + 1)
