#!/usr/bin/env bash
# Builds what a user runs, command, viewer and library, and not the tests: scripts/build.sh [BUILD]
set -euo pipefail
cd "$(dirname "$0")/.."
command -v cmake ninja >/dev/null || { echo "This needs CMake, Ninja and more: run scripts/packages.sh first." >&2; exit 1; }
build=${1:-build/release}
[ -f "$build/build.ninja" ] || cmake --preset release -B "$build" >/dev/null
cmake --build "$build" --target xrds_product
