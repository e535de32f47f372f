#!/usr/bin/python3
"""Draws docs/performance/*.svg from the lines that scaling.py and blender_bake.py kept.

    bench/scaling.py --json out/scaling.json
    bench/blender_bake.py cornell.glb loose.glb --json out/bake.json
    bench/plots.py out/scaling.json out/bake.json

Needs Debian's python3-matplotlib, and so Debian's Python.
"""
import json
import sys
from collections import defaultdict
from pathlib import Path

try:
    import matplotlib
except ModuleNotFoundError:
    sys.exit("no matplotlib: apt-get install python3-matplotlib, and run with /usr/bin/python3")
matplotlib.use("svg")
# Text stays text, and the same numbers give the same bytes.
matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "halflight", "font.size": 9})
import matplotlib.pyplot as plt  # noqa: E402  after the choice of what draws

TO = Path(__file__).resolve().parent.parent / "docs" / "performance"


def draw(name, curves, x_title, y_title):
    """Curves: name to points; both axes logarithmic."""
    figure, axes = plt.subplots(figsize=(5, 3.4))
    for (label, points), mark in zip(sorted(curves.items()), "osv^Dx+*" * 2):
        axes.loglog(*zip(*sorted(points)), marker=mark, markersize=4, linewidth=1, label=label)
    axes.set_xlabel(x_title)
    axes.set_ylabel(y_title)
    axes.grid(True, which="major", linewidth=0.4)
    axes.legend(frameon=False)
    figure.tight_layout()
    TO.mkdir(parents=True, exist_ok=True)
    figure.savefig(TO / f"{name}.svg", metadata={"Date": None})
    plt.close(figure)
    print(f"{TO / name}.svg")


def draw_scaling(lines):
    for name, key, factor, title in (
            ("time", "cpu_seconds", 1, "processor seconds of halflight solve"),
            ("memory", "peak_bytes", 2**-20, "peak memory, MiB")):
        curves = defaultdict(list)
        for line in lines:
            curves[line["family"]].append((line["triangles"], factor * line[key]))
        draw(name, curves, "triangles", title)


def draw_errors(lines):
    """A picture for each scene; a scene's lines come after the one that names its file."""
    scene, curves, points = None, defaultdict(lambda: defaultdict(list)), 0
    for line in lines:
        points = line.get("points", points)
        if "sensors" in line:
            scene = Path(line["scene"]).stem
        elif "nrmse" in line:
            gathers = "gather" in line["setting"] and "gather 0" not in line["setting"]
            who = line["who"] + (", final gather" if gathers else "")
            curves[scene][who].append((line["cpu_seconds"], 100 * line["nrmse"]))
    for scene, of_scene in curves.items():
        draw(f"error-{scene}", of_scene, f"processor seconds for {points:,} points", "NRMSE, %")


def main():
    if len(sys.argv) < 2:
        sys.exit("plots.py LINES.json...")
    lines = []
    for path in sys.argv[1:]:
        with open(path, encoding="utf-8") as file:
            lines += [json.loads(line) for line in file]
    scaling = [line for line in lines if "family" in line and "peak_bytes" in line]
    if scaling:
        draw_scaling(scaling)
    draw_errors([line for line in lines if "family" not in line])


if __name__ == "__main__":
    main()
