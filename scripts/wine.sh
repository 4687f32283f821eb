#!/usr/bin/env bash
# Tries a build of scripts/windows.sh under Wine: wine.sh BUILD [FILTER]. Tests that meet no Vulkan device are counted apart.
set -euo pipefail
cd "$(dirname "$0")/.."
build=$1 filter=${2:-*}
wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
[ -x "$wine" ] || { echo "Wine is missing: run scripts/packages.sh windows." >&2; exit 1; }
export WINEPREFIX=$PWD/build/windows/wine WINEDEBUG=-all
export LC_ALL=C.UTF-8  # by which Wine reads the names of files
# Its driver for the X server is Wine's way to this machine's Vulkan, where there are no validation layers.
export XRDS_TEST_NO_VALIDATION=1
screen=()
command -v xvfb-run > /dev/null && screen=(xvfb-run -a)
prefix=$build/wine
rm -rf "$prefix"
cmake --install "$build" --prefix "$prefix" > /dev/null
failed=0
for program in app/xrds_app_tests image/xrds_image_tests advice/xrds_advice_tests sequence/xrds_sequence_tests tests/xrds_tests; do
  [ -e "$build/$program.exe" ] || continue
  name=${program##*/}
  cp "$build/$program.exe" "$prefix/bin/"
  "${screen[@]}" "$wine" "$prefix/bin/$name.exe" --gtest_filter="$filter" --gtest_output="json:Z:$(realpath "$prefix")/$name.json" > "$prefix/$name.txt" 2>&1 || true
  [ -s "$prefix/$name.json" ] || { tail "$prefix/$name.txt"; echo "$name did not come to its end" >&2; exit 1; }
  python3 scripts/wine_results.py "$prefix/$name.json" | sed "s/^/$name: /" || failed=1
done
if [ -e "$prefix/bin/xrds.exe" ]; then
  "$wine" "$prefix/bin/xrds.exe" --version
  "$wine" "$prefix/bin/xrds.exe" info | tr -d '\r' | tr '\n' ' '
  echo
  "${screen[@]}" "$wine" "$prefix/bin/xrds.exe" devices || echo "Without a device nothing is upscaled" 
  if "${screen[@]}" "$wine" "$prefix/bin/xrds.exe" devices > /dev/null 2>&1; then
    "${screen[@]}" "$wine" "$prefix/bin/xrds.exe" upscale samples/outdoor_lr64.exr samples/outdoor_aux16.exr --model xrds-x4-nano \
      --quiet -o "$prefix/out.exr"
    "$wine" "$prefix/bin/xrds.exe" compare "$prefix/out.exr" samples/outdoor_gt.exr
    # The same of files whose names no code page has.
    names=$prefix/Größe-日本
    mkdir "$names"
    cp samples/outdoor_lr64.exr "$names/色.0001.exr"
    cp samples/outdoor_aux16.exr "$names/Übung.exr"
    "${screen[@]}" "$wine" "$prefix/bin/xrds.exe" upscale "$names/色.####.exr" "$names/Übung.exr" --model xrds-x4-nano \
      --quiet -o "$names/出.####.exr"
    cmp "$names/出.0001.exr" "$prefix/out.exr"
  fi
fi
exit $failed
