#!/usr/bin/env python3
"""Solves the scenes that have path-traced references and writes the table of quality.

    scripts/build.sh && bench/quality.py                  every scene, docs/quality.md
    bench/quality.py kitchen sponza --json out/some.json   some scenes, no document
    bench/quality.py --pictures cornell-box                also out/quality/NAME.png, NAME-path-traced.png

References: ../shared/scenes/references/NAME.txt, a sensor a line: x y z nx ny nz Er Eg Eb stderr.
Error of a sensor: |mean over channels - reference| / max(reference, 1 % of the mean reference).
"""
import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENES = ROOT.parent / "shared" / "scenes"
OUT = ROOT / "out" / "quality"
LIT_SCENES = ["kitchen", "office-block"]  # a million triangles each, lit at 5 cm
LIMITS = {"median": 0.03, "p90": 0.15, "wall_seconds": 60, "peak_bytes": 2 << 30}
LIT_LIMITS = {"wall_seconds": 300, "peak_bytes": 6 << 30}
CORNELL_LIMITS = {"median": 0.02, "wall_seconds": 60, "peak_bytes": 2 << 30}
CORNELL_SENSORS = 4096
CORNELL_SAMPLES = 1 << 12
PICTURE_SIZE, PICTURE_SAMPLES = "480x360", "64"


def scene_file(name):
    kinds = (".obj", ".glb", ".gltf")
    return next(f for f in sorted((SCENES / name).iterdir()) if f.suffix in kinds)


def read_rows(path):
    lines = (line for line in path.read_text().splitlines() if line and not line.startswith("#"))
    return [[float(word) for word in line.split()] for line in lines]


def write_sensors(path, rows):
    path.write_text("".join(" ".join(f"{v:.9g}" for v in r[:6]) + "\n" for r in rows))


def run(binary, *arguments):
    """Runs halflight; time and peak memory as the system counts them."""
    start = time.monotonic()
    process = subprocess.Popen([binary, *map(str, arguments), "--progress", "none"],
                               stderr=subprocess.PIPE, text=True)
    messages = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    code = process.returncode = os.waitstatus_to_exitcode(status)
    if code not in (0, 4):  # 4: the budget ended first, the result is valid
        last = messages.strip().splitlines()[-1:] or ["no message"]
        raise RuntimeError(f"exit status {code}: {last[0]}")
    return {"wall_seconds": time.monotonic() - start,
            "cpu_seconds": usage.ru_utime + usage.ru_stime, "peak_bytes": usage.ru_maxrss * 1024}


def facts_of(report):
    facts = json.loads(report.read_text())
    return {"elements": facts["elements"], "links": facts["links"], "rays": facts["rays"]["exact"]}


def errors(reference, solved):
    """Quantiles over sensors; the reference's own noise is in the same measure as the error."""
    mean = sum(sum(r[6:9]) for r in reference) / len(reference) / 3
    relative, noise, square = [], [], 0.0
    for r, s in zip(reference, solved, strict=True):
        expected, got = sum(r[6:9]) / 3, sum(s[6:9]) / 3
        scale = max(expected, 0.01 * mean)
        relative.append(abs(got - expected) / scale)
        noise.append(r[9] / scale)
        square += sum((a - b) ** 2 for a, b in zip(r[6:9], s[6:9]))
    n = len(reference)
    relative.sort()
    noise.sort()
    return {"median": relative[n // 2], "p90": relative[int(0.9 * n)],
            "nrmse": math.sqrt(square / n / 3) / mean, "noise": noise[n // 2]}


def measure_sensors(binary, scene, reference):
    with tempfile.TemporaryDirectory() as folder:
        points, solved, report = (Path(folder) / f for f in ("points", "solved", "report"))
        write_sensors(points, reference)
        cost = run(binary, "solve", scene, "--points", points, "--points-out", solved,
                   "--report", report)
        return errors(reference, read_rows(solved)) | cost | facts_of(report)


def measure_lit(binary, scene):
    with tempfile.TemporaryDirectory() as folder:
        lit, report = Path(folder) / "lit.glb", Path(folder) / "report"
        cost = run(binary, "solve", scene, "--feature-size", "5cm", "-o", lit, "--report", report)
        mesh = json.loads(report.read_text())["lit_mesh"]
        return cost | facts_of(report) | {"vertices": mesh["vertices"],
                                          "file_bytes": lit.stat().st_size}


def sensors_on_obj(path, count):
    """Spread over the area by a seeded generator, on the side that the corners wind around."""
    positions, triangles = [], []
    for words in map(str.split, path.read_text().splitlines()):
        if words[:1] == ["v"]:
            positions.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            indices = [int(w.split("/")[0]) for w in words[1:]]
            corners = [positions[i if i < 0 else i - 1] for i in indices]
            triangles += [(corners[0], b, c) for b, c in zip(corners[1:], corners[2:])]

    def normal_and_area(a, b, c):
        u, v = ([q - p for p, q in zip(a, end)] for end in (b, c))
        cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        length = math.hypot(*cross)
        return [x / length for x in cross], length / 2

    normals, areas = zip(*(normal_and_area(*t) for t in triangles))
    generator = random.Random(1)
    rows = []
    for t in generator.choices(range(len(triangles)), areas, k=count):
        root, v = math.sqrt(generator.random()), generator.random()
        weights = (1 - root, root * (1 - v), root * v)
        point = [sum(w * x for w, x in zip(weights, xs)) for xs in zip(*triangles[t])]
        rows.append(point + normals[t])
    return rows


def measure_cornell(binary):
    scene = scene_file("cornell-box")
    reference = OUT / f"cornell-box-{CORNELL_SENSORS}-sensors-{CORNELL_SAMPLES}-paths.txt"
    if not reference.exists():
        points = OUT / "cornell-box-sensors.txt"
        write_sensors(points, sensors_on_obj(scene, CORNELL_SENSORS))
        subprocess.run([binary, "reference", scene, "--points", points, "--spp",
                        str(CORNELL_SAMPLES), "--points-out", reference], check=True)
    return measure_sensors(binary, scene, read_rows(reference))


def make_pictures(binary, name):
    view = ["--camera", SCENES / name / "camera.json", "--size", PICTURE_SIZE]
    run(binary, "render", scene_file(name), *view, "-o", OUT / f"{name}.png")
    traced = OUT / f"{name}-path-traced.png"
    if not traced.exists():
        run(binary, "render", scene_file(name), *view, "--path-trace", PICTURE_SAMPLES, "-o", traced)


PERCENT, SECONDS, MIB, COUNT = "{:.1%}", "{:.1f}", "{:,.0f}", "{:,}"
COLUMNS = [("median", "median error", PERCENT), ("p90", "90 % below", PERCENT),
           ("nrmse", "NRMSE", PERCENT), ("noise", "reference noise", "{:.2%}"),
           ("wall_seconds", "seconds", SECONDS),
           ("cpu_seconds", "CPU seconds", SECONDS), ("peak_bytes", "MiB", MIB),
           ("elements", "elements", COUNT), ("links", "links", COUNT), ("rays", "rays", COUNT),
           ("vertices", "vertices", COUNT), ("file_bytes", "file MiB", MIB)]


def cell(result, key, form, limits):
    if key not in result:
        return ""
    value = result[key]
    text = form.format(value / 2**20 if key.endswith("_bytes") else value)
    return f"**{text}**" if value > limits.get(key, math.inf) else text


def table(results, limits):
    """Markdown; what exceeds its limit is bold."""
    columns = [c for c in COLUMNS if any(c[0] in r for r in results.values())]
    lines = ["| scene | " + " | ".join(title for _, title, _ in columns) + " |",
             "|---" + "|--:" * len(columns) + "|"]
    for name, result in results.items():
        cells = ([cell(result, key, form, limits) for key, _, form in columns]
                 if "failed" not in result else [result["failed"]])
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def machine():
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo")
                  if line.startswith("model name")), "unknown processor")
    cores = len(os.sched_getaffinity(0))
    busy = os.getloadavg()[0]
    text = f"{model}, {cores} cores"
    if busy > 0.5:
        text += f"; {busy:.1f} other processes wanted to run when it began, so times are too long"
    return text


def document(results, machine_facts):
    return f"""# Quality

What the default settings give on real scenes, against independent path-traced irradiance at 1,000
sensors a scene. Written by `bench/quality.py`; bold is what misses its goal (median error 3 %, nine
sensors of ten within 15 %, 60 s, 2 GiB).

Machine: {machine_facts}.

{table(results["sensors"], LIMITS)}

The error of a sensor is relative to the reference there, or to 1 % of the scene's mean where that is
more; NRMSE is the root of the mean squared error over the mean. An error cannot be told from the
reference's own noise once it is below it. Seconds and memory are those of the whole
`halflight solve SCENE --points ...`, reading the scene included; elements, links and rays come from
its report.

## A million triangles at 5 cm
`halflight solve SCENE --feature-size 5cm -o lit.glb`; goals: 5 minutes, 6 GiB.

{table(results["lit"], LIT_LIMITS)}

## Cornell box, {CORNELL_SENSORS:,} sensors
Against `halflight reference --spp {CORNELL_SAMPLES}`, spread evenly over the surfaces.

{table(results["cornell"], CORNELL_LIMITS)}
"""


def attempt(measure, *arguments):
    try:
        return measure(*arguments)
    except (RuntimeError, subprocess.CalledProcessError) as failure:
        return {"failed": str(failure)}


def main():
    known = sorted(f.stem for f in (SCENES / "references").glob("*.txt"))
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", help="default: all, and then docs/quality.md is written")
    parser.add_argument("--json", type=Path, help="write the numbers here as well")
    parser.add_argument("--pictures", action="store_true", help="also render, into out/quality")
    parser.add_argument("--halflight", default=ROOT / "build/release/bin/halflight", type=Path)
    arguments = parser.parse_args()
    binary = arguments.halflight.resolve()
    if not known:
        sys.exit(f"no references in {SCENES / 'references'}")
    if not binary.exists():
        sys.exit(f"no {binary}: run scripts/build.sh")
    for name in arguments.scenes:
        if name not in known:
            sys.exit(f"no reference for '{name}'; there are: {' '.join(known)}")

    OUT.mkdir(parents=True, exist_ok=True)
    chosen = arguments.scenes or known
    machine_facts = machine()
    results = {"sensors": {}, "lit": {}, "cornell": {}}
    for name in chosen:
        results["sensors"][name] = attempt(
            measure_sensors, binary, scene_file(name),
            read_rows(SCENES / "references" / f"{name}.txt"))
        print(table({name: results["sensors"][name]}, LIMITS).splitlines()[-1], flush=True)
        if arguments.pictures:
            failed = attempt(make_pictures, binary, name)
            if failed:
                print(f"{name}: {failed['failed']}", flush=True)
    for name in filter(chosen.__contains__, LIT_SCENES):
        results["lit"][name] = attempt(measure_lit, binary, scene_file(name))
        print(table({name: results["lit"][name]}, LIT_LIMITS).splitlines()[-1], flush=True)
    if "cornell-box" in chosen:
        results["cornell"]["cornell-box"] = attempt(measure_cornell, binary)
        print(table(results["cornell"], CORNELL_LIMITS).splitlines()[-1], flush=True)
    if arguments.json:
        arguments.json.write_text(json.dumps({"machine": machine_facts, **results}, indent=1) + "\n")
    if not arguments.scenes:
        (ROOT / "docs" / "quality.md").write_text(document(results, machine_facts))


if __name__ == "__main__":
    main()
