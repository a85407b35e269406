"""Devices: which there are."""

from __future__ import annotations

from dataclasses import dataclass
import warnings
from typing import List, Optional, Tuple

from . import _energywave

# Drivers read the environment when they are first asked for devices.
for _line in _energywave.suit_drivers():
    warnings.warn(_line, RuntimeWarning, stacklevel=2)


@dataclass(frozen=True)
class Device:
    """A device that can draw.

    Attributes:
        index: its number, which may change when drivers are installed.
        type: ``gpu``, ``cpu``, ``accelerator``, or ``reference``, which is built in and needs no OpenCL.
        memory_bytes, max_allocation_bytes: of its memory, and of the largest buffer.
        lanes: rays that a work-item carries side by side.
        default: whether it draws where no device is named.
    """

    index: int
    name: str
    type: str
    platform: str
    version: str
    driver: str
    compute_units: int
    memory_bytes: int
    max_allocation_bytes: int
    lanes: int
    tile_workers: int
    default: bool


class Devices(List[Device]):
    """All devices; the last is the built-in reference.

    Attributes:
        problem: why there is no OpenCL device, and what to install; None where there is one.
        absent: of every driver without a device that can draw why, a line each.
    """

    problem: Optional[str] = None
    absent: Tuple[str, ...] = ()


def devices() -> Devices:
    """Looks for devices: GPUs, other OpenCL devices, the built-in reference."""
    records, problem, absent = _energywave.devices()
    found = Devices(Device(**record) for record in records)
    found.problem, found.absent = problem, tuple(absent)
    return found
