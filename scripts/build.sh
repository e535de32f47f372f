#!/usr/bin/env bash
# Builds a preset (default: release) into build/PRESET; the program is build/PRESET/bin/halflight.
set -euo pipefail
cd "$(dirname "$0")/.."
preset=${1:-release}
cmake --preset "$preset" >/dev/null
cmake --build --preset "$preset"
