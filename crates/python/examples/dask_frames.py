"""Draws a sequence on a cluster of dask.distributed, one of whose workers is killed in the middle.

    python dask_frames.py [SCENE]

Every frame is a function of its time alone, so that dask draws those of a lost worker again, and all are there in the
end, equal to the bit. On machines of one's own: `Client("scheduler:8786")` in the place of the local cluster.
"""

import os
import signal
import sys
import time

import energywave as ew
import numpy as np
from dask.distributed import Client, LocalCluster, as_completed

FRAMES, FPS, SIZE = 48, 24, (96, 54)
SCENE = {
    "camera": {"eye": [0, -4, 2], "target": [0, 0, 0]},
    "torus": [{"major_radius": {"times": [0, 2], "values": [0.2, 1.5]}, "coefficient": 0.01}],
}


def draw(scene, frame: int) -> np.ndarray:
    """Draws a frame; the renderer is kept by the worker's thread."""
    time.sleep(0.02)  # or all is drawn before a worker can be killed
    return ew.render(scene, size=SIZE, t=frame / FPS)


def main(scene) -> None:
    # Workers are new processes: a renderer doesn't outlive a fork.
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        victim = next(iter(client.run(os.getpid).values()))
        futures = client.map(draw, [scene] * FRAMES, range(FRAMES), retries=3)
        for done, _ in enumerate(as_completed(futures)):
            if done == FRAMES // 3:
                os.kill(victim, signal.SIGKILL)
                print(f"killed worker {victim} after {done + 1} of {FRAMES} frames")
        frames = client.gather(futures)
        assert victim not in client.run(os.getpid).values(), "the worker was not killed"
    assert len(frames) == FRAMES
    for number, frame in enumerate(frames):
        assert np.array_equal(frame, draw(scene, number)), f"frame {number} differs"
    assert not np.array_equal(frames[0], frames[-1])
    print(f"all {FRAMES} frames are there, equal to the bit")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else SCENE)
