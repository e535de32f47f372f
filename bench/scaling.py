#!/usr/bin/env python3
"""How time, memory, links, elements and rays grow with the number of triangles, and what a second
thread gains.

    bench/scaling.py                              10,000 to a million triangles, all families
    bench/scaling.py --most 1e7 office            one family, to ten million
    bench/scaling.py --threads                    instead: 1 and 2 threads, 100,000 triangles

Families:
  loose      loose triangles in one room, smaller the more there are: the same area in all
  plants     potted plants in one room, more and more of them
  office     an office that grows with what lies in it: constant density
  instanced  one clump of 1,000 triangles, repeated by nodes over a growing floor: constant density

The feature size stays the same, or a growing scene would be solved more and more coarsely. Prints
lines of JSON: the machine, a line for each solve, the exponents p of x ~ triangles^p.
"""
import argparse
import json
import math
import random
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

from common import BINARY, exponent, facts, show, solve

GROWING = ["cpu_seconds", "wall_seconds", "solve_seconds", "first_result_seconds", "peak_bytes",
           "links", "elements", "rays"]
CLUMP = 1000
PER_THING = 60  # triangles of a small thing of the office, about


def write_instanced(path, triangles):
    """Floor tiles of 1 m, each with a clump 1 m high and a lamp above it: three meshes in all."""
    tiles = max(1, round(triangles / (CLUMP + 6)))
    side = math.ceil(math.sqrt(tiles))
    dice = random.Random(1)

    def clump():
        for _ in range(CLUMP):
            at = [dice.random() for _ in range(3)]
            for _ in range(3):
                yield [a + dice.uniform(-0.03, 0.03) for a in at]

    def square(low, high, y, up):
        corners = [(low, y, low), (low, y, high), (high, y, high), (high, y, low)]
        for i in (0, 1, 2, 0, 2, 3) if up else (0, 2, 1, 0, 3, 2):
            yield list(corners[i])

    shapes = [list(clump()), list(square(0, 1, 0, True)) + list(square(0, 1, 2.5, False)),
              list(square(0.3, 0.7, 2.4, False))]
    data, views, accessors, meshes = b"", [], [], []
    for material, corners in enumerate(shapes):
        packed = b"".join(struct.pack("<3f", *c) for c in corners)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        accessors.append({"bufferView": material, "componentType": 5126, "type": "VEC3",
                          "count": len(corners),
                          "min": [min(c[k] for c in corners) for k in range(3)],
                          "max": [max(c[k] for c in corners) for k in range(3)]})
        meshes.append({"primitives": [{"attributes": {"POSITION": material},
                                       "material": material}]})
        data += packed

    def colour(r, g, b):
        return {"pbrMetallicRoughness": {"baseColorFactor": [r, g, b, 1], "metallicFactor": 0}}

    nodes = [{"mesh": mesh, "translation": [i % side, 0.05 if mesh == 0 else 0, i // side]}
             for i in range(tiles) for mesh in range(len(shapes))]
    document = {"asset": {"version": "2.0"}, "scene": 0,
                "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "meshes": meshes,
                "materials": [colour(0.3, 0.6, 0.3) | {"doubleSided": True}, colour(0.7, 0.7, 0.7),
                              colour(0, 0, 0) | {"emissiveFactor": [1, 1, 1]}],
                "accessors": accessors, "bufferViews": views,
                "buffers": [{"byteLength": len(data)}]}
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(data)) +
                     struct.pack("<I4s", len(text), b"JSON") + text +
                     struct.pack("<I4s", len(data), b"BIN\0") + data)


def write_scene(binary, family, triangles, path):
    if family == "instanced":
        write_instanced(path, triangles)
        return
    built_in = {"loose": ["loose-triangles", "--count", triangles,
                          "--size", max(0.001, 0.06 * math.sqrt(16384 / triangles))],
                "plants": ["plants", "--count", min(triangles, 8_000_000)],
                "office": ["office", "--count", max(1, triangles // PER_THING)]}[family]
    subprocess.run([str(c) for c in (binary, "scene", *built_in, "-o", path)], check=True,
                   stderr=subprocess.DEVNULL)


def grow(arguments, family, folder):
    results = []
    for k in range(round(arguments.steps * math.log10(arguments.most / arguments.least)) + 1):
        triangles = round(arguments.least * 10 ** (k / arguments.steps))
        scene = folder / f"{family}.glb"
        write_scene(arguments.halflight, family, triangles, scene)
        cost = solve(arguments.halflight, scene, "--feature-size", arguments.feature_size,
                     "--time", arguments.time)
        cost["bytes_per_triangle"] = cost["peak_bytes"] / cost["triangles"]
        show({"family": family} | cost, arguments.json)
        results.append(cost)
    if len(results) > 1:
        triangles = [r["triangles"] for r in results]
        show({"family": family, "exponents": {name: round(exponent(triangles,
             [r[name] for r in results]), 3) for name in GROWING}}, arguments.json)


def thread(arguments, family, folder):
    """The fastest of several runs in turn, as whatever else runs only makes them slower."""
    scene = folder / f"{family}.glb"
    write_scene(arguments.halflight, family, 100_000, scene)
    fastest = {}
    for _ in range(arguments.repeats):
        for threads in (1, 2):
            cost = solve(arguments.halflight, scene, "--feature-size", arguments.feature_size,
                         "--threads", threads)
            fastest[threads] = min(fastest.get(threads, math.inf), cost["solve_seconds"])
    show({"family": family, "triangles": cost["triangles"], "seconds_1_thread": fastest[1],
          "seconds_2_threads": fastest[2], "speedup": fastest[1] / fastest[2]}, arguments.json)


def main():
    families = ["loose", "plants", "office", "instanced"]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("families", nargs="*", metavar="FAMILY", help=", ".join(families))
    parser.add_argument("--least", type=float, default=1e4, help="triangles")
    parser.add_argument("--most", type=float, default=1e6, help="triangles")
    parser.add_argument("--steps", type=int, default=2, help="for each factor of ten")
    parser.add_argument("--feature-size", default="5cm")
    parser.add_argument("--time", default="10m", help="limit of a solve")
    parser.add_argument("--threads", action="store_true", help="strong scaling, 1 and 2 threads")
    parser.add_argument("--repeats", type=int, default=3, help="of runs with --threads")
    parser.add_argument("--json", type=Path, help="add the lines to this file too, for plots.py")
    parser.add_argument("--halflight", type=Path, default=BINARY)
    arguments = parser.parse_args()
    unknown = set(arguments.families) - set(families)
    if unknown:
        sys.exit(f"no family '{unknown.pop()}'; there are: {' '.join(families)}")
    if not 1000 <= arguments.least <= arguments.most <= 2e7:
        sys.exit("1,000 <= --least <= --most <= 20,000,000 triangles")
    if not arguments.halflight.exists():
        sys.exit(f"no {arguments.halflight}: run scripts/build.sh")
    show({"bench": "threads" if arguments.threads else "scaling",
          "feature_size": arguments.feature_size} | facts(arguments.halflight), arguments.json)
    with tempfile.TemporaryDirectory() as folder:
        for family in arguments.families or families:
            (thread if arguments.threads else grow)(arguments, family, Path(folder))


if __name__ == "__main__":
    main()
