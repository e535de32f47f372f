#!/usr/bin/env bash
# Formats all C++ sources in place; with --check only tells which lines would change, and fails.
set -euo pipefail
cd "$(dirname "$0")/.."
mode=(-i)
[ "${1:-}" != --check ] || mode=(--dry-run -Werror)

folders=()
for folder in src apps tests fuzz bench experiments; do
  [ ! -d "$folder" ] || folders+=("$folder")
done
find "${folders[@]}" -name node_modules -prune -o \( -name '*.h' -o -name '*.cpp' \) -print0 |
  xargs -0 clang-format --style=file "${mode[@]}"
