#!/usr/bin/env bash
# Measures the engine on this machine, beside PyTorch on its NVIDIA GPU, and makes a page of it:
#
#     bench/gpu.sh OUT_FOLDER [SCENES]
#
# Writes operators.json and network.json with their texts, families.json and operators_FAMILY.json (kernel families
# beside each other), bands.txt (frames in bands of rows and in one piece), peers_fp32.txt and peers_fp16.txt,
# machine.txt and report.html. SCENES is a folder of validation renders for the image error. BUILD is the build's folder
# (default build/release), DEVICE the engine's device as xrds --device takes it (default: the best one), FAMILIES the
# kernel families to compare (default plain,tile,matrix,fused; what a device does not run is reported as refused), PYTHON a
# Python with training/requirements.txt and PyTorch (default python3), PEERS what bench/peers.py shall run (default:
# those on the GPU), SIZES the sides of the outputs (default 256,512,1024,2048,4096), SIDE that of operators, families
# and peers (default 1024), CONFIGS the peers' networks (default paper,compact,nano), RUNS the frames or rounds that
# count (default 5). A part that fails is named; the others still run.
set -euo pipefail
[ $# -eq 1 ] || [ $# -eq 2 ] || { sed -n '2,14s/^# \{0,1\}//p' "$0" >&2; exit 2; }
out=$1 scenes=${2:-}
here=$(cd "$(dirname "$0")" && pwd)
build=${BUILD:-$here/../build/release}
python=${PYTHON:-python3}
side=${SIDE:-1024} runs=${RUNS:-5} families=${FAMILIES:-plain,tile,matrix,fused}
mkdir -p "$out"
device=()
[ -z "${DEVICE:-}" ] || device=(--device "$DEVICE")
failed=0

# part NAME COMMAND...: runs the command, shows what it prints and keeps it in NAME.txt.
part() {
  echo "== $1" >&2
  "${@:2}" 2> "$out/$1.log" | tee "$out/$1.txt" && return
  echo "failed: $1, $(tail -1 "$out/$1.log")" >&2
  failed=1
}

describe() {
  "$build/cli/xrds" devices
  lscpu | grep 'Model name' || true
  nvidia-smi --query-gpu=name,driver_version,power.limit,clocks.max.sm --format=csv || echo "no nvidia-smi"
}

operators() {
  "$build/bench/xrds_bench_operators" "${device[@]}" --size "$side" \
    --benchmark_out="$out/operators.json" --benchmark_out_format=json
}

network() {
  "$build/bench/xrds_bench_network" "${device[@]}" --size 64 --runs 1 --write-model "$out/paper-size.safetensors" > /dev/null
  local options=()
  [ -z "$scenes" ] || options=(--scenes "$scenes")
  "$build/cli/xrds" bench network "${device[@]}" --model all --model "$out/paper-size.safetensors" \
    --size "${SIZES:-256,512,1024,2048,4096}" --runs "$runs" --json "$out/network.json" "${options[@]}"
}

families() {
  "$build/cli/xrds" bench network "${device[@]}" --model xrds-x4-compact --model "$out/paper-size.safetensors" \
    --size "$side" --runs "$runs" --family "$families" --json "$out/families.json"
}

# Bands keep memory low, with many small dispatches; one piece is the other way round.
bands() {
  for model in "$out/paper-size.safetensors" "$here/../models/xrds-x4-compact.safetensors"; do
    for precision in fp32 fp16; do
      for rows in 0 65536; do
        echo "$(basename "$model" .safetensors), $precision, $([ $rows = 0 ] && echo bands || echo one piece)"
        "$build/bench/xrds_bench_network" "${device[@]}" --model "$model" --size "$side" --runs "$runs" \
          --precision $precision --band-rows $rows
      done
    done
  done
}

# operators_of FAMILY
operators_of() {
  "$build/bench/xrds_bench_operators" "${device[@]}" --family "$1" --network paper,compact --size "$side" \
    --benchmark_out="$out/operators_$1.json" --benchmark_out_format=json ||
    grep 'needs matrix units' "$out/operators_$1.log"  # it cannot be compared here, which is no failure
}

# peers PRECISION DEFAULT_PEERS
peers() {
  "$python" "$here/peers.py" "$build/bench/xrds_bench_network" "${device[@]}" --configs "${CONFIGS:-paper,compact,nano}" \
    --size "$side" --rounds "$runs" --precision "$1" --peers "${PEERS:-$2}"
}

report() {
  local options=()
  [ ! -e "$out/operators.json" ] || options=(--operators "$out/operators.json")
  "$python" "$here/report.py" "$out/network.json" "${options[@]}" -o "$out/report.html"
}

part machine describe
part operators operators
part network network
part families families
part bands bands
for family in ${families//,/ }; do
  part "operators_$family" operators_of "$family"
done
part peers_fp32 peers fp32 pytorch-cuda,pytorch-cuda-compile
part peers_fp16 peers fp16 pytorch-cuda-fp16,pytorch-cuda-fp16-compile
part report report
exit $failed
