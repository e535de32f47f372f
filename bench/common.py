"""What the scripts of bench/ share: the machine's facts, a solve and what it cost, a fit."""
import json
import math
import os
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BINARY = ROOT / "build/release/bin/halflight"


def output_of(*command, cwd=ROOT):
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else ""


def compiler_of(build):
    """The compiler that a build folder was configured with."""
    try:
        cache = (build / "CMakeCache.txt").read_text().splitlines()
    except OSError:
        return "unknown"
    program = next((line.split("=", 1)[1] for line in cache
                    if line.startswith("CMAKE_CXX_COMPILER:")), "c++")
    return (output_of(program, "--version").splitlines() or ["unknown"])[0]


def facts(binary=BINARY, commit=None):
    """Every benchmark's first line: numbers of other machines cannot be compared."""
    model = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo", encoding="utf-8")
                  if line.startswith("model name")), "unknown")
    return {"cpu": model, "cores": len(os.sched_getaffinity(0)),
            "memory_bytes": os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"),
            "compiler": compiler_of(Path(binary).resolve().parent.parent),
            "commit": commit or output_of("git", "describe", "--always", "--dirty"),
            "waiting_processes": os.getloadavg()[0]}


def show(line, to=None):
    """Prints a line of JSON, and adds it to a file."""
    text = json.dumps(line)
    print(text, flush=True)
    if to:
        with open(to, "a", encoding="utf-8") as file:
            file.write(text + "\n")


def solve(binary, scene, *arguments):
    """Runs halflight solve. First result: ray structure, hierarchy and the first iteration, after
    loading. Processor time and peak memory are the whole program's, as the system counts them."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "report.json"
        command = [binary, "solve", scene, *arguments, "--report", path, "--progress", "none"]
        process = subprocess.Popen([str(c) for c in command], stderr=subprocess.PIPE, text=True)
        messages = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in (0, 4):  # 4: the budget ended first, the result is valid
            last = messages.strip().splitlines()[-1:] or ["no message"]
            raise RuntimeError(f"{scene}: exit status {process.returncode}: {last[0]}")
        report = json.loads(path.read_text())
    phases = report["phases"]
    first = phases["rays"] + phases["hierarchy"] + report["history"][0]["seconds"]
    return {"triangles": report["input"]["triangles"], "wall_seconds": report["wall_seconds"],
            "cpu_seconds": usage.ru_utime + usage.ru_stime, "load_seconds": phases["load"],
            "solve_seconds": report["wall_seconds"] - phases["load"],
            "first_result_seconds": first, "peak_bytes": usage.ru_maxrss * 1024,
            "links": report["links"], "elements": report["elements"],
            "rays": report["rays"]["exact"] + report["rays"]["multi_resolution"],
            "estimated_error": report.get("estimated_error")}


def exponent(xs, ys):
    """p of y = c x^p by least squares in logarithms."""
    xs, ys = [math.log(x) for x in xs], [math.log(y) for y in ys]
    mx, my = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((x - mx) * (y - my) for x, y in zip(xs, ys)) / sum((x - mx) ** 2 for x in xs)


def median(values):
    values = sorted(values)
    return (values[(len(values) - 1) // 2] + values[len(values) // 2]) / 2
