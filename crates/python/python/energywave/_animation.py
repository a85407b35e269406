"""The frames of a scene that moves."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any, Iterator

from ._errors import make

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._render import Renderer


class Animation(Iterator["NDArray[np.float32]"]):
    """The frames of a scene that moves, drawn one after the other as they are asked for.

    Attributes:
        frames: their numbers.
        fps: frames a second.
    """

    #: A loop may end so far from a whole number of frames before its seam is seen.
    _SEAM = Fraction(1, 1000)

    def __init__(self, renderer: Renderer, opened: Any, fps: Any, frames: Any, progress: Any, overrides: Any) -> None:
        self.fps = fps if isinstance(fps, Fraction) else Fraction(fps).limit_denominator(100_000)
        if not 0 < self.fps <= 100_000:
            remedy = "more than 0 and at most 100000 frames a second"
            raise make("unsupported", f"fps: {fps}; {remedy}", "fps", remedy)
        self._renderer, self._opened, self._progress, self._overrides = renderer, opened, progress, overrides
        if frames is None:
            frames = self._last(opened) + 1
        self.frames = range(frames) if isinstance(frames, int) else list(frames)
        self._next = 0

    def _last(self, opened: Any) -> int:
        if opened.span is None:
            remedy = "name frames=, or give the scene a [time] loop"
            what = "moves without end" if opened.is_animated else "doesn't move"
            raise make("unsupported", f"frames: the scene {what}; {remedy}", "frames", remedy)
        seconds, loops = opened.span
        count = Fraction(seconds) * self.fps
        is_whole = abs(count - round(count)) <= self._SEAM
        if loops and is_whole:
            return max(round(count) - 1, 0)
        return round(count) if is_whole else int(count)

    def __len__(self) -> int:
        return len(self.frames) - self._next

    def __iter__(self) -> "Animation":
        return self

    def __next__(self) -> "NDArray[np.float32]":
        if self._next >= len(self.frames):
            raise StopIteration
        frame = self.draw(self.frames[self._next])
        self._next += 1
        return frame

    def time_of(self, frame: int) -> float:
        """Returns when a frame is, seconds."""
        return float(frame * self.fps.denominator / self.fps.numerator)

    def draw(self, frame: int) -> "NDArray[np.float32]":
        """Draws the frame of a number; each is a function of its time alone."""
        overrides = dict(self._overrides, t=self.time_of(frame))
        return self._renderer._native.render_frame(self._opened, float(self.fps), overrides, self._progress)
