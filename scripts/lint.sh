#!/usr/bin/env bash
# Runs clang-tidy with the checks of .clang-tidy over the sources that a built preset compiled
# (default: ci). Arguments after the preset limit it to files whose path matches one of them.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-ci}
shift || true
[ $# -gt 0 ] || set -- '/src/halflight/' '/apps/'

cmake --preset "$preset" >/dev/null
run-clang-tidy -quiet -j "$(nproc)" -p "build/$preset" "$@" \
  2> >(grep -v "warnings\? generated" >&2)
