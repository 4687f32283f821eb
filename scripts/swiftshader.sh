#!/usr/bin/env bash
# Brings SwiftShader, a second Vulkan device in software, out of Debian's chromium-common into a folder of its own:
# ${XDG_CACHE_HOME:-~/.cache}/xrds/swiftshader, or the one that is named. Installs nothing on the host; prints what to set.
# A build configured with -DXRDS_SWIFTSHADER_TESTS=ON afterwards has the tests swiftshader.* (slow: up to 50 minutes).
#
#     scripts/swiftshader.sh [FOLDER]
set -euo pipefail
case ${1:-} in -*) sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2 ;; esac
folder=${1:-${XDG_CACHE_HOME:-$HOME/.cache}/xrds/swiftshader}
icd=$folder/vk_swiftshader_icd.json
if [ ! -e "$icd" ]; then
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  (cd "$work" && apt-get -o "APT::Sandbox::User=$(id -un)" -qq download chromium-common && dpkg-deb -x chromium-common_*.deb .)
  mkdir -p "$folder"
  cp "$work"/usr/lib/chromium/libvk_swiftshader.so "$folder"
  cp "$work"/usr/lib/chromium/vk_swiftshader_icd.json "$folder"
fi
echo "VK_DRIVER_FILES=$icd VK_ICD_FILENAMES=$icd"
