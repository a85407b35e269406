"""Are points that come with a frame those that a scene lists?"""

import warnings

import energywave as ew
import numpy as np
import pytest

#: So many are a crowd.
COUNT = 700


def rows(seed):
    """Positions and lights, float32 (n, 4), whose fourth numbers nobody looks at."""
    random = np.random.default_rng(seed)
    positions, lights = (random.uniform(low, 1, (COUNT, 4)).astype(np.float32) for low in (-1, 0.2))
    positions[:, 3], lights[:, 3] = np.nan, -7
    return positions, lights


def listed(scene, positions, lights=None, **look):
    """The scene with the same points in a table of its own."""
    previous = look.pop("previous", None)
    for key, given in dict(colors=lights, previous=previous).items():
        look.update({} if given is None else {key: given[:, :3].tolist()})
    return ew.Scene(scene.camera, scene.image, *scene.torus, ew.Points(positions=positions[:, :3].tolist(), **look))


def test_arrays_are_the_points_of_a_table_to_the_bit(scene, renderer):
    opened, (positions, lights), nothing = ew.open_scene(scene), rows(1), renderer.render(scene)
    for profile in ("inverse", "inverse-square"):
        look = dict(coefficient=2.0**-9, profile=profile)
        expected = renderer.render(listed(scene, positions, lights, **look))
        points = ew.HostPoints(positions, lights, **look)
        found = renderer.render(opened, points=points)
        assert np.array_equal(found, expected) and not np.array_equal(found, nothing)
        into = np.empty_like(expected)
        renderer.render_into(opened, into, points=[points])
        assert np.array_equal(into, expected)
        colored = dict(look, color=(0.25, 0.5, 1.0))
        found = renderer.render(opened, points=ew.HostPoints(positions, **colored))
        assert np.array_equal(found, renderer.render(listed(scene, positions, **colored)))
        assert not np.array_equal(found, expected)
    assert np.array_equal(renderer.render(opened), nothing)  # the scene stays as it is
    assert np.array_equal(renderer.render(opened, points=()), nothing)


def test_arrays_are_read_anew_for_every_frame(scene, renderer):
    opened, (positions, lights), (moved, _) = ew.open_scene(scene), rows(2), rows(3)
    points = ew.HostPoints(positions, lights, coefficient=2.0**-9)
    before = renderer.render(opened, points=points)
    positions[:] = moved
    found = renderer.render(opened, points=points)
    assert np.array_equal(found, renderer.render(listed(scene, moved, lights, coefficient=2.0**-9)))
    assert not np.array_equal(found, before)


def test_trails_and_balls_of_arrays_are_those_of_a_table_to_the_bit(scene, renderer):
    opened, (positions, lights), (before, _) = ew.open_scene(scene), rows(11), rows(12)
    seen = []
    for look in [
        dict(profile="inverse"),
        dict(profile="inverse", previous=before),
        dict(profile="inverse", previous=positions),  # which have not moved
        dict(profile="smeared", radius=0.03125),
        dict(profile="smeared", radius=0.0625),
        dict(profile="inverse", radius=0.0625),
    ]:
        look.update(coefficient=2.0**-9)
        seen.append(renderer.render(opened, points=ew.HostPoints(positions, lights, **look)))
        assert np.array_equal(seen[-1], renderer.render(listed(scene, positions, lights, **look))), look
    points, trails, resting, *balls = seen
    np.testing.assert_allclose(resting, points, rtol=2e-3)
    for one, other in [(trails, points), (balls[0], points), (balls[1], balls[0]), (balls[2], balls[1])]:
        assert not np.array_equal(one, other)
    # Truth, of few: each trail is the sum of the points of its way.
    few, small = slice(0, 20), dict(size=(16, 12), antialias="none")
    look = dict(profile="inverse", coefficient=1e-2)
    trails = ew.HostPoints(positions[few], lights[few], previous=before[few], **look)
    found = ew.render(opened, points=trails, **small)
    np.testing.assert_allclose(found, ew.render(opened, points=trails, reference=True, **small), rtol=1e-2)
    steps, look["coefficient"] = 400, 1e-2 / 400
    shares = (np.arange(steps) + 0.5) / steps
    way = [share * positions[few, :3] + (1 - share) * before[few, :3] for share in shares]
    along = ew.HostPoints(np.concatenate(way), np.tile(lights[few], (steps, 1)), **look)
    summed = ew.render(opened, points=along, **small)
    np.testing.assert_allclose(found, summed, rtol=1e-2)
    assert not np.allclose(summed, ew.render(opened, points=ew.HostPoints(
        positions[few], lights[few], profile="inverse", coefficient=1e-2
    ), **small), rtol=1e-2)  # fmt: skip


def test_other_numbers_are_copied_and_several_lists_add_up(scene, renderer):
    opened, (positions, lights) = ew.open_scene(scene), rows(4)
    both = [ew.HostPoints(positions, lights, coefficient=1e-3), ew.HostPoints(positions, coefficient=1e-3)]
    expected = renderer.render(opened, points=both)
    for change in [
        lambda it: it[:, :3],
        lambda it: it.astype(np.float64),
        lambda it: np.asfortranarray(it),
        lambda it: np.repeat(it, 2, axis=0)[::2],
        lambda it: it[:, :3].tolist(),
    ]:
        given = [ew.HostPoints(change(positions), change(lights), coefficient=1e-3), both[1]]
        assert np.array_equal(renderer.render(opened, points=iter(given)), expected)
    assert not np.array_equal(renderer.render(opened, points=both[:1]), expected)


def test_the_reference_and_the_functions_take_points(scene):
    opened, (positions, lights) = ew.open_scene(scene), rows(5)
    points = ew.HostPoints(positions[:40], lights[:40], coefficient=1e-2)
    small = dict(size=(16, 12), antialias="none")
    truth = ew.render(opened, points=points, reference=True, **small)
    found = ew.render(opened, points=points, **small)
    np.testing.assert_allclose(found, truth, rtol=1e-2)
    assert not np.allclose(found, ew.render(opened, **small), rtol=1e-2)


def test_a_scene_whose_only_light_are_such_points_is_not_warned_of(scene, renderer):
    dark, (positions, _) = ew.Scene(scene.camera, scene.image), rows(10)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        light = renderer.render(dark, points=ew.HostPoints(positions))
    assert light[..., :3].min() > 0
    with pytest.warns(ew.SceneWarning, match="no source of light"):
        renderer.render(dark)


def test_what_are_no_points_is_refused_with_code_place_and_remedy(scene, renderer):
    opened, (right, lights) = ew.open_scene(scene), rows(6)
    nowhere, glaring = right.copy(), lights.copy()
    nowhere[5, 1], glaring[699, 2] = np.nan, np.inf
    good = ew.HostPoints(right, lights)
    for kind, code, place, words, points in [
        (ew.ArgumentError, "bad-argument", "points", "it is of type int", 3),
        (ew.ArgumentError, "bad-argument", "points[1]", "it is of type ndarray", [good, right]),
        (ew.ArgumentError, "bad-argument", "points[0].positions", "it is None", ew.HostPoints(None)),
        (ew.ArgumentError, "bad-argument", "points[0].positions", "array", ew.HostPoints([[1, 2, 3], [1, 2]])),
        (ew.ArgumentError, "bad-argument", "points[0].lights", "array", ew.HostPoints(right, "white")),
        (ew.UnsupportedError, "unsupported", "points[0].positions", "shape", ew.HostPoints(right[:, :2])),
        (ew.UnsupportedError, "unsupported", "points[1].lights", "699 rows", [good, ew.HostPoints(right, lights[1:])]),
        (ew.ArgumentError, "bad-argument", "points[0].previous", "array", ew.HostPoints(right, previous="there")),
        (ew.UnsupportedError, "unsupported", "points[0].previous", "shape", ew.HostPoints(right, previous=right[0])),
        (ew.UnsupportedError, "unsupported", "points[0].previous", "1 rows", ew.HostPoints(right, previous=right[:1])),
        (ew.UnsupportedError, "unsupported", "points[0].radius", "number", ew.HostPoints(right, radius="1")),
        (ew.UnsupportedError, "unsupported", "points[0].count", "rows", ew.HostPoints(right, count=3)),
        (ew.UnsupportedError, "unsupported", "points[0].profile", "inverse", ew.HostPoints(right, profile="gaussian")),
        (ew.UnsupportedError, "unsupported", "points[0].color", "colour", ew.HostPoints(right, color=(1, 2))),
        (ew.UnsupportedError, "unsupported", "points[0].coefficient", "number", ew.HostPoints(right, coefficient="1")),
        (ew.SceneError, "scene", "points[0]", "particle 5 is at", ew.HostPoints(nowhere)),
        (ew.SceneError, "scene", "points[1]", "point 699", [good, ew.HostPoints(right, glaring)]),
        (ew.SceneError, "scene", "points[0]", "point 5 was at", ew.HostPoints(right, previous=nowhere)),
        (ew.SceneError, "scene", "points[0].previous", "\"inverse\"", ew.HostPoints(right, previous=right)),
        (ew.SceneError, "scene", "points[0].radius", "finite", ew.HostPoints(right, radius=np.nan)),
        (ew.SceneError, "scene", "points[0].radius", "radius", ew.HostPoints(right, profile="smeared")),
        (ew.SceneError, "scene", "points[0].coefficient", "finite", ew.HostPoints(right, coefficient=np.nan)),
    ]:
        with pytest.raises(kind) as raised:
            renderer.render(opened, points=points)
        error = raised.value
        assert (error.code, error.place) == (code, place) and words in str(error) and error.remedy, str(error)
    renderer.render(opened, points=good)


@pytest.fixture(scope="module")
def host():
    cl = pytest.importorskip("pyopencl")
    if not cl.get_platforms():
        pytest.skip("pyopencl finds no OpenCL")
    context = cl.Context(cl.get_platforms()[0].get_devices()[:1])
    queue = cl.CommandQueue(context)
    return cl, context, queue, ew.Renderer(queue=queue)


class Target:
    """A buffer that frames with points are drawn into, and read from."""

    def __init__(self, host):
        self.cl, self.context, self.queue, self.renderer = host
        self.buffer = self.cl.Buffer(self.context, self.cl.mem_flags.READ_WRITE, 16 * 64 * 48)

    def store(self, values, flags=0):
        flags |= self.cl.mem_flags.READ_WRITE | self.cl.mem_flags.COPY_HOST_PTR
        return self.cl.Buffer(self.context, flags, hostbuf=np.ascontiguousarray(values))

    def draw(self, scene, **keywords):
        event = self.renderer.enqueue(scene, self.buffer, **keywords)
        light = np.empty((48, 64, 4), np.float32)
        self.cl.enqueue_copy(self.queue, light, self.buffer, wait_for=[event])
        return light


def test_buffers_are_the_points_of_a_table_to_the_bit(host, scene, renderer):
    target, opened = Target(host), ew.open_scene(scene)
    (positions, lights), (moved, _) = rows(7), rows(8)
    buffers = target.store(positions), target.store(lights)
    look = dict(coefficient=2.0**-9, profile="inverse")
    points = ew.HostPoints(*buffers, **look)
    expected = renderer.render(listed(scene, positions, lights, **look))
    assert np.array_equal(target.draw(opened, points=points), expected)
    half = ew.HostPoints(*buffers, count=COUNT // 2, **look)
    assert np.array_equal(
        target.draw(opened, points=half), renderer.render(opened, points=ew.HostPoints(
            positions[: COUNT // 2], lights[: COUNT // 2], **look
        ))
    )  # fmt: skip
    trails = ew.HostPoints(*buffers, previous=target.store(moved), **look)
    found = target.draw(opened, points=trails)
    assert np.array_equal(found, renderer.render(listed(scene, positions, lights, previous=moved, **look)))
    assert not np.array_equal(found, expected)
    ball = dict(look, profile="smeared", radius=0.03125)
    found = target.draw(opened, points=ew.HostPoints(*buffers, **ball))
    assert np.array_equal(found, renderer.render(listed(scene, positions, lights, **ball)))
    # Beside those of an array, and moved by a command that the frame waits for.
    array = ew.HostPoints(moved, **look)
    together = renderer.render(opened, points=[array, ew.HostPoints(positions, lights, **look)])
    assert np.array_equal(target.draw(opened, points=[array, points]), together)
    event = target.cl.enqueue_copy(target.queue, buffers[0], moved, is_blocking=False)
    found = target.draw(opened, points=points, wait_for=[event])
    assert np.array_equal(found, renderer.render(listed(scene, moved, lights, **look)))
    assert not np.array_equal(found, expected)


def test_buffers_that_do_not_fit_are_refused(host, scene, renderer):
    target, (positions, lights) = Target(host), rows(9)
    places, colors = target.store(positions), target.store(lights)
    nowhere = positions.copy()
    nowhere[5, 1] = np.nan
    unread = target.store(positions, target.cl.mem_flags.HOST_NO_ACCESS)
    foreign = target.cl.Buffer(target.cl.Context(target.context.devices), target.cl.mem_flags.READ_WRITE, 16 * COUNT)
    for kind, place, words, points in [
        (ew.HostError, "positions of points", "701 points need 16 each", ew.HostPoints(places, count=COUNT + 1)),
        (ew.HostError, "positions of points", "CL_MEM_HOST_NO_ACCESS", ew.HostPoints(unread)),
        (ew.HostError, "lights of points", "another context", ew.HostPoints(places, foreign)),
        (ew.HostError, "points", "point 5 is at", ew.HostPoints(target.store(nowhere))),
        (ew.HostError, "points", "point 5 was at", ew.HostPoints(places, previous=target.store(nowhere))),
        (ew.HostError, "previous positions of points", "another context", ew.HostPoints(places, previous=foreign)),
        (ew.HostError, "previous positions of points", "need 16 each", ew.HostPoints(
            places, previous=target.store(positions[1:])
        )),
        (ew.ArgumentError, "points[0].previous", "two arrays or", ew.HostPoints(places, previous=positions)),
        (ew.UnsupportedError, "points[0].count", "no number", ew.HostPoints(places, count=-1)),
        (ew.UnsupportedError, "points[0].profile", "inverse", ew.HostPoints(places, profile="z")),
        (ew.ArgumentError, "points[0].lights", "two arrays or two buffers", ew.HostPoints(places, lights)),
        (ew.ArgumentError, "points[0].lights", "two arrays or two buffers", ew.HostPoints(positions, colors)),
    ]:
        with pytest.raises(kind, match=words) as raised:
            target.draw(scene, points=points)
        assert raised.value.place == place
    with pytest.raises(ew.UnsupportedError) as raised:
        renderer.render(scene, points=ew.HostPoints(places))
    assert raised.value.place == "points" and "enqueue" in raised.value.remedy
    target.draw(scene, points=ew.HostPoints(places, colors))
