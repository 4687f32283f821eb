"""libxrds exports the C API alone, all that its headers declare, and that is what programs were built with.

    python3 tests/exports_test.py LIBRARY SIZES_PROGRAM

tests/abi/abi.txt has the soname, the functions of the C API, and what tests/abi/sizes.c prints: sizes, places and values,
on a 64-bit system. While the soname stays, lines may be added to it and structures with a structSize may grow; nothing
else may change or go.
"""
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
STORED = HERE / "abi" / "abi.txt"
HEADERS = HERE.parent / "include" / "xrds"
FIXED = {"XrdsImage", "XrdsVulkanImage", "XrdsTimelinePoint"}  # the head of xrds.h says so


def output(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def exported(library):
    """Names without the version of the symbol, and these versions."""
    lines = output("nm", "--dynamic", "--demangle", "--defined-only", "--with-symbol-versions", library).splitlines()
    symbols = [line.split(" ", 2)[2].rsplit("@@", 1) for line in lines if " A " not in line]
    return sorted(symbol[0] for symbol in symbols), {symbol[-1] for symbol in symbols}


def soname(library):
    return re.search(r"SONAME\s+(\S+)", output("objdump", "-p", library))[1]


def declared(pattern):
    """What the headers declare, without their comments."""
    texts = (re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.S) for path in sorted(HEADERS.rglob("*.h")))
    return sorted({name for text in texts for name in re.findall(pattern, text)})


def broken(stored, found):
    """The lines of the stored list with which programs of today would not run."""
    sizes = dict(line.split() for line in found if " " in line)

    def grew(line):
        name, _, size = line.partition(" ")
        return re.fullmatch(r"Xrds\w+", name) and name not in FIXED and int(sizes.get(name, 0)) > int(size)

    return [line for line in stored if line not in set(found) and not grew(line)]


def main():
    library, sizes = sys.argv[1:]
    names, versions = exported(library)
    functions = declared(r"XRDS_API [^;]*?\b(xrds[A-Z]\w*)\(")
    if names != functions:
        sys.exit(f"Exported, but not declared: {sorted(set(names) - set(functions))}\n"
                 f"Declared, but not exported: {sorted(set(functions) - set(names))}")
    if versions != {"XRDS_0"}:
        sys.exit(f"Symbols have the versions {sorted(versions)}, expected XRDS_0")
    found = [soname(library), *names, *output(sizes).splitlines()]
    if unlisted := set(declared(r"typedef struct (Xrds\w+) \{")) - {line.split()[0] for line in found}:
        sys.exit(f"tests/abi/sizes.c lacks {sorted(unlisted)}")
    stored = STORED.read_text().splitlines()
    if gone := broken(stored, found):
        sys.exit(f"Programs that were built before would break, which a new soname must tell: {gone}")
    if found != stored:
        sys.exit("The C API has more than tests/abi/abi.txt; it is now\n" + "\n".join(found))
    print(f"{len(names)} functions of the C API in {found[0]}, and no other name")


if __name__ == "__main__":
    main()
