#!/usr/bin/env python3
"""Kills solves at random moments, resumes them, and compares what comes out byte for byte.

    scripts/kill_and_resume.py SCENE [--kills 200] [--seed 1] [--binary FILE] [-- SOLVE OPTIONS...]

Every run is killed with SIGKILL between one and three times before it may end. Prints how far the
checkpoints had got when the runs were killed, and fails at the first difference.
"""
import argparse
import collections
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=pathlib.Path)
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--binary", default=str(ROOT / "build/release/bin/halflight"))
    words = sys.argv[1:]
    end = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:end])
    arguments.options = words[end + 1:]
    random.seed(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        return run(arguments, pathlib.Path(folder))


def run(arguments, folder):
    def command(name):
        return [arguments.binary, "solve", str(arguments.scene.resolve()), "--progress", "none",
                "--checkpoint", str(folder / f"{name}.ckpt"), "-o", str(folder / f"{name}.glb"),
                "--resume"] + arguments.options

    start = time.monotonic()
    subprocess.run(command("whole"), check=True, stderr=subprocess.DEVNULL)
    took = time.monotonic() - start
    print(f"a whole run takes {took:.2f} s")
    whole = [(folder / f"whole.{end}").read_bytes() for end in ("ckpt", "glb")]

    kills, runs, sizes = 0, 0, collections.Counter()
    checkpoint = folder / "part.ckpt"
    while kills < arguments.kills:
        checkpoint.unlink(missing_ok=True)
        for _ in range(random.randint(1, 3)):
            process = subprocess.Popen(command("part"), stderr=subprocess.DEVNULL)
            time.sleep(random.uniform(0, 1.1 * took))
            process.kill()
            if process.wait() == -signal.SIGKILL:
                kills += 1
                sizes[checkpoint.stat().st_size if checkpoint.exists() else 0] += 1
        subprocess.run(command("part"), check=True, stderr=subprocess.DEVNULL)
        runs += 1
        if [(folder / f"part.{end}").read_bytes() for end in ("ckpt", "glb")] != whole:
            print(f"run {runs}, after {kills} kills: other bytes than those of the whole run")
            return 1
    print(f"{kills} kills in {runs} runs, all of which ended with the same bytes")
    for size, count in sorted(sizes.items()):
        print(f"  {count:4} while the checkpoint had {size} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
