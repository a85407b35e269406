"""Are the objects of pyopencl taken as they are?"""

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
