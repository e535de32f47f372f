#!/usr/bin/env python3
"""Solves the same scenes with two commits in turn and compares time, memory, rays and links.

    bench/compare_commits.py main HEAD                      built-in scenes
    bench/compare_commits.py v0.1 HEAD SCENE... --repeats 9 files

Each commit is built in a git worktree of its own outside this one (kept under --folder, so that the
next comparison with it starts at once). A solve by the one follows a solve by the other, so that
what else the machine does hits both alike; the ratio B / A is the median over such pairs, its spread
the smallest and the largest. Prints lines of JSON; exit status 1 when something has grown: three of
four pairs and their median are above the limit, which noise alone seldom brings about.
"""
import argparse
import os
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from common import ROOT, facts, median, output_of, show, solve

BUILT_IN = ["cornell-box", "loose-triangles", "office", "plants"]
LIMITS = {"cpu_seconds": 1.10, "first_result_seconds": 1.25, "peak_bytes": 1.05, "rays": 1.05,
          "links": 1.05}
SHARE_OF_PAIRS = 0.75


def build(commit, folder, jobs):
    """The program of a commit, built without tests."""
    tree = folder / commit
    if not tree.exists():
        subprocess.run(["git", "worktree", "add", "--quiet", "--detach", tree, commit], cwd=ROOT,
                       check=True)
    done = subprocess.run(["cmake", "--preset", "release", "-DHALFLIGHT_TESTS=OFF"], cwd=tree,
                          capture_output=True, text=True, check=False)
    if done.returncode == 0:
        done = subprocess.run(["cmake", "--build", "build/release", f"-j{jobs}", "--target",
                               "halflight_app"], cwd=tree, capture_output=True, text=True,
                              check=False)
    if done.returncode != 0:
        sys.exit(f"{commit} does not build:\n" + "\n".join((done.stdout + done.stderr)
                                                           .splitlines()[-8:]))
    return tree / "build/release/bin/halflight"


def remove(commits, folder):
    for commit in commits:
        subprocess.run(["git", "worktree", "remove", "--force", folder / commit], cwd=ROOT,
                       check=False)


def compare(programs, scene, arguments):
    """The names of what has grown beyond its limit."""
    pairs = [[solve(p, scene, *arguments.options) for p in programs]
             for _ in range(arguments.repeats)]
    grown = []
    for name, limit in LIMITS.items():
        a, b = ([pair[i][name] for pair in pairs] for i in (0, 1))
        ratios = [y / x for x, y in zip(a, b)]
        limit = 1 + (limit - 1) * arguments.tolerance
        most = sum(r > limit for r in ratios) >= SHARE_OF_PAIRS * len(ratios)
        worse = most and median(ratios) > limit
        show({"scene": scene.stem, "what": name, "a": median(a), "b": median(b),
              "ratio": round(median(ratios), 4),
              "spread": [round(min(ratios), 4), round(max(ratios), 4)], "limit": limit,
              "grown": worse}, arguments.json)
        if worse:
            grown.append(f"{scene.stem}: {name}")
    return grown


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("a", metavar="A", help="commit, the base")
    parser.add_argument("b", metavar="B", help="commit, judged")
    parser.add_argument("scenes", nargs="*", type=Path, metavar="SCENE")
    parser.add_argument("--repeats", type=int, default=5, help="pairs of solves of each scene")
    parser.add_argument("--tolerance", type=float, default=1.0,
                        help="by which the limits' distance from 1 is multiplied")
    parser.add_argument("--options", type=shlex.split, default=[],
                        help='of halflight solve, as --options="--feature-size 5cm"')
    parser.add_argument("--folder", type=Path, help="for the worktrees, kept; else they are removed")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--json", type=Path, help="add the lines to this file too")
    arguments = parser.parse_args()
    if arguments.repeats < 1:
        sys.exit("--repeats: at least 1")
    commits = [output_of("git", "rev-parse", "--short=12", "--verify", f"{name}^{{commit}}")
               for name in (arguments.a, arguments.b)]
    for name, commit in zip((arguments.a, arguments.b), commits):
        if not commit:
            sys.exit(f"'{name}' is no commit of this repository")
    for scene in arguments.scenes:
        if not scene.exists():
            sys.exit(f"{scene}: no such file")
    with tempfile.TemporaryDirectory(prefix="halflight-commits-") as passing:
        folder = (arguments.folder or Path(passing)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        try:
            programs = [build(commit, folder, arguments.jobs) for commit in commits]
            scenes = arguments.scenes
            if not scenes:
                for name in BUILT_IN:
                    scenes.append(Path(passing) / f"{name}.glb")
                    subprocess.run([programs[0], "scene", name, "-o", scenes[-1]],
                                   check=True, stderr=subprocess.DEVNULL)
            show({"bench": "commits", "a": commits[0], "b": commits[1], "limits": LIMITS,
                  "repeats": arguments.repeats} | facts(programs[1], commits[1]), arguments.json)
            grown = [g for scene in scenes for g in compare(programs, scene, arguments)]
        finally:
            if not arguments.folder:
                remove(set(commits), folder)
    if grown:
        sys.exit("grown beyond its limit: " + ", ".join(grown))


if __name__ == "__main__":
    main()
