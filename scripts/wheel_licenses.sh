#!/usr/bin/env bash
# Puts the licences of what a wheel is made of into it, as these ask for: scripts/wheel_licenses.sh WHEEL ... They are those of the
# libraries that auditwheel put beside it, and of those that are compiled into it. scripts/wheel.sh calls it with its tools, `wheel` and nanobind.
set -euo pipefail
cd "$(dirname "$0")/.."
compiled=(nlohmann-json3-dev libcli11-dev libvulkan-volk-dev)
nanobind=$(python -c 'import importlib.metadata as m; print(next(f.locate() for f in m.files("nanobind") if f.name == "LICENSE"))')
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for made; do
  wheel unpack --dest "$work" "$made" > /dev/null
  unpacked=("$work"/xrds-*)
  licenses=("${unpacked[0]}"/*.dist-info/licenses)
  packages=("${compiled[@]}")
  for library in "${unpacked[0]}"/xrds.libs/*; do
    name=$(basename "$library" | sed -E 's/-[0-9a-f]{8}\.so/.so/')  # auditwheel adds a hash
    packages+=("$(dpkg-query -S "*/$name" | sed -n 1p | cut -d: -f1)")
  done
  for package in $(printf '%s\n' "${packages[@]}" | sort -u); do cp -L "/usr/share/doc/$package/copyright" "${licenses[0]}/$package.txt"; done
  cp "$nanobind" "${licenses[0]}/nanobind.txt"
  wheel pack --dest-dir "$(dirname "$made")" "${unpacked[0]}" > /dev/null
  rm -rf "${unpacked[0]}"
done
