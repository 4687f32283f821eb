#!/usr/bin/env bash
# Upscales a real render by 4 with the shipped model and shows the result beside its rivals: ./demo.sh [interior|outdoor|glossy|studio]
set -euo pipefail
cd "$(dirname "$0")"
scene=${1:-interior}
[ -f "samples/${scene}_lr64.exr" ] || { echo "There is no scene '$scene': ./demo.sh [interior|outdoor|glossy|studio]" >&2; exit 2; }
scripts/packages.sh
scripts/build.sh
mkdir -p out
xrds=build/release/cli/xrds
$xrds upscale samples/${scene}_lr64.exr samples/${scene}_aux16.exr -o out/${scene}.exr --preview out/${scene}.png \
  --reference samples/${scene}_gt.exr --side-by-side out/${scene}_side_by_side.png
echo "Wrote out/${scene}.exr, out/${scene}.png and out/${scene}_side_by_side.png (low-resolution input, bicubic, xrds, reference)."
echo "The command is $xrds; scripts/install.sh puts it, the viewer and the library into ~/.local (or --prefix DIR)."
