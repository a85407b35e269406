"""Frames into memory that is there, by Python and by Rust in turn: medians, and how much more Python takes.

render_into.py RUST [SCENE] [--size WIDTHxHEIGHT] [--rounds N] [--frames N] [--most PERCENT]

RUST is the example of the crate energywave-python (`crates/python/bench/run` builds it, and runs this). Rounds
alternate which of the two draws first; one waits while the other draws. With --most it fails if Python takes more.
"""

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from pathlib import Path

import energywave as ew
import numpy as np

SCENES = Path(__file__).resolve().parents[3] / "scenes"


class Python:
    def __init__(self, scene, size):
        self.scene, self.size = ew.open_scene(scene), size
        self.renderer = ew.Renderer()
        self.light = np.zeros((size[1], size[0], 4), np.float32)

    def draw(self, frames):
        times = []
        for _ in range(frames):
            begun = time.perf_counter()
            self.renderer.render_into(self.scene, self.light, size=self.size)
            times.append(time.perf_counter() - begun)
        return times


class Rust:
    def __init__(self, program, scene, size):
        command = [program, scene, *map(str, size)]
        self.child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def draw(self, frames):
        print(frames, file=self.child.stdin, flush=True)
        return [float(word) for word in self.child.stdout.readline().split()]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rust")
    parser.add_argument("scene", nargs="?", default=str(SCENES / "figure-07.toml"))
    parser.add_argument("--size", default="3840x2160")
    parser.add_argument("--rounds", type=int, default=20)
    parser.add_argument("--frames", type=int, default=3, help="of each in a round")
    parser.add_argument("--most", type=float, help="percent that Python may take more")
    arguments = parser.parse_args()
    size = tuple(int(word) for word in arguments.size.split("x"))
    both = {"python": Python(arguments.scene, size), "rust": Rust(arguments.rust, arguments.scene, size)}
    for each in both.values():
        each.draw(3)  # kernels are built, the pace is learnt
    rounds = []
    for number in range(arguments.rounds):
        names = list(both)[:: 1 if number % 2 else -1]
        rounds.append({name: both[name].draw(arguments.frames) for name in names})
    result = {"scene": Path(arguments.scene).name, "size": arguments.size, "load": os.getloadavg()[0]}
    result["machine"] = f"{platform.machine()}, {os.cpu_count()} cores"
    for name in both:
        times = [time for round in rounds for time in round[name]]
        result[f"{name}_ms"] = round(1e3 * statistics.median(times), 3)
        result[f"{name}_best_ms"] = round(1e3 * min(times), 3)
    pairs = [statistics.median(each["python"]) / statistics.median(each["rust"]) for each in rounds]
    more = 100 * (statistics.median(pairs) - 1)
    result["python_takes_more_percent"] = round(more, 2)
    quarters = statistics.quantiles(pairs, n=4)
    result["quartiles_percent"] = [round(100 * (it - 1), 2) for it in (quarters[0], quarters[2])]
    print(json.dumps(result, indent=1))
    if arguments.most is not None and more > arguments.most:
        sys.exit(f"Python takes {more:.1f} % more than Rust, which is more than {arguments.most} %")


if __name__ == "__main__":
    main()
