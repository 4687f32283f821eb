"""libxrds exports the public API alone: python3 tests/exports_test.py LIBRARY"""
import re
import subprocess
import sys

PUBLIC = {"Cancelled", "Device", "DeviceLost", "Error", "Examination", "Model", "OutOfMemory", "Upscaler",
          "colourDifference", "estimatedFullShare", "fullShare", "levelledColour", "mergedColour", "mirrored", "mirroredPixel",
          "mirrorsOf", "relativeDepth"}
NAME = re.compile(r"^(?:typeinfo for |typeinfo name for |vtable for )?xrds::(\w+)(?!::State::)")


def exported(library):
    lines = subprocess.run(["nm", "--dynamic", "--demangle", "--defined-only", library], capture_output=True, text=True, check=True).stdout
    return [line.split(" ", 2)[2] for line in lines.splitlines()]


def main():
    names = exported(sys.argv[1])
    foreign = [name for name in names if not (found := NAME.match(name)) or found[1] not in PUBLIC]
    missing = PUBLIC - {found[1] for name in names if (found := NAME.match(name))}
    if foreign or missing:
        sys.exit(f"Exported, but not of the public API: {foreign}\nOf the public API, but not exported: {sorted(missing)}")
    print(f"{len(names)} names, all of the public API")


if __name__ == "__main__":
    main()
