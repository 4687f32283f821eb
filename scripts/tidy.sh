#!/usr/bin/env bash
# Runs clang-tidy with the checks of .clang-tidy over every room, or over those named: scripts/tidy.sh [ROOM ...]
# With the room api goes what reads the headers of the C API as C.
set -euo pipefail
cd "$(dirname "$0")/.."
command -v run-clang-tidy >/dev/null || { echo "This needs clang-tidy: install the package of that name." >&2; exit 1; }
build=${XRDS_BUILD:-build/release}
[ -f "$build/build.ninja" ] || { echo "There is no $build, whose generated headers are read: build it first." >&2; exit 1; }
rooms=("${@%/}")
[ $# -gt 0 ] || rooms=(engine shaders graph network frames checks tuning api image advice sequence app cli viewer bench python tests)
for room in "${rooms[@]}"; do
  [ -d "$room" ] || { echo "There is no room '$room': scripts/tidy.sh [ROOM ...]" >&2; exit 2; }
done
pattern=$(IFS='|'; echo "${rooms[*]}")
cmake -DXRDS_UNITY_BUILD=OFF "$build" >/dev/null  # each file by itself
# Its compiler's precompiled headers are none of clang's.
mkdir -p "$build/tidy"
sed -E 's# -Winvalid-pch -include [^ ]*cmake_pch\.hxx##' "$build/compile_commands.json" > "$build/tidy/compile_commands.json"
read_as_c() {
  [[ " ${rooms[*]} " != *" api "* ]] || clang-tidy -quiet examples/upscale.c tests/abi/sizes.c -- -std=c11 -Iinclude
}
{ run-clang-tidy -quiet -p "$build/tidy" "^$PWD/($pattern)/"; read_as_c; } 2>&1 | grep -vE '^clang-tidy|^$|warnings generated' | tee "$build/tidy.txt" || true
! grep -qE 'warning:|error:' "$build/tidy.txt"
