"""A scene: its tables, and what reads and draws them."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Dict, Optional, Union

from ._energywave import OpenedScene
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
            setattr(self, name, list(value) if _is_list(name) and value is not None else value)
        for table in tables:
            self.add(table)

    def __setattr__(self, name: str, value: Any) -> None:
        if name in self._keys and _is_list(name) and value is None:
            value = []
        super().__setattr__(name, value)

    def add(self, table: Table) -> "Scene":
        """Adds a table, to the others of its kind, or in the place of the one that was there. Returns the scene."""
        name = getattr(table, "_name", None)
        if not isinstance(table, Table) or name not in self._keys:
            raise TypeError(f"a scene has no table {type(table).__name__}; it has {', '.join(self._keys)}")
        if _is_list(name):
            getattr(self, name).append(table)
        else:
            setattr(self, name, table)
        return self

    @classmethod
    def from_dict(cls, tables: Mapping[str, Any]) -> "Scene":
        """Makes a scene of dictionaries, as a JSON file has them; those of keys become tables.

        Raises:
            TypeError: for a key that there is not.
        """
        scene = cls()
        for key, value in tables.items():
            setattr(scene, key, _table_of(cls._keys.get(key, {}), value))
        return scene

    @classmethod
    def load(cls, path: "Union[str, os.PathLike[str]]") -> "Scene":
        """Reads a scene file, TOML (Python 3.11 or later, or with tomli) or ``.json``, to be changed.

        What is only to be drawn needs no such thing: :func:`energywave.render` takes the path.
        """
        path = Path(path)
        text = path.read_text(encoding="utf-8")
        if path.suffix.lower() == ".json":
            tables = json.loads(text)
        else:
            try:
                import tomllib
            except ImportError:
                import tomli as tomllib  # type: ignore[no-redef,import-not-found]
            tables = tomllib.loads(text)
        scene = cls.from_dict(tables)
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
    if isinstance(scene, (str, os.PathLike)):
        return OpenedScene.from_file(os.fspath(scene))
    if not isinstance(scene, (Table, Mapping)) or (isinstance(scene, Table) and not isinstance(scene, Scene)):
        raise TypeError(f"a scene is a path, a dictionary or a Scene, not a {type(scene).__name__}")
    tables: Dict[str, Any] = plain(scene, "")
    if not needs_camera and "camera" not in tables:
        tables["camera"] = {"eye": [0, -4, 0], "target": [0, 0, 0]}
    folder = scene._folder if isinstance(scene, Scene) else None
    return OpenedScene.from_json(json.dumps(tables, allow_nan=False), True, folder)
