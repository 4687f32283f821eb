"""Times cold and warm starts: from the start of a process to its first finished frame, in phases.

    python3 bench/startup.py build/release/bench/xrds_bench_network models/xrds-x4-compact.safetensors [--size 1024] [--rounds 5]

Each round starts the program with an empty cache folder (cold), then again with what that left (warm). A process runs
one frame, and the same once more. Medians, in seconds:

    open     process start, device and weights, until the preparation
    prepare  planning, packing and upload of the weights, compilation, recording
    first    the first frame, upload and download included
    again    the second frame: what a frame costs
    beyond   open + prepare + first - again: what the start adds to the frame

The caches, all in one folder (XDG_CACHE_HOME/xrds, here a temporary one): pipelines-DEVICE-DRIVER.bin, the driver's
VkPipelineCache; mesa-wBITS/, Mesa's shader cache for that vector width, on CPUs whose width the engine chooses.
"""
import argparse
import os
import pathlib
import re
import statistics
import subprocess
import tempfile
import time

PHASES = ("open", "prepare", "first", "again", "beyond")
PRINTED = re.compile(r"preparation ([\d.]+) s, first run ([\d.]+) s, steady median ([\d.]+) s")


def start(command, caches):
    """Seconds of each phase of one process, and what it compiled for: the device's line."""
    environment = {**os.environ, "XDG_CACHE_HOME": caches, "MESA_SHADER_CACHE_DIR": str(pathlib.Path(caches) / "mesa")}
    begin = time.perf_counter()
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, env=environment).stdout
    whole = time.perf_counter() - begin
    prepare, first, again = map(float, PRINTED.search(text).groups())
    rest = whole - prepare - first - again
    return (rest, prepare, first, again, rest + prepare + first - again), re.search(r"device (.*)", text)[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="xrds_bench_network of a release build")
    parser.add_argument("models", nargs="+", help="model files")
    parser.add_argument("--size", default="1024", help="side of the output in pixels, or a comma list")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--precision", default="fp32", choices=("fp32", "fp16"))
    arguments = parser.parse_args()
    print(f"{'model':26} {'size':>5} {'':5}" + "".join(f"{phase:>9}" for phase in PHASES) + "   cache MB")
    for model in arguments.models:
        for size in arguments.size.split(","):
            command = [arguments.program, "--model", model, "--size", size, "--runs", "1", "--precision", arguments.precision]
            samples = {"cold": [], "warm": []}
            for _ in range(arguments.rounds):
                with tempfile.TemporaryDirectory() as caches:
                    for kind in samples:
                        phases, device = start(command, caches)
                        samples[kind].append(phases)
                    megabytes = sum(file.stat().st_size for file in pathlib.Path(caches).rglob("*") if file.is_file()) / 1e6
            for kind, rows in samples.items():
                medians = "".join(f"{statistics.median(column):9.3f}" for column in zip(*rows))
                print(f"{pathlib.Path(model).stem:26} {size:>5} {kind:5}{medians} {megabytes:10.1f}", flush=True)
    print(f"on {device}, {os.cpu_count()} processors, {arguments.rounds} rounds")


if __name__ == "__main__":
    main()
