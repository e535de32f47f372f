#!/usr/bin/env bash
# Installs what is missing, builds a preset (default: release) and runs every test.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}

scripts/install_packages.sh
for folder in web tests/web; do
  lock=$folder/package-lock.json
  [ -f "$lock" ] || continue
  [ "$folder/node_modules/.package-lock.json" -nt "$lock" ] ||
    npm --prefix "$folder" ci --no-audit --no-fund --loglevel=error
done
scripts/build.sh "$preset"
ctest --preset "$preset" --parallel "$(nproc)"
