"""Copies a Python package so that its native code sees no AVX-512, for a runtime that has no switch for it, such as ONNX Runtime.

    python3 bench/without_avx512.py PACKAGE FOLDER
    PYTHONPATH=FOLDER python3 bench/peers.py ...

In the copy each `xgetbv`, by which a program asks which registers the system keeps, answers 7: those of SSE and AVX. Needs objdump (binutils).
"""
import argparse
import importlib.util
import pathlib
import re
import shutil
import subprocess

XGETBV = b"\x0f\x01\xd0"
SEVEN = b"\x6a\x07\x58"     # push 7; pop rax


def text_offset(library):
    """What to take off an address in the library's code for its place in the file."""
    listing = subprocess.run(["objdump", "-h", "-j", ".text", library], check=True, capture_output=True, text=True).stdout
    row = re.search(r"\.text\s+\w+\s+(\w+)\s+\w+\s+(\w+)", listing)
    return int(row[1], 16) - int(row[2], 16)


def narrow(library):
    """Changes the file; returns how many places."""
    process = subprocess.Popen(["objdump", "-d", "-j", ".text", "--no-show-raw-insn", library], stdout=subprocess.PIPE, text=True)
    addresses = [int(line.split(":")[0], 16) for line in process.stdout if line.rstrip().endswith("xgetbv")]
    if process.wait():
        raise SystemExit(f"objdump cannot read {library}")
    if not addresses:
        return 0
    offset, code = text_offset(library), bytearray(library.read_bytes())
    for address in addresses:
        place = slice(address - offset, address - offset + len(XGETBV))
        if code[place] != XGETBV:
            raise SystemExit(f"{library}: no xgetbv at {address:#x}")
        code[place] = SEVEN
    library.write_bytes(code)
    return len(addresses)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("package", help="name of an installed package: onnxruntime")
    parser.add_argument("folder", type=pathlib.Path)
    options = parser.parse_args()
    found = importlib.util.find_spec(options.package)
    if found is None or not found.submodule_search_locations:
        raise SystemExit(f"there is no package {options.package}")
    copy = options.folder / options.package
    shutil.copytree(found.submodule_search_locations[0], copy)
    for library in sorted(copy.rglob("*.so*")):
        if places := narrow(library):
            print(f"{library.relative_to(options.folder)}: {places} places")


if __name__ == "__main__":
    main()
