"""The kernel of the paper of 2015 as it stands there, benches/plain.cl, by pyopencl: one ring or curve, Simpson's rule.
The number of divisions is the knob."""

import numpy as np
import pyopencl as cl

from runner import Runner as Base
from scene import HERE

# The structs of the kernel's arguments, as far as it reads them: in the place of energywave's own headers.
STRUCTS = """
typedef struct { float4 first_pixel, column_step, row_step; float ray_length; uint width; uint unused[2]; } View;
typedef struct { uint count; } FilmPart;
typedef struct { uint node_count; } Integrand;
"""


class Runner(Base):
    name = "the paper's kernel"

    def __init__(self):
        self.context = cl.Context([cl.get_platforms()[0].get_devices()[0]])
        self.queue = cl.CommandQueue(self.context)
        text = (HERE.parent.parent / "benches" / "plain.cl").read_text()
        lines = [line for line in text.splitlines() if not line.startswith("#include")]
        program = cl.Program(self.context, STRUCTS + "\n".join(lines)).build(["-DIS_TORUS=1"])
        self.kernel = cl.Kernel(program, "plain")

    def refuses(self, scene):
        rings = scene.kinds.get("torus")
        is_one = list(scene.kinds) == ["torus"] and len(rings.shape) == 1
        is_level = is_one and tuple(rings.shape[0, 3:6]) == (0.0, 0.0, 1.0) and not rings.is_squared[0]
        is_papers = is_level and scene.decay is not None and not scene.measures_length
        return None if is_papers else "it draws one level ring of inverse distances, with a decay"

    def settings(self, scene):
        return [8, 16, 32, 64, 128, 256, 512, 1024]

    def prepare(self, scene, setting):
        starts, _ = scene.rays()
        eye = np.array(scene.camera["eye"], dtype=float)
        grid = (starts - eye).reshape(scene.height, scene.width, 3)
        pad = lambda vector: np.append(vector, 0.0).astype(np.float32).tobytes()  # noqa: E731
        view = pad(grid[0, 0]) + pad(grid[0, 1] - grid[0, 0]) + pad(grid[1, 0] - grid[0, 0])
        view += np.float32(scene.ray_length).tobytes() + np.array([scene.width, 0, 0], np.uint32).tobytes()
        ring = scene.kinds["torus"]
        numbers = [*(ring.shape[0, :3] - eye), ring.shape[0, 6], ring.color[0, 0], *scene.decay]
        flags = cl.mem_flags
        source = cl.Buffer(self.context, flags.READ_ONLY | flags.COPY_HOST_PTR, hostbuf=np.array(numbers, np.float32))
        pixels = scene.width * scene.height
        light = np.empty((scene.height, scene.width, 4), np.float32)
        image = cl.Buffer(self.context, flags.WRITE_ONLY, light.nbytes)
        arguments = (view, np.uint32(pixels), np.uint32(setting + 1), source, image)

        def draw():
            self.kernel(self.queue, (-(-pixels // 64) * 64,), (64,), *arguments)
            cl.enqueue_copy(self.queue, light, image)
            return light[..., :3]

        return draw
