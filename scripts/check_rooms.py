#!/usr/bin/env python3
"""Checks that rooms include only themselves and rooms named earlier in docs/design/rooms.md, and
that oneTBB and Embree are named in one source file each. Prints one line per offence."""

import pathlib
import re
import sys

LIBRARY_OWNERS = {
    "tbb": (re.compile(r"^(oneapi/)?tbb/"), "src/halflight/base/parallel.cpp"),
    "Embree": (re.compile(r"^embree"), "src/halflight/rays/ray_scene.cpp"),
}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
ROOM_ROW = re.compile(r"^\| `(\w+)` \|")


def rooms_in_order(root):
    text = (root / "docs/design/rooms.md").read_text(encoding="utf-8")
    return [match[1] for line in text.splitlines() if (match := ROOM_ROW.match(line))]


def sources(root):
    for folder in ("src/halflight", "apps"):
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                yield path.relative_to(root)


def room_of(path):
    return path.parts[2] if path.parts[0] == "src" else "apps"


def includes(path):
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if match := INCLUDE.match(line):
            yield number, match[1] == '"', match[2]


def offence(path, quoted, target, order):
    for library, (pattern, owner) in LIBRARY_OWNERS.items():
        if pattern.match(target) and path.as_posix() != owner:
            return f"only {owner} may name {library}"
    room = room_of(path)
    if room not in order:
        return f"room '{room}' is not in docs/design/rooms.md"
    if target.startswith("halflight/"):
        target_room = target.split("/")[1]
        if target_room not in order:
            return f"room '{target_room}' is not in docs/design/rooms.md"
        if order.index(target_room) > order.index(room):
            return f"room '{room}' must not depend on the later room '{target_room}'"
    elif room == "apps" and target.startswith("experiments/"):
        return None  # outside the list; the command line runs them
    elif quoted and (room != "apps" or "/" in target):
        return f'include "{target}" by its full path "halflight/ROOM/FILE"'
    return None


def check(root):
    """All offences below `root`, one line each."""
    order = rooms_in_order(root)
    found = []
    for path in sources(root):
        for number, quoted, target in includes(root / path):
            if why := offence(path, quoted, target, order):
                found.append(f"{path}:{number}: {why}")
    return found


if __name__ == "__main__":
    offences = check(pathlib.Path(__file__).resolve().parent.parent)
    print("\n".join(offences), end="\n" if offences else "")
    sys.exit(1 if offences else 0)
