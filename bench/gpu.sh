#!/usr/bin/env bash
# A first look at this machine's GPU, in the order of what matters, within 8 minutes:
#
#     bench/gpu.sh OUT_FOLDER [SCENES]
#
# Devices, every kernel against double precision, pictures of each kernel family, paper size and compact by family in fp16 and fp32
# beside PyTorch on the same GPU, tuning, the tests, bands beside one piece, all models and sizes, operators, and a page of it all.
# Each part has a limit of its own, writes OUT_FOLDER/PART.txt, PART.log and its JSON as soon as it ends, and what fails or runs out
# of time is named at the end; the others still run. Files over 16 MB are cut, and said so.
#
# SCENES is a folder of validation renders for the image error. SECONDS_LEFT is the time for all (default 470), BUILD the build's
# folder (default build/release), DEVICE the engine's device as xrds --device takes it (default: the best one), FAMILIES the kernel
# families (default plain,tile,matrix,fused; what a device does not run is reported as refused), SIDE the side of the outputs
# (default 1024), SIZES those of the last parts (default 256,512,2048,4096), RUNS the frames that count (default 5), PYTHON a Python
# with training/requirements.txt and PyTorch (default python3).
set -uo pipefail
[ $# -eq 1 ] || [ $# -eq 2 ] || { sed -n '2,15s/^# \{0,1\}//p' "$0" >&2; exit 2; }
mkdir -p "$1"
out=$(realpath "$1") scenes=${2:-}
here=$(cd "$(dirname "$0")" && pwd)
build=${BUILD:-$here/../build/release}
python=${PYTHON:-python3}
side=${SIDE:-1024} runs=${RUNS:-5} families=${FAMILIES:-plain,tile,matrix,fused} sizes=${SIZES:-256,512,2048,4096}
models=$here/../models samples=$here/../samples
device=()
[ -z "${DEVICE:-}" ] || device=(--device "$DEVICE")
end=$((SECONDS + ${SECONDS_LEFT:-470}))
unended=()
most=16000000

# part LIMIT NAME COMMAND...: runs it for at most LIMIT seconds, and shows and keeps what it prints.
part() {
  local limit=$1 name=$2
  shift 2
  local left=$((end - SECONDS))
  [ "$left" -lt "$limit" ] && limit=$left
  if [ "$limit" -lt 3 ]; then
    unended+=("$name: no time was left")
    return
  fi
  echo "== $name [$((end - SECONDS)) s left]" >&2
  timeout --kill-after=5 "$limit" "$@" 2> "$out/$name.log" | tee "$out/$name.txt"
  local code=${PIPESTATUS[0]}
  case $code in
    0) ;;
    124 | 137) unended+=("$name: not done in $limit s") ;;
    *) unended+=("$name: exit code $code, $(tail -1 "$out/$name.log" | cut -c1-200)") ;;
  esac
}

describe() {
  "$build/cli/xrds" devices
  lscpu | grep 'Model name'
  nvidia-smi --query-gpu=name,driver_version,power.limit,clocks.max.sm --format=csv || echo "no nvidia-smi"
}

doctor() { "$build/cli/xrds" doctor "${device[@]}"; }

# A picture of each family in both precisions beside the reference.
pictures() {
  local family precision
  for family in ${families//,/ }; do
    for precision in fp32 fp16; do
      echo "$family, $precision"
      XRDS_KERNEL_FAMILY=$family "$build/cli/xrds" upscale "${device[@]}" "$samples/interior_lr64.exr" "$samples/interior_aux16.exr" \
        -o "$out/picture_${family}_$precision.exr" --precision "$precision" --reference "$samples/interior_gt.exr" \
        --model "$models/xrds-x4-compact.safetensors" 2>&1 | grep -v warning
    done
  done
}

# family_times MODEL PRECISION
family_times() {
  "$build/cli/xrds" bench network "${device[@]}" --model "$1" --size "$side" --runs "$runs" --family "$families" --precision "$2" --no-check \
    --json "$out/families_$(basename "$1" .safetensors)_$2.json"
}

# peers PRECISION CONFIGS PEERS
peers() {
  "$python" "$here/peers.py" "$build/bench/xrds_bench_network" "${device[@]}" --configs "$2" --size "$side" --rounds "$runs" \
    --precision "$1" --peers "$3"
}

# In eight processes at once, each with a file of its own. Without the validation layer, where there is none, they see results alone.
tests() {
  local folder found="" shard processes=() failed=0
  for folder in ${VK_LAYER_PATH:-} /usr/share/vulkan/explicit_layer.d /usr/local/share/vulkan/explicit_layer.d /etc/vulkan/explicit_layer.d; do
    [ ! -e "$folder/VkLayer_khronos_validation.json" ] || found=yes
  done
  [ -n "$found" ] || { export XRDS_TEST_NO_VALIDATION=1 && echo "no validation layer"; }
  for shard in 1 2 3 4 5 6 7 8; do
    GTEST_TOTAL_SHARDS=8 GTEST_SHARD_INDEX=$((shard - 1)) "$build/tests/xrds_tests" --gtest_brief=1 > "$out/tests_$shard.txt" 2>&1 &
    processes+=($!)
  done
  for shard in "${processes[@]}"; do wait "$shard" || failed=1; done
  grep -hE '^\[  (PASSED|SKIPPED) |^\[  FAILED  \] .* ms\)' "$out"/tests_?.txt
  return $failed
}

tune() {
  "$build/cli/xrds" tune "${device[@]}" --size "${side}x$side" --precision fp16 --json "$out/tune.json" xrds-x4-compact
}

# Bands keep memory low, with many small dispatches; one piece is the other way round.
bands() {
  local model precision rows
  for model in "$out/paper-size.safetensors" "$models/xrds-x4-compact.safetensors"; do
    for precision in fp16 fp32; do
      for rows in 0 65536; do
        echo "$(basename "$model" .safetensors), $precision, $([ $rows = 0 ] && echo bands || echo one piece)"
        "$build/bench/xrds_bench_network" "${device[@]}" --model "$model" --size "$side" --runs "$runs" \
          --precision $precision --band-rows $rows
      done
    done
  done
}

# network SIZES MODEL...: times, memory and errors of models.
network() {
  local options=() model
  [ -z "$scenes" ] || options=(--scenes "$scenes")
  for model in "${@:2}"; do options+=(--model "$model"); done
  "$build/cli/xrds" bench network "${device[@]}" --size "$1" --runs "$runs" --json "$out/network_${1//,/_}.json" "${options[@]}"
}

# operators_of FAMILY
operators_of() {
  "$build/bench/xrds_bench_operators" "${device[@]}" --family "$1" --network compact,paper --size "$side" \
    --benchmark_min_time=0.02 --benchmark_out="$out/operators_$1.json" --benchmark_out_format=json ||
    grep 'needs matrix units' "$out/operators_$1.log"  # it cannot be compared here, which is no failure
}

report() {
  local file
  for file in "$out"/network_*.json; do
    [ ! -s "$file" ] || "$python" "$here/report.py" "$file" -o "${file%.json}.html"
  done
}

export here build python side runs families models samples out scenes device_name="${DEVICE:-}"
# run LIMIT NAME FUNCTION ARGUMENTS...: part() of a function, in a shell of its own so that a limit ends it.
run() {
  local limit=$1 name=$2
  shift 2
  part "$limit" "$name" bash -c "$functions"$'\n''device=(); [ -z "$device_name" ] || device=(--device "$device_name"); "$@"' bash "$@"
}
functions=$(declare -f describe doctor pictures family_times peers tests tune bands network operators_of report)

timeout --kill-after=5 60 "$build/bench/xrds_bench_network" "${device[@]}" --size 64 --runs 1 --write-model "$out/paper-size.safetensors" > /dev/null 2>&1
paper=$out/paper-size.safetensors
run 20 machine describe
run 90 doctor doctor
run 40 pictures pictures
run 40 paper_fp16 family_times "$paper" fp16
run 30 compact_fp16 family_times xrds-x4-compact fp16
run 40 peers_fp16 peers fp16 compact,paper pytorch-cuda-fp16
run 30 paper_fp32 family_times "$paper" fp32
run 20 compact_fp32 family_times xrds-x4-compact fp32
run 60 tune tune
run 100 tests tests
run 30 bands bands
run 30 network_side network "$side" all
run 30 peers_fp32 peers fp32 compact,paper pytorch-cuda
run 90 peers_compiled peers fp16 compact pytorch-cuda-fp16-compile
for family in ${families//,/ }; do
  run 20 "operators_$family" operators_of "$family"
done
run 40 network_sizes network "$sizes" xrds-x4-compact "$paper"
end=$((SECONDS + 10))
run 10 report report
rm -f "$paper"

for file in "$out"/*; do
  if [ "$(stat -c %s "$file")" -gt $most ]; then
    truncate -s $most "$file"
    unended+=("$(basename "$file"): cut after $most bytes")
  fi
done
: > "$out/unended.txt"
[ ${#unended[@]} -eq 0 ] || printf 'not whole: %s\n' "${unended[@]}" | tee "$out/unended.txt"
[ ${#unended[@]} -eq 0 ]
