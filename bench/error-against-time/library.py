"""energywave's library for C, as far as the benchmark needs it. ENERGYWAVE_LIBRARY names it, or the loader finds it."""

import ctypes
import os
from ctypes import POINTER, byref, c_char_p, c_double, c_float, c_int32, c_size_t, c_uint32, c_void_p

import numpy as np


class Overrides(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_size_t),
        ("width", c_uint32),
        ("height", c_uint32),
        ("method", c_char_p),
        ("sampling", c_char_p),
        ("antialias", c_char_p),
        ("tolerance", c_double),
        ("divisions", c_uint32),
        ("reserved", c_uint32),
    ]


class Error(ctypes.Structure):
    _fields_ = [("struct_size", c_size_t), ("status", c_int32), ("line", c_uint32), ("column", c_uint32)] + [
        ("reserved", c_uint32),
        *((name, c_char_p) for name in ("code", "message", "path", "key", "remedy")),
    ]


class Library:
    def __init__(self) -> None:
        name = os.environ.get("ENERGYWAVE_LIBRARY", "libenergywave_c.so.1")
        try:
            self.c = ctypes.CDLL(name)
        except OSError as error:
            raise ImportError(f"{error}; crates/capi/install makes it, ENERGYWAVE_LIBRARY names it") from error
        handle = [c_void_p, c_void_p]
        self.c.energywave_scene_free.argtypes = [c_void_p]
        self.c.energywave_renderer_free.argtypes = [c_void_p]
        self.c.energywave_render.argtypes = [*handle, POINTER(c_float), c_size_t, c_size_t]
        self.c.energywave_integrate.argtypes = [*handle, *2 * [POINTER(c_double)], c_size_t, POINTER(c_double)]
        self.check(self.c.energywave_suit_drivers())

    def check(self, status: int) -> None:
        if status != 0:
            error = Error(struct_size=ctypes.sizeof(Error))
            self.c.energywave_last_error(byref(error))
            raise RuntimeError(error.message.decode())

    def scene(self, path, **values) -> c_void_p:
        scene = c_void_p()
        self.check(self.c.energywave_scene_from_file(os.fsencode(path), byref(scene)))
        words = {key: value.encode() if isinstance(value, str) else value for key, value in values.items()}
        overrides = Overrides(struct_size=ctypes.sizeof(Overrides), **words)
        self.check(self.c.energywave_scene_override(scene, byref(overrides)))
        return scene

    def renderer(self, device: str | None) -> c_void_p:
        renderer = c_void_p()
        choice = None if device is None else device.encode()
        self.check(self.c.energywave_renderer_new(choice, None, byref(renderer)))
        return renderer

    def render(self, renderer: c_void_p, scene: c_void_p, light: np.ndarray) -> None:
        """Renders into float32 RGBA."""
        pointer = light.ctypes.data_as(POINTER(c_float))
        self.check(self.c.energywave_render(renderer, scene, pointer, light.nbytes, 0))

    def integrate(self, device: str, path, starts: np.ndarray, ends: np.ndarray) -> np.ndarray:
        scene, renderer = self.scene(path), self.renderer(device)
        light = np.empty_like(starts)
        arrays = [np.ascontiguousarray(it, dtype=float) for it in (starts, ends)]
        pointers = [it.ctypes.data_as(POINTER(c_double)) for it in (*arrays, light)]
        self.check(self.c.energywave_integrate(renderer, scene, *pointers[:2], len(starts), pointers[2]))
        self.c.energywave_renderer_free(renderer)
        self.c.energywave_scene_free(scene)
        return light
