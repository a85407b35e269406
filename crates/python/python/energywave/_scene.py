"""A scene: its tables, and what reads and draws them."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Dict, List, Optional, Union

from ._energywave import OpenedScene
from ._errors import ArgumentError, Error, make, mistype, misuse
from ._given import path as path_of
from ._tables import SCHEMA, TABLES, Table, keys_of, plain

#: Longest edge of the picture that a notebook shows, pixels.
NOTEBOOK_PIXELS = 640


_KEYS: Dict[str, Dict[str, Any]] = keys_of(SCHEMA)


def _is_list(name: str) -> bool:
    return _KEYS.get(name, {}).get("type") == "array"


class Scene(Table):
    """A scene: a camera, and what glows.

    Tables can be given by their names, as in a file, or one after the other::

        scene = Scene(Camera(eye=[0, -4, 2], target=[0, 0, 0]), Torus(major_radius=0.9))
        scene.sphere.append(Sphere(center=[0, 0, 1], coefficient=0.01))

    Tables of which there can be several (``torus``, ``sphere``, ...) are lists, the others are one table or None.
    In the place of any table a dictionary may stand, of any number, vector, colour or list of such a ``Track``. Files
    that a scene names are from the working folder, or from the folder of the file that the scene was loaded from.
    """

    _name = ""
    _keys = _KEYS
    _required = ()
    _folder: Optional[str] = None

    def __init__(self, *tables: Table, **values: Any) -> None:
        for name in self._keys:
            if _is_list(name):
                vars(self)[name] = []
        for name, value in values.items():
            setattr(self, name, value)
        for table in tables:
            self.add(table)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in self._keys and _is_list(name):
            value = _tables(name, value)
        super().__setattr__(name, value)

    def add(self, table: Table) -> "Scene":
        """Adds a table, to the others of its kind, or in the place of the one that was there. Returns the scene."""
        name = getattr(table, "_name", None)
        if not isinstance(table, Table) or name not in self._keys:
            what = table.__name__ if isinstance(table, type) else type(table).__name__
            remedy = "give one that was made, such as Torus(...)" if isinstance(table, type) else None
            remedy = remedy or f"it has {', '.join(self._keys)}"
            raise mistype("table", f"a scene has no table {what}", remedy)
        if _is_list(name):
            getattr(self, name).append(table)
        else:
            setattr(self, name, table)
        return self

    @classmethod
    def from_dict(cls, tables: Mapping[str, Any]) -> "Scene":
        """Makes a scene of dictionaries, as a JSON file has them; those of keys become tables.

        Raises:
            ArgumentError: for a key that there is not.
        """
        if not isinstance(tables, Mapping):
            raise mistype("tables", f"it is of type {type(tables).__name__}", "give a dictionary of tables")
        scene = cls()
        for key, value in tables.items():
            setattr(scene, key, _table_of(cls._keys.get(key, {}), value))
        return scene

    @classmethod
    def load(cls, path: "Union[str, os.PathLike[str]]") -> "Scene":
        """Reads a scene file, TOML (Python 3.11 or later, or with tomli) or ``.json``, to be changed.

        What is only to be drawn needs no such thing: :func:`energywave.render` takes the path.

        Raises:
            InputError: for a file that cannot be read; NoSuchFileError, which is also a FileNotFoundError, if it is not
                there.
            SceneError: for a file that is no scene; its place is file, line and column.
        """
        path = Path(path_of("path", path))
        try:
            scene = cls.from_dict(_read(path))
        except (OSError, ValueError, TypeError) as error:
            if isinstance(error, Error) and not isinstance(error, ArgumentError):
                raise
            OpenedScene.from_file(str(path))  # says where
            remedy = "check the file"
            raise make("scene", f"scene: {path}: {error}; {remedy}", str(path), remedy) from error
        object.__setattr__(scene, "_folder", str(path.parent.absolute()))
        return scene

    def _repr_png_(self) -> bytes:
        """Returns the picture that a notebook shows: the scene at 0 s, small."""
        from ._picture import tone_map
        from ._render import render

        opened = open_scene(self)
        width, height = opened.size()
        share = min(1.0, NOTEBOOK_PIXELS / max(width, height))
        size = (max(1, round(width * share)), max(1, round(height * share)))
        return tone_map(render(opened, size=size), opened)._repr_png_()


def _read(path: Path) -> Any:
    """Reads the tables of a file."""
    text = path.read_text(encoding="utf-8")
    if path.suffix.lower() == ".json":
        return json.loads(text)
    try:
        import tomllib
    except ImportError:
        try:
            import tomli as tomllib  # type: ignore[no-redef,import-not-found]
        except ImportError:
            remedy = "install tomli, or give the path to what draws"
            raise misuse("path", "TOML is read by Python 3.11 or later, or with tomli", remedy) from None
    return tomllib.loads(text)


def _tables(name: str, value: Any) -> List[Any]:
    """Returns the list of tables that a key of a scene holds."""
    if value is None:
        return []
    if isinstance(value, list):
        return value
    if isinstance(value, (Table, Mapping, str, bytes)) or not hasattr(value, "__iter__"):
        remedy = f"give a list, also of one: scene.{name} = [...], or scene.add(...)"
        raise mistype(name, f"there may be several, and it is of type {type(value).__name__}", remedy)
    return list(value)


def _table_of(schema: Dict[str, Any], value: Any) -> Any:
    """Returns what a key's value is as tables, as far as the schema says that it is some."""
    for form in [schema, *schema.get("anyOf", ())]:
        name = form.get("$ref", "").rpartition("/")[2]
        if name in TABLES and isinstance(value, Mapping):
            kind = TABLES[name]
            keys = kind._keys  # type: ignore[attr-defined]
            names = {key: key + "_" if key + "_" in keys else key for key in value}
            return kind(**{names[key]: _table_of(keys.get(names[key], {}), it) for key, it in value.items()})
        if isinstance(value, list) and "items" in form:
            value = [_table_of(form["items"], it) for it in value]
    return value


def open_scene(scene: Any, needs_camera: bool = True) -> OpenedScene:
    """Reads a scene: a path, a dictionary, a :class:`Scene`, or one that was opened.

    What was opened is drawn again and again without being read anew. It doesn't change: open a scene again after a
    change.

    Args:
        scene: the path of a TOML or ``.json`` file, a dictionary as a JSON file has it, or a :class:`Scene`.
        needs_camera: whether a scene without a camera is refused.

    Raises:
        SceneError: for what is no scene; its place is file, line and column, or the key.
        InputError: for a file that cannot be read.
    """
    if isinstance(scene, OpenedScene):
        return scene
    if isinstance(scene, (str, bytes, os.PathLike)):
        return OpenedScene.from_file(path_of("scene", scene))
    if not isinstance(scene, (Table, Mapping)) or (isinstance(scene, Table) and not isinstance(scene, Scene)):
        is_table = isinstance(scene, Table)
        remedy = "put it into one, Scene(Camera(...), ...)" if is_table else "give a path, a dictionary or a Scene"
        raise mistype("scene", f"it is of type {type(scene).__name__}", remedy)
    tables: Dict[str, Any] = plain(scene, "")
    if not needs_camera and "camera" not in tables:
        tables["camera"] = {"eye": [0, -4, 0], "target": [0, 0, 0]}
    folder = scene._folder if isinstance(scene, Scene) else None
    return OpenedScene.from_json(json.dumps(tables, allow_nan=False), True, folder)
