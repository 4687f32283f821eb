"""Asserts that every test in C++ is compiled: python3 tests/built_test.py BUILD_FOLDER

A file that no CMakeLists.txt names any more, because its folder moved, say, would be missed by nobody.
"""
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
NO_ROOMS = {"build", ".venv", "examples", "_skbuild"}


def compiled(build):
    """What the build compiles, one by one or several files together."""
    files = {pathlib.Path(command["file"]).resolve() for command in json.loads((build / "compile_commands.json").read_text())}
    for together in build.rglob("Unity/*.cxx"):
        files |= {pathlib.Path(name).resolve() for name in re.findall(r'#include "([^"]+)"', together.read_text())}
    return files


def main():
    rooms = [room for room in ROOT.iterdir() if room.is_dir() and room.name not in NO_ROOMS and not room.name.startswith(".")]
    tests = {file.resolve() for room in rooms for file in room.rglob("*_test.cpp")}
    left_out = sorted(str(file.relative_to(ROOT)) for file in tests - compiled(pathlib.Path(sys.argv[1])))
    if not tests or left_out:
        sys.exit(f"Of {len(tests)} files of tests no program has {', '.join(left_out) or 'any'}.")


if __name__ == "__main__":
    main()
