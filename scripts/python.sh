#!/usr/bin/env bash
# Puts what the Python package is built and tested with (python/requirements.txt) into the folder .venv, which CMake
# finds. PYTHON names the interpreter, 3.10 or newer. Without a network nothing is lost: the package is left out.
set -euo pipefail
cd "$(dirname "$0")/.."
list=python/requirements.txt
if [ -x .venv/bin/python ] && cmp -s "$list" .venv/installed.txt; then exit 0; fi
if "${PYTHON:-python3}" -m venv .venv && .venv/bin/pip --quiet --disable-pip-version-check install -r "$list"; then
  cp "$list" .venv/installed.txt
else
  rm -rf .venv
  echo "The Python package is not built: its tools could not be installed (python3-venv, a network)." >&2
fi
