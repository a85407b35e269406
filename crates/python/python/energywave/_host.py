"""What hosts have in memory of their own: depths that end rays, points of light; and which memory is an image."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Dict, Iterable, List, Optional, Sequence, Union

import numpy as np

from ._errors import mistype, misuse
from ._given import numbers

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class HostDepth:
    """Depths in a buffer or an image of pyopencl's, one for each pixel, which end the rays of a frame.

    They are read on the device, anew for every frame. A length of 0 hides all of a ray, an infinite value nothing;
    neither does what is no number, a negative length, or beyond the planes of the projection.

    Attributes:
        memory: a ``pyopencl.Buffer`` of float32, by rows; or a 2D ``pyopencl.Image`` of the scene's size, of which the
            first channel is taken: R, DEPTH or RGBA, of FLOAT, HALF_FLOAT or UNORM_INT16.
        along: what depths are measured along: ``"ray"``, ``"axis"`` (the direction of view), or behind the projection
            of the scene's camera ``"ndc"`` (z / w of clip space) or ``"buffer"`` (as a depth buffer holds it).
        scale: world units to a unit of depth; negative where depths are; not 0.
        is_bottom_up: whether the first row is the lowest, as OpenGL draws; else it is the highest.
        offset: where the first row of a buffer begins, bytes.
        row_pitch: from row to row of a buffer, bytes; 0: no gap.
    """

    memory: Any
    along: str = "ray"
    scale: float = 1.0
    is_bottom_up: bool = False
    offset: int = 0
    row_pitch: int = 0

    @property
    def is_image(self) -> bool:
        """Whether the memory is an image, not a buffer."""
        return is_image(self.memory)

    @classmethod
    def of(cls, depth: Any) -> "HostDepth":
        """Returns depths; a buffer or an image alone has lengths along the rays."""
        return depth if isinstance(depth, HostDepth) else cls(depth)


@dataclass(frozen=True)
class HostPoints:
    """Points of light, in any number, that are others in every frame: a particle system has them.

    They are drawn as the same :class:`Points` of a scene, to the bit; the scene stays as it is, and is read once. They
    are arrays of NumPy, or in :meth:`Renderer.enqueue` also buffers of pyopencl's; in a frame they are read anew.

    Attributes:
        positions: float32 of shape (n, 4): x, y and z, world units; the fourth is not looked at. Other numbers, and
            (n, 3), are copied to that. Or a ``pyopencl.Buffer`` of float4.
        lights: linear RGB of each, likewise; None: all have ``color``.
        count: how many points of a buffer, from its beginning; None: as many as it has. Arrays have as many as they
            have.
        coefficient: what the light of each is multiplied with.
        color: linear RGB of points that have no lights of their own.
        profile: how their light falls off: ``"inverse"``, ``"inverse-square"`` or ``"smeared"``.
        previous: where each was, likewise: its light lies evenly along the way from there, as of a spark that flies,
            and falls off by ``"inverse"``, without a radius; None: they have not moved.
        radius: how thick they are, world units: of ``"smeared"``, which needs one, the standard deviation of a ball of
            light. Of the others each is then drawn by itself, which is slow for many; 0: they are points.
    """

    positions: Any
    lights: Any = None
    count: Optional[int] = None
    coefficient: float = 1.0
    color: Sequence[float] = (1.0, 1.0, 1.0)
    profile: str = "inverse-square"
    previous: Any = None
    radius: float = 0.0

    @property
    def is_buffer(self) -> bool:
        """Whether positions are in a buffer, not an array."""
        return hasattr(self.positions, "int_ptr")

    @classmethod
    def listed(cls, points: "Union[HostPoints, Iterable[HostPoints]]") -> "List[HostPoints]":
        """Returns points, one or several, as rows of four or buffers."""
        several = [points] if isinstance(points, HostPoints) else points
        remedy = "give an energywave.HostPoints, or several"
        try:
            found = list(several)
        except TypeError:
            raise mistype("points", f"it is of type {type(points).__name__}", remedy) from None
        for index, one in enumerate(found):
            if not isinstance(one, HostPoints):
                raise mistype(f"points[{index}]", f"it is of type {type(one).__name__}", remedy)
        return [one._as_rows(f"points[{index}]") for index, one in enumerate(found)]

    def _as_rows(self, place: str) -> "HostPoints":
        others: Dict[str, Any] = {"lights": self.lights, "previous": self.previous}
        others = {name: given for name, given in others.items() if given is not None}
        for name, given in others.items():
            if hasattr(given, "int_ptr") != self.is_buffer:
                reason = f"it is of type {type(given).__name__}, positions {type(self.positions).__name__}"
                raise mistype(f"{place}.{name}", reason, "give two arrays or two buffers")
        if self.is_buffer:
            return replace(self, count=self.positions.size // 16) if self.count is None else self
        if self.count is not None:
            raise misuse(f"{place}.count", "an array has as many points as rows", "give a part of the array")
        positions = _rows(f"{place}.positions", self.positions)
        others = {name: _rows(f"{place}.{name}", given) for name, given in others.items()}
        for name, rows in others.items():
            if len(rows) != len(positions):
                reason = f"{len(rows)} rows, and {len(positions)} positions"
                raise misuse(f"{place}.{name}", reason, "give as many of both")
        return replace(self, positions=positions, **others)


def _rows(name: str, given: Any) -> "NDArray[np.float32]":
    """Returns rows of four float32."""
    remedy = "give an array of (n, 4), or (n, 3), or a pyopencl.Buffer of float4"
    rows: "NDArray[np.float32]" = numbers(name, given, np.float32, remedy)
    if rows.ndim != 2 or rows.shape[1] not in (3, 4):
        raise misuse(name, f"an array of shape {list(rows.shape)}", remedy)
    if rows.shape[1] == 4:
        return np.ascontiguousarray(rows)
    four = np.zeros((len(rows), 4), np.float32)
    four[:, :3] = rows
    return four


def is_image(memory: Any) -> bool:
    """Returns whether memory of pyopencl's is an image."""
    import pyopencl

    return isinstance(memory, pyopencl.Image)
