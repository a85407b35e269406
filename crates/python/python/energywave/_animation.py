"""The frames of a scene that moves."""

from __future__ import annotations

import operator
from fractions import Fraction
from typing import TYPE_CHECKING, Any, Iterator, Sequence

from ._errors import Error, misuse

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._render import Renderer


#: The greatest number of a frame, as of the program's.
LAST_FRAME = 99_999_999


class Animation(Iterator["NDArray[np.float32]"]):
    """The frames of a scene that moves, drawn one after the other as they are asked for.

    Attributes:
        frames: their numbers.
        fps: frames a second.
    """

    #: A loop may end so far from a whole number of frames before its seam is seen.
    _SEAM = Fraction(1, 1000)

    def __init__(self, renderer: Renderer, opened: Any, fps: Any, frames: Any, progress: Any, overrides: Any) -> None:
        self.fps = _rate(fps)
        if overrides.get("t") is not None:
            remedy = "name frames=, or draw one by render(scene, t=...)"
            raise misuse("t", "each frame has a time of its own", remedy)
        self._renderer, self._opened, self._progress, self._overrides = renderer, opened, progress, overrides
        if frames is None:
            frames = self._last(opened) + 1
        self.frames = _numbers(frames)
        self._next = 0

    def _last(self, opened: Any) -> int:
        if opened.span is None:
            remedy = "name frames=, or give the scene a [time] loop"
            what = "moves without end" if opened.is_animated else "doesn't move"
            raise misuse("frames", f"the scene {what}", remedy)
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
        """Draws the frame of a number, 0 or more; each is a function of its time alone."""
        overrides = dict(self._overrides, t=self.time_of(_number(frame)))
        return self._renderer._native.render_frame(self._opened, float(self.fps), overrides, self._progress)


def _rate(fps: Any) -> Fraction:
    try:
        rate = fps if isinstance(fps, Fraction) else Fraction(fps).limit_denominator(100_000)
    except (TypeError, ValueError, ArithmeticError):  # None, texts, NaN, infinity
        rate = Fraction(0)
    if not 0 < rate <= 100_000:
        raise misuse("fps", f"{fps!r} is no frame rate", "more than 0 and at most 100000 frames a second")
    return rate


def _unfit(frame: Any) -> Error:
    remedy = f"frames are whole numbers from 0 to {LAST_FRAME}, or how many there are"
    return misuse("frames", f"{frame!r} is none", remedy)


def _number(frame: Any) -> int:
    try:
        number = operator.index(frame)
    except TypeError:
        raise _unfit(frame) from None
    if isinstance(frame, bool) or not 0 <= number <= LAST_FRAME:
        raise _unfit(frame)
    return number


def _numbers(frames: Any) -> "Sequence[int]":
    """Returns the numbers of frames: so many from 0 on, or those that are named."""
    if isinstance(frames, range):
        if frames:
            _number(frames[0]), _number(frames[-1])
        return frames
    if hasattr(frames, "__index__") and not getattr(frames, "shape", ()):
        return range(_number(frames))
    if isinstance(frames, (str, bytes)) or not hasattr(frames, "__iter__"):
        raise _unfit(frames)
    return [_number(frame) for frame in frames]
