#!/usr/bin/env bash
# Measures every shipped model on a folder of validation scenes, beside its rivals, and writes Markdown and JSON:
#
#     bench/quality.sh VAL_FOLDER OUT_FOLDER [single | merged]
#
# With "single" scale 1 alone, of which one render is all: beside Open Image Denoise, as they are and denoised first.
# With "merged" not that, but the compact and the full models on merged colours, as they are and denoised first.
# A table a setting (x4_64_aux16.md: scale 4, colour at 64 spp, albedo and normal at 16), and two that gather the means:
# auxiliary.md (scale 4 with albedo and normal of growing quality) and equal.md (equal average samples, Open Image
# Denoise included); beside each table its LPIPS (x4_64_aux16.lpips.md). `python3 bench/tables.py gather OUT_FOLDER
# [single | merged]` takes all of it over for docs/quality.md. XRDS is the program (default build/release/cli/xrds). PEERS is a Python with
# bench/oidn-requirements.txt and bench/lpips-requirements.txt (default python3). A model that is not there, a setting
# without renders, and OIDN and LPIPS, if they cannot run, are named and left out.
set -euo pipefail
[ $# -eq 2 ] || [ "${3:-}" = merged ] || [ "${3:-}" = single ] || { sed -n '2,13s/^# \{0,1\}//p' "$0" >&2; exit 2; }
val=$1 out=$2
here=$(cd "$(dirname "$0")" && pwd)
xrds=${XRDS:-$here/../build/release/cli/xrds}
peers=${PEERS:-python3}
mkdir -p "$out"
rm -f "$out"/{auxiliary,equal}.md "$out"/x*_aux*.{md,json} "$out"/oidn_*.lpips.{md,json}
python3 "$here/tables.py" origin > "$out/origin.json"

is_shipped() { "$xrds" info | grep -x "$1" > /dev/null; }  # reads all: -q would end the writer early

# The --model options of the shipped models of a scale, but for those that only take merged colours.
model_options() {
  local name names
  case $1 in
    4) names="xrds-x4-compact xrds-x4-small xrds-x4-mini xrds-x4-nano xrds-x4-compact-albedo xrds-x4-compact-plain" ;;
    *) names="xrds-x$1-compact" ;;
  esac
  for name in $names; do
    if is_shipped "$name"; then
      echo "--model $name"
    elif [ $# -gt 1 ]; then
      echo "left out: model $name is not there" >&2
    fi
  done
}

# Those of the models that are measured on merged colours.
merging_model_options() {
  for name in "xrds-x$1-compact" "xrds-x$1-full"; do
    if is_shipped "$name"; then echo "--model $name"; fi
  done
}

# Those of scale 1 that are measured on denoised colours.
single_model_options() {
  if is_shipped xrds-x1-compact; then echo "--model xrds-x1-compact"; fi
}

# table SCALE COLOUR AUX [OPTION...]: writes xSCALE_COLOUR_auxAUX.md and .json, with --merge ..._merged, with
# --denoise-first (after it ..._merged_denoised) ..._denoised, with --ensemble N ..._ensembleN; false if it cannot.
table() {
  local models=model_options
  fragment=$out/x$1_$2_aux$3
  case ${4:-} in
    --merge) fragment+=_merged models=merging_model_options ;;
    --denoise-first) fragment+=_denoised models=single_model_options ;;
    --ensemble) fragment+=_ensemble$5 ;;
  esac
  [ "${5:-}" != --denoise-first ] || fragment+=_denoised
  [ "$fragment.md" -nt "$out/started" ] && return  # by an earlier setting of this run
  echo "scale $1, colour $2 spp, aux $3" >&2
  rm -rf "$out/images"
  # shellcheck disable=SC2046 # the options are words
  "$xrds" bench quality "$val" --scale "$1" --samples "$2" --aux "$3" $("$models" "$1") "${@:4}" \
    --write "$out/images" --markdown "$fragment.md" --json "$fragment.json" > /dev/null 2> "$fragment.log" || {
    echo "left out: $(grep -v warning "$fragment.log" | tail -1)" >&2
    return 1
  }
  lpips "$out/images" "$fragment"
  rm -r "$out/images"  # hundreds of MB
}

# lpips IMAGES FRAGMENT: writes FRAGMENT.lpips.md and .json.
lpips() {
  "$peers" "$here/lpips.py" "$val" "$1" --json "$2.lpips.json" > "$2.lpips.md" 2> "$2.lpips.log" ||
    echo "left out: LPIPS of $1, $(tail -1 "$2.lpips.log")" >&2
}

# gather FILE SETTING: appends the means of the last table, all but those of the methods that ignore the auxiliary images.
gather() {
  if [ ! -e "$1" ]; then
    printf '%s\n' '| setting | method | PSNR dB | RelMSE | trimmed | median | 99.9 % | FLIP |' \
      '|---|---|---|---|---|---|---|---|' > "$1"
  fi
  awk -F' *[|] *' -v setting="$2" '
    means && NF > 9 && $2 !~ /^(---|bicubic|demodulated|input)/ {
      printf "| %s | %s | %s | %s | %s | %s | %s | %s |\n", setting, $2, $3, $5, $6, $7, $8, $9 }
    $2 == "mean" { means = 1 }' "$fragment.md" >> "$1"
}

# denoise SPP: fills the array `also` with the options that put OIDN's images into a table.
denoise() {
  also=()
  local folder=$out/oidn_images
  if ! { "$peers" "$here/oidn.py" "$val" "$folder/plain" --spp "$1" &&
    "$peers" "$here/oidn.py" "$val" "$folder/prefiltered" --spp "$1" --prefilter; } > "$out/oidn_$1.log" 2>&1; then
    echo "left out: Open Image Denoise at $1 spp, $(tail -1 "$out/oidn_$1.log")" >&2
    return 0
  fi
  also=(--also "OIDN=$folder/plain/*_oidn$1.exr" --also "OIDN, prefiltered=$folder/prefiltered/*_oidn$1.exr")
}

# Of one render of full resolution, and what Open Image Denoise makes of it.
single() {
  for spp in 1 2 4 8 16; do
    denoise "$spp"
    if table 1 "$spp" "$spp" "${also[@]}"; then table 1 "$spp" "$spp" --denoise-first || true; fi
  done
  table 1 8 8 --ensemble 2 || true
  for kind in "$out"/oidn_images/*; do
    [ ! -e "$kind" ] || lpips "$kind" "$out/oidn_$(basename "$kind")"
  done
}

if [ "${3:-}" = single ]; then
  touch "$out/started"
  single
  rm "$out/started"
  exit
fi

if [ "${3:-}" = merged ]; then
  touch "$out/started"
  for setting in "4 64 16" "4 64 4" "4 16 1" "2 16 4" "2 4 1"; do
    # shellcheck disable=SC2086 # three words
    { table $setting --merge && table $setting --merge --denoise-first --ensemble 8; } || true
  done
  rm "$out/started"
  exit
fi

for scale in 1 2 4 8; do model_options "$scale" loud > "$out/started"; done

# The scales, with albedo and normal at 16 spp.
table 2 16 16 || true
table 8 64 16 || true
table 8 256 16 || true

# Scale 4: albedo and normal of growing quality.
for aux in 1 4 16 converged; do
  table 4 64 "$aux" && gather "$out/auxiliary.md" "x4, 64 spp, aux $aux"
done

# The mean of several passes over the frame and its mirror images.
for setting in "4 64 16 2" "4 64 16 4" "2 16 16 2" "8 64 16 2"; do
  read -r scale colour aux passes <<< "$setting"
  table "$scale" "$colour" "$aux" --ensemble "$passes" || true
done

# Equal average samples: OIDN's full-resolution render of K spp; at scale s K = colour / s^2 + aux.
single
for setting in "2 16 4 1" "4 32 8 2" "8 64 16 4"; do
  read -r average colour4 colour2 aux <<< "$setting"
  fragment=$out/x1_${average}_aux$average
  [ ! -e "$fragment.md" ] || gather "$out/equal.md" "$average: x1, $average spp"
  table 2 "$colour2" "$aux" && gather "$out/equal.md" "$average: x2, $colour2 spp, aux $aux"
  table 4 "$colour4" "$aux" && gather "$out/equal.md" "$average: x4, $colour4 spp, aux $aux"
done
rm "$out/started"
echo "$out: auxiliary.md, equal.md and a .md and .json for every setting" >&2
