"""Converts the kernels to Metal's shading language, as MoltenVK does, as far as that goes without a Mac: python3 scripts/metal_check.py [--build FOLDER] [--keep FOLDER]

Needs spirv-cross (Debian: spirv-cross; $XRDS_SPIRV_CROSS names another) and a build, whose SPIR-V is read.
Nothing is compiled or run. Names each kernel that cannot be converted, each that has an array whose size Metal does not
take: a function constant, or what is computed of one; and each that asks whether a number is finite other than by its bits
(shaders/common/finite.glsl), as Metal's fast-math takes all numbers for finite. Ends with 1 if there are any."""
import argparse
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SPIRV_MAGIC = 0x07230203
NOT_FOR_METAL = re.compile(r"_lane4?_|_matrix_")  # for CPU devices; matrix units, for which MoltenVK has no extension


def spirv_of(header):
    """The words that the build has put into a header, as bytes; nothing if it has none."""
    words = [int(word, 16) for word in re.findall(r"0x([0-9a-fA-F]{8})", header.read_text())]
    return struct.pack(f"<{len(words)}I", *words) if words and words[0] == SPIRV_MAGIC else b""


def converted(spirv, place):
    program = os.environ.get("XRDS_SPIRV_CROSS", "spirv-cross")
    with tempfile.NamedTemporaryFile(suffix=".spv") as file:
        file.write(spirv)
        file.flush()
        done = subprocess.run([*program.split(), "--msl", "--msl-version", "20300", "--msl-texture-buffer-native", file.name, "--output", str(place)],
                              capture_output=True, text=True)
    return done.stderr.strip() or "spirv-cross failed." if done.returncode else ""


def sizes_of_function_constants(source):
    """Names of constants that arrays have as their size, and that are no constants to the compiler."""
    late = set(re.findall(r"^constant \w+ (\w+) \[\[function_constant", source, re.M))
    definitions = re.findall(r"^constant \w+ (\w+)(?: \[\[maybe_unused\]\])? = (.*);$", source, re.M)
    for name, value in definitions:  # each stands behind what it needs
        if late & set(re.findall(r"\w+", value)):
            late.add(name)
    sizes = set(re.findall(r", (\w+)>", source))  # spvUnsafeArray<float4, 3>, or <spvUnsafeArray<float4, 3>, 6>
    for declared in re.findall(r"^\s*threadgroup \w+ \w+((?:\[\w+\])+);", source, re.M):
        sizes |= set(re.findall(r"\w+", declared))
    return sorted(late & sizes)


def tests_of_finiteness(source):
    """Functions that are called to learn whether a number is finite."""
    return sorted(set(re.findall(r"\b(is(?:nan|inf|finite|normal))\(", source)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build" / "release")
    parser.add_argument("--keep", help="a folder for the sources in Metal's language")
    options = parser.parse_args()
    headers = [header for header in sorted((options.build / "shaders").glob("*.h")) if not NOT_FOR_METAL.search(header.stem)]
    kernels = {header.stem: spirv for header in headers if (spirv := spirv_of(header))}
    if not kernels:
        sys.exit(f"There are no kernels in {options.build / 'shaders'}: build it first.")
    faults = []
    with tempfile.TemporaryDirectory() as own:
        folder = pathlib.Path(options.keep or own)
        folder.mkdir(parents=True, exist_ok=True)
        for name, spirv in kernels.items():
            place = folder / f"{name}.metal"
            if problem := converted(spirv, place):
                faults.append(f"{name}: {problem}")
                continue
            source = place.read_text()
            if sizes := sizes_of_function_constants(source):
                faults.append(f"{name}: arrays of size {', '.join(sizes)}")
            if tests := tests_of_finiteness(source):
                faults.append(f"{name}: {', '.join(tests)}, which fast-math takes for known")
    print("\n".join([*faults, f"{len(kernels)} kernels, {len(faults)} with faults"]))
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
