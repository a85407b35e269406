"""Do pictures, files and animations hold the light?"""

from fractions import Fraction

import energywave as ew
import numpy as np
import pytest
from conftest import ring

PULSE = {"times": [0, 1], "values": [0.5, 1.5]}


def pixels(path):
    return np.asarray(pytest.importorskip("PIL.Image").open(path))


def test_pictures_are_those_that_are_saved(scene, renderer, tmp_path):
    light = renderer.render(scene)
    ew.save(tmp_path / "saved.png", light, scene)
    picture = ew.tone_map(light, scene)
    (tmp_path / "shown.png").write_bytes(picture._repr_png_())
    assert picture.pixels.shape == (48, 64, 3) and picture.pixels.dtype == np.uint8
    assert np.array_equal(np.asarray(picture), pixels(tmp_path / "saved.png"))
    assert np.array_equal(pixels(tmp_path / "shown.png"), pixels(tmp_path / "saved.png"))
    brighter = ew.tone_map(light, scene, exposure=1)
    assert brighter.pixels.mean() > picture.pixels.mean() and np.array_equal(ew.tone_map(2 * light), brighter)
    deep = ew.tone_map(light, scene.replace(display=ew.Display(bits=16, alpha="luminance")))
    assert deep.pixels.shape == (48, 64, 4) and deep.pixels.dtype == np.uint16
    assert deep._repr_png_()[24:26] == bytes([16, 6])


def test_a_notebook_shows_a_scene(scene):
    assert scene.replace(image=ew.Image(width=2000, height=1000))._repr_png_()[16:24] == bytes(
        [0, 0, 640 >> 8, 640 & 255, 0, 0, 320 >> 8, 320 & 255]
    )


def test_frames_are_functions_of_their_time(renderer):
    moving = ring(major_radius=PULSE)
    frames = renderer.animate(moving, fps=4)
    assert len(frames) == 5 and list(frames.frames) == [0, 1, 2, 3, 4]
    drawn = list(frames)
    assert len(drawn) == 5 and len(frames) == 0
    for number, frame in enumerate(drawn):
        assert np.array_equal(frame, renderer.render(moving, t=number / 4))
        assert np.array_equal(frame, renderer.render(ring(major_radius=0.5 + number / 4)))
    assert not np.array_equal(drawn[0], drawn[1])
    some = renderer.animate(moving, fps=4, frames=[3, 1])
    assert np.array_equal(next(some), drawn[3]) and np.array_equal(next(some), drawn[1])
    with pytest.raises(StopIteration):
        next(some)


def test_a_loop_lacks_the_frame_that_is_its_first_again(renderer):
    looped = ring(major_radius=dict(PULSE, loop="repeat"))
    assert len(renderer.animate(looped, fps=30)) == 30
    assert renderer.animate(looped, fps=Fraction(30000, 1001)).time_of(30000) == 1001.0
    with pytest.raises(ew.UnsupportedError):
        renderer.animate(ring())


def test_a_shutter_that_is_open_blurs(renderer):
    still, moving = ring(), ring(major_radius=PULSE)
    moving.time = still.time = ew.Time(shutter=0.5)
    (blurred,) = renderer.animate(moving, fps=2, frames=[1])
    assert not np.array_equal(blurred, renderer.render(moving, t=0.5))
    sharp = [renderer.render(moving, t=0.5 + 0.25 * (index + 0.5) / 64) for index in range(64)]
    assert np.allclose(blurred, np.mean(sharp, axis=0), rtol=0.05)
    (same,) = renderer.animate(still, fps=2, frames=[1])
    assert np.array_equal(same, renderer.render(still))
