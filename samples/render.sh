#!/bin/sh
# Renders every sample into this folder (or $1): apt-get install blender, then wait.
set -eu
here=$(dirname "$0")
for scene in interior outdoor glossy; do
    nice -n 19 blender -b --factory-startup -noaudio -P "$here/render.py" -- --scene "$scene" --out "${1:-$here}" |
        grep "spp"
done
