"""libxrds exports the C API alone, and that is what programs were built with.

    python3 tests/exports_test.py LIBRARY SIZES_PROGRAM

tests/abi/abi.txt lists the functions of the C API, then what tests/abi/sizes.c prints: sizes, places and values, on a
64-bit system. A line may be added to it; none may change or go while the number of the soname stays.
"""
import pathlib
import re
import subprocess
import sys

STORED = pathlib.Path(__file__).parent / "abi" / "abi.txt"


def exported(library):
    """Names without the version of the symbol, and these versions."""
    command = ["nm", "--dynamic", "--demangle", "--defined-only", "--with-symbol-versions", library]
    lines = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    symbols = [line.split(" ", 2)[2].rsplit("@@", 1) for line in lines if " A " not in line]
    return [symbol[0] for symbol in symbols], {symbol[-1] for symbol in symbols}


def main():
    names, versions = exported(sys.argv[1])
    functions = sorted(name for name in names if re.fullmatch(r"xrds[A-Z]\w*", name))
    if foreign := [name for name in names if name not in functions]:
        sys.exit(f"Exported, but not of the C API: {foreign}")
    if versions != {"XRDS_0"}:
        sys.exit(f"Symbols have the versions {sorted(versions)}, expected XRDS_0")
    sizes = subprocess.run([sys.argv[2]], capture_output=True, text=True, check=True).stdout.split("\n")
    found = functions + [line for line in sizes if line]
    if found != STORED.read_text().splitlines():
        sys.exit("The C API differs from tests/abi/abi.txt; it is now\n" + "\n".join(found))
    print(f"{len(functions)} functions of the C API, and no other name")


if __name__ == "__main__":
    main()
