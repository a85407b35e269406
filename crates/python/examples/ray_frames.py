"""Draws a sequence on a cluster of Ray, one of whose workers is killed in the middle.

    python ray_frames.py [SCENE]

Every frame is a function of its time alone, so that Ray draws those of a lost worker again, and all are there in the
end, equal to the bit. On machines of one's own: `ray.init("auto")` in the place of the local cluster.
"""

import os
import signal
import sys
import time

import energywave as ew
import numpy as np
import ray

FRAMES, FPS, SIZE = 48, 24, (96, 54)
SCENE = {
    "camera": {"eye": [0, -4, 2], "target": [0, 0, 0]},
    "torus": [{"major_radius": {"times": [0, 2], "values": [0.2, 1.5]}, "coefficient": 0.01}],
}


def draw(scene, frame: int) -> np.ndarray:
    """Draws a frame; the renderer is kept by the worker's thread."""
    return ew.render(scene, size=SIZE, t=frame / FPS)


@ray.remote(max_retries=3)
def draw_far(scene, frame: int):
    time.sleep(0.05)  # or all is drawn before a worker can be killed
    return os.getpid(), draw(scene, frame)


def main(scene) -> None:
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False, logging_level="error")
    tasks = [draw_far.remote(scene, frame) for frame in range(FRAMES)]
    done, others = ray.wait(tasks, num_returns=FRAMES // 3)
    victim = ray.get(done[-1])[0]
    os.kill(victim, signal.SIGKILL)
    print(f"killed worker {victim} after {len(done)} of {FRAMES} frames")
    results = ray.get(tasks)
    last = {pid for pid, _ in results[-2:]}
    ray.shutdown()
    assert others and victim not in last, "the worker was not killed"
    frames = [frame for _, frame in results]
    assert len(frames) == FRAMES
    for number, frame in enumerate(frames):
        assert np.array_equal(frame, draw(scene, number)), f"frame {number} differs"
    assert not np.array_equal(frames[0], frames[-1])
    print(f"all {FRAMES} frames are there, equal to the bit")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else SCENE)
