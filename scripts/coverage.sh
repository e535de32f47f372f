#!/usr/bin/env bash
# Runs the tests of the preset coverage and prints how many lines of src/halflight they ran: for each
# room and in all, and with --uncovered the lines that they did not.
#
#   scripts/coverage.sh [--uncovered] [-- CTEST OPTIONS...]
set -euo pipefail
cd "$(dirname "$0")/.."

uncovered=false options=()
while [ $# -gt 0 ]; do
  case $1 in
    --uncovered) uncovered=true ;;
    --) shift && options=("$@") && break ;;
    *) sed -n '2,5s/^# \{0,1\}//p' "$0" >&2 && exit 1 ;;
  esac
  shift
done

cmake --preset coverage >/dev/null
cmake --build --preset coverage
find build/coverage -name '*.gcda' -delete
# Programs that are killed, or may write or start no more, leave torn counts.
torn='Fault|Vanishing|FewThreads|Killed|kills|Interrupted'
# Threads that count how often the same lines run wait for each other: a test on one core is 4 times
# less work than on two. Each core has its share of the tests.
ctest --preset coverage --show-only >/dev/null  # lists the tests, which two must not do at once
mapfile -t cores < <(python3 -c 'import os; print(*os.sched_getaffinity(0), sep="\n")')
runs=()
for i in "${!cores[@]}"; do
  taskset --cpu-list "${cores[i]}" ctest --preset coverage --exclude-regex "$torn" \
    --tests-information "$((i + 1)),,${#cores[@]}" "${options[@]}" &
  runs+=($!)
done
for run in "${runs[@]}"; do wait "$run" || echo "some tests fail" >&2; done
mkdir -p build/coverage/report
gcovr --root . --filter 'src/halflight/' --exclude-throw-branches -j "$(nproc)" \
  --json build/coverage/report/lines.json build/coverage/src/halflight >/dev/null

python3 - build/coverage/report/lines.json $uncovered <<'PYTHON'
import collections
import json
import sys

counted = collections.defaultdict(lambda: [0, 0])
missed = {}
for file in json.load(open(sys.argv[1]))["files"]:
    room = file["file"].split("/")[2]
    lines = {}
    for line in file["lines"]:
        if not line.get("gcovr/noncode"):
            lines[line["line_number"]] = lines.get(line["line_number"], 0) + line["count"]
    for name in (room, "all"):
        counted[name][0] += sum(count > 0 for count in lines.values())
        counted[name][1] += len(lines)
    missed[file["file"]] = sorted(n for n, count in lines.items() if count == 0)
for room, (ran, lines) in sorted(counted.items(), key=lambda item: (item[0] == "all", item[0])):
    print(f"{room:12} {ran:6} of {lines:6} lines  {100 * ran / lines:5.1f} %")
if sys.argv[2] == "true":
    for name, lines in sorted(missed.items()):
        if lines:
            print(f"{name}: {', '.join(map(str, lines))}")
PYTHON
