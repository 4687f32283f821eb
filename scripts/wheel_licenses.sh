#!/usr/bin/env bash
# Puts the licences of the libraries that auditwheel put beside a wheel into it, as these ask for: scripts/wheel_licenses.sh WHEEL ...
# It has those of what is compiled into it (cmake/Licences.cmake). scripts/wheel.sh calls it with its tool `wheel`.
set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for made; do
  wheel unpack --dest "$work" "$made" > /dev/null
  unpacked=("$work"/xrds-*)
  licenses=("${unpacked[0]}"/*.dist-info/licenses)
  packages=()
  for library in "${unpacked[0]}"/xrds.libs/*; do
    name=$(basename "$library" | sed -E 's/-[0-9a-f]{8}\.so/.so/')  # auditwheel adds a hash
    packages+=("$(dpkg-query -S "*/$name" | sed -n 1p | cut -d: -f1)")
  done
  for package in $(printf '%s\n' "${packages[@]}" | sort -u); do cp -L "/usr/share/doc/$package/copyright" "${licenses[0]}/$package.txt"; done
  wheel pack --dest-dir "$(dirname "$made")" "${unpacked[0]}" > /dev/null
  rm -rf "${unpacked[0]}"
done
