#!/usr/bin/env bash
# Installs the packages that scripts/package.sh made in a fresh root of this Debian, and runs them: try_packages.sh OUT.
# Needs root, mmdebstrap and Debian's mirror. What runs there: the command, an upscaled sample, a program in C.
set -euo pipefail
cd "$(dirname "$0")/.."
out=$1
root=$(mktemp -d)
log=$root.txt
trap 'rm -rf --one-file-system "$root" "$log"' EXIT
. /etc/os-release
echo "A fresh root of $VERSION_CODENAME, with the packages"
# apt is asked for the rest while mmdebstrap still has its lists and its way to the mirror.
mmdebstrap --quiet --variant=apt --include=mesa-vulkan-drivers,gcc,libc6-dev,pkg-config \
  --customize-hook="mkdir \"\$1/packages\" && cp $(printf '%q ' "$out"/*.deb samples/outdoor_*.exr) \"\$1/packages\"" \
  --customize-hook='chroot "$1" sh -c "apt-get -q -y --no-install-recommends install /packages/*.deb"' \
  "$VERSION_CODENAME" "$root" > "$log" 2>&1 || { cat "$log"; exit 1; }
# With a /proc of its own, by which programs find their folder.
in_root() { unshare --mount --pid --fork --mount-proc="$root/proc" chroot "$root" env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/root DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }

run() { echo "$ xrds $*"; in_root xrds "$@"; }
run --version
run devices
run info | tr '\n' ' '
echo
run upscale /packages/outdoor_lr64.exr /packages/outdoor_aux16.exr -o /out.exr --model xrds-x4-nano --quiet
run compare /out.exr /packages/outdoor_gt.exr
in_root sh -c 'xrds-view --help' | sed -n 1p
for file in share/man/man1/xrds.1.gz share/bash-completion/completions/xrds share/zsh/vendor-completions/_xrds \
  share/fish/vendor_completions.d/xrds.fish share/xrds/models/xrds-x4-nano.md share/doc/xrds/copyright; do
  [ -s "$root/usr/$file" ] || { echo "/usr/$file is missing"; exit 1; }
done

echo "A program in C against libxrds-dev"
in_root sh -c 'cc /usr/share/doc/libxrds-dev/examples/upscale.c $(pkg-config --cflags --libs xrds) -o /upscale'
in_root sh -c 'set -e; for header in xrds xrds_report xrds_examine xrds_vulkan; do echo "#include <xrds/$header.h>" | cc -fsyntax-only -xc -; done'
c++ -std=c++17 tests/consumer/frames.cpp -static -o "$root/frames"
mkdir "$root/pictures"
in_root /frames write /pictures
in_root /upscale xrds-x4-nano /pictures/colour.pfm /pictures/albedo.pfm /pictures/normal.pfm /pictures/result.pfm
in_root /frames check /pictures

echo "The archive, unpacked"
mkdir "$root/archive"
tar -xJf "$out"/xrds-*.tar.xz -C "$root/archive" --strip-components=1
in_root /archive/bin/xrds upscale /packages/outdoor_lr64.exr /packages/outdoor_aux16.exr -o /archive.exr --model xrds-x4-nano --quiet
cmp "$root/out.exr" "$root/archive.exr"
in_root sh -c 'apt-get -q -y purge xrds libxrds-dev "libxrds0*" xrds-models' > "$log" 2>&1 || { cat "$log"; exit 1; }
left=$(find "$root/usr" -name '*xrds*')
[ -z "$left" ] || { echo "Left behind: $left"; exit 1; }
echo "Installed, ran and removed without a trace"
