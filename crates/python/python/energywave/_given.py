"""What calls are given: numbers and paths, or what no call takes."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import mistype

if TYPE_CHECKING:
    from numpy.typing import NDArray


def numbers(name: str, given: Any, dtype: Any, remedy: str) -> "NDArray[Any]":
    """Returns an array of numbers of a kind.

    Raises:
        ArgumentError: for what is no array of real numbers: texts, truths, times, complex numbers, None.
    """
    try:
        array = np.asarray(given)
        if array.dtype.kind in "fiu":
            return array.astype(dtype, copy=False)
        if array.dtype.kind == "O" and array.ndim > 0 and not any(it is None for it in array.flat):
            return array.astype(dtype)
        what = "None" if given is None else f"an array of {array.dtype}" if array.ndim else f"a {type(given).__name__}"
    except (TypeError, ValueError) as error:  # rows of different lengths
        what = f"no array: {str(error).splitlines()[0].rstrip('.')}"
    raise mistype(name, f"it is {what}", remedy)


def path(name: str, given: Any) -> str:
    """Returns a path as a text.

    Raises:
        ArgumentError: for what is no path.
    """
    remedy = "give the path of a file, a str or a pathlib.Path"
    if not isinstance(given, (str, bytes, os.PathLike)):
        raise mistype(name, f"it is of type {type(given).__name__}", remedy)
    text = os.fsdecode(given)
    if not text:
        raise mistype(name, "it is empty", remedy)
    return text
