"""Renders one sample scene, under the names that `xrds bench quality` reads: low-resolution colour (lr), full-resolution
auxiliaries (aux), reference (gt); and full-resolution auxiliaries with their noisy colour (full).

blender -b --factory-startup -noaudio -P samples/render.py -- --scene interior --out samples
"""
import argparse
import importlib
import os
import sys
import time

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "scenes"))
import exr  # noqa: E402
import passes  # noqa: E402


def arguments():
    parser = argparse.ArgumentParser(prog="render.py", description=__doc__)
    parser.add_argument("--scene", required=True, choices=("interior", "outdoor", "glossy", "studio"))
    parser.add_argument("--out", required=True, help="folder for the files")
    parser.add_argument("--width", type=int, default=512)
    parser.add_argument("--height", type=int, default=384)
    parser.add_argument("--scale", type=int, default=4, help="full size over low-resolution size")
    parser.add_argument("--samples", type=int, default=64, help="of the low-resolution colour")
    parser.add_argument("--aux-samples", type=int, default=16)
    parser.add_argument("--full-samples", type=int, default=4, help="of the auxiliaries with colour")
    parser.add_argument("--reference-samples", type=int, default=1024)
    parser.add_argument("--kinds", nargs="+", default=("lr", "aux", "gt"), choices=("lr", "aux", "gt", "full"))
    parser.add_argument("--threads", type=int, default=0, help="0: all")
    parser.add_argument("--preview", type=int, default=0, metavar="SAMPLES", help="only a small image NAME_preview.exr")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:])


def timed(path, scene, width, height, samples, seed, keep, at_once=1024, noted=True):
    """Renders, stores and reports; in rounds of `at_once` samples, so that a slow machine leaves a usable file early."""
    begin, mean = time.monotonic(), {}
    for done in range(0, samples, at_once):
        count = min(at_once, samples - done)
        image = passes.render(scene, width, height, count, seed + done // at_once)
        for name in image:
            mean[name] = mean.get(name, 0.0) + (image[name] - mean.get(name, 0.0)) * (count / (done + count))
        exr.write(path, keep(mean), done + count if noted else 0)
        print(f"{os.path.basename(path)}: {width} x {height}, {done + count} spp, {time.monotonic() - begin:.1f} s, "
              f"{os.path.getsize(path) / 1024:.0f} KiB", flush=True)


def main():
    ask = arguments()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    importlib.import_module(ask.scene).build(scene)
    passes.configure(scene, threads=ask.threads)
    os.makedirs(ask.out, exist_ok=True)
    low = ask.width // ask.scale, ask.height // ask.scale
    found = passes.expose(scene, *low)
    print(f"{ask.scene}: log-average luminance {found:.3g} before the last exposure step", flush=True)

    def path(kind):
        return os.path.join(ask.out, f"{ask.scene}_{kind}.exr")

    if ask.preview:
        timed(path("preview"), scene, ask.width, ask.height, ask.preview, 9, passes.colour)
        return
    if "lr" in ask.kinds:
        timed(path(f"lr{ask.samples}"), scene, *low, ask.samples, 1, passes.colour)
    if "aux" in ask.kinds:
        timed(path(f"aux{ask.aux_samples}"), scene, ask.width, ask.height, ask.aux_samples, 2, passes.auxiliaries, noted=False)
    if "full" in ask.kinds:
        timed(path(f"full{ask.full_samples}"), scene, ask.width, ask.height, ask.full_samples, 4, passes.full)
    if "gt" in ask.kinds:
        timed(path("gt"), scene, ask.width, ask.height, ask.reference_samples, 3, passes.colour, at_once=64, noted=False)


main()
