#!/bin/sh
# Renders every sample into this folder (or $1): apt-get install blender, then wait.
set -eu
here=$(dirname "$0")
out=${1:-$here}
render() {
    nice -n 19 blender -b --factory-startup -noaudio -P "$here/render.py" -- --out "$out" --scene "$@" | grep "spp"
}
render interior
render outdoor --width 320 --height 240 --kinds lr aux gt full
render glossy
render studio --width 512 --height 288 --reference-samples 256
