#!/usr/bin/env python3
"""How much results of lavapipe differ between vector widths, each in a process and with a cache of its own.

    python3 bench/widths.py build/release/cli/xrds [--models xrds-x4-nano,xrds-x4-compact] [--widths 128,256,512]

Upscales samples/glossy_*.exr with every model, precision and width, twice with the first width. Prints the RMS of the
difference to the first width over the RMS of that, and the largest difference over it, both of log(1 + radiance) as the
networks see it.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "samples" / "scenes"))
import exr  # noqa: E402


def upscaled(arguments, model, precision, width, folder, name):
    """log(1 + radiance) of the upscaled sample [h, w, 3]."""
    output = pathlib.Path(folder) / f"{name}.exr"
    environment = dict(os.environ, LP_NATIVE_VECTOR_WIDTH=width, MESA_SHADER_CACHE_DIR=f"{folder}/cache-{width}")
    subprocess.run([arguments.xrds, "upscale", ROOT / "samples/glossy_lr64.exr", ROOT / "samples/glossy_aux16.exr", "-o", output,
                    "--model", model, "--precision", precision, "--exposure", "1"], env=environment, check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    channels = exr.read(output)
    return np.log1p(np.stack([channels[c] for c in "RGB"], -1).astype(np.float64).clip(0))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("xrds")
    parser.add_argument("--models", default="xrds-x4-nano,xrds-x4-compact")
    parser.add_argument("--widths", default="128,256,512")
    arguments = parser.parse_args()
    first, *others = arguments.widths.split(",")
    with tempfile.TemporaryDirectory() as folder:
        for model in arguments.models.split(","):
            for precision in ("fp32", "fp16"):
                start = upscaled(arguments, model, precision, first, folder, "first")
                rms = np.sqrt((start ** 2).mean())
                for width in [first] + others:
                    difference = upscaled(arguments, model, precision, width, folder, "other") - start
                    print(f"{model} {precision} {first} to {width}: RMS {np.sqrt((difference ** 2).mean()) / rms:.1e}, "
                          f"largest {np.abs(difference).max() / rms:.1e}", flush=True)


if __name__ == "__main__":
    main()
