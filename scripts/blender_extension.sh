#!/usr/bin/env bash
# Makes the extension for Blender, build/blender/xrds_render-VERSION.zip: scripts/blender_extension.sh [PYTHON ...]. It carries the
# wheels of scripts/wheel.sh for these interpreters, by default python3.11 (Blender 3.4 of Debian, 4.2 to 5.0), or those that
# build/wheels has already if XRDS_KEEP_WHEELS is set. Blender 4.2 and newer install the file as an extension, older ones as an add-on.
# The wheel for Python 3.12 and newer is in a file of its own, xrds_render-VERSION-python3.12.zip: Blender 4.2 and newer think that an extension
# with a wheel for one Python is for no other.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -gt 0 ] || set -- python3.11
if [ -z "${XRDS_KEEP_WHEELS:-}" ] || ! ls build/wheels/*.whl > /dev/null 2>&1; then scripts/wheel.sh "$@"; fi
python3 - <<'PYTHON'
import pathlib, re, zipfile
sources, wheels = pathlib.Path("blender/xrds_render"), sorted(pathlib.Path("build/wheels").glob("*.whl"))
version = re.search(r"project\(xrds VERSION ([\d.]+)", pathlib.Path("CMakeLists.txt").read_text())[1]
manifest = (sources / "blender_manifest.toml").read_text()
for stated in (re.search(r'^version = "(.*)"', manifest, re.M)[1], re.search(r'"version": \((.*)\)', (sources / "__init__.py").read_text())[1].replace(", ", ".")):
    assert stated == version, f"The extension says it is {stated}, and CMakeLists.txt {version}"
wheels = {"": [one for one in wheels if "-abi3-" not in one.name], "-python3.12": [one for one in wheels if "-abi3-" in one.name]}


def write(target, wheels):
    listed = ", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels)
    whole = manifest.replace("\n[permissions]", f"platforms = [\"linux-x64\"]\nwheels = [{listed}]\n\n[permissions]")
    part = target.with_suffix(".part")
    with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as made:
        made.writestr("xrds_render/blender_manifest.toml", whole)
        made.write("blender/LICENSE", "xrds_render/LICENSE")
        made.write("LICENSE", "xrds_render/LICENSE-MIT.txt")
        for source in sorted(sources.glob("*.py")):     # links to files of other folders, too
            made.write(source, f"xrds_render/{source.name}")
        for wheel in wheels:
            made.write(wheel, f"xrds_render/wheels/{wheel.name}", zipfile.ZIP_STORED)
    part.replace(target)
    print(target, f"{target.stat().st_size / 1e6:.1f} MB")


folder = pathlib.Path("build/blender")
folder.mkdir(parents=True, exist_ok=True)
for suffix, some in wheels.items():
    target = folder / f"xrds_render-{version}{suffix}.zip"
    target.unlink(missing_ok=True)
    if some:
        write(target, some)
PYTHON
