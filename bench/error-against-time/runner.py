"""What a runner is: a way to draw a scene, with a knob that trades error for time."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from scene import Scene


class Runner:
    """One file of runners/ has one: its class is called `Runner`. Whatever it lacks, it says by an ImportError."""

    name = ""

    def refuses(self, scene: Scene) -> str | None:
        """Returns why it cannot draw a scene; None: it can."""
        return None

    def settings(self, scene: Scene) -> Iterable[Any]:
        """Returns the settings of its knob, the quickest first: numbers or words."""
        raise NotImplementedError

    def prepare(self, scene: Scene, setting: Any) -> Callable[[], np.ndarray]:
        """Returns what draws a whole frame: its result, linear RGB (height, width, 3), is in the host's memory.

        What is made here is not timed, and neither is the first frame: compilers, uploads, grids.
        """
        raise NotImplementedError
