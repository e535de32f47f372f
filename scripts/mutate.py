#!/usr/bin/env python3
"""Makes the mistakes of scripts/mutants.txt one at a time in a copy of the tree and tells which of
them no test notices.

usage: mutate.py [--check] [--every N] [--only TEXT] [--work FOLDER] [--preset NAME] [--jobs N]
                 [--green]

Each mistake is built (only what it touches) and then tested from the nearest tests to the farthest,
until one is red; of a header the test of its own name is tried first, by itself. Exit status: 0 when
at least 95 % are noticed, else 1; 2 when the list no longer matches the source.
"""
import argparse
import contextlib
import glob
import os
import re
import shutil
import subprocess
import sys
import time

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
LIST = os.path.join(ROOT, "scripts", "mutants.txt")
WANTED = 0.95

# Test files by folder of the source: nearest first, each list is one run of the tests.
STAGES = {
    "scene": ["rays_path_tracer*", "scene_*", "accuracy_direct*"],
    "transport": ["transport_*", "solve_furnace* solve_energy* rays_light_tree*",
                  "accuracy_*", "solve_visibility* solve_reference* solve_mix*"],
    "solve": ["solve_furnace*", "solve_energy* transport_*", "accuracy_*",
              "solve_iterations* solve_mix* solve_reference*",
              "solve_properties* solve_sweep* experiments_figure10*"],
    "rays": ["rays_sampling* rays_spherical* rays_light* rays_adaptive* rays_path_tracer*",
             "accuracy_*", "solve_reference*"],
    "visibility": ["visibility_*", "solve_visibility*", "experiments_*"],
    "features": ["features_*", "visibility_blocker*", "experiments_table1*"],
    "hierarchy": ["hierarchy_*", "solve_furnace* transport_*", "solve_energy*"],
    "output": ["output_*", "accuracy_*", "solve_reference*", "app_lightmap*"],
}
SECONDS = 400  # for one run of tests: a mistake that makes them hang is noticed, too


class Mutant:
    def __init__(self, file, reason, old, new):
        self.file, self.reason, self.old, self.new = file, reason, old, new

    def path(self, root):
        return os.path.join(root, "src", "halflight", self.file)


def read_list():
    mutants, head = [], None
    old = None
    for number, line in enumerate(open(LIST), 1):
        line = line.rstrip("\n")
        if not line or line.startswith("#"):
            continue
        if line.startswith("- "):
            old = line[2:]
        elif line.startswith("+ "):
            if head is None or old is None:
                sys.exit(f"{LIST}:{number}: a replacement without its text")
            mutants.append(Mutant(*head, old, line[2:]))
            head = old = None
        else:
            file, _, reason = line.partition(": ")
            head = (file, reason)
    return mutants


def check(mutants):
    bad = 0
    for m in mutants:
        found = open(m.path(ROOT)).read().count(m.old) if os.path.exists(m.path(ROOT)) else 0
        if found != 1:
            print(f"{m.file}: {m.reason}: its text occurs {found} times: {m.old}")
            bad += 1
        if m.file.split("/")[0] not in STAGES:
            print(f"{m.file}: no tests are named for its folder")
            bad += 1
    return bad


def suites(patterns):
    names = set()
    for pattern in patterns.split():
        for file in glob.glob(os.path.join(ROOT, "tests", pattern + "_test.cpp")):
            names |= set(re.findall(r"^TEST(?:_F|_P)?\((\w+),", open(file).read(), re.M))
    return ":".join(f"{n}.*:*/{n}.*" for n in sorted(names))


def prepare(work, preset):
    """A copy of the files that are tracked, with the changes that are not committed yet."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, check=True,
                            capture_output=True, text=True).stdout.split("\n")
    files = {file for file in listed if os.path.isfile(os.path.join(ROOT, file))}
    for folder in ("apps", "experiments", "src", "tests"):  # whose sources are built as found
        for kind in ("cpp", "h"):
            for old in glob.glob(f"{folder}/**/*.{kind}", root_dir=work, recursive=True):
                if old not in files:
                    os.remove(os.path.join(work, old))
    for file in files:
        source, target = os.path.join(ROOT, file), os.path.join(work, file)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        if not os.path.exists(target) or open(source, "rb").read() != open(target, "rb").read():
            shutil.copyfile(source, target)
            shutil.copymode(source, target)
    shared = os.path.join(os.path.dirname(work), "shared")
    if not os.path.exists(shared) and os.path.exists(os.path.join(ROOT, "..", "shared")):
        os.symlink(os.path.realpath(os.path.join(ROOT, "..", "shared")), shared)
    subprocess.run(["cmake", "--preset", preset], cwd=work, check=True, stdout=subprocess.DEVNULL)


@contextlib.contextmanager
def changed(path, mutant):
    text = open(path).read()
    open(path, "w").write(text.replace(mutant.old, mutant.new))
    try:
        yield
    finally:
        open(path, "w").write(text)


def build(work, preset, jobs):
    return subprocess.run(["nice", "-n", "19", "ninja", "-C", f"build/{preset}", f"-j{jobs}",
                           "halflight_tests"], cwd=work, capture_output=True).returncode == 0


def is_noticed(work, preset, folder):
    """The run of tests that turned red, or none."""
    for patterns in STAGES[folder]:
        command = ["nice", "-n", "19", os.path.join(work, "build", preset, "bin", "halflight_tests"),
                   "--gtest_fail_fast", "--gtest_brief=1", "--gtest_filter=" + suites(patterns)]
        try:
            if subprocess.run(command, cwd=work, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, timeout=SECONDS).returncode != 0:
                return patterns
        except subprocess.TimeoutExpired:
            return patterns + " (hangs)"
    return None


def run_alone(work, preset, test):
    """Builds one test file anew, against the library as it is, and runs it: whether it turns red."""
    folder = os.path.join(work, "build", preset)
    commands = subprocess.run(["ninja", "-t", "commands", "halflight_tests"], cwd=folder, check=True,
                              capture_output=True, text=True).stdout.splitlines()
    objects, alone = "tests/CMakeFiles/halflight_tests.dir", "tests/alone.cpp.o"
    compiling = next(c for c in commands if c.endswith(test))
    compiling = compiling.replace(f"{objects}/{os.path.basename(test)}.o", alone)
    linking = re.sub(r"tests/\S+\.o(?= )", "", commands[-1])
    linking = linking.replace("-o bin/halflight_tests", f"{alone} -o bin/alone")
    for command in (compiling, linking):
        if subprocess.run(["nice", "-n", "19", "sh", "-c", command], cwd=folder,
                          capture_output=True).returncode != 0:
            return False
    try:
        return subprocess.run(["nice", "-n", "19", os.path.join(folder, "bin", "alone"),
                               "--gtest_brief=1"], cwd=work, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL, timeout=SECONDS).returncode != 0
    except subprocess.TimeoutExpired:
        return True


def is_noticed_alone(work, preset, jobs, mutant):
    """Most sources include a header: its own test answers without building them all."""
    name, kind = os.path.splitext(mutant.file)
    test = os.path.join("tests", name.replace("/", "_") + "_test.cpp")
    if kind != ".h" or not os.path.exists(os.path.join(work, test)):
        return None
    build(work, preset, jobs)
    header = mutant.path(work)
    times = os.stat(header).st_atime_ns, os.stat(header).st_mtime_ns
    with changed(header, mutant):
        red = run_alone(work, preset, test)
    os.utime(header, ns=times)  # nothing else is out of date
    return test if red else None


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--check", action="store_true", help="only see that the list still fits")
    parser.add_argument("--every", type=int, default=1, help="a sample: every Nth mistake")
    parser.add_argument("--only", default="", help="those whose file or reason contains this")
    parser.add_argument("--work", default="/tmp/halflight-mutants/tree")
    parser.add_argument("--preset", default="release")
    parser.add_argument("--green", action="store_true",
                        help="the tests are known to pass: do not run them without mistakes first")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    mutants = read_list()
    if check(mutants):
        return 2
    if options.check:
        print(f"{len(mutants)} mutants fit the source")
        return 0
    mutants = [m for m in mutants if options.only in f"{m.file}: {m.reason}"][:: options.every]

    prepare(options.work, options.preset)
    if not build(options.work, options.preset, options.jobs):
        sys.exit("the tree does not build without mutants")
    tests = os.path.join(options.work, "build", options.preset, "bin", "halflight_tests")
    if subprocess.run([tests, "--gtest_list_tests"], capture_output=True).returncode != 0:
        sys.exit("the tests do not start without mutants")
    for folder in [] if options.green else sorted({m.file.split("/")[0] for m in mutants}):
        if red := is_noticed(options.work, options.preset, folder):
            sys.exit(f"tests are red without mutants: {red}")

    killed, survived, unfit = 0, [], []
    for m in mutants:
        start = time.time()
        built = red = is_noticed_alone(options.work, options.preset, options.jobs, m)
        if not red:
            with changed(m.path(options.work), m):
                built = build(options.work, options.preset, options.jobs)
                red = built and is_noticed(options.work, options.preset, m.file.split("/")[0])
        if not built:
            unfit.append(m)
        elif red:
            killed += 1
        else:
            survived.append(m)
        verdict = "killed" if red else "SURVIVED" if built else "DOES NOT BUILD"
        print(f"{verdict}  {m.file}: {m.reason}  ({red or 'no test'}, {time.time() - start:.0f} s)",
              flush=True)
    for m in survived:
        print(f"no test notices {m.file}: {m.reason}\n- {m.old}\n+ {m.new}")
    share = killed / max(1, killed + len(survived))
    print(f"{killed} of {killed + len(survived)} killed, {100 * share:.1f} %")
    return 2 if unfit else 0 if share >= WANTED else 1


if __name__ == "__main__":
    sys.exit(main())
