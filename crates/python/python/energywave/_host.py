"""Memory of pyopencl's: what is an image, and depths that end rays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


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


def is_image(memory: Any) -> bool:
    """Returns whether memory of pyopencl's is an image."""
    import pyopencl

    return isinstance(memory, pyopencl.Image)
