#!/bin/sh
# Trains and exports every shipped model: x4 compact first, the others from its weights.
# usage: models.sh SHARD_FOLDERS VAL_FOLDER RUN_FOLDER [MINUTES=80] [MODEL ...]
# LIVE_FOLDER: where the live models are measured, scenes of few samples; without it they are left out.
# The paper-size xrds-x4 wants a CUDA device and is trained only when named: models.sh SHARDS VAL RUNS 25 xrds-x4
# SHARD_FOLDERS in quotes, MINUTES those of x4 compact (the others take a share of them); MODEL: only these.
# x1 and the full models learn from the noisy colour that shards hold: pack them with shards.py --noisy-every 1, for full models
# --noisy-every 0 --noisy-bits 6. Full and live models need pyoidn (bench/oidn-requirements.txt) as well.
# It may be stopped and started again: finished models are skipped, the others resumed. PYTHON chooses the interpreter.
set -eu
here=$(dirname "$0")
shards=$1 validation=$2 runs=$3 minutes=${4:-80}
shift 3
[ $# -gt 0 ] && shift
only=" $* "
python=${PYTHON:-python3}
export MALLOC_MMAP_MAX_=0 MALLOC_TRIM_THRESHOLD_=100000000000 OMP_WAIT_POLICY=PASSIVE

# model NAME PERCENT_OF_MINUTES START FLAGS...: trains RUN_FOLDER/NAME, then writes models/NAME.safetensors and its card.
model() {
    name=$1 share=$2 start=$3
    shift 3
    case "$only" in "  " | *" $name "*) ;; *) return 0 ;; esac
    run=$runs/$name
    [ -e "$run/exported" ] && return 0
    time=$(echo "$minutes * $share / 100" | bc -l)
    [ -z "$start" ] || set -- --start "$runs/$start/checkpoint.pt" "$@"
    # shellcheck disable=SC2086
    "$python" "$here/train.py" $shards --validation "$validation" --output "$run" --minutes "$time" "$@"
    "$python" "$here/export.py" "$run/checkpoint.pt" "$here/../models/$name.safetensors" --validation "$validation" --licence MIT --data "$data" --limits "$limits" $card ${start:+--start "$start"}
    touch "$run/exported"
}

data="{scenes} path-traced scenes (Blender Cycles 3.4: random interiors, table tops, scatter, architecture, vegetation, terrain, glass and metal,"
data="$data typography, dungeons, streets), references of at most 256 samples per pixel, colour and auxiliary images of several sample counts; crops,"
data="$data mirrors, turns, exchanged colours, tinted light, normals in other axes, exposure."
limits="Trained on images of 256 x 256 pixels of one renderer (Cycles), its pixel filter and its denoising albedo and normal."
card=
filter="--aux-kernels 5"
mini="--channels 16 --aux-channels 8 --head-channels 16 --groups 1 --output-side 1"
full="--aux albedo,normal,colour --colour-kernels 5 --prefilter 2 --output-side 1 --denoised-share 0.65"
few="--prefilter 2 --rate 1e-3 --aux-shares 0:0.6,1:0.25,4:0.15 --denoised-share 0.6"
# shellcheck disable=SC2086
{
    model xrds-x4-compact 100 "" --output-side 1 $filter
    model xrds-x4-small 80 xrds-x4-compact --groups 1 --output-side 1 $filter
    model xrds-x2-compact 25 xrds-x4-compact --scale 2 --output-side 1 --rate 3e-4 --ratio 0.5 $filter
    model xrds-x4-full 70 xrds-x4-compact $full --rate 4e-4 --colour-shares 64:0.45,16:0.55 --aux-shares 1:0.35,2:0.15,4:0.25,8:0.1,16:0.15 $filter
    model xrds-x2-full 60 xrds-x4-full --scale 2 $full --rate 5e-4 --colour-shares 16:0.5,4:0.4,1:0.05,2:0.05 --aux-shares 1:0.33,2:0.12,4:0.33,8:0.1,16:0.12 $filter
    model xrds-x8-compact 25 xrds-x4-compact --scale 8 --output-side 1 --crop 16 --rate 4e-4 $filter
    model xrds-x1-compact 120 xrds-x4-compact --scale 1 --crop 64 --batch 2 --rate 4e-4 --tone 0.4 --denoised-darker 80 --denoised-brighter 20 $filter
    model xrds-x4-compact-albedo 50 xrds-x4-compact --aux albedo --output-side 1 $filter
    model xrds-x4-compact-plain 50 xrds-x4-compact --aux "" --base bicubic --kernels 0 --aux-skip 0
    case "$only" in *" xrds-x4 "*) model xrds-x4 100 "" --channels 64 --aux-channels 32 --blocks 5 --batch 16 --rate 3e-4 $filter ;; esac
    model xrds-x4-mini 65 "" $mini --rate 1e-3 $filter
    model xrds-x4-nano 50 "" $mini --kernels 0 --rate 1e-3
    [ -n "${LIVE_FOLDER:-}" ] || exit 0
    validation=$LIVE_FOLDER
    card="--spp 1-0,2-0,4-0,16-0,1-1,4-1"
    model xrds-x2-live 101 "" --scale 2 $mini --block rstb $few --colour-shares 1:0.35,2:0.3,4:0.25,16:0.1 --validation-spp 1-0,2-0,4-0 $filter
    card="--spp 1-0,4-0,16-0,64-0,1-1,16-1"
    model xrds-x4-live 82 xrds-x4-mini $mini $few --colour-shares 1:0.3,4:0.35,16:0.25,64:0.1 --validation-spp 1-0,4-0,16-0 $filter
}
