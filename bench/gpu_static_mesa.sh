#!/usr/bin/env bash
# Brings Mesa 25.0 of Debian trixie, whose RADV compiles for GPUs that are not there, with the Vulkan loader and glslang
# into a folder of its own: ${XDG_CACHE_HOME:-~/.cache}/xrds/mesa25, or the one that is named. Installs nothing on the
# host and needs no rights: apt-get and dpkg-deb of any Debian or Ubuntu, 65 MB of packages. Prints the folder.
#
#     bench/gpu_static_mesa.sh [FOLDER]          XRDS_DEBIAN_MIRROR names another mirror
set -euo pipefail
folder=${1:-${XDG_CACHE_HOME:-$HOME/.cache}/xrds/mesa25}
mirror=${XRDS_DEBIAN_MIRROR:-http://deb.debian.org/debian}
packages=(mesa-vulkan-drivers libvulkan1 libc6 libstdc++6 glslang-tools)
if [ -e "$folder/complete" ]; then
  echo "$folder"
  exit 0
fi
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
[ -e "$keyring" ] || { echo "$keyring is missing: install debian-archive-keyring." >&2; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{state/lists/partial,cache/archives/partial,root}
: >"$work/state/status"  # nothing counts as installed
echo "deb [signed-by=$keyring] $mirror trixie main" >"$work/sources.list"
options=(
  -o "Dir::State=$work/state" -o "Dir::State::status=$work/state/status" -o "Dir::Cache=$work/cache"
  -o "Dir::Etc::sourcelist=$work/sources.list" -o Dir::Etc::sourceparts=/dev/null -o "Dir::Etc::preferencesparts=/dev/null"
  -o APT::Install-Recommends=false -o "APT::Sandbox::User=$(id -un)" -o Debug::NoLocking=1
)
apt-get "${options[@]}" -qq update
apt-get "${options[@]}" -qq -y --download-only install "${packages[@]}"
for package in "$work"/cache/archives/*.deb; do dpkg-deb -x "$package" "$work/root"; done
version=$(dpkg-deb -f "$work"/cache/archives/mesa-vulkan-drivers_*.deb Version)
case $version in
  25.0.*) ;;
  *) echo "Debian trixie has Mesa $version, and only 25.0 has been tried." >&2; exit 1 ;;
esac
echo "$version" >"$work/root/complete"
mkdir -p "$(dirname "$folder")"
rm -rf "$folder"
mv "$work/root" "$folder"
echo "$folder"
