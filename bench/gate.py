#!/usr/bin/env python3
"""What the feature size saves: elements, links, rays and time of whole solves as s grows, and the
error at the sensors of ../shared/scenes/references, where the scene has some.

    bench/gate.py office-lbl soda-shop        scenes of ../shared/scenes
    bench/gate.py office.glb                  or files
    bench/gate.py --options "--visibility exact" kitchen

s is given as a share of the scene's diagonal; 0.1 % stands for no gate.
"""

import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SCENES = ROOT.parent / "shared" / "scenes"
SHARES = (0.1, 1.0, 2.0, 5.0, 10.0)  # percent of the diagonal


def scene_file(name):
    if pathlib.Path(name).is_file():
        return pathlib.Path(name)
    files = sorted((SCENES / name).glob("*"))
    return next(f for f in files if f.suffix in (".obj", ".glb", ".gltf"))


def rows(path):
    lines = (line.split() for line in path.read_text().splitlines() if not line.startswith("#"))
    return [[float(v) for v in line] for line in lines if line]


def diagonal(binary, scene):
    return json.loads(subprocess.check_output([binary, "inspect", scene, "--json"]))["diagonal"]


def solve(binary, scene, size, reference, options, folder):
    command = [binary, "solve", scene, "--feature-size", f"{size:.6g}", "--progress", "none"]
    command += ["--report", folder / "report.json", *options]
    subprocess.run(command, check=True, capture_output=True)
    report = json.loads((folder / "report.json").read_text())
    if reference:
        # A run of its own: reading 1,000 sensors is not what is timed.
        (folder / "points").write_text("".join(" ".join(f"{v:.9g}" for v in r[:6]) + "\n" for r in reference))
        command += ["--points", folder / "points", "--points-out", folder / "out"]
        subprocess.run(command, check=True, capture_output=True)
        got = rows(folder / "out")
        mean = sum(sum(r[6:9]) for r in reference) / len(reference)
        errors = sorted(
            abs(sum(g[6:9]) - sum(r[6:9])) / max(sum(r[6:9]), 0.01 * mean) for g, r in zip(got, reference)
        )
        report["median"] = errors[len(errors) // 2]
        report["p90"] = errors[int(0.9 * len(errors))]
    return report


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--options", default="", help="passed on to halflight solve")
    parser.add_argument("--halflight", default=ROOT / "build" / "release" / "bin" / "halflight")
    arguments = parser.parse_args()
    print("| scene | s | elements | links | rays | CPU s | median | 90th percentile |")
    print("|---|--:|--:|--:|--:|--:|--:|--:|")
    for name in arguments.scenes:
        scene = scene_file(name)
        sensors = SCENES / "references" / f"{name}.txt"
        reference = rows(sensors) if sensors.is_file() else []
        for share in SHARES:
            with tempfile.TemporaryDirectory() as folder:
                size = diagonal(arguments.halflight, scene) * share / 100
                report = solve(
                    arguments.halflight, scene, size, reference, arguments.options.split(), pathlib.Path(folder)
                )
            rays = report["rays"]["exact"] + report["rays"]["multi_resolution"]
            error = f"{report['median']:.2%} | {report['p90']:.1%}" if reference else "- | -"
            print(
                f"| {scene.stem} | {share} % | {report['elements']:,} | {report['links']:,} | {rays:,} | "
                f"{report['cpu_seconds']:.2f} | {error} |",
                flush=True,
            )


if __name__ == "__main__":
    sys.exit(main())
