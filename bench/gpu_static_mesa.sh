#!/usr/bin/env bash
# Brings two Mesas of Debian, with the Vulkan loader and glslang, each into a folder of its own in ${XDG_CACHE_HOME:-~/.cache}/xrds or
# the folder that is named: mesa25 of trixie, whose RADV compiles for GPUs of AMD that are not there, and mesa26 of a later
# Debian, whose drivers do for those of NVIDIA, Apple, Qualcomm and the newest of AMD on kernel interfaces that do nothing
# (mesa-drm-shim). That of Intel no Debian has: it is made of mesa25's source, where bison, flex, pkg-config, ninja, a C++
# compiler and libdrm-dev are installed (2 minutes; meson comes from PyPI); else it is left out. Installs nothing on the
# host and needs no rights: apt-get and dpkg-deb of any Debian or Ubuntu, 190 MB. Prints the folders.
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

# The shim of Intel into the libraries of mesa25, whose ANV it serves.
shim_of_intel() {
  local library=libintel_noop_drm_shim.so folder=$parent/mesa25 root=$work/intel
  local place=$folder/usr/lib/x86_64-linux-gnu/$library
  [ ! -e "$place" ] || return 0
  for tool in bison flex pkg-config ninja c++; do
    command -v $tool >/dev/null || { echo "No GPUs of Intel: $tool is not installed." >&2; return 0; }
  done
  pkg-config --exists libdrm || { echo "No GPUs of Intel: libdrm-dev is not installed." >&2; return 0; }
  mkdir -p "$root/lists/partial" "$root/source" "$root/build"
  echo "deb-src [signed-by=$keyring] $mirror trixie main" >"$root/sources.list"
  (
    cd "$root/source"
    options=(-o "Dir::State::lists=$root/lists" -o "Dir::Etc::sourcelist=$root/sources.list" -o Dir::Etc::sourceparts=/dev/null
      -o "APT::Sandbox::User=$(id -un)" -o Debug::NoLocking=1)
    apt-get "${options[@]}" -qq update
    apt-get "${options[@]}" -qq source --tar-only mesa
    tar -xf mesa_25.0.*.orig.tar.xz --strip-components 1
    python3 -m venv "$root/tools"
    "$root/tools/bin/pip" -q install meson==1.7.0 mako==1.3.9 pyyaml==6.0.2 packaging==24.2
    export PATH=$root/tools/bin:$PATH
    meson setup "$root/build" -Dtools=drm-shim,intel -Dbuildtype=release -Dplatforms= -Dvulkan-drivers= -Dgallium-drivers= \
      -Dopengl=false -Dgles1=disabled -Dgles2=disabled -Dglx=disabled -Degl=disabled -Dgbm=disabled -Dllvm=disabled \
      -Dshader-cache=disabled -Dzstd=disabled -Dvideo-codecs= -Dlibunwind=disabled -Dvalgrind=disabled -Dlmsensors=disabled
    ninja -C "$root/build" src/intel/tools/$library
  ) >"$root/log" 2>&1 || { tail -20 "$root/log" >&2; echo "No GPUs of Intel: their kernel interface could not be made." >&2; return 0; }
  mv "$root/build/src/intel/tools/$library" "$place"
}

bring mesa25 trixie 25.0.
shim_of_intel
bring mesa26 "${XRDS_DEBIAN_LATER:-forky}" 26. mesa-drm-shim
