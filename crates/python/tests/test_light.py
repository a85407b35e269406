"""Is the light that comes to Python the light?"""

import threading

import energywave as ew
import numpy as np
import pytest
from conftest import ring

#: What the exact method may be off by, relative to a pixel: ten times its tolerance, as the worst pixel may.
WORST = 1e-2
#: What the ways to the same pixels may differ by: nothing.
SAME = 0.0


def worst(image, truth):
    return float(np.max(np.abs(image - truth) / np.abs(truth)))


def test_light_is_an_array_of_float32_that_is_the_references(scene, renderer):
    light = renderer.render(scene, antialias="none")
    assert light.shape == (48, 64, 4) and light.dtype == np.float32 and (light[..., 3] == 1).all()
    truth = ew.render(scene, reference=True, antialias="none")
    assert worst(light, truth) < WORST
    other = ew.render(ring(major_radius=0.93), reference=True, antialias="none")
    assert worst(light, other) > WORST  # another scene is told from it


def test_all_ways_to_give_a_scene_give_the_same_light(scene, renderer, tmp_path, monkeypatch):
    light = renderer.render(scene)
    tables = scene.to_dict()
    (tmp_path / "scene.json").write_text(__import__("json").dumps(tables))
    (tmp_path / "scene.toml").write_text(
        "[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n[image]\nwidth = 64\nheight = 48\n"
        "[[torus]]\nmajor_radius = 0.9\ncoefficient = 0.01\ncolor = [0.15, 0.35, 1.0]\n"
    )
    ways = [tables, tmp_path / "scene.json", str(tmp_path / "scene.toml"), ew.open_scene(scene)]
    ways += [ew.Scene.from_dict(tables), ew.Scene.load(tmp_path / "scene.json")]
    arrays = ring(color=np.array([0.15, 0.35, 1.0]), major_radius=np.float64(0.9))
    for way in [*ways, arrays]:
        assert np.array_equal(renderer.render(way), light)
    assert not np.array_equal(renderer.render(ring(coefficient=0.011)), light)


def test_an_array_that_is_there_gets_the_same_light(scene, renderer):
    array = np.full((48, 64, 4), np.nan, np.float32)
    renderer.render_into(scene, array)
    assert np.array_equal(array, renderer.render(scene))
    shaped = [array[:, :32], np.empty((48, 64, 4)), np.empty((64, 48, 4), np.float32)]
    for wrong in [*shaped, array[::-1], np.asfortranarray(array), [1.0]]:
        with pytest.raises(ew.UnsupportedError) as raised:
            renderer.render_into(scene, wrong)
        assert raised.value.place == "array"


def test_arrays_in_any_order_are_read_by_their_axes(scene, renderer):
    """Points that come as columns, every other one, backwards, or with the first axis closest together."""
    begins, ends = np.random.default_rng(2).normal(size=(2, 40, 3)) + [[[0, -4, 2]], [[0, 1, 0]]]
    ways = [
        np.asfortranarray,
        lambda points: np.array(list(points.T)).T,
        lambda points: np.repeat(points, 2, axis=0)[::2],
        lambda points: points[::-1].copy()[::-1],
        lambda points: np.pad(points, ((0, 0), (1, 2)))[:, 1:4],
    ]
    for call in [renderer.integrate, renderer.irradiance]:
        light = call(scene, begins, ends)
        for way in ways:
            assert np.array_equal(call(scene, way(begins), ends), light)
            assert np.array_equal(call(scene, begins, way(ends)), light)
        assert not np.array_equal(call(scene, begins.T.reshape(-1, 3), ends), light)  # what a mistaken order gives
    light = renderer.render(scene)
    pixels = ew.tone_map(light).pixels
    for other in [np.asfortranarray(light), light[::-1].copy()[::-1], np.repeat(light, 2, axis=1)[:, ::2]]:
        assert np.array_equal(ew.tone_map(other).pixels, pixels)


def test_keywords_replace_values(scene, renderer):
    assert renderer.render(scene, size=(32, 16)).shape == (16, 32, 4)
    assert renderer.render(scene, width=32).shape == (48, 32, 4)
    tables = scene.to_dict()
    tables["integration"] = {"antialias": "none", "tolerance": 1e-4, "sampling": "pixels"}
    replaced = renderer.render(scene, antialias="none", tolerance=1e-4, sampling="pixels")
    assert np.array_equal(replaced, renderer.render(tables))
    assert not np.array_equal(replaced, renderer.render(scene, antialias="none"))
    with pytest.raises(TypeError, match="did you mean `width`"):
        renderer.render(scene, widht=3)


def test_rays_get_the_integral_of_the_reference(scene, renderer):
    ends = np.random.default_rng(1).normal(size=(1000, 3))
    light = renderer.integrate(scene, [0, -4, 2], ends)
    truth = ew.integrate(scene, [0, -4, 2], ends, reference=True)
    assert light.shape == (1000, 3) and light.dtype == np.float64
    assert worst(light, truth) < WORST
    assert worst(light, np.roll(truth, 1, axis=0)) > WORST
    one = ew.integrate(scene, [0, -4, 2], ends[7], reference=True)
    assert one.shape == (3,) and np.array_equal(one, truth[7])
    grid = renderer.integrate(scene.to_dict(), np.zeros(3), ends.reshape(10, 100, 3))
    assert grid.shape == (10, 100, 3)
    without_camera = {"torus": scene.to_dict()["torus"]}
    assert np.array_equal(renderer.integrate(without_camera, [0, -4, 2], ends), light)


def test_the_rays_of_pixels_get_the_light_of_pixels(scene, renderer):
    begins, ends = ew.rays(scene)
    assert begins.shape == ends.shape == (48, 64, 3)
    light = ew.integrate(scene, begins, ends, reference=True)
    drawn = renderer.render(scene, antialias="none")[..., :3]
    assert worst(drawn, light) < WORST
    assert worst(drawn, light[::-1]) > WORST  # the first row is the top one


def test_more_rays_than_a_device_gets_at_once_are_the_same_rays(scene, renderer):
    ends = np.random.default_rng(2).normal(size=(150_001, 3))
    told = []
    light = renderer.integrate(scene, [0, -4, 2], ends, progress=told.append)
    assert told == sorted(told) and told[-1] == 1.0
    assert renderer.last_cost["integrals"] == len(ends)
    some = np.r_[0:100, 65_500:65_600, len(ends) - 100 : len(ends)]
    assert worst(light[some], ew.integrate(scene, [0, -4, 2], ends[some], reference=True)) < WORST
    assert worst(light[some], light[some + 1 - 2 * (some > 0)]) > WORST
    backwards = renderer.integrate(scene, [0, -4, 2], ends[::-1])  # an array that doesn't lie in C's order
    assert worst(backwards[::-1], light) < WORST
    assert renderer.integrate(scene, np.zeros((0, 3)), np.zeros((0, 3))).shape == (0, 3)


def test_a_sphere_has_the_integral_that_is_known(renderer):
    """A point of 1 / d^2 seen past at the distance h, along the whole line: pi / h."""
    scene = {"sphere": [{"coefficient": 1.0}]}
    light = renderer.integrate(scene, [-1e4, 0.5, 0], [1e4, 0.5, 0])
    assert np.allclose(light, np.pi / 0.5, rtol=1e-3) and not np.allclose(light, np.pi / 0.51, rtol=1e-3)


def test_irradiance_is_the_references(scene, renderer):
    points = np.array([[0, 0, 0.5], [0.3, 0.1, -1.0], [2, 0, 0.2]])
    found = renderer.irradiance(scene, points, [[0, 0, -1], [0, 0, 1], [-1, 0, 0]])
    truth = ew.irradiance(scene, points, [[0, 0, -1], [0, 0, 1], [-1, 0, 0]], reference=True)
    assert found.shape == (3, 3) and found.dtype == np.float32 and (truth > 0).all()
    assert worst(found, truth) < WORST
    assert (renderer.irradiance(scene, [0, 0, 0.5], [0, 0, 1]) == 0).all()  # it looks away


def test_an_error_map_says_where_light_is_off(scene, renderer):
    errors = renderer.error_map(scene)
    assert errors.shape == (48, 64, 3) and errors.max() < WORST
    rough = renderer.error_map(scene, divisions=4)
    assert rough.max() > 10 * WORST


def test_threads_draw_the_right_pictures_by_renderers_of_their_own():
    radii = [0.5 + 0.1 * index for index in range(8)]
    expected = [ew.render(ring(major_radius=radius)) for radius in radii]
    assert not np.array_equal(expected[0], expected[1])
    wrong = []

    def draw(index):
        renderer = ew.Renderer()
        for _ in range(20):
            if not np.array_equal(renderer.render(ring(major_radius=radii[index])), expected[index]):
                wrong.append(index)

    threads = [threading.Thread(target=draw, args=(index,)) for index in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_threads_may_share_a_renderer(renderer):
    radii = [0.5 + 0.1 * index for index in range(4)]
    expected = [renderer.render(ring(major_radius=radius)) for radius in radii]
    right = []

    def draw(index):
        drawn = [renderer.render(ring(major_radius=radii[index])) for _ in range(10)]
        right.append(all(np.array_equal(light, expected[index]) for light in drawn))

    threads = [threading.Thread(target=draw, args=(index,)) for index in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert right == [True] * 4
