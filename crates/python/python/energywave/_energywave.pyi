"""The native half of the package."""

from collections.abc import Mapping, Sequence
from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from ._host import HostDepth, HostPoints

_Overrides = Mapping[str, object]
_Progress = Optional[Callable[[float], object]]
_Record = Dict[str, Any]

def schema() -> str: ...
def suit_drivers() -> List[str]: ...
def devices() -> Tuple[List[_Record], Optional[str], List[str]]: ...
def tone_map(
    radiance: NDArray[np.float32], scene: Optional[OpenedScene], overrides: _Overrides
) -> Tuple[NDArray[Any], List[int]]: ...
def save(path: str, radiance: NDArray[np.float32], scene: Optional[OpenedScene], overrides: _Overrides) -> None: ...

class OpenedScene:
    """A scene that was read. It is the fastest to draw often: what it is at a time is worked out once."""

    @staticmethod
    def from_file(path: str) -> OpenedScene: ...
    @staticmethod
    def from_toml(text: str) -> OpenedScene: ...
    @staticmethod
    def from_json(text: str, is_object: bool = False, folder: Optional[str] = None) -> OpenedScene: ...
    def size(self, **overrides: Any) -> Tuple[int, int]: ...
    def rays(self, overrides: _Overrides) -> Tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    @property
    def is_animated(self) -> bool: ...
    @property
    def span(self) -> Optional[Tuple[float, bool]]: ...
    @property
    def files(self) -> List[str]: ...

class Renderer:
    def __init__(self, device: Optional[str] = None, self_test: bool = True) -> None: ...
    @staticmethod
    def on_queue(queue: Any) -> Renderer: ...
    @property
    def device_records(self) -> List[_Record]: ...
    @property
    def last_cost(self) -> Dict[str, float]: ...
    def render(
        self, scene: OpenedScene, overrides: _Overrides, progress: _Progress = None, points: Sequence[HostPoints] = ()
    ) -> NDArray[np.float32]: ...
    def render_into(
        self,
        scene: OpenedScene,
        array: NDArray[np.float32],
        overrides: _Overrides,
        progress: _Progress = None,
        points: Sequence[HostPoints] = (),
    ) -> None: ...
    def render_frame(
        self, scene: OpenedScene, rate: float, overrides: _Overrides, progress: _Progress = None
    ) -> NDArray[np.float32]: ...
    def integrate(
        self,
        scene: OpenedScene,
        origins: NDArray[np.float64],
        ends: NDArray[np.float64],
        overrides: _Overrides,
        progress: _Progress = None,
    ) -> NDArray[np.float64]: ...
    def irradiance(
        self, scene: OpenedScene, points: NDArray[np.float64], normals: NDArray[np.float64], overrides: _Overrides
    ) -> NDArray[np.float32]: ...
    def enqueue(
        self,
        scene: OpenedScene,
        target: Tuple[Any, bool],
        depth_and_points: Tuple[Optional[HostDepth], List[HostPoints]],
        wait_for: List[Any],
        overrides: _Overrides,
    ) -> int: ...
