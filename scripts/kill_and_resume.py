#!/usr/bin/env python3
"""Kills and interrupts commands at random moments and looks at what they leave behind.

    scripts/kill_and_resume.py [SCENE] [--kills 200] [--seed 1] [--binary FILE] [-- SOLVE OPTIONS...]

Runs solve with every kind of output, render and sample, and sends SIGKILL, SIGTERM or SIGINT at a
random moment. After each, every output must hold what was there before, or what a whole run gives,
or (after SIGTERM and SIGINT) a valid result with status 3; `sample` must read the checkpoint. Now
and then the solve is resumed and must end with the bytes of an uninterrupted one. Prints torn
outputs, unusable checkpoints and other failures, and fails if there are any. Without SCENE it takes
the built-in Cornell box.
"""
import argparse
import collections
import json
import math
import pathlib
import random
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
INTERRUPTED = 3
BEFORE = b"what was there before"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=pathlib.Path, nargs="?")
    parser.add_argument("--kills", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--binary", type=pathlib.Path,
                        default=ROOT / "build/release/bin/halflight")
    words = sys.argv[1:]
    end = words.index("--") if "--" in words else len(words)
    arguments = parser.parse_args(words[:end])
    arguments.options = words[end + 1:] or ["--feature-size", "3cm"]
    random.seed(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        trial = Trial(arguments, pathlib.Path(folder))
        trial.run(arguments.kills)
        return trial.report()


def heed_signals():
    """In the child: this script may run where they are ignored, which is inherited."""
    for heeded in [signal.SIGINT, signal.SIGTERM]:
        signal.signal(heeded, signal.SIG_DFL)


# What makes a file a whole one, told without the program that wrote it where that is possible.

def is_glb(data):
    if data[:4] != b"glTF" or struct.unpack_from("<I", data, 8)[0] != len(data):
        return False
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20:20 + length])
    binary = struct.unpack_from("<I", data, 20 + length)[0]
    return binary == len(data) - length - 28 and document["buffers"][0]["byteLength"] <= binary


def is_png(data):
    at, types = 8, []
    while at < len(data):
        length = struct.unpack_from(">I", data, at)[0]
        body = data[at + 4:at + 8 + length]
        if struct.unpack_from(">I", data, at + 8 + length)[0] != zlib.crc32(body):
            return False
        types.append(body[:4])
        at += 12 + length
    return data[:8] == b"\x89PNG\r\n\x1a\n" and types[0] == b"IHDR" and types[-1] == b"IEND"


def is_table(data):
    lines = data.decode().split("\n")
    rows = [[float(word) for word in line.split()] for line in lines[:-1]]
    return not lines[-1] and len(rows) == SENSORS and all(
        len(row) == 9 and all(math.isfinite(x) for x in row) and min(row[6:]) >= 0 for row in rows)


def is_report(data):
    return json.loads(data)["wall_seconds"] > 0


def is_exr(data):
    """Attributes, then offsets of blocks of lines, then the blocks, of which the last ends the file."""
    at = 8
    while data[at]:
        size_at = data.index(0, data.index(0, at) + 1) + 1
        at = size_at + 4 + struct.unpack_from("<I", data, size_at)[0]
    first = struct.unpack_from("<Q", data, at + 1)[0]
    offsets = struct.unpack_from(f"<{(first - at - 1) // 8}Q", data, at + 1)
    ends = [offset + 8 + struct.unpack_from("<I", data, offset + 4)[0] for offset in offsets]
    return data[:4] == b"\x76\x2f\x31\x01" and max(ends) == len(data)


SENSORS = 20
VALID = {".glb": is_glb, ".png": is_png, ".txt": is_table, ".json": is_report, ".exr": is_exr}


def is_valid(name, data):
    try:
        return VALID[pathlib.Path(name).suffix](data)
    except (ValueError, KeyError, IndexError, struct.error):
        return False


class Trial:
    def __init__(self, arguments, folder):
        self.binary, self.folder = arguments.binary.resolve(), folder
        self.scene = folder / "scene.glb"
        if arguments.scene:
            self.scene = arguments.scene.resolve()
        else:
            self.call(["scene", "cornell-box", "-o", str(self.scene)])
        self.write_sensors()
        self.failures = collections.defaultdict(list)
        self.ends, self.looked_at, self.unfinished = collections.Counter(), 0, 0
        solve = ["solve", str(self.scene), "--progress", "none", *arguments.options,
                 "--points", "sensors.txt", "--checkpoint", "NAME.ckpt", "--resume",
                 "--points-out", "NAME.txt", "-o", "NAME.glb", "--lightmap", "128",
                 "--report", "NAME.json"]
        render = ["render", "whole.ckpt", "--camera", "auto", "--size", "160x120",
                  "--progress", "none", "-o", "NAME-r.png", "--visibility-mask", "NAME-m.exr"]
        sample = ["sample", "whole.ckpt", "--points", "sensors.txt",
                  "--points-out", "NAME-s.txt", "-o", "NAME-s.glb", "--lightmap", "64"]
        self.solve = Job(self, solve, [".ckpt", ".txt", ".glb", ".lightmap.exr",
                                       ".lightmap.png", ".json"])
        others = [Job(self, render, ["-r.png", "-m.exr"]),
                  Job(self, sample, ["-s.txt", "-s.glb", "-s.lightmap.exr", "-s.lightmap.png"])]
        self.jobs = [self.solve] * 3 + others

    def write_sensors(self):
        rows = [f"{0.1 + 0.015 * i} 0.001 {0.1 + 0.01 * i} 0 1 0\n" for i in range(SENSORS)]
        (self.folder / "sensors.txt").write_text("".join(rows))

    def call(self, words):
        return subprocess.run([self.binary, *words], cwd=self.folder, stderr=subprocess.PIPE,
                              stdout=subprocess.DEVNULL, check=False, text=True)

    def fail(self, kind, text):
        self.failures[kind].append(text)
        print(f"{kind}: {text}", flush=True)

    def run(self, kills):
        while self.ends.total() < kills:
            job = random.choice(self.jobs)
            for _ in range(random.randint(1, 3)):
                if random.random() < 0.7:
                    job.put_before()
                self.strike(job)
            if job is self.solve:
                job.finish()
            job.clear()

    def strike(self, job):
        """Starts the job, sends one signal or two, and looks at what is left."""
        before = job.contents()
        sent = random.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
        process = subprocess.Popen([self.binary, *job.words("part")], cwd=self.folder,
                                   stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   preexec_fn=heed_signals)
        time.sleep(random.uniform(0, 1.05 * job.seconds))
        process.send_signal(sent)
        if sent != signal.SIGKILL and random.random() < 0.4:
            time.sleep(random.uniform(0, 0.2 * job.seconds))
            process.kill()  # while it writes what it has
        try:
            status = process.wait(60)
        except subprocess.TimeoutExpired:
            process.kill()
            status = process.wait()
            self.fail("hangs", f"{job.name} after {sent.name}")
        if status == 0:
            return  # it was faster
        self.ends[f"{job.name}, {sent.name}: status {status}"] += 1
        if status not in (INTERRUPTED, -sent, -signal.SIGKILL):
            self.fail("wrong statuses", f"{status} of {job.name} after {sent.name}")
        self.look_at(job, before, sent, status)

    def look_at(self, job, before, sent, status):
        for name, data in job.contents().items():
            self.looked_at += 1
            if name.endswith(".ckpt"):
                self.check_checkpoint(name, data)
            elif data in (before[name], job.whole[name]):
                if status == INTERRUPTED and data == BEFORE:
                    self.fail("outputs not written", f"{name} by {job.name} after {sent.name}")
            elif name.endswith(".json") and is_valid(name, data):
                pass  # no two reports tell of the same seconds
            elif sent == signal.SIGKILL or not is_valid(name, data):
                self.fail("torn outputs", f"{name} of {job.name}, {len(data or b'')} bytes, "
                          f"after {sent.name}, status {status}")
        for left in self.folder.glob("*.partial-*"):
            self.unfinished += 1
            left.unlink()

    def check_checkpoint(self, name, data):
        if data is None or data == BEFORE:
            return
        read = self.call(["sample", name, "--points", "sensors.txt", "--points-out", "look.txt"])
        if "holds no light yet" in read.stderr:
            return  # killed before its first iteration: only good for going on
        table = (self.folder / "look.txt").read_bytes() if read.returncode == 0 else b""
        if read.returncode != 0 or not is_table(table):
            self.fail("unusable checkpoints", f"{len(data)} bytes: {read.stderr.strip()}")

    def report(self):
        for end, count in sorted(self.ends.items()):
            print(f"  {count:4} {end}")
        print(f"{self.ends.total()} commands ended by a signal, {self.solve.finished} resumed to "
              f"the end, {self.looked_at} outputs looked at, "
              f"{self.unfinished} unfinished files left beside them")
        for kind in ["torn outputs", "unusable checkpoints", "outputs with other bytes",
                     "outputs not written", "wrong statuses", "hangs"]:
            print(f"  {len(self.failures[kind])} {kind}")
        return 1 if any(self.failures.values()) else 0


class Job:
    """A command, what it writes, and what a whole run of it writes."""

    def __init__(self, trial, words, endings):
        self.trial, self.template, self.endings, self.name = trial, words, endings, words[0]
        self.finished = 0
        start = time.monotonic()
        done = trial.call(self.words("whole"))
        self.seconds = time.monotonic() - start
        if done.returncode != 0:
            sys.exit(f"{self.name} fails by itself: {done.stderr}")
        whole = self.contents("whole")
        # The lit scene names its lightmap.
        self.whole = {name.replace("whole", "part", 1): data for name, data in whole.items()}
        trial.call(self.words("part"))
        again = self.contents()
        for name, data in again.items():
            if name.endswith(".glb"):
                self.whole[name] = data
            elif not name.endswith(".json") and data != self.whole[name]:
                trial.fail("outputs with other bytes", f"{name} of {self.name} when run again")
        self.clear()
        print(f"{self.name} takes {self.seconds:.2f} s and writes {len(endings)} files")

    def words(self, name):
        return [word.replace("NAME", name) for word in self.template]

    def paths(self, name):
        return [self.trial.folder / (name + ending) for ending in self.endings]

    def contents(self, name="part"):
        return {path.name: path.read_bytes() if path.exists() else None
                for path in self.paths(name)}

    def put_before(self):
        for path in self.paths("part"):
            if path.suffix != ".ckpt":
                path.write_bytes(BEFORE)

    def clear(self):
        for path in self.paths("part"):
            path.unlink(missing_ok=True)

    def finish(self):
        done = self.trial.call(self.words("part"))
        self.finished += 1
        if done.returncode != 0:
            self.trial.fail("wrong statuses", f"{done.returncode} when resumed: {done.stderr}")
        for name, data in self.contents().items():
            if data != self.whole[name] and not name.endswith(".json"):
                self.trial.fail("outputs with other bytes", f"{name} after {self.name} was resumed")


if __name__ == "__main__":
    sys.exit(main())
