"""The tables of a scene as classes: one for each, made from the schema of scene files when the package is imported.

``Torus(major_radius=0.9)`` is the table ``[[torus]]`` of a file with that key. A key that is not given is left out, and
reads as its default, or as None where it has none. ``from``, a word of Python's, is written ``from_``.
"""

from __future__ import annotations

import copy
import difflib
import json
import keyword
import math
import os
from collections.abc import Mapping
from typing import Any, Dict, Iterable, Iterator, List, Tuple

import numpy as np

from . import _energywave
from ._errors import make, mistype

SCHEMA: Dict[str, Any] = json.loads(_energywave.schema())


class Table:
    """A table of a scene: keys and values as attributes."""

    _name = ""
    _keys: Dict[str, Dict[str, Any]] = {}
    _required: Tuple[str, ...] = ()

    def __init__(self, *positional: Any, **values: Any) -> None:
        kind = type(self).__name__
        if positional:
            raise mistype(kind, "its keys have names", f"give {kind}({next(iter(self._keys), 'key')}=...)")
        for name, value in values.items():
            setattr(self, name, value)
        missing = [key for key in self._required if key not in vars(self)]
        if missing:
            needed = " and ".join(f"{key}=" for key in missing)
            raise mistype(f"{kind}()", f"needs {needed}", "give them")

    def __setattr__(self, name: str, value: Any) -> None:
        if name not in self._keys:
            kind = type(self).__name__
            raise mistype(f"{kind}.{name}", f"{kind} has no key `{name}`", self._hint(name))
        if value is None:
            vars(self).pop(name, None)
        else:
            vars(self)[name] = value

    def __getattr__(self, name: str) -> Any:
        # Only for what is not set.
        if name in self._keys:
            return copy.deepcopy(self._keys[name].get("default"))
        raise AttributeError(f"{type(self).__name__} has no key `{name}`; {self._hint(name)}")

    def __delattr__(self, name: str) -> None:
        vars(self).pop(name, None)

    def _hint(self, name: str) -> str:
        near = difflib.get_close_matches(name, self._keys, n=1)
        return f"did you mean `{near[0]}`?" if near else f"it has {', '.join(self._keys)}"

    def _set_items(self) -> Iterator[Tuple[str, Any]]:
        values = vars(self)
        return ((key, values[key]) for key in self._keys if key in values and not _is_empty(values[key]))

    def __repr__(self) -> str:
        keys = ", ".join(f"{key}={value!r}" for key, value in self._set_items())
        return f"{type(self).__name__}({keys})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.to_dict() == other.to_dict()  # type: ignore[attr-defined]

    __hash__ = None  # type: ignore[assignment]

    def __dir__(self) -> Iterable[str]:
        return sorted({*super().__dir__(), *self._keys})

    def replace(self, **values: Any) -> "Table":
        """Returns a copy in which these keys have other values; None leaves a key out."""
        other = copy.deepcopy(self)
        for name, value in values.items():
            setattr(other, name, value)
        return other

    def to_dict(self) -> Dict[str, Any]:
        """Returns the table as a JSON file has it: numbers, words, lists and dictionaries.

        Raises:
            SceneError: for a value that JSON cannot hold, such as infinity; its place is the key.
        """
        result: Dict[str, Any] = plain(self, "")
        return result


def plain(value: Any, place: str) -> Any:
    """Returns a value of a scene as JSON has it; `place` is its key."""
    if isinstance(value, (str, bool)):
        return value
    if isinstance(value, Table):
        inside = f"{place}." if place else ""
        return {_key_of(name): plain(it, inside + _key_of(name)) for name, it in value._set_items()}
    if isinstance(value, Mapping):
        inside = f"{place}." if place else ""
        return {str(key): plain(it, f"{inside}{key}") for key, it in value.items() if it is not None}
    if isinstance(value, np.ndarray):
        if value.dtype.kind == "f" and not np.isfinite(value).all():
            raise _not_finite(place, value[~np.isfinite(value)].flat[0])
        return value.tolist() if value.dtype.kind in "fiub" else [plain(it, place) for it in value.tolist()]
    if isinstance(value, (list, tuple)):
        return [plain(it, f"{place}[{index}]") for index, it in enumerate(value)]
    if isinstance(value, np.generic):
        return plain(value.item(), place)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise _not_finite(place, value)
        return value
    if isinstance(value, int):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    reason = f"a {type(value).__name__} is no value of a scene"
    remedy = "give numbers, words, lists, arrays or tables"
    raise make("scene", f"scene: {place}: {reason}; {remedy}", place or None, remedy)


def _not_finite(place: str, value: float) -> Exception:
    remedy = "leave the key out, or give a finite number"
    return make("scene", f"scene: {place}: {value} is no number of a scene; {remedy}", place or None, remedy)


def _is_empty(value: Any) -> bool:
    """Whether it is a list of tables with nothing in it."""
    return isinstance(value, list) and not value


def _key_of(name: str) -> str:
    return name[:-1] if name.endswith("_") else name


def _name_of(key: str) -> str:
    return f"{key}_" if keyword.iskeyword(key) else key


def class_name(table: str) -> str:
    """Returns the name of the class of a table: ``LightBall`` of ``light_ball``."""
    return "".join(part[:1].upper() + part[1:] for part in table.replace(".", "_").split("_"))


def keys_of(schema: Dict[str, Any]) -> Dict[str, Dict[str, Any]]:
    """Returns the keys of a table of the schema, by their names in Python."""
    return {_name_of(key): value for key, value in schema.get("properties", {}).items()}


def _described(name: str, schema: Dict[str, Any]) -> str:
    lines: List[str] = [f"{schema.get('description', name)}.", "", f"The table ``{name}`` of a scene.", "", "Args:"]
    for key, value in keys_of(schema).items():
        default = f" Default {json.dumps(value['default'])}." if "default" in value else ""
        needed = " Required." if _key_of(key) in schema.get("required", ()) else ""
        lines.append(f"    {key}: {value.get('description', '')}.{default}{needed}")
    return "\n".join(lines)


def _class_of(name: str, schema: Dict[str, Any]) -> type:
    required = tuple(_name_of(key) for key in schema.get("required", ()))
    body = {
        "__doc__": _described(name, schema),
        "__module__": "energywave",
        "_name": name,
        "_keys": keys_of(schema),
        "_required": required,
    }
    return type(class_name(name), (Table,), body)


#: The classes of all tables, by their names in a scene.
TABLES: Dict[str, type] = {
    name: _class_of(name, schema) for name, schema in SCHEMA["$defs"].items() if "properties" in schema
}
globals().update({kind.__name__: kind for kind in TABLES.values()})
__all__ = [kind.__name__ for kind in TABLES.values()]
