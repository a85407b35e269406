"""Draws every scene by every runner at every setting, and says how wrong the light is and how long a frame takes.

run.py [--out results.json] [--plot FOLDER] [--record FOLDER] [--runners NAME,..] [--scenes NAME,..] [--seconds 1.0]
       [--add results.json ..]
"""

import argparse
import importlib
import json
import os
import platform
import time
from pathlib import Path

import numpy as np

from scene import HERE, Scene, names


def load(wanted: list[str] | None) -> list:
    """Makes the runners of runners/, and says which are missing."""
    runners = []
    for path in sorted((HERE / "runners").glob("[!_]*.py")):
        if wanted is not None and path.stem not in wanted:
            continue
        try:
            runners.append(importlib.import_module(f"runners.{path.stem}").Runner())
        except Exception as error:  # a driver or a package that is not there is no fault of the others
            print(f"{path.stem}: left out: {type(error).__name__}: {str(error).splitlines()[0]}")
    return runners


def errors(scene: Scene, frame: np.ndarray) -> dict[str, float]:
    """Returns how far the pixels are from the truth, relative to the pixel, the worst of their channels."""
    pixels, truth = scene.truth()
    found = frame.reshape(-1, 3)[pixels].astype(float)
    relative = (np.abs(found - truth) / np.abs(truth)).max(axis=1)
    relative = np.where(np.isfinite(relative), relative, np.inf)
    parts = {"median": 50, "p99": 99, "p999": 99.9, "worst": 100}
    return {name: float(np.percentile(relative, part)) for name, part in parts.items()}


def measure(draw, seconds: float) -> tuple[np.ndarray, dict[str, float]]:
    """Draws frames for so long, three at the least - or one, where it takes seconds - after one that is not counted."""
    frame, times = np.array(draw()), []
    begun = time.perf_counter()
    spent = lambda: time.perf_counter() - begun  # noqa: E731
    while not times or (len(times) < 3 and spent() < 3 * seconds) or (len(times) < 200 and spent() < seconds):
        begin = time.perf_counter()
        draw()
        times.append(time.perf_counter() - begin)
    return frame, {"best_s": min(times), "median_s": float(np.median(times)), "frames": len(times)}


def table(rows: list[dict]) -> str:
    head = ["scene", "runner", "setting", "best ms", "median ms", "median error", "99 %", "worst"]
    lines = ["| " + " | ".join(head) + " |", "|---|---|---|" + "---:|" * 5]
    for row in rows:
        numbers = [f"{1e3 * row['best_s']:.3g}", f"{1e3 * row['median_s']:.3g}"]
        numbers += [f"{row[name]:.1e}" for name in ("median", "p99", "worst")]
        lines.append("| " + " | ".join([row["scene"], row["runner"], str(row["setting"]), *numbers]) + " |")
    return "\n".join(lines)


def joined(result: dict, others: list[dict]) -> dict:
    """Adds what other runs found, of what several have the quickest; the machine says which are from where."""
    best = {(row["scene"], row["runner"], str(row["setting"])): row for row in result["rows"]}
    added = {}
    for other in others:
        for row in other["rows"]:
            key = row["scene"], row["runner"], str(row["setting"])
            if key not in best or row["best_s"] < best[key]["best_s"]:
                best[key] = row
                added.setdefault(row["runner"], set()).add(round(other["machine"]["load_before"], 1))
    machine = result["machine"] | {"added": {name: sorted(loads) for name, loads in added.items()}}
    scenes = list(dict.fromkeys(key[0] for key in best))
    return {"machine": machine, "rows": sorted(best.values(), key=lambda row: scenes.index(row["scene"]))}


def record(result: dict, folder: Path) -> None:
    """Writes what a run gave into a folder: results.json, plot.svg, and a README.md with the table."""
    from plot import draw_overview

    folder.mkdir(parents=True, exist_ok=True)
    machine, rows = result["machine"], result["rows"]
    lines = ",\n".join(json.dumps(row) for row in rows)
    (folder / "results.json").write_text(f'{{"machine": {json.dumps(machine)},\n"rows": [\n{lines}\n]}}\n')
    draw_overview(rows, folder / "plot.svg")
    load = machine["load_before"]
    busy = "**Loaded:** other work ran, and times are too long. " if load > 0.5 else ""
    for name, loads in machine.get("added", {}).items():
        loads = ", ".join(str(load) for load in loads)
        busy += f"Rows of {name} are the best of runs that were added, at a load of {loads}. "
    (folder / "README.md").write_text(
        f"# Error against time, {machine['date']}\n\n"
        f"{busy}Load before the run {load:.1f}, {machine['cpus']} cores, {machine['system']}; "
        f"every setting for {machine['seconds']} s. [What is measured](../../README.md#what-is-measured).\n\n"
        f"![](plot.svg)\n\n{table(rows)}\n"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("results.json"))
    parser.add_argument("--plot", type=Path, help="folder for an SVG of each scene")
    parser.add_argument("--record", type=Path, help="folder for results.json, a table and one SVG of all scenes")
    parser.add_argument("--runners", help="names of files in runners/, with commas between")
    parser.add_argument("--scenes", help="names of files in scenes/, with commas between")
    parser.add_argument("--seconds", type=float, default=1.0, help="how long each setting is drawn")
    parser.add_argument("--add", type=Path, nargs="+", default=[], help="results of other runs on this machine")
    arguments = parser.parse_args()
    machine = {"cpus": os.cpu_count(), "load_before": os.getloadavg()[0], "system": f"{platform.system()} {platform.machine()}"}
    machine |= {"date": time.strftime("%Y-%m-%d"), "seconds": arguments.seconds}
    runners = load(None if arguments.runners is None else arguments.runners.split(","))
    rows = []
    for name in arguments.scenes.split(",") if arguments.scenes else names():
        scene = Scene.open(name)
        for runner in runners:
            if reason := runner.refuses(scene):
                print(f"{name}: {runner.name}: {reason}")
                continue
            for setting in runner.settings(scene):
                frame, times = measure(runner.prepare(scene, setting), arguments.seconds)
                row = {"scene": name, "runner": runner.name, "setting": setting, **times, **errors(scene, frame)}
                rows.append(row)
                print(f"{name}: {runner.name} {setting}: {1e3 * times['best_s']:.3g} ms, {row['p99']:.1e}", flush=True)
    result = {"machine": machine, "rows": rows}
    if arguments.add:
        result = joined(result, [json.loads(file.read_text()) for file in arguments.add])
        rows = result["rows"]
    arguments.out.write_text(json.dumps(result, indent=1) + "\n")
    print(table(rows))
    if arguments.plot:
        from plot import draw_all

        draw_all(rows, arguments.plot)
    if arguments.record:
        record(result, arguments.record)


if __name__ == "__main__":
    main()
