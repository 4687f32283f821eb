#!/usr/bin/env bash
# Brings two Mesas of Debian, with the Vulkan loader and glslang, each into a folder of its own in ${XDG_CACHE_HOME:-~/.cache}/xrds or
# the folder that is named: mesa25 of trixie, whose RADV compiles for GPUs of AMD that are not there, and mesa26 of a later
# Debian, whose NVK does for NVIDIA's on a kernel interface that does nothing (mesa-drm-shim). Installs nothing on the host
# and needs no rights: apt-get and dpkg-deb of any Debian or Ubuntu, 140 MB of packages. Prints the folders.
#
#     bench/gpu_static_mesa.sh [FOLDER]      XRDS_DEBIAN_MIRROR names another mirror, XRDS_DEBIAN_LATER another suite than forky
set -euo pipefail
parent=${1:-${XDG_CACHE_HOME:-$HOME/.cache}/xrds}
mirror=${XRDS_DEBIAN_MIRROR:-http://deb.debian.org/debian}
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
[ -e "$keyring" ] || { echo "$keyring is missing: install debian-archive-keyring." >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# bring FOLDER SUITE VERSION PACKAGE...: of the Mesa that has been tried, 25.0. or 26.
bring() {
  local folder=$parent/$1 suite=$2 tried=$3 root=$work/$1 version
  shift 3
  if [ -e "$folder/complete" ]; then
    echo "$folder"
    return
  fi
  mkdir -p "$root"/{state/lists/partial,cache/archives/partial,root}
  : >"$root/state/status"  # nothing counts as installed
  echo "deb [signed-by=$keyring] $mirror $suite main" >"$root/sources.list"
  local options=(
    -o "Dir::State=$root/state" -o "Dir::State::status=$root/state/status" -o "Dir::Cache=$root/cache"
    -o "Dir::Etc::sourcelist=$root/sources.list" -o Dir::Etc::sourceparts=/dev/null -o "Dir::Etc::preferencesparts=/dev/null"
    -o APT::Install-Recommends=false -o "APT::Sandbox::User=$(id -un)" -o Debug::NoLocking=1
  )
  apt-get "${options[@]}" -qq update
  apt-get "${options[@]}" -qq -y --download-only install mesa-vulkan-drivers libvulkan1 libc6 libstdc++6 glslang-tools "$@"
  for package in "$root"/cache/archives/*.deb; do dpkg-deb -x "$package" "$root/root"; done
  version=$(dpkg-deb -f "$root"/cache/archives/mesa-vulkan-drivers_*.deb Version)
  case $version in
    "$tried"*) ;;
    *) echo "Debian $suite has Mesa $version, and only $tried has been tried." >&2; return 1 ;;
  esac
  echo "$version" >"$root/root/complete"
  mkdir -p "$parent"
  rm -rf "$folder"
  mv "$root/root" "$folder"
  echo "$folder"
}

bring mesa25 trixie 25.0.
bring mesa26 "${XRDS_DEBIAN_LATER:-forky}" 26. mesa-drm-shim
