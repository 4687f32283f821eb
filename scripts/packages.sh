#!/usr/bin/env bash
# Installs the Debian or Ubuntu packages that xrds is built, tested and run with, if any of them is missing. Other lists:
# `scripts/packages.sh package` for scripts/package.sh, `windows` for scripts/windows.sh, `macos` for scripts/macos_check.sh.
set -euo pipefail
packages=(
  g++ cmake ninja-build ccache git
  libvulkan-dev libvulkan-volk-dev glslang-tools mesa-vulkan-drivers vulkan-validationlayers spirv-tools spirv-cross
  libopenexr-dev libpng-dev nlohmann-json3-dev libcli11-dev libgtest-dev libbenchmark-dev libglfw3-dev libimgui-dev
  libassimp-dev libstb-dev libx11-dev pkg-config xvfb python3-dev python3-venv
)
case ${1:-build} in
  build) ;;
  package) packages=(dpkg-dev lintian mmdebstrap xz-utils fish zsh) ;;
  windows) packages=(g++-mingw-w64-x86-64-posix libz-mingw-w64-dev wine64 googletest dpkg-dev xvfb) ;;
  macos) packages=(clang-16 libc++-16-dev) ;;
  *) echo "There is no list '$1': scripts/packages.sh [package|windows|macos]" >&2; exit 2 ;;
esac
if ! command -v dpkg-query >/dev/null; then
  echo "This is no Debian or Ubuntu: install ${packages[*]} or their like by hand." >&2
  exit 0
fi
missing=()
for package in "${packages[@]}"; do
  [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0
echo "Installing ${missing[*]}"
as_root=()
[ "$(id -u)" -eq 0 ] || as_root=(sudo)
export DEBIAN_FRONTEND=noninteractive
options=(-o DPkg::Lock::Timeout=600 -y --no-install-recommends)
"${as_root[@]}" apt-get "${options[@]}" install "${missing[@]}" ||
  { "${as_root[@]}" apt-get update && "${as_root[@]}" apt-get "${options[@]}" install "${missing[@]}"; }
