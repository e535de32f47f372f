#!/usr/bin/env bash
# Runs the tests under the sanitizers of GCC, and small solves under valgrind; the light that a
# sanitized program finds must be that of the release build. Stops at the first report.
#
#   scripts/sanitize.sh [asan|tsan|valgrind]... [-- CTEST OPTIONS...]   default: all three
#
# asan is the address and the undefined behaviour sanitizer together. Builds take the presets
# asan-ubsan and tsan; valgrind and the comparison take the preset ci.
set -euo pipefail
cd "$(dirname "$0")/.."

kinds=() options=()
while [ $# -gt 0 ]; do
  case $1 in
    asan | tsan | valgrind) kinds+=("$1") ;;
    --) shift && options=("$@") && break ;;
    *) sed -n '2,8s/^# \{0,1\}//p' "$0" >&2 && exit 1 ;;
  esac
  shift
done
[ ${#kinds[@]} -gt 0 ] || kinds=(asan tsan valgrind)

export ASAN_OPTIONS=halt_on_error=1:detect_leaks=1:strict_string_checks=1:detect_invalid_pointer_pairs=2
export UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1
export TSAN_OPTIONS=halt_on_error=1:second_deadlock_stack=1:suppressions=$PWD/cmake/tsan.supp

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
build() { cmake --preset "$1" >/dev/null && cmake --build --preset "$1" "${@:2}"; }

# One solve with both kinds of links, and readings of them; the first argument starts the program.
solve_small() {
  local out=$1 links
  shift
  for links in refined sampled; do
    "$@" solve "$work/box.glb" --feature-size 12cm --links $links --progress none --threads 2 \
      --points "$work/points.txt" --points-out "$work/$out-$links.txt" -o "$work/$out-$links.glb" \
      --lightmap 64 --report "$work/$out-$links.json" --checkpoint "$work/$out-$links.ckpt"
  done
  "$@" sample "$work/$out-sampled.ckpt" --points "$work/points.txt" --points-out "$work/$out-read.txt"
  "$@" render "$work/$out-refined.ckpt" --camera auto --size 64x48 --progress none -o "$work/$out.png"
}

prepare_small() {
  build ci --target halflight_app >/dev/null
  build/ci/bin/halflight scene cornell-box -o "$work/box.glb"
  for i in 1 2 3 4 5; do
    for k in 1 2 3 4 5; do echo "0.0$((9 * i + 4)) 0.001 0.0$((9 * k + 4)) 0 1 0"; done
  done >"$work/points.txt"
  solve_small release build/ci/bin/halflight
}

# Sums that other optimisation rounds otherwise may differ in their last digits.
compare_small() {
  local kind
  for kind in refined sampled read; do
    python3 - "$work/release-$kind.txt" "$work/$1-$kind.txt" <<'PYTHON'
import sys
release, other = ([[float(x) for x in line.split()] for line in open(name)] for name in sys.argv[1:])
assert len(release) == len(other) == 25
worst = max(abs(a - b) / max(abs(b), 1e-6) for r, o in zip(release, other) for a, b in zip(r, o))
print(f"{sys.argv[2].rsplit('/', 1)[1]}: largest relative difference from the release build {worst:.2g}")
sys.exit(0 if worst <= 1e-4 else 1)
PYTHON
  done
}

prepare_small
for kind in "${kinds[@]}"; do
  if [ "$kind" = valgrind ]; then
    # One thread at a time runs under valgrind; stacks that the C library keeps for the next thread
    # look "possibly lost".
    solve_small valgrind valgrind --quiet --error-exitcode=99 --leak-check=full \
      --show-leak-kinds=definite --errors-for-leak-kinds=definite --fair-sched=yes \
      --suppressions=cmake/valgrind.supp build/ci/bin/halflight
  else
    preset=$kind
    [ "$kind" != asan ] || preset=asan-ubsan
    build "$preset"
    ctest --preset "$preset" --parallel "$(nproc)" "${options[@]}"
    solve_small "$kind" "build/$preset/bin/halflight"
  fi
  compare_small "$kind"
  echo "$kind: clean"
done
