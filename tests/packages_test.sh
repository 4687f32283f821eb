#!/usr/bin/env bash
# packages_test.sh BUILD WORK VERSION SOVERSION VIEWER: lets cpack make the archive and Debian's packages of a build, and
# compares what is in them with what should be. 77, skipped, without dpkg-deb. lintian looks on where it is installed.
set -euo pipefail
build=$1 work=$2 version=$3 soversion=$4 viewer=$5
rm -rf "$work"
mkdir -p "$work"
fail() { echo "$*" >&2; exit 1; }

make_package() {
  cpack --config "$build/CPackConfig.cmake" -G "$1" -B "$work" -D CPACK_DEBIAN_COMPRESSION_TYPE=gzip > "$work/log" 2>&1 ||
    { cat "$work/log"; exit 1; }
}
# compare NAME EXPECTED FILES: lists without folders; the library's folder is lib whatever it is.
compare() {
  local found
  found=$(sed -E 's|/lib(64)?(/[a-z0-9_]+-linux-[a-z]+)?/|/lib/|' <<< "$3" | grep -vE '/$|^$' | sort)
  diff <(sort <<< "$2" | grep .) <(echo "$found") || fail "$1 differs from what it should have: < expected, > found"
}

source=$(cd "$(dirname "$0")/.." && pwd)
headers=$(cd "$source/include" && find xrds -type f -printf 'include/%p\n')
models=$(cd "$source/models" && find . -type f \( -name '*.safetensors' -o -name '*.md' -o -name ways.json \) -printf 'share/xrds/models/%P\n')
[ "$(grep -c safetensors <<< "$models")" -eq "$(grep -c 'md$' <<< "$models")" ] || fail "A model has no card"
kind=$(sed -n 's/^CMAKE_BUILD_TYPE:STRING=//p' "$build/CMakeCache.txt" | tr '[:upper:]' '[:lower:]')
library="lib/libxrds.so.$soversion
lib/libxrds.so.$version"
development="$headers
lib/libxrds.so
lib/pkgconfig/xrds.pc
lib/cmake/xrds/xrds-config.cmake
lib/cmake/xrds/xrds-config-version.cmake
lib/cmake/xrds/xrds-config-$kind.cmake"
command="bin/xrds
share/bash-completion/completions/xrds
share/fish/vendor_completions.d/xrds.fish"
programs=
[ "$viewer" = no ] || programs="
bin/xrds-view"

# licences FOLDER PACKAGE...: of what is compiled in, where Debian brought it.
licences() {
  local package folder=$1
  shift
  for package; do [ ! -e "/usr/share/doc/$package/copyright" ] || echo "$folder/licenses/$package.txt"; done
}
of_library=(nlohmann-json3-dev libvulkan-volk-dev)
of_command=("${of_library[@]}" libcli11-dev libopenexr-dev libimath-dev)
[ "$viewer" = no ] || of_command+=(libimgui-dev libassimp-dev libstb-dev)

# examples FOLDER: below a folder of papers.
examples() {
  (cd "$source/examples" && find upscale.c embed_vulkan -type f -printf "$1/examples/%p\n")
}
farms=$(cd "$source/share" && find flamenco openjd slurm -type f -printf 'share/xrds/%p\n')

make_package TGZ
archive=$(tar -tzf "$work"/xrds-"$version"-*.tar.gz | sed 's|^[^/]*/||')
page=
[ "$viewer" = no ] || page="
share/man/man1/xrds-view.1"
compare "The archive" "$library
$development
$models
$command$programs$page
share/man/man1/xrds.1
share/zsh/site-functions/_xrds
share/doc/xrds/LICENSE
$(licences share/doc/xrds "${of_command[@]}")
$farms
$(examples share/doc/xrds)" "$archive"

command -v dpkg-deb > /dev/null || { echo "Debian's packages are not tried: dpkg-deb is not installed"; exit 77; }
make_package DEB
check_deb() {  # check_deb PACKAGE EXPECTED
  local file
  file=$(ls "$work/$1"_"$version"-*.deb)
  compare "$1" "$2
share/doc/$1/copyright
share/doc/$1/changelog.Debian.gz" "$(dpkg-deb --fsys-tarfile "$file" | tar -t | sed 's|^\./usr/||; s|^\./$|/|')"
}
[ "$(find "$work" -maxdepth 1 -name '*.deb' | wc -l)" -eq 4 ] || fail "There should be four packages"
check_deb "libxrds$soversion" "$library
$(licences "share/doc/libxrds$soversion" "${of_library[@]}")"
check_deb libxrds-dev "$development
$(examples share/doc/libxrds-dev)"
check_deb xrds-models "$models"
check_deb xrds "$command$programs${page:+$page.gz}
$(licences share/doc/xrds "${of_command[@]}")
$farms
share/man/man1/xrds.1.gz
share/zsh/vendor-completions/_xrds"
dpkg-deb --field "$work"/libxrds-dev_*.deb Depends | grep -qF "libxrds$soversion (= $version-1)" || fail "libxrds-dev depends on another library"
dpkg-deb --field "$work"/libxrds-dev_*.deb Depends | grep -qF "libvulkan-dev" || fail "libxrds-dev has headers without those that they include"
dpkg-deb --field "$work"/xrds_*.deb Depends | grep -qF "xrds-models (= $version-1)" || fail "xrds depends on other models"
if ! command -v lintian > /dev/null; then
  echo "The lists are right; lintian is not installed"
  exit 0
fi
lintian --allow-root --fail-on error "$work"/*.deb
echo "The lists are right and lintian finds no errors"
