#!/usr/bin/env bash
# Makes the packages of xrds and checks them: scripts/package.sh [--try] [OUT], default build/packages.
# OUT gets four .deb, one .tar.xz and their SHA-256. lintian's errors are errors. With --try, as root: installs the .deb in
# a fresh root of Debian (mmdebstrap, chroot) and runs them there, then builds and runs a program against the library.
# DEBFULLNAME and DEBEMAIL: the maintainer.
set -euo pipefail
cd "$(dirname "$0")/.."
try=no out=build/packages
for word in "$@"; do
  case $word in
    --try) try=yes ;;
    -h | --help) sed -n '2,5s/^# //p' "scripts/${0##*/}"; exit 0 ;;
    -*) echo "There is no option '$word': scripts/package.sh [--try] [OUT]" >&2; exit 2 ;;
    *) out=$word ;;
  esac
done
command -v cmake ninja lintian >/dev/null || { echo "Run scripts/packages.sh and scripts/packages.sh package first." >&2; exit 1; }
build=build/package
maintainer=()
[ -z "${DEBEMAIL:-}" ] || maintainer=(-D "XRDS_MAINTAINER=${DEBFULLNAME:-The xrds authors} <$DEBEMAIL>")
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || stat -c %Y CHANGELOG.md)}
export SOURCE_DATE_EPOCH

echo "Building in $build"
cmake --preset release -B "$build" -D CMAKE_INSTALL_PREFIX=/usr -D XRDS_TESTS=OFF -D XRDS_SOURCE_MODELS=OFF \
  "${maintainer[@]}" > "$build.txt" || { cat "$build.txt" >&2; exit 1; }
cmake --build "$build" --target xrds_product
rm -rf "$out"
mkdir -p "$out"
for kind in DEB TXZ; do
  cpack --config "$build/CPackConfig.cmake" -G $kind -B "$out" > "$build.txt" 2>&1 || { cat "$build.txt" >&2; exit 1; }
done
rm -rf "$out/_CPack_Packages"
(cd "$out" && ls -s --block-size=1K ./*.deb ./*.tar.xz)
lintian --allow-root --fail-on error --suppress-tags initial-upload-closes-no-bugs "$out"/*.deb
echo "lintian finds no errors"
[ $try = yes ] || exit 0
scripts/try_packages.sh "$out"
