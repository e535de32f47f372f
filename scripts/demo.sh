#!/usr/bin/env bash
# Installs what is missing, builds, and lights the built-in office: a lit glTF and a picture.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/install_packages.sh
scripts/build.sh release
halflight=build/release/bin/halflight
mkdir -p out

"$halflight" scene office -o out/office.glb
"$halflight" solve out/office.glb -o out/demo.glb --report out/demo.json \
  --checkpoint out/demo.ckpt
"$halflight" render out/demo.ckpt --camera desk -o out/demo.png

echo "Picture:         out/demo.png"
echo "Lit scene:       out/demo.glb (opens in any glTF viewer)"
echo "What was done:   out/demo.json"
echo "Watch it live:   build/release/bin/halflight view out/office.glb"
