#!/usr/bin/env python3
"""Bakes the irradiance of a scene in Blender's Cycles beside Halflight, at the same points.

    bench/blender_bake.py SCENE.glb... [--points 65536] [--install]

Points lie at random over the sides that can see light (bench_time_to_error chooses them and times
Halflight and our own path tracer). In Blender each is a triangle far smaller than the scene that no
ray meets, and one texel of a picture: a diffuse bake, direct and indirect, without colour, on all
cores. Its error is judged against two bakes with many samples, as bench_time_to_error does with
paths: subtracted one by one, the differences multiplied, so that their noise does not count. Its
seconds are those of the samples alone: start, import, export to Cycles and ray structure, told as
"overhead_seconds", are left out by the line through two bakes. An error e then takes
seconds ~ 1 / e^2. "truths_differ" tells how far the two truths, Cycles' and ours, are apart
(relative to the mean; the RMS is noise too): the same light is computed.

Only opaque scenes compare: what lets light through is not translated. Needs Debian's blender, which
--install gets when it is missing, and a build with -DHALFLIGHT_BENCH=ON.
"""
import argparse
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from common import ROOT, facts, show

TARGETS = [0.1, 0.05, 0.02, 0.01]
TRUTH_SAMPLES = 128  # of each of the two bakes
SAMPLES = [4, 16, 64]


def install_blender():
    as_root = [] if os.geteuid() == 0 else ["sudo"]
    for step in (["update", "-qq"], ["install", "-y", "-qq", "--no-install-recommends", "blender"]):
        subprocess.run([*as_root, "env", "DEBIAN_FRONTEND=noninteractive", "apt-get", *step],
                       check=True, stdout=subprocess.DEVNULL)


def read_rows(path):
    return [[float(w) for w in line.split()] for line in path.read_text().splitlines()]


def mean_of(values):
    return sum(values) / len(values)


def nrmse(values, a, b):
    """Free of the noise of the two truths a and b, which are independent."""
    product = mean_of([(v - x) * (v - y) for v, x, y in zip(values, a, b)])
    return math.sqrt(max(product, 0)) / mean_of([(x + y) / 2 for x, y in zip(a, b)])


def bake(scene, sensors, folder):
    """Samples, seconds (wall, all processors) and irradiance of each bake: two truths, the one that
    tells the overhead, then SAMPLES."""
    settings = [(TRUTH_SAMPLES, 1), (TRUTH_SAMPLES, 2)] + [(n, 3) for n in (1, *SAMPLES)]
    task = folder / "task.json"
    task.write_text(json.dumps({"scene": str(scene), "sensors": str(sensors),
                                "bakes": settings, "to": str(folder)}))
    # Debian's Blender looks for Debian's Python by the path, where another may come first.
    done = subprocess.run(["blender", "--background", "--factory-startup", "--python-exit-code", "1",
                           "--python", ROOT / "bench/blender_side.py", "--", task],
                          env=os.environ | {"PATH": "/usr/bin:" + os.environ["PATH"]},
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit("Blender failed: " + "\n".join((done.stdout + done.stderr).splitlines()[-5:]))
    results = json.loads((folder / "bakes.json").read_text())
    return results["blender"], [(n, r["seconds"], read_column(folder / r["file"]))
                                for (n, _), r in zip(settings, results["bakes"])]


def read_column(path):
    return [float(line) for line in path.read_text().split()]


def halflight_lines(program, count, scene, sensors):
    """bench_time_to_error's lines; it writes the sensors with its two truths beside them."""
    done = subprocess.run([program, "--sensors", sensors, str(count), scene], capture_output=True,
                          text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{program} failed: {done.stderr.strip()}")
    return [json.loads(line) for line in done.stdout.splitlines()]


def compare(arguments, scene):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sensors = folder / "sensors.txt"
        ours = halflight_lines(arguments.build / "bin/bench_time_to_error", arguments.points, scene,
                               sensors)
        for line in ours:
            show(line, arguments.json)
        blender, bakes = bake(scene.resolve(), sensors, folder)
        rows = read_rows(sensors)
    (_, _, a), (_, _, b) = bakes[:2]
    (n0, first, _), runs = bakes[2], bakes[3:]
    n1, last, _ = runs[-1]
    per_sample = [(t1 - t0) / (n1 - n0) for t0, t1 in zip(first, last)]  # wall, all processors
    truth, other = [(x + y) / 2 for x, y in zip(a, b)], [(r[6] + r[7]) / 2 for r in rows]
    mean = mean_of(other)
    rms = math.sqrt(mean_of([(x - y) ** 2 for x, y in zip(truth, other)]))
    show({"who": "cycles", "blender": blender,
          "overhead_seconds": first[0] - n0 * per_sample[0],
          "truths_differ": {"mean": mean_of(truth) / mean - 1, "rms": rms / mean}}, arguments.json)
    for n, _, values in runs:
        error = nrmse(values, a, b)
        show({"who": "cycles", "setting": f"{n} samples", "seconds": n * per_sample[0],
              "cpu_seconds": n * per_sample[1], "nrmse": error}, arguments.json)
    for target in TARGETS:
        line = next(x for x in ours if x.get("target") == target)
        result = {"scene": scene.stem} | line
        for suffix, seconds in zip(("", "_cpu"), per_sample):
            result["cycles" + suffix] = n * seconds * (error / target) ** 2
            mine = line["halflight" + suffix]
            result["cycles_times" + suffix] = mine and result["cycles" + suffix] / mine
        show(result, arguments.json)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="+", type=Path, metavar="SCENE.glb")
    parser.add_argument("--points", type=int, default=65536)
    parser.add_argument("--install", action="store_true", help="install Blender when it is missing")
    parser.add_argument("--build", type=Path, default=ROOT / "build/release")
    parser.add_argument("--json", type=Path, help="add the lines to this file too, for plots.py")
    arguments = parser.parse_args()
    if arguments.install and not shutil.which("blender"):
        install_blender()
    if not shutil.which("blender"):
        sys.exit("no blender: bench/blender_bake.py --install, or apt-get install blender")
    if not (arguments.build / "bin/bench_time_to_error").exists():
        sys.exit(f"no bench_time_to_error in {arguments.build}/bin: build with -DHALFLIGHT_BENCH=ON")
    for scene in arguments.scenes:
        if scene.suffix != ".glb" or not scene.exists():
            sys.exit(f"{scene}: a GLB file is needed (halflight scene NAME -o NAME.glb writes one)")
    show({"bench": "time to error", "points": arguments.points} |
         facts(arguments.build / "bin/halflight"), arguments.json)
    for scene in arguments.scenes:
        compare(arguments, scene)


if __name__ == "__main__":
    main()
