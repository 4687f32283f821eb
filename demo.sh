#!/usr/bin/env bash
# Upscales a real render by 4 with the shipped model and shows the result beside its rivals: ./demo.sh [interior|outdoor|glossy]
set -euo pipefail
cd "$(dirname "$0")"
scene=${1:-interior}
scripts/install.sh
[ -f build/release/build.ninja ] || cmake --preset release >/dev/null
cmake --build --preset release --target xrds_cli | tail -n 1
mkdir -p out
xrds=build/release/cli/xrds
$xrds upscale samples/${scene}_lr.exr samples/${scene}_aux.exr -o out/${scene}.exr --preview out/${scene}.png \
  --reference samples/${scene}_ref.exr --side-by-side out/${scene}_side_by_side.png
echo "Wrote out/${scene}.exr, out/${scene}.png and out/${scene}_side_by_side.png (low-resolution input, bicubic, xrds, reference)."
