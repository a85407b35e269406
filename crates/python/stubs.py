"""Writes the stubs of the tables of a scene from the schema, where the package is installed.

`--print` prints them instead. A test says whether they are those of the schema.
"""

import json
import sys
from pathlib import Path

from energywave._tables import SCHEMA, TABLES, class_name, keys_of

HEAD = '''"""The tables of a scene. Written by stubs.py from the schema of scene files; change nothing here."""

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Dict, Literal, Optional, Tuple, TypeVar, Union

from numpy.typing import ArrayLike

Self = TypeVar("Self", bound="Table")
_Tables = Mapping[str, Any]
_Number = Union[float, "Track", _Tables]
_Values = Union[ArrayLike, "Track", _Tables, Sequence[Any]]

SCHEMA: Dict[str, Any]
TABLES: Dict[str, type]

def plain(value: Any, place: str) -> Any: ...
def class_name(table: str) -> str: ...
def keys_of(schema: Dict[str, Any]) -> Dict[str, Dict[str, Any]]: ...

class Table:
    _name: str
    _keys: Dict[str, Dict[str, Any]]
    _required: Tuple[str, ...]
    def __init__(self, **values: Any) -> None: ...
    def replace(self: Self, **values: Any) -> Self: ...
    def to_dict(self) -> Dict[str, Any]: ...
'''


def kind_of(key: str, schema: dict) -> str:
    """Returns the type of a key's value."""
    forms = schema.get("anyOf", [schema])
    names = [form["$ref"].rpartition("/")[2] for form in forms if "$ref" in form]
    if names and names[0] in TABLES and names[0] != "track":
        short = ["bool"] if any(form.get("type") == "boolean" for form in forms) else []
        return f"Union[{', '.join([class_name(names[0]), '_Tables', *short])}]"
    if "enum" in schema:
        return f"Literal[{', '.join(json.dumps(word) for word in schema['enum'])}]"
    inner = schema.get("items", {}).get("$ref", "").rpartition("/")[2]
    if inner in TABLES and inner != "track":
        return f"Sequence[Union[{class_name(inner)}, _Tables]]"
    simple = {"boolean": "bool", "integer": "int", "number": "float"}
    if schema.get("type") in simple:
        return simple[schema["type"]]
    if schema.get("type") == "string":
        return 'Union[str, "PathLike[str]"]' if key == "file" else "str"
    inside = json.dumps(schema)
    kinds = ["str"] if '"string"' in inside or '"const"' in inside else []
    kinds.insert(0, "_Values" if '"array"' in inside else "_Number")
    return kinds[0] if len(kinds) == 1 else f"Union[{', '.join(kinds)}]"


def stub_of(name: str, schema: dict) -> str:
    keys = keys_of(schema)
    required = [key for key in keys if key.rstrip("_") in schema.get("required", ())]
    others = [key for key in keys if key not in required]
    lines = [f"class {class_name(name)}(Table):"]
    lines += [f"    {key}: {kind_of(key, value)}" for key, value in keys.items()]
    lines += ["    def __init__(", "        self,", "        *,"]
    lines += [f"        {key}: {kind_of(key, keys[key])}," for key in required]
    lines += [f"        {key}: Optional[{kind_of(key, keys[key])}] = None," for key in others]
    return "\n".join([*lines, "    ) -> None: ..."])


def main() -> None:
    classes = [stub_of(name, SCHEMA["$defs"][name]) for name in TABLES]
    names = ", ".join(json.dumps(class_name(name)) for name in TABLES)
    text = HEAD + "\n" + "\n\n".join(classes) + f"\n\n__all__ = [{names}]\n"
    if sys.argv[1:] == ["--print"]:
        sys.stdout.write(text)
    else:
        (Path(__file__).parent / "python/energywave/_tables.pyi").write_text(text)


if __name__ == "__main__":
    main()
