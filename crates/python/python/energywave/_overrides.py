"""The keywords that replace values of a scene, for type checkers alone."""

from typing import Literal, Tuple, Union

from typing_extensions import TypedDict


class Overrides(TypedDict, total=False):
    """What :class:`energywave.Renderer` says of them."""

    size: Tuple[int, int]
    width: int
    height: int
    method: Literal["exact", "simpson", "jittered"]
    divisions: int
    tolerance: float
    sampling: Literal["tiles", "pixels"]
    antialias: Literal["footprint", "none"]
    exposure: Union[float, Literal["auto"]]
    t: float
