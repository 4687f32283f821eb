#!/usr/bin/env bash
# Builds xrds for 64-bit Windows on Debian by mingw-w64 and tries it under Wine: scripts/windows.sh [--library] [--test] [OUT]
# OUT (default build/packages) gets xrds-VERSION-windows-x86_64.zip: libxrds.dll, headers, models and, without --library,
# the command xrds.exe, for which OpenEXR, Imath and libpng are built of Debian's sources. --test runs the tests under Wine:
# with Xvfb and a Vulkan driver of this machine all of them, else those that need no device. First run
# scripts/packages.sh and scripts/packages.sh windows.
set -euo pipefail
cd "$(dirname "$0")/.."
command=ON test=no out=build/packages
for word in "$@"; do
  case $word in
    --library) command=OFF ;;
    --test) test=yes ;;
    -h | --help) sed -n '2,6s/^# //p' "scripts/${0##*/}"; exit 0 ;;
    -*) echo "There is no option '$word': scripts/windows.sh [--library] [--test] [OUT]" >&2; exit 2 ;;
    *) out=$word ;;
  esac
done
command -v x86_64-w64-mingw32-g++-posix > /dev/null || { echo "Run scripts/packages.sh windows first." >&2; exit 1; }
work=$PWD/build/windows
prefix=$work/prefix
mkdir -p "$prefix/include" "$prefix/share/cmake" "$work/source" "$out"
log=$work/log.txt

quietly() { "$@" > "$log" 2>&1 || { tail -n 40 "$log" >&2; exit 1; }; }

cross() {  # cross NAME SOURCE OPTION...: configures SOURCE in build/windows/NAME
  local name=$1 source=$2
  shift 2
  quietly cmake -G Ninja -S "$source" -B "$work/$name" -D CMAKE_TOOLCHAIN_FILE="$PWD/cmake/Mingw.cmake" -D CMAKE_BUILD_TYPE=Release \
    -D CMAKE_FIND_ROOT_PATH="$prefix" -D CMAKE_INSTALL_PREFIX="$prefix" \
    -D ZLIB_LIBRARY=/usr/x86_64-w64-mingw32/lib/libz.a "$@"
}

# What is headers alone comes from this system.
for header in vulkan vk_video volk.h volk.c nlohmann CLI; do cp -ru /usr/include/$header "$prefix/include/"; done
cp -ru /usr/share/cmake/nlohmann_json /usr/share/cmake/CLI11 "$prefix/share/cmake/"

library() {  # library NAME SOURCE OPTION...: builds and installs it, once
  [ -e "$work/$1.done" ] && return
  echo "Building $1"
  cross "$@"
  quietly cmake --build "$work/$1" --target install
  touch "$work/$1.done"
}

fetch() {  # fetch PACKAGE...: Debian's sources into build/windows/source, by lists of their own
  local apt=$work/apt package
  mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial"
  . /etc/os-release
  echo "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] http://deb.debian.org/debian $VERSION_CODENAME main" > "$apt/sources.list"
  local options=(-o Dir::Etc::SourceList="$apt/sources.list" -o Dir::Etc::SourceParts=/dev/null -o Dir::State::Lists="$apt/lists"
    -o Dir::Cache="$apt/cache" -o APT::Sandbox::User=root)
  quietly apt-get "${options[@]}" update
  for package in "$@"; do
    [ -d "$work/source/$package" ] && continue
    (cd "$apt" && quietly apt-get "${options[@]}" source --download-only "$package")
    quietly dpkg-source --no-check -x "$apt/${package}"_*.dsc "$work/source/$package"
  done
}

library googletest /usr/src/googletest -D BUILD_GMOCK=OFF
if [ $command = ON ]; then
  for package in imath openexr libpng1.6; do [ -d "$work/source/$package" ] || { fetch imath openexr libpng1.6; break; }; done
  library libpng "$work/source/libpng1.6" -D PNG_TESTS=OFF -D PNG_SHARED=OFF -D PNG_BUILD_ZLIB=OFF
  library imath "$work/source/imath" -D BUILD_TESTING=OFF -D BUILD_SHARED_LIBS=OFF
  library openexr "$work/source/openexr" -D BUILD_TESTING=OFF -D BUILD_SHARED_LIBS=OFF -D OPENEXR_BUILD_TOOLS=OFF \
    -D OPENEXR_INSTALL_EXAMPLES=OFF -D OPENEXR_INSTALL_TOOLS=OFF
fi

echo "Building xrds"
cross xrds . -D XRDS_COMMAND=$command -D XRDS_SOURCE_MODELS=OFF -D XRDS_VIEWER=OFF -D XRDS_TESTS=$([ $test = yes ] && echo ON || echo OFF) \
  -D CMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST
targets=(xrds)
[ $command = OFF ] || targets=(xrds_product)
if [ $test = yes ]; then
  targets+=(xrds_tests)
  [ $command = OFF ] || targets+=(xrds_app_tests xrds_image_tests xrds_advice_tests xrds_sequence_tests)
fi
cmake --build "$work/xrds" --target "${targets[@]}"
quietly cpack --config "$work/xrds/CPackConfig.cmake" -G ZIP -B "$out"
rm -rf "$out/_CPack_Packages"
(cd "$out" && ls -s --block-size=1K ./*.zip)
[ $test = no ] || scripts/wine.sh "$work/xrds"
