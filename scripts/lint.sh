#!/usr/bin/env bash
# Runs clang-tidy with the checks of .clang-tidy, on the compile commands of a preset.
#
#   scripts/lint.sh [PRESET [PATH...]]   all sources, or those whose path contains one of PATHS
#   scripts/lint.sh PRESET --part        what the last commit changed, and a third of the others:
#                                        another third for each of three commits in a row
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-ci}
shift || true
parts=3

mapfile -t sources < <(git ls-files '*.cpp' | grep -E '^(src/halflight|apps)/')
selected=()
if [ "${1:-}" = --part ]; then
  # A merge changed what it brought in; a changed header is looked at through the source beside it.
  changed=$(git diff --name-only HEAD~1 2>/dev/null | sed 's/\.[a-z]*$//' || true)
  turn=$(($(git rev-list --count HEAD) % parts))
  for i in "${!sources[@]}"; do
    if ((i % parts == turn)) || grep -qxF "${sources[i]%.cpp}" <<<"$changed"; then
      selected+=("${sources[i]}")
    fi
  done
else
  for source in "${sources[@]}"; do
    [ $# -eq 0 ] || grep -qF "$(printf '%s\n' "$@")" <<<"$source" || continue
    selected+=("$source")
  done
fi
echo "clang-tidy: ${#selected[@]} of ${#sources[@]} sources"

cmake --preset "$preset" >/dev/null
printf '%s\0' "${selected[@]}" |
  xargs -0 -P "$(nproc)" -n 4 clang-tidy --quiet -p "build/$preset" \
    2> >(grep -v "warnings\? generated" >&2)
