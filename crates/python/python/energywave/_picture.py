"""Light as pictures: tone mapping, files, notebooks."""

from __future__ import annotations

import os
import struct
import zlib
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from . import _energywave
from ._errors import make, mistype, misuse
from ._given import numbers
from ._given import path as path_of
from ._scene import open_scene

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from typing_extensions import Unpack

    from ._overrides import Overrides


class Picture:
    """A picture for screens, sRGB-encoded. A notebook shows it; ``numpy.asarray`` gives its pixels.

    Attributes:
        pixels: (height, width, 3) of uint8 from the top left, or 4 channels with straight alpha; uint16 where the
            scene's display asks for 16 bits.
    """

    def __init__(self, pixels: "NDArray[Any]") -> None:
        channels = pixels.shape[-1] if isinstance(pixels, np.ndarray) and pixels.ndim == 3 else 0
        if channels not in (3, 4) or pixels.dtype not in (np.uint8, np.uint16):
            remedy = "pixels are an array of uint8 or uint16, (height, width, 3 or 4); tone_map makes them of light"
            raise mistype("pixels", "they are none of a picture", remedy)
        self.pixels = pixels

    def __array__(self, dtype: Any = None, copy: Optional[bool] = None) -> "NDArray[Any]":
        return np.array(self.pixels, dtype=dtype, copy=True if copy is None else copy)

    def __repr__(self) -> str:
        height, width, channels = self.pixels.shape
        return f"<energywave picture, {width}x{height}, {channels} channels of {8 * self.pixels.itemsize} bits>"

    def _repr_png_(self) -> bytes:
        return png(self.pixels)

    def save_png(self, path: "Union[str, os.PathLike[str]]") -> None:
        """Writes it as PNG. :func:`energywave.save` writes light to other formats, too.

        Raises:
            OutputError: for a file that cannot be written.
        """
        name = path_of("path", path)
        try:
            with open(name, "wb") as file:
                file.write(self._repr_png_())
        except OSError as error:
            remedy = "check the path, and what is left of the disk"
            raise make("output", f"{name}: cannot write: {error.strerror}; {remedy}", name, remedy) from error


def png(pixels: "NDArray[Any]") -> bytes:
    """Encodes (height, width, 3 or 4) of uint8 or uint16 as PNG (ISO/IEC 15948), sRGB."""
    height, width, channels = pixels.shape
    depth = 8 * pixels.itemsize
    rows = np.ascontiguousarray(pixels.astype(pixels.dtype.newbyteorder(">"))).view(np.uint8).reshape(height, -1)
    # Filter 1, "Sub": differences from the pixel to the left.
    step = channels * pixels.itemsize
    filtered = np.ones((height, rows.shape[1] + 1), np.uint8)
    filtered[:, 1 : 1 + step] = rows[:, :step]
    filtered[:, 1 + step :] = rows[:, step:] - rows[:, :-step]

    def chunk(name: bytes, data: bytes) -> bytes:
        check = zlib.crc32(name + data)
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", check)

    header = struct.pack(">IIBBBBB", width, height, depth, 2 if channels == 3 else 6, 0, 0, 0)
    data = zlib.compress(filtered.tobytes(), 6)
    chunks = chunk(b"IHDR", header) + chunk(b"sRGB", b"\0") + chunk(b"IDAT", data) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + chunks


def _light(radiance: "ArrayLike") -> "NDArray[np.float32]":
    remedy = "light is (height, width, 4), as render gives it"
    light = numbers("radiance", radiance, np.float32, remedy)
    if light.ndim != 3:
        raise misuse("radiance", f"an array of shape {list(light.shape)}", remedy)
    return light


def tone_map(radiance: "ArrayLike", scene: Any = None, **overrides: "Unpack[Overrides]") -> Picture:
    """Makes a picture for screens of light, as the ``display`` of a scene says: exposure, curve, bloom, background.

    Args:
        radiance: (height, width, 4), linear RGBA, as :func:`render` gives it.
        scene: whose display is meant; None: the default display.
        overrides: ``exposure`` in stops or ``"auto"``, and others as :func:`render` takes them.

    Raises:
        UnsupportedError: for an array of another shape.
    """
    opened = None if scene is None else open_scene(scene)
    values, shape = _energywave.tone_map(_light(radiance), opened, overrides)
    return Picture(values.reshape(shape))


def save(
    path: "Union[str, os.PathLike[str]]", radiance: "ArrayLike", scene: Any = None, **overrides: "Unpack[Overrides]"
) -> None:
    """Writes light to a file whose ending chooses: ``.exr`` (linear, float32), or ``.png``, ``.webp``, ``.jpg``.

    Args:
        path: the file; none is left half written.
        radiance: (height, width, 4), linear RGBA, as :func:`render` gives it.
        scene: whose display is meant; None: the default display.
        overrides: ``exposure`` in stops or ``"auto"``, and others as :func:`render` takes them.

    Raises:
        OutputError: for an ending that is no format's, or a file that cannot be written.
        UnsupportedError: for an array of another shape.
    """
    opened = None if scene is None else open_scene(scene)
    if isinstance(path, np.ndarray):
        raise mistype("path", "it is an array", "the path is first: save(path, light)")
    _energywave.save(path_of("path", path), _light(radiance), opened, overrides)
