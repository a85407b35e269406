"""Are faults exceptions that say what, where, and what to do; and is a renderer as good as new after them?"""

import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import energywave as ew
import numpy as np
import pytest
from conftest import ring

CAMERA = {"eye": [0, -4, 2], "target": [0, 0, 0]}


def fault(scene, **keywords):
    with pytest.raises(ew.Error) as raised:
        ew.render(scene, **keywords)
    return raised.value


def test_a_fault_of_a_dictionary_has_the_key_as_its_place():
    error = fault({"camera": CAMERA, "torus": [{"major_radius": 1}, {"major_radius": -1}]})
    assert (error.code, error.place) == ("scene", "torus[1].major_radius")
    assert isinstance(error, ew.SceneError) and isinstance(error, ValueError) and error.remedy
    error = fault({"camera": CAMERA, "torus": [{"major_radius": 1, "coeficient": 2}]})
    assert "coefficient" in str(error) and error.place.startswith("torus[0]")
    error = fault({"camera": {"eye": [0, -4, float("nan")], "target": [0, 0, 0]}})
    assert error.place == "camera.eye[2]"
    error = fault({"camera": CAMERA, "sphere": [{"center": object()}]})
    assert error.place == "sphere[0].center"


def test_a_fault_of_a_file_has_line_and_column(tmp_path):
    file = tmp_path / "scene.toml"
    file.write_text("[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n[[torus]]\nmajor_radius = -1\n")
    error = fault(file)
    assert error.place == f"{file}:5:16" and error.code == "scene"
    error = fault(tmp_path / "none.toml")
    assert error.code == "input" and isinstance(error, OSError) and error.place.endswith("none.toml")


def test_other_faults_have_classes_that_python_knows(scene, tmp_path):
    error = fault(scene, device="no such device")
    assert (
        error.code == "no-such-device" and isinstance(error, (RuntimeError, LookupError)) and "devices" in error.remedy
    )
    assert fault(scene, method="simson").place == "method"
    assert fault(scene, divisions=3).place == "integration.divisions"
    assert fault(scene, size=(0, 4)).place == "image.width"
    light = ew.render(scene)
    for name in ["light.gif", "no folder/light.png"]:
        with pytest.raises(ew.OutputError) as raised:
            ew.save(tmp_path / name, light)
        assert isinstance(raised.value, OSError) and raised.value.place.endswith(name)
    with pytest.raises(ew.UnsupportedError):
        ew.save(tmp_path / "light.png", light[..., 0])
    with pytest.raises(ew.UnsupportedError):
        ew.integrate(scene, [[0, 0]], [[1, 1]])
    with pytest.raises(ew.SceneError) as raised:
        ew.integrate(scene, [[0, 0, 0]] * 2, [[0, 0, 1], [0, 0, 0]])
    assert raised.value.place == "ray 1"
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    "keywords",
    [dict(size=3), dict(size=(3.5, 4)), dict(size=(-3, 4)), dict(size=(3, 4, 5)), dict(width="x"), dict(t="1")]
    + [dict(tolerance="x"), dict(divisions=2.5), dict(method=3), dict(antialias=[1]), dict(exposure="Auto")],
)
def test_a_keyword_of_a_wrong_kind_is_named(scene, keywords):
    (name,) = keywords
    error = fault(scene, **keywords)
    assert isinstance(error, ew.UnsupportedError) and error.place == name and str(error).startswith(f"{name}: ")
    assert error.remedy.startswith(("give ", "use "))


def test_arrays_that_do_not_fit_are_named(scene, renderer):
    right = np.zeros((48, 64, 4), np.float32)
    fixed = right.copy()
    fixed.flags.writeable = False
    wrong = [fixed, right.astype(float), right[:47], right[..., 0], np.zeros((48, 128, 4), np.float32)[:, ::2], [1, 2]]
    for array in wrong:
        with pytest.raises(ew.UnsupportedError, match="^array: ") as raised:
            renderer.render_into(scene, array)
        assert raised.value.place == "array"
    renderer.render_into(scene, right)
    three, four = np.zeros((3, 3)), np.ones((4, 3))
    for place, call in [
        ("ends", lambda: renderer.integrate(scene, three, four)),
                ("normals", lambda: renderer.irradiance(scene, three, four)),
        ("queue", lambda: ew.Renderer(queue=3)),
    ]:
        with pytest.raises(ew.UnsupportedError, match=f"^{place}: ") as raised:
            call()
        assert raised.value.place == place


ON_Z = [0.0, 0.0, 1.0]
NAN, INFINITY = float("nan"), float("inf")


@pytest.mark.parametrize(
    "origin, end, words",
    [
        ([0, 0, NAN], ON_Z, "start: z is NaN; coordinates are finite"),
        (ON_Z, [0, INFINITY, 0], "end: y is inf; coordinates are finite"),
        (ON_Z, [-INFINITY, NAN, 0], "end: x is -inf"),
        (ON_Z, [2e9, 0, 0], "end: x is 2e9; float32 devices"),
        ([0, -2.5e9, 0], ON_Z, "start: y is -2.5e9; float32 devices"),
        ([-9e8, 0, 0], [9e8, 0, 0], "longer than"),
        (ON_Z, ON_Z, "start and end are less than 1e-9 apart"),
    ],
)
def test_a_ray_that_is_none_is_named_with_its_coordinate(scene, renderer, origin, end, words):
    fine = [[0, 0, 0]] * 2
    for reference in [False, True]:
        with pytest.raises(ew.SceneError, match=f"^scene: ray 2: {words}") as raised:
            ew.integrate(scene, [*fine, origin], [ON_Z, ON_Z, end], reference=reference)
        assert raised.value.place == "ray 2" and raised.value.remedy
    if not np.isfinite(origin).all():
        with pytest.raises(ew.SceneError, match="point 0: z is NaN"):
            renderer.irradiance(scene, origin, ON_Z)
        with pytest.raises(ew.SceneError, match="normal 0: .* not finite"):
            renderer.irradiance(scene, ON_Z, origin)


def test_a_file_that_cannot_be_loaded_is_named(tmp_path):
    """As those that are only drawn, and by line and column."""
    pytest.importorskip("tomllib")
    for name, text, kind, place in [
        ("none.toml", None, FileNotFoundError, "none.toml"),
        ("none.json", None, ew.InputError, "none.json"),
        ("folder.toml", "/", ew.InputError, "folder.toml"),
        ("open.json", "{", ew.SceneError, "open.json:1:1"),
        ("list.json", "[1]", ew.SceneError, "list.json:1:2"),
        ("empty.toml", "camera =\n", ew.SceneError, "empty.toml:1:9"),
        ("key.toml", "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\ney = 3\n", ew.SceneError, "key.toml:4:1"),
        ("bytes.toml", b"\xff\xfe", ew.InputError, "bytes.toml"),
    ]:
        file = tmp_path / name
        if isinstance(text, bytes):
            file.write_bytes(text)
        elif text == "/":
            file.mkdir()
        elif text is not None:
            file.write_text(text)
        for call in [ew.Scene.load, ew.open_scene]:
            with pytest.raises(kind) as raised:
                call(file)
            error = raised.value
            assert isinstance(error, ew.Error) and error.place == str(tmp_path / place) and error.remedy, name
            if text is None:
                assert isinstance(error, ew.NoSuchFileError) and isinstance(error, OSError) and error.code == "input"
                again = pickle.loads(pickle.dumps(error))
                assert type(again) is type(error) and (str(again), again.place) == (str(error), error.place)


WRONG = {
    "frames": [
        *(dict(frames=[it]) for it in [-1, NAN, 1.5, 2.0, 10**8, "a", None, True]),
        *(dict(frames=it) for it in [-3, 2.5, "12", object(), True, range(-1, 3), np.arange(3) - 1, np.zeros(2)]),
    ],
    "fps": [dict(frames=1, fps=it) for it in [0, -1, NAN, INFINITY, "x", None, 1e6]],
    "t": [dict(frames=1, t=1.0)],
}


@pytest.mark.parametrize("place", WRONG)
def test_frames_are_whole_numbers_from_0_on(scene, renderer, place):
    for keywords in WRONG[place]:
        with pytest.raises(ew.UnsupportedError, match=f"^{place}: ") as raised:
            renderer.animate(scene, **keywords)
        assert raised.value.place == place and raised.value.remedy, keywords
    for frame in [-1, 0.5, NAN]:
        with pytest.raises(ew.UnsupportedError, match="^frames: "):
            renderer.animate(scene, frames=1).draw(frame)
    for frames, count in [(0, 0), (3, 3), (np.int64(2), 2), (np.arange(2), 2), (range(5, 1, -2), 2), ([], 0)]:
        assert len(renderer.animate(scene, frames=frames)) == count


MISTAKEN = {  # what is given, and the place of the fault
    "scene": [lambda it: ew.render(it), [None, 3, [1], "", np.zeros(3), ew.Torus(major_radius=1), ew.Scene]],
    "path": [lambda it: ew.Scene.load(it), [None, 3, "", ["a"]]],
    "tables": [lambda it: ew.Scene.from_dict(it), [None, [1], "abc"]],
    "torus": [lambda it: ew.Scene(torus=it), [3, "abc", ew.Torus(major_radius=1), {"major_radius": 1}]],
    "device": [lambda it: ew.render(ring(), device=it), [1.5, [0], True, {}]],
    "progress": [lambda it: ew.render(ring(), progress=it), [3, "abc"]],
    "origins": [
        lambda it: ew.integrate(ring(), it, [ON_Z]),
        [None, "abc", [["0", "0", "0"]], [[1j, 0, 0]], [[None, 0, 0]], [[0, 0, 0], [0]], np.zeros((1, 3), bool),
         np.zeros((1, 3), "M8[s]"), object()],
    ],
    "radiance": [lambda it: ew.tone_map(it), [None, "abc", np.zeros((2, 2, 4), complex), [[1], [1, 2]]]],
    "pixels": [lambda it: ew.Picture(it), [None, 3, np.zeros((3, 3), np.uint8), np.zeros((3, 3, 3))]],
    "Torus": [lambda it: ew.Torus(it), [1]],
    "widht": [lambda it: ew.render(ring(), widht=it), [3]],
}  # fmt: skip


@pytest.mark.parametrize("place", MISTAKEN)
def test_what_no_call_takes_is_an_error_of_ours_and_of_pythons(place):
    call, things = MISTAKEN[place]
    for thing in things:
        with pytest.raises(TypeError) as raised:
            call(thing)
        error = raised.value
        assert isinstance(error, ew.ArgumentError), (thing, error)
        assert (error.code, error.place) == ("bad-argument", place) and str(error).startswith(f"{place}: "), thing
        assert error.remedy and str(error).endswith(error.remedy), thing


def test_other_arguments_that_do_not_fit_are_named(scene, renderer, tmp_path):
    light = np.ones((2, 2, 4), np.float32)
    for place, call in [
        ("device", lambda: ew.Renderer("gpu", reference=True)),
        ("reference", lambda: ew.Renderer(queue=3, reference=True)),
        ("width", lambda: renderer.render(scene, width=3, size=(3, 4))),
        ("size", lambda: renderer.render(scene, size="34")),
        ("size", lambda: renderer.render(scene, size=(2**40, 3))),
        ("height", lambda: renderer.render(scene, height=True)),
        ("t", lambda: renderer.render(scene, t=NAN)),
        ("exposure", lambda: ew.tone_map(light, exposure=1e9)),
        ("exposure", lambda: ew.tone_map(light, exposure=NAN)),
        ("path", lambda: ew.save(light, "light.png")),
        ("radiance", lambda: ew.tone_map(light[:0])),
    ]:
        with pytest.raises(ew.UnsupportedError, match=f"^{place}: ") as raised:
            call()
        assert raised.value.place == place and raised.value.remedy
    error = fault(scene, method="simpson", sampling="tiles")
    assert error.place == "integration.sampling" and isinstance(error, ew.SceneError)
    with pytest.raises(ew.ArgumentError, match="Renderer\\(device="):
        renderer.render(scene, device="cpu")
    with pytest.raises(ew.ArgumentError, match="did you mean `device`"):
        ew.render(scene, devcie="cpu")
    with pytest.raises(ew.OutputError) as raised:
        ew.tone_map(light).save_png(tmp_path / "none" / "light.png")
    assert raised.value.place == str(tmp_path / "none" / "light.png")
    assert np.array_equal(renderer.render(scene, size=np.array([3, 2])), renderer.render(scene, size=[3, 2]))


def test_exceptions_come_whole_out_of_another_process(scene):
    error = fault(scene, divisions=3)
    other = pickle.loads(pickle.dumps(error))
    assert type(other) is type(error) and str(other) == str(error)
    assert (other.code, other.place, other.remedy) == (error.code, error.place, error.remedy)


def test_what_was_hardly_meant_is_a_warning(renderer):
    with pytest.warns(ew.SceneWarning) as caught:
        renderer.render({"camera": CAMERA, "sphere": [{"coefficient": 0}]}, size=(16, 12))
    assert caught[0].filename == __file__ and "sphere[0]" in str(caught[0].message)


@pytest.mark.parametrize("reference", [False, True])
def test_an_exception_in_a_frame_leaves_the_renderer_usable(scene, reference):
    renderer = ew.Renderer(reference=reference)
    expected = renderer.render(scene, size=(16, 12), antialias="none")
    told = []

    def stop(share):
        told.append(share)
        raise LookupError("that is enough")

    array = np.zeros((400, 600, 4), np.float32)
    long = dict(size=(600, 400), antialias="none", tolerance=1e-9, sampling="pixels")
    for call in [
        lambda: renderer.render(scene, progress=stop, **long),
        lambda: renderer.render_into(scene, array, progress=stop, **long),
        lambda: next(renderer.animate(scene, frames=3, progress=stop, **long)),
        lambda: renderer.integrate(
            scene, [0, -4, 2], np.random.default_rng(1).normal(size=(100_000, 3)), progress=stop
        ),
    ]:
        told.clear()
        with pytest.raises(LookupError, match="that is enough"):
            call()
        assert len(told) == 1 and 0 <= told[0] <= 1
        assert np.array_equal(renderer.render(scene, size=(16, 12), antialias="none"), expected)


def test_progress_is_told_how_far_it_is(scene, renderer):
    told = []
    renderer.render(scene, progress=told.append, size=(600, 400))
    assert told == sorted(told) and told[-1] == 1.0
    with pytest.raises(ew.UnsupportedError):  # it would wait for itself
        renderer.render(scene, progress=lambda share: renderer.render(scene), size=(600, 400))
    assert renderer.render(scene).shape == (48, 64, 4)


def test_ctrl_c_stops_a_frame_at_once(scene):
    renderer = ew.Renderer(reference=True)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # Python has none where a shell let it be ignored
    timer = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
    timer.start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        renderer.render(scene, antialias="none", size=(4000, 4000))  # for minutes
    signal.signal(signal.SIGINT, before)
    assert time.monotonic() - begun < 5
    assert renderer.render(scene, size=(4, 3)).shape == (3, 4, 4)


def test_other_threads_run_while_a_frame_is_drawn(scene):
    """Python's lock is released: a thread counts on while the reference draws."""
    count, stop = [0], threading.Event()

    def run():
        while not stop.is_set():
            count[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=run)
    thread.start()
    before = count[0]
    begun = time.monotonic()
    ew.render(scene, reference=True, antialias="none", size=(256, 192))
    took, counted = time.monotonic() - begun, count[0] - before
    stop.set()
    thread.join()
    assert counted > 0.1 * took / 0.001 or took < 0.05, (counted, took)


WITHOUT_OPENCL = """
import warnings
import energywave as ew
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    light = ew.render({"camera": {"eye": [0, -4, 2], "target": [0, 0, 0]}, "sphere": [{}]}, size=(16, 12))
assert light.shape == (12, 16, 4) and light[..., 0].max() > 0
found = ew.devices()
assert [device.type for device in found] == ["reference"] and found.problem, found
assert [warning.category for warning in caught] == [ew.NoDeviceWarning], caught
assert caught[0].filename == "<string>", caught  # here, and not in the package
ew.save("light.png", light)
"""


def test_without_opencl_the_reference_draws_and_says_so(tmp_path):
    no_vendors = dict(os.environ, OCL_ICD_VENDORS=str(tmp_path / "none"), OPENCL_VENDOR_PATH=str(tmp_path / "none"))
    no_vendors.pop("ENERGYWAVE_DEVICE", None)
    subprocess.run([sys.executable, "-c", WITHOUT_OPENCL], check=True, cwd=tmp_path, env=no_vendors)
    assert (tmp_path / "light.png").stat().st_size > 100


SUITED = """
import ctypes, warnings
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    import energywave as ew
getenv = ctypes.CDLL(None).getenv
getenv.restype = ctypes.c_char_p
print(getenv(b"POCL_AFFINITY"), [str(it.message) for it in caught if it.category is RuntimeWarning])
"""


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="PoCL's threads are pinned on Linux alone")
def test_pocl_gets_what_it_needs_unless_the_user_has_chosen(tmp_path):
    def suited(**variables):
        bare = {name: value for name, value in os.environ.items() if name != "POCL_AFFINITY"}
        command = [sys.executable, "-c", SUITED]
        return subprocess.run(command, env=bare | variables, check=True, capture_output=True, text=True).stdout

    cores = os.sched_getaffinity(0)
    is_ours = len(cores) > 1 and cores == set(range(len(cores)))
    assert suited() == f"{b'1' if is_ours else None} []\n"
    assert suited(POCL_AFFINITY="0") == "b'0' []\n"
    file = tmp_path / "file"
    file.touch()
    said = suited(POCL_AFFINITY="0", POCL_CACHE_DIR=str(file))
    assert "PoCL's cache" in said and str(file) in said
