#!/usr/bin/env bash
# Builds what a user runs and puts it in place: scripts/install.sh [--prefix DIR] [--build DIR]
# DIR/bin gets xrds and xrds-view, DIR/share models, licence, man page and completion. Default: ~/.local, build/release.
set -euo pipefail
here=$PWD
cd "$(dirname "$0")/.."
prefix=$HOME/.local build=build/release
while [ $# -gt 0 ]; do
  case $1 in
    --prefix | --build)
      [ $# -ge 2 ] || { echo "$1 takes a folder: scripts/install.sh [--prefix DIR] [--build DIR]" >&2; exit 2; }
      [ "$1" = --prefix ] && prefix=$2 || build=$2
      shift 2 ;;
    --prefix=*) prefix=${1#*=}; shift ;;
    --build=*) build=${1#*=}; shift ;;
    -h | --help) sed -n '2,3s/^# //p' "scripts/${0##*/}"; exit 0 ;;
    *) echo "There is no option '$1': scripts/install.sh [--prefix DIR] [--build DIR]" >&2; exit 2 ;;
  esac
done
case $prefix in /*) ;; *) prefix=$here/$prefix ;; esac
scripts/build.sh "$build"
log=$(cmake --install "$build" --prefix "$prefix") || { echo "$log" >&2; exit 1; }
prefix=$(cd "$prefix" && pwd)
echo "Installed in $prefix: bin/xrds, its viewer, library, models, licence, man page and completion."
case ":$PATH:" in
  *":$prefix/bin:"*) ;;
  *) echo "Its commands are not found yet; run this, and add it to your ~/.profile: export PATH=\"$prefix/bin:\$PATH\"" ;;
esac
