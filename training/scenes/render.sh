#!/usr/bin/env bash
# Renders training scenes in the background of other work; start it again to go on where it stopped.
# Blender ends with it.
# usage: render.sh OUT FIRST END [PROCESSES=1] [HDRI] [MODELS]
set -eu
[ $# -ge 3 ] || { sed -n 's/^# usage/usage/p' "$0" >&2; exit 2; }
here=$(dirname "$0")
out=$1 first=$2 end=$3 processes=${4:-1} hdri=${5:-} models=${6:-}
mkdir -p "$out"

# A process for every 20 seeds, so that a crash costs one scene and memory is given back.
share() {
    blender=
    trap 'kill $blender || true; wait; exit 143' TERM
    from=$((first + $1))
    while [ "$from" -lt "$end" ]; do
        to=$((from + 20 * processes))
        nice -n 19 blender -b --factory-startup -noaudio -P "$here/render.py" -- --seeds "$from:$((to < end ? to : end))" \
            --stride "$processes" --threads 1 --out "$out" --hdri "$hdri" --models "$models" \
            > >(grep --line-buffered -E "^s[0-9]+ |Error|error" >>"$out/render.$1.log") 2>&1 &
        blender=$!
        wait "$blender" || true
        from=$to
    done
}

trap 'kill $(jobs -p) || true; wait; exit 143' TERM INT
for process in $(seq 0 $((processes - 1))); do share "$process" & done
wait
