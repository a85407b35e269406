"""Draws error against time: an SVG for each scene, or all in one. plot.py results.json FOLDER."""

import json
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.ticker import FuncFormatter, LogLocator  # noqa: E402

MARKS = "osD^v<>pP*X"


def time_name(milliseconds: float, _) -> str:
    return f"{milliseconds / 1e3:g} s" if milliseconds >= 1e3 else f"{milliseconds:g} ms"


def draw_scene(axes, rows: list[dict], scene: str, runners: list[str]) -> None:
    for index, runner in enumerate(runners):
        own = [row for row in rows if row["scene"] == scene and row["runner"] == runner]
        if own:
            times = [1e3 * row["best_s"] for row in own]
            mark = {"marker": MARKS[index % len(MARKS)], "color": f"C{index}", "markersize": 4.5, "linewidth": 1.3}
            axes.plot(times, [max(row["p99"], 1e-16) for row in own], label=runner, **mark)
    axes.set(xscale="log", yscale="log")
    axes.xaxis.set_major_locator(LogLocator(numticks=8))
    axes.xaxis.set_major_formatter(FuncFormatter(time_name))
    axes.tick_params(which="minor", length=0)
    axes.grid(alpha=0.3)
    axes.set_title(scene, loc="left", fontweight="bold")


def ready(rows: list[dict]) -> tuple[list[str], list[str]]:
    """Returns the runners and the scenes; the same rows make the same file."""
    plt.rcParams.update({"svg.hashsalt": "energywave", "font.size": 9})
    return [list(dict.fromkeys(row[key] for row in rows)) for key in ("runner", "scene")]


def draw_all(rows: list[dict], folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    runners, scenes = ready(rows)
    for scene in scenes:
        figure, axes = plt.subplots(figsize=(8, 5.5), layout="constrained")
        draw_scene(axes, rows, scene, runners)
        axes.set_xlabel("time of a frame (the best)")
        axes.set_ylabel("relative error that 99 % of the pixels keep to")
        axes.legend()
        figure.savefig(folder / f"{scene}.svg", metadata={"Date": None})
        plt.close(figure)


def draw_overview(rows: list[dict], path: Path) -> None:
    """Draws all scenes beside each other on the same axes, with one legend in the place after the last."""
    runners, scenes = ready(rows)
    across = 3
    down = len(scenes) // across + 1
    size = {"figsize": (10, 3.1 * down + 0.3), "layout": "constrained"}
    figure, grid = plt.subplots(down, across, sharex=True, sharey=True, squeeze=False, **size)
    places = list(grid.flat)
    for axes, scene in zip(places, scenes):
        draw_scene(axes, rows, scene, runners)
        axes.tick_params(labelbottom=True, labelleft=True)
    for axes in places[len(scenes) :]:
        axes.axis("off")
    marks = {}
    for axes in places[: len(scenes)]:
        marks |= dict(reversed(pair) for pair in zip(*axes.get_legend_handles_labels()))
    named = [name for name in runners if name in marks]
    title = "128x128 pixels; left and low is better"
    place = {"loc": "upper left", "frameon": False, "title": title, "alignment": "left"}
    places[len(scenes)].legend([marks[name] for name in named], named, **place)
    figure.supxlabel("time of a frame (the best)", fontsize=9)
    figure.supylabel("relative error that 99 % of the pixels keep to", fontsize=9)
    figure.savefig(path, metadata={"Date": None}, facecolor="white")
    plt.close(figure)


if __name__ == "__main__":
    draw_all(json.loads(Path(sys.argv[1]).read_text())["rows"], Path(sys.argv[2]))
