#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test: ./test.sh [release|debug|sanitize]
set -euo pipefail
cd "$(dirname "$0")"
preset=${1:-release}
scripts/packages.sh
scripts/python.sh
cmake --preset "$preset"
cmake --build --preset "$preset"
ctest --preset "$preset" --parallel 2
