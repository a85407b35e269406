"""Drawing: renderers, and functions that keep one for each thread."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Optional, Tuple, Union

import numpy as np

from . import _energywave
from ._animation import Animation
from ._devices import Device
from ._errors import mistype, misuse
from ._given import numbers
from ._host import HostDepth, HostPoints, is_image
from ._scene import open_scene

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import ArrayLike, NDArray
    from typing_extensions import Unpack

    from ._overrides import Overrides

    Progress = Callable[[float], object]
    Given = Union[HostPoints, Iterable[HostPoints]]


class Renderer:
    """Draws scenes on a device; kernels and buffers are kept from frame to frame.

    Kernels are built, for seconds, when a scene first needs them; later frames allocate nothing on the device and
    upload what changed. Python's lock is released while a frame is drawn, and Ctrl-C stops it; a renderer is as good as
    new after that, and after every exception. Threads may share one, and wait for each other; with one each they draw
    at the same time. It doesn't outlive a ``fork``: start processes by ``spawn``.

    All methods take a scene as a path, a dictionary, a :class:`Scene`, or what :func:`open_scene` made of one, and
    these keywords, which replace values of the scene:

    ====================  ===========================================================================
    ``size``              width and height in pixels; also ``width``, ``height``
    ``method``            ``"exact"``, ``"simpson"``, ``"jittered"``
    ``divisions``         of Simpson's rule; asks for it
    ``tolerance``         relative error of the exact method; asks for it
    ``sampling``          ``"tiles"`` or ``"pixels"``, of the exact method; asks for it
    ``antialias``         ``"footprint"`` or ``"none"``
    ``exposure``          stops, or ``"auto"``: of the picture, not of the light
    ``t``                 time in a scene that moves, seconds
    ====================  ===========================================================================

    ``progress`` is called with the finished share, 0 to 1, several times a second; an exception in it stops the work.

    Args:
        device: a number of :func:`devices`, a part of a name, ``"gpu"``, ``"cpu"``, ``"all"``; None: what the
            environment variable ``ENERGYWAVE_DEVICE`` says, else the best, else the built-in reference, with a warning.
        reference: draw by the built-in reference: in float64, by another method, hundreds of times slower.
        queue: a ``pyopencl.CommandQueue`` whose context and device are to be used, in the place of ``device``.

    Raises:
        NoSuchDeviceError: if no device answers to the choice, or more than one.
        DeviceError: if the driver refuses.
        HostError: if the queue's device cannot draw.
    """

    def __init__(
        self,
        device: "Union[str, int, Device, None]" = None,
        *,
        reference: bool = False,
        queue: Any = None,
    ) -> None:
        _check_choice(device, reference, queue)
        if queue is not None:
            self._native = _energywave.Renderer.on_queue(queue)
            return
        choice = "reference" if reference else device
        if isinstance(choice, Device):
            choice = choice.index
        self._native = _energywave.Renderer(None if choice is None else str(choice))

    @property
    def devices(self) -> List[Device]:
        """What draws; nothing is known of a host's queue."""
        return [Device(**record) for record in self._native.device_records]

    @property
    def last_cost(self) -> Dict[str, float]:
        """What the last frame cost: ``kernel_seconds``, ``integrals``, ``samples``, ``launches``."""
        return self._native.last_cost

    def __repr__(self) -> str:
        names = " + ".join(device.name for device in self.devices) or "a queue of pyopencl's"
        return f"<energywave renderer on {names}>"

    def render(
        self,
        scene: Any,
        *,
        points: "Given" = (),
        progress: "Optional[Progress]" = None,
        **overrides: "Unpack[Overrides]",
    ) -> "NDArray[np.float32]":
        """Returns the light of a scene: (height, width, 4) of float32, linear RGBA from the top left, alpha 1.

        Light has no unit and no exposure; :func:`tone_map` and :func:`save` make pictures of it.

        Args:
            points: points of light besides the scene's: :class:`HostPoints` of arrays, or several.

        Raises:
            SceneError: for a scene that cannot be drawn.
            UnsupportedError: for arrays that are no points; an ArgumentError for what is no array of numbers.
            DeviceError, OutOfMemoryError: if the device fails.
            KeyboardInterrupt: after Ctrl-C.
        """
        return self._native.render(open_scene(scene), overrides, progress, HostPoints.listed(points))

    def render_into(
        self,
        scene: Any,
        array: "NDArray[np.float32]",
        *,
        points: "Given" = (),
        progress: "Optional[Progress]" = None,
        **overrides: "Unpack[Overrides]",
    ) -> None:
        """Draws into an array that is there: float32, (height, width, 4), in C's order. Points are as of `render`.

        Raises:
            UnsupportedError: for an array of another shape or order. Otherwise as :meth:`render`; what the array holds
                is undefined then.
        """
        if not isinstance(array, np.ndarray) or array.dtype != np.float32 or array.ndim != 3:
            found = f"{array.dtype} of {array.ndim} axes" if isinstance(array, np.ndarray) else type(array).__name__
            remedy = "give numpy.empty((height, width, 4), numpy.float32)"
            raise misuse("array", f"it is {found}", remedy)
        if not array.flags.writeable:
            raise misuse("array", "it is read-only", "give one that may be written")
        self._native.render_into(open_scene(scene), array, overrides, progress, HostPoints.listed(points))

    def integrate(
        self,
        scene: Any,
        origins: "ArrayLike",
        ends: "ArrayLike",
        *,
        progress: "Optional[Progress]" = None,
        **overrides: "Unpack[Overrides]",
    ) -> "NDArray[np.float64]":
        """Integrates along any rays; the scene's camera plays no part, and may be absent. Surfaces hide nothing.

        Args:
            origins: where rays begin, (n, 3), world units; of any shape (..., 3), or one point for all rays.
            ends: where they end, likewise.

        Returns:
            Linear RGB, (n, 3) of float64, over the length or the parameter of each ray as the scene's ``measure`` says;
            of devices correct to float32, of the reference to 1e-10.

        Raises:
            SceneError: also for a ray that is shorter than 1e-9, beyond 1e9, or no number; its place is ``ray 7``.
            UnsupportedError: for arrays that are no points; an ArgumentError for what is no array of numbers.
        """
        begins, ends = _pairs(("origins", "ends"), origins, ends)
        shape = begins.shape
        light = self._native.integrate(
            open_scene(scene, False), begins.reshape(-1, 3), ends.reshape(-1, 3), overrides, progress
        )
        return light.reshape(shape)

    def irradiance(
        self, scene: Any, points: "ArrayLike", normals: "ArrayLike", **overrides: "Unpack[Overrides]"
    ) -> "NDArray[np.float32]":
        """Returns what the cores of a scene's waves cast on points of surfaces.

        Args:
            points: (n, 3), world units; of any shape (..., 3).
            normals: of any length but zero, likewise, or one for all points.

        Returns:
            Irradiance, linear RGB, (n, 3) of float32. A matt surface of the albedo a has the radiance a / pi times
            that.
        """
        points, normals = _pairs(("points", "normals"), points, normals)
        shape = points.shape
        found = self._native.irradiance(
            open_scene(scene, False), points.reshape(-1, 3), normals.reshape(-1, 3), overrides
        )
        return found.reshape(shape)

    def error_map(
        self, scene: Any, *, progress: "Optional[Progress]" = None, **overrides: "Unpack[Overrides]"
    ) -> "NDArray[np.float32]":
        """Returns the relative error of each channel of each pixel against the float64 reference, (height, width, 3).

        The reference draws the exact integral along the rays through the pixels' centres (``antialias="none"``, unless
        another is asked for); it takes hundreds of times longer, so a small ``size`` is in order. Two zeros agree; what
        is no number is infinitely wrong.
        """
        opened = open_scene(scene)
        overrides.setdefault("antialias", "none")
        image = self.render(opened, **overrides)[..., :3].astype(np.float64)
        exact = overrides.copy()
        exact.pop("divisions", None)
        exact.pop("sampling", None)
        exact["method"] = "exact"
        truth = _kept(None, True).render(opened, progress=progress, **exact)[..., :3].astype(np.float64)
        with np.errstate(divide="ignore", invalid="ignore"):
            errors = np.abs(image - truth) / np.abs(truth)
        errors[image == truth] = 0.0
        errors[np.isnan(errors)] = np.inf
        return errors.astype(np.float32)

    def animate(
        self,
        scene: Any,
        *,
        fps: "Union[float, Fraction]" = 30,
        frames: "Union[int, Iterable[int], None]" = None,
        progress: "Optional[Progress]" = None,
        **overrides: "Unpack[Overrides]",
    ) -> "Animation":
        """Returns an iterator of frames, each as :meth:`render` gives it; frame n is at n / fps seconds.

        Args:
            fps: frames a second; 23.976 and the like are best given as a Fraction.
            frames: how many, or their numbers, whole ones from 0 to 99999999; None: as long as the scene moves,
                without the frame that is the first again where it loops.

        Raises:
            UnsupportedError: if ``frames`` is None and the scene doesn't say how long it moves; for other numbers, and
                for ``t``: frames have times of their own.
        """
        return Animation(self, open_scene(scene), fps, frames, progress, overrides)

    def enqueue(
        self,
        scene: Any,
        target: Any,
        *,
        depth: Any = None,
        points: "Given" = (),
        wait_for: Iterable[Any] = (),
        **overrides: "Unpack[Overrides]",
    ) -> Any:
        """Enqueues a frame that is drawn into memory of pyopencl's, on a renderer that was made with a ``queue``.

        Nothing is read back, and nothing waits but for the compiler, the first time, where surfaces of a scene meet
        depths, and for points in buffers. What comes after it on an in-order queue waits for the frame.

        Args:
            target: a ``pyopencl.Buffer`` of 16 * width * height bytes (float32 RGBA), or a 2D ``pyopencl.Image`` of
                RGBA with float32 or half floats; READ_WRITE.
            depth: depths that end the rays, in the place of the scene's own: a :class:`HostDepth`, or a buffer or an
                image of lengths along the rays.
            points: points of light besides the scene's: :class:`HostPoints`, or several. Of buffers they are read after
                what the frame waits for; when the call comes back they may be written again.
            wait_for: events that the frame waits for.

        Returns:
            The ``pyopencl.Event`` of its end. Until then nothing else may use the target, and nothing write the depths.

        Raises:
            HostError: for a target, depths, points or an event that don't fit; nothing was enqueued.
        """
        import pyopencl

        depths = None if depth is None else HostDepth.of(depth)
        into, besides = (target, is_image(target)), (depths, HostPoints.listed(points))
        event = self._native.enqueue(open_scene(scene), into, besides, list(wait_for), overrides)
        return pyopencl.Event.from_int_ptr(event, retain=False)


def _check_choice(device: Any, reference: bool, queue: Any = None) -> None:
    """Checks that one thing at most says what draws."""
    if device is not None and (isinstance(device, bool) or not isinstance(device, (str, int, np.integer, Device))):
        remedy = "give a number of devices(), a part of a name, \"gpu\", \"cpu\" or \"all\""
        raise mistype("device", f"it is of type {type(device).__name__}", remedy)
    given = [("device", device is not None), ("reference", reference), ("queue", queue is not None)]
    names = [f"{name}=" for name, is_given in given if is_given]
    if len(names) > 1:
        raise misuse(names[0][:-1], f"{' and '.join(names)} all say what draws", "give one of them")


def _points(name: str, array: "ArrayLike") -> "NDArray[np.float64]":
    remedy = f"{name} are numbers, (n, 3), or one point of 3"
    points = numbers(name, array, np.float64, remedy)
    if points.ndim == 0 or points.shape[-1] != 3:
        raise misuse(name, f"an array of shape {list(points.shape)}", remedy)
    return points


def _pairs(names: Tuple[str, str], *arrays: "ArrayLike") -> "List[NDArray[np.float64]]":
    """Returns two arrays of points, as many in both."""
    points = [_points(name, array) for name, array in zip(names, arrays)]
    try:
        return list(np.broadcast_arrays(*points))
    except ValueError:
        shapes = " and ".join(f"{name} of {list(it.shape)}" for name, it in zip(names, points))
        raise misuse(names[1], shapes, "give as many of both, or one of either") from None


_local = threading.local()


def _kept(device: Any, reference: bool) -> Renderer:
    """Returns this thread's renderer on a device."""
    _check_choice(device, reference)
    renderers: Dict[Any, Renderer] = _local.__dict__.setdefault("renderers", {})
    key = "reference" if reference else device
    if key not in renderers:
        renderers[key] = Renderer(device, reference=reference)
    return renderers[key]


def render(
    scene: Any,
    *,
    points: "Given" = (),
    device: Any = None,
    reference: bool = False,
    **overrides: "Unpack[Overrides]",
) -> "NDArray[np.float32]":
    """Returns the light of a scene: (height, width, 4) of float32, linear RGBA from the top left.

    As :meth:`Renderer.render`, by a renderer that is kept for this thread. ``reference=True`` computes in float64, by
    another method, and rounds the light to float32 (:func:`rays` says how to get all of its digits).
    """
    return _kept(device, reference).render(scene, points=points, **overrides)


def integrate(
    scene: Any,
    origins: "ArrayLike",
    ends: "ArrayLike",
    *,
    device: Any = None,
    reference: bool = False,
    **overrides: "Unpack[Overrides]",
) -> "NDArray[np.float64]":
    """Integrates along any rays, as :meth:`Renderer.integrate`: linear RGB, (n, 3) of float64.

    ``reference=True`` computes in float64 throughout, to about 1e-10.
    """
    return _kept(device, reference).integrate(scene, origins, ends, **overrides)


def rays(scene: Any, **overrides: "Unpack[Overrides]") -> "Tuple[NDArray[np.float64], NDArray[np.float64]]":
    """Returns where the rays through the centres of a scene's pixels begin, and where they end, world units.

    Each is (height, width, 3). ``integrate(scene, *rays(scene), reference=True)`` is the image in float64.
    """
    return open_scene(scene).rays(overrides)


def irradiance(
    scene: Any,
    points: "ArrayLike",
    normals: "ArrayLike",
    *,
    device: Any = None,
    reference: bool = False,
    **overrides: "Unpack[Overrides]",
) -> "NDArray[np.float32]":
    """Returns what the waves cast on points of surfaces, as :meth:`Renderer.irradiance`: linear RGB, (n, 3)."""
    return _kept(device, reference).irradiance(scene, points, normals, **overrides)


def error_map(scene: Any, *, device: Any = None, **overrides: "Unpack[Overrides]") -> "NDArray[np.float32]":
    """Returns relative errors against the float64 reference, as :meth:`Renderer.error_map`: (height, width, 3)."""
    return _kept(device, False).error_map(scene, **overrides)


def animate(scene: Any, *, device: Any = None, reference: bool = False, **keywords: Any) -> Animation:
    """Returns an iterator of frames, as :meth:`Renderer.animate`."""
    return _kept(device, reference).animate(scene, **keywords)
