#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test: ./test.sh [release|debug|sanitize]
set -euo pipefail
cd "$(dirname "$0")"
preset=${1:-release}
scripts/packages.sh
scripts/python.sh
# A first build is one of everything: see XRDS_UNITY_BUILD in cmake/QuickBuild.cmake.
unity=
[ -f "build/$preset/CMakeCache.txt" ] || unity=-DXRDS_UNITY_BUILD=ON
cmake --preset "$preset" $unity
cmake --build --preset "$preset"
ctest --preset "$preset" --parallel 2
