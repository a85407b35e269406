"""Are there classes for all that a scene can have, and do they hold what they are given?"""

import copy
import pickle
import subprocess
import sys
from pathlib import Path

import energywave as ew
import numpy as np
import pytest
from energywave._tables import SCHEMA, TABLES

CRATE = Path(__file__).parents[1]
SCENES = CRATE.parents[1] / "scenes"


def test_every_table_of_the_schema_has_a_class_and_every_key_an_attribute():
    tables = {name: schema for name, schema in SCHEMA["$defs"].items() if "properties" in schema}
    assert len(tables) > 35 and set(tables) == set(TABLES)
    for name, schema in tables.items():
        kind = getattr(ew, "".join(word.capitalize() for word in name.replace(".", "_").split("_")))
        assert schema["description"] in kind.__doc__
        for key in schema["properties"]:
            attribute = key + "_" if key == "from" else key
            assert attribute in kind._keys and f"    {attribute}: " in kind.__doc__, (name, key)
    assert set(ew.Scene._keys) == set(SCHEMA["properties"])


def test_every_scene_of_ours_is_the_same_through_objects():
    tomllib = pytest.importorskip("tomllib")
    files = sorted(SCENES.rglob("*.toml"))
    assert len(files) > 50
    for file in files:
        tables = tomllib.loads(file.read_text())
        assert ew.Scene.load(file).to_dict() == {key: value for key, value in tables.items() if value != []}, file
        assert eval(repr(ew.Scene.load(file)), vars(ew)) == ew.Scene.load(file)  # a repr is what makes it


def test_a_loaded_scene_is_drawn_as_its_file_is(renderer):
    pytest.importorskip("tomllib")
    file = SCENES / "lit-floor.toml"  # names a file of a mesh
    size = (48, 27)
    assert np.array_equal(renderer.render(ew.Scene.load(file), size=size), renderer.render(file, size=size))


def test_tables_refuse_what_they_do_not_have():
    for make, words in [
        (lambda: ew.Torus(), "needs major_radius="),
        (lambda: ew.Torus(major_radius=1, coeficient=2), "did you mean `coefficient`"),
        (lambda: ew.Scene(toruss=[]), "did you mean `torus`"),
        (lambda: ew.Scene(ew.Bloom(strength=1)), "no table Bloom"),
    ]:
        with pytest.raises(TypeError, match=words):
            make()
    with pytest.raises(AttributeError, match="did you mean `coefficient`"):
        ew.Torus(major_radius=1).coeficient


def test_tables_are_values(scene):
    torus = scene.torus[0]
    assert repr(torus) == "Torus(coefficient=0.01, color=[0.15, 0.35, 1.0], major_radius=0.9)"
    assert torus.profile == "inverse-square" and torus.reach is None and torus.to_dict().keys() == {
        "coefficient", "color", "major_radius"
    }  # fmt: skip
    other = torus.replace(major_radius=1.1, color=None)
    assert other != torus and other.color == [1, 1, 1] and torus.major_radius == 0.9
    assert copy.deepcopy(scene) == scene == pickle.loads(pickle.dumps(scene))
    segment = ew.Segment(from_=[0, 0, 0], to=[1, 0, 0], radius=ew.Track(times=[0, 1], values=[0.1, 0.2]))
    assert segment.to_dict()["from"] == [0, 0, 0] and segment.to_dict()["radius"]["values"] == [0.1, 0.2]


def test_stubs_are_those_of_the_schema():
    made = subprocess.run([sys.executable, CRATE / "stubs.py", "--print"], check=True, capture_output=True, text=True)
    assert made.stdout == (CRATE / "python/energywave/_tables.pyi").read_text(), "run crates/python/stubs.py"
