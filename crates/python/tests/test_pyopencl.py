"""Are the objects of pyopencl taken as they are?"""

import dataclasses

import energywave as ew
import numpy as np
import pytest

#: Digits of half floats.
HALF = 1e-3

cl = pytest.importorskip("pyopencl")
if not cl.get_platforms():
    pytest.skip("pyopencl finds no OpenCL", allow_module_level=True)


@pytest.fixture(scope="module")
def host():
    context = cl.Context(cl.get_platforms()[0].get_devices()[:1])
    queue = cl.CommandQueue(context)
    return context, queue, ew.Renderer(queue=queue)


def test_a_buffer_gets_the_light_and_an_event_its_end(host, scene, renderer):
    context, queue, on_queue = host
    buffer = cl.Buffer(context, cl.mem_flags.READ_WRITE, 16 * 64 * 48)
    event = on_queue.enqueue(scene, buffer)
    assert isinstance(event, cl.Event)
    light = np.empty((48, 64, 4), np.float32)
    cl.enqueue_copy(queue, light, buffer, wait_for=[event])
    assert np.array_equal(light, renderer.render(scene))
    again = on_queue.enqueue(scene, buffer, wait_for=[event], tolerance=1e-2)
    again.wait()
    assert again.command_execution_status == cl.command_execution_status.COMPLETE


def test_an_image_gets_the_light(host, scene, renderer):
    context, queue, on_queue = host
    expected = renderer.render(scene)
    for kind, dtype, limit in [
        (cl.channel_type.FLOAT, np.float32, 0.0),
        (cl.channel_type.HALF_FLOAT, np.float16, HALF),
    ]:
        form = cl.ImageFormat(cl.channel_order.RGBA, kind)
        image = cl.create_image(context, cl.mem_flags.READ_WRITE, form, shape=(64, 48))
        on_queue.enqueue(scene, image)
        light = np.empty((48, 64, 4), dtype)
        cl.enqueue_copy(queue, light, image, origin=(0, 0), region=(64, 48))
        assert np.max(np.abs(light - expected) / expected) <= limit


#: Depths of 48 rows of 64: a slanted surface through the ring, nothing on the right, all hidden at the bottom.
LENGTHS = np.linspace(3.4, 5.4, 64, dtype=np.float32) + np.linspace(0, 0.5, 48, dtype=np.float32)[:, None]
LENGTHS[:, 56:] = np.inf
LENGTHS[44:] = 0


def behind(scene, lengths, folder, along="ray"):
    """The scene behind depths of its own."""
    lengths.astype("<f4").tofile(folder / "depth.f32")
    return ew.Scene(scene.camera, scene.image, *scene.torus, ew.Depth(file=folder / "depth.f32", along=along))


class Target:
    """A buffer that frames are drawn into and read from."""

    def __init__(self, host):
        self.context, self.queue, self.renderer = host
        self.buffer = cl.Buffer(self.context, cl.mem_flags.READ_WRITE, 16 * 64 * 48)

    def draw(self, scene, **keywords):
        event = self.renderer.enqueue(scene, self.buffer, **keywords)
        light = np.empty((48, 64, 4), np.float32)
        cl.enqueue_copy(self.queue, light, self.buffer, wait_for=[event])
        return light

    def store(self, values):
        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        return cl.Buffer(self.context, flags, hostbuf=np.ascontiguousarray(values))

    def picture(self, values, order, kind):
        form = cl.ImageFormat(order, kind)
        flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
        return cl.create_image(self.context, flags, form, shape=(64, 48), hostbuf=np.ascontiguousarray(values))


def test_depths_of_a_buffer_end_the_rays(host, scene, renderer, tmp_path):
    target = Target(host)
    expected = renderer.render(behind(scene, LENGTHS, tmp_path))
    assert (expected[44:, :, :3] == 0).all()
    np.testing.assert_allclose(expected[:44, 60], renderer.render(scene)[:44, 60], rtol=1e-3)
    assert np.array_equal(target.draw(scene, depth=target.store(LENGTHS)), expected)
    padded = np.full((50, 67), 3.0, np.float32)
    padded[1:49, 2:66] = 0.5 * LENGTHS[::-1]
    depth = ew.HostDepth(target.store(padded), scale=2, is_bottom_up=True, offset=4 * (67 + 2), row_pitch=4 * 67)
    assert np.array_equal(target.draw(scene, depth=depth), expected)
    for change in [dict(scale=1.0), dict(is_bottom_up=False), dict(offset=4 * 67), dict(along="axis")]:
        spoiled = target.draw(scene, depth=dataclasses.replace(depth, **change))
        assert not np.array_equal(spoiled, expected), change
    assert np.array_equal(target.draw(scene), renderer.render(scene))  # depths are those of one frame


def test_depths_of_an_image_end_the_rays(host, scene, renderer, tmp_path):
    target = Target(host)
    four = np.zeros((48, 64, 4), np.float32)
    four[..., 0], four[..., 1:] = LENGTHS, 3.0
    halves = LENGTHS.astype(np.float16)
    order, kind = cl.channel_order, cl.channel_type
    for lengths, image in [
        (LENGTHS, target.picture(LENGTHS, order.R, kind.FLOAT)),
        (LENGTHS, target.picture(four, order.RGBA, kind.FLOAT)),
        (halves, target.picture(halves, order.R, kind.HALF_FLOAT)),
    ]:
        for along in ["ray", "axis"]:
            expected = renderer.render(behind(scene, lengths, tmp_path, along))
            assert np.array_equal(target.draw(scene, depth=ew.HostDepth(image, along=along)), expected)
        ray = target.draw(scene, depth=image)
        assert not np.array_equal(ray, expected)
        assert not np.array_equal(ray, target.draw(scene, depth=ew.HostDepth(image, is_bottom_up=True)))


def test_depths_of_clip_space_are_behind_the_projection_of_the_camera(host, scene, renderer, tmp_path):
    target = Target(host)
    view = [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, -4], [0, 0, 0, 1]]
    projection = [[1.8, 0, 0, 0], [0, 2.4, 0, 0], [0, 0, 0, 0.1], [0, 0, -1, 0]]  # reversed z
    matrices = ew.Scene(ew.Camera(view=view, projection=projection), scene.image, *scene.torus)
    with np.errstate(divide="ignore"):
        clip = np.where(LENGTHS == 0, 1, np.float32(0.1) / LENGTHS)
        lengths = np.float32(0.1) / clip
    expected = renderer.render(behind(matrices, lengths, tmp_path, "axis"))
    found = target.draw(matrices, depth=ew.HostDepth(target.store(clip), along="buffer"))
    np.testing.assert_allclose(found, expected, rtol=1e-4)
    spoiled = target.draw(matrices, depth=ew.HostDepth(target.store(clip), along="buffer", scale=1.05))
    assert not np.allclose(spoiled, expected, rtol=1e-4)
    with pytest.raises(ew.HostError, match="view and projection") as raised:
        target.draw(scene, depth=ew.HostDepth(target.store(clip), along="buffer"))
    assert raised.value.place == "depth"


def test_depths_that_are_written_later_are_waited_for(host, scene, renderer, tmp_path):
    target = Target(host)
    expected = renderer.render(behind(scene, LENGTHS, tmp_path))
    depths = target.store(np.full_like(LENGTHS, 3.0))
    early = target.draw(scene, depth=depths)
    gate, other = cl.UserEvent(target.context), cl.CommandQueue(target.context)
    written = cl.enqueue_copy(other, depths, LENGTHS, is_blocking=False, wait_for=[gate])
    event = target.renderer.enqueue(scene, target.buffer, depth=depths, wait_for=[written])
    assert event.command_execution_status != cl.command_execution_status.COMPLETE
    gate.set_status(cl.command_execution_status.COMPLETE)
    light = np.empty_like(expected)
    cl.enqueue_copy(target.queue, light, target.buffer, wait_for=[event])
    assert np.array_equal(light, expected) and not np.array_equal(early, expected)


def test_depths_that_do_not_fit_are_refused(host, scene, tmp_path):
    target = Target(host)
    fits = target.store(LENGTHS)
    for place, reason, depth in [
        ("depth buffer", "need 12288", target.store(LENGTHS[1:])),
        ("depth buffer", "drawn into the same", target.buffer),
        ("depth buffer", "multiple", ew.HostDepth(fits, offset=2)),
        ("depth image", "CL_SIGNED_INT32", target.picture(LENGTHS, cl.channel_order.R, cl.channel_type.SIGNED_INT32)),
        ("depth", "scale", ew.HostDepth(fits, scale=0)),
        ("depth", "of its own", None),
    ]:
        drawn = scene if depth is not None else behind(scene, LENGTHS, tmp_path)
        with pytest.raises(ew.HostError, match=reason) as raised:
            target.draw(drawn, depth=fits if depth is None else depth)
        assert raised.value.place == place
    for place, depth in [
        ("depth.memory", LENGTHS),
        ("depth.along", ew.HostDepth(fits, along="z")),
        ("depth.offset", ew.HostDepth(fits, offset=-4)),
    ]:
        with pytest.raises(ew.UnsupportedError) as raised:
            target.draw(scene, depth=depth)
        assert raised.value.place == place
    target.draw(scene, depth=fits)


def test_what_does_not_fit_is_refused(host, scene, renderer):
    context, _, on_queue = host
    small = cl.Buffer(context, cl.mem_flags.READ_WRITE, 16 * 64 * 47)
    other = cl.Context(context.devices)
    foreign = cl.Buffer(other, cl.mem_flags.READ_WRITE, 16 * 64 * 48)
    read_only = cl.Buffer(context, cl.mem_flags.READ_ONLY, 16 * 64 * 48)
    for target in [small, foreign, read_only]:
        with pytest.raises(ew.HostError) as raised:
            on_queue.enqueue(scene, target)
        assert raised.value.code == "host" and raised.value.place == "buffer"
    with pytest.raises(ew.UnsupportedError):
        on_queue.enqueue(scene, np.zeros(3))
    right = cl.Buffer(context, cl.mem_flags.READ_WRITE, 16 * 64 * 48)
    with pytest.raises(ew.HostError):
        renderer.enqueue(scene, right)  # made without a queue
    on_queue.enqueue(scene, right).wait()
