"""Draws error against time, an SVG for each scene: plot.py results.json FOLDER."""

import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402

MARKS = "osD^v<>pP*X"


def draw_all(rows: list[dict], folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    runners = list(dict.fromkeys(row["runner"] for row in rows))
    plt.rcParams["svg.hashsalt"] = "energywave"  # the same rows make the same file
    for scene in dict.fromkeys(row["scene"] for row in rows):
        figure, axes = plt.subplots(figsize=(8, 5.5), layout="constrained")
        for index, runner in enumerate(runners):
            own = [row for row in rows if row["scene"] == scene and row["runner"] == runner]
            if own:
                times = [1e3 * row["best_s"] for row in own]
                mark = {"marker": MARKS[index % len(MARKS)], "color": f"C{index}"}
                axes.plot(times, [max(row["p99"], 1e-16) for row in own], label=runner, **mark)
        axes.set(xscale="log", yscale="log", xlabel="milliseconds a frame (the best)")
        axes.set_ylabel("relative error that 99 % of the pixels keep to")
        axes.set_title(f"{scene}: left and low is better", loc="left")
        axes.grid(alpha=0.3)
        axes.legend()
        figure.savefig(folder / f"{scene}.svg", metadata={"Date": None})
        plt.close(figure)


if __name__ == "__main__":
    draw_all(json.loads(Path(sys.argv[1]).read_text())["rows"], Path(sys.argv[2]))
