"""Builds and renders random scenes for training, one for each seed; finished ones are skipped.

blender -b --factory-startup -noaudio -P training/scenes/render.py -- --seeds 20000:20100 --out DIR --hdri DIR --models DIR
"""
import argparse
import importlib
import os
import sys
import time
from random import Random

import bpy
import numpy as np

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "..", "samples", "scenes")]
import families  # noqa: E402
import passes  # noqa: E402
import storage  # noqa: E402


def arguments():
    parser = argparse.ArgumentParser(prog="render.py", description=__doc__)
    parser.add_argument("--seeds", required=True, metavar="FIRST:END", help="half-open range")
    parser.add_argument("--stride", type=int, default=1, help="take every n-th seed, for parallel processes")
    parser.add_argument("--out", default=".")
    parser.add_argument("--hdri", default="", help="folder of .exr and .hdr surroundings")
    parser.add_argument("--models", default="", help="folder of .glb models")
    parser.add_argument("--family", choices=families.NAMES, help="only this one")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--lights", action="store_true", help="with the diffuse and glossy light of the full-resolution renders")
    parser.add_argument("--only", metavar="KINDS", default="", help="not every low-resolution and noisy render but these, as lr64,x2lr4,aux4")
    parser.add_argument("--auxiliaries", metavar="SAMPLES", help="the noisy full-resolution renders alone, of these counts, as 1,2,8; "
                        "those that there are not yet")
    parser.add_argument("--preview", type=int, default=0, metavar="SAMPLES", help="only sNNNN_preview.exr, always anew")
    parser.add_argument("--blend", action="store_true", help="only sNNNN.blend, the scene itself, at the resolution of the full render")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:])


def poor(image):
    """Why a first look at a scene speaks against it, or nothing."""
    colour = np.stack([image[name] for name in passes.COMBINED])
    level = np.log2(np.maximum(colour.mean(0), 1e-4))
    depth, albedo = image[passes.DEPTH[0]], np.stack([image[name] for name in passes.ALBEDO]).mean(0)
    edges = np.abs(np.diff(albedo, axis=0)).mean() + np.abs(np.diff(level, axis=0)).mean()
    nearest = np.percentile(depth[depth > 0], 60) if (depth > 0).any() else 0
    if level.std() < 0.45:
        return "flat"
    if (level < -7).mean() > 0.35:
        return "dark"
    if (colour.min(0) > 1).mean() > 0.3:
        return "burnt"
    if edges < 0.1:
        return "empty"
    return "blocked" if nearest < 0.12 else ""


def compose(ask, seed, name):
    """Builds and exposes a scene, anew until a first look approves; returns it."""
    for attempt in range(5):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        random = Random(f"{seed} {attempt}")
        importlib.import_module(f"families.{name}").build(scene, random, ask)
        passes.configure(scene, clamp=random.choice((3.0, 6.0, 10.0)), threads=ask.threads, lights=ask.lights)
        passes.expose(scene, ask.size // 4, ask.size // 4, random.choice((0.1, 0.18, 0.18, 0.25)), 9)
        reason = poor(passes.render(scene, ask.size // 4, ask.size // 4, 9, seed))
        if not reason:
            break
        print(f"s{seed} {name}: {reason}, again", flush=True)
    return scene


def render(ask, seed, scene):
    """All files of a scene, the reference last; returns their bytes."""
    full, total = ask.size, 0
    only = ask.only.split(",") if ask.only else None
    for scale, samples in storage.LOW:
        if only and storage.low_kind(scale, samples) not in only:
            continue
        low = passes.render(scene, full // scale, full // scale, samples, 7 * seed + 10 * scale + samples)
        total += storage.write(ask.out, seed, storage.low_kind(scale, samples), storage.colour(low))
    total += render_auxiliaries(ask, seed, scene, [samples for samples in storage.AUX if not only or f"aux{samples}" in only])
    reference = passes.render(scene, full, full, storage.REFERENCE, 7 * seed + 2000, threshold=0.03)
    return total + storage.write(ask.out, seed, "gt", storage.reference(reference))


def render_auxiliaries(ask, seed, scene, counts):
    """The noisy full-resolution renders of these sample counts; returns their bytes."""
    total = 0
    for samples in counts:
        aux = passes.render(scene, ask.size, ask.size, samples, 7 * seed + 1000 + samples)
        total += storage.write(ask.out, seed, f"aux{samples}", storage.noisy(aux))
    return total


def main():
    ask = arguments()
    first, end = (int(part) for part in ask.seeds.split(":"))
    wanted = [int(count) for count in ask.auxiliaries.split(",")] if ask.auxiliaries else []
    for seed in range(first, end, ask.stride):
        counts = [count for count in wanted if not os.path.exists(storage.path(ask.out, seed, f"aux{count}"))]
        if not ask.preview and not ask.blend and (wanted and not counts or not wanted and storage.finished(ask.out, seed)):
            continue
        begin = time.monotonic()
        name = ask.family or families.NAMES[seed % len(families.NAMES)]
        try:
            scene = compose(ask, seed, name)
        except LookupError as missing:
            print(f"s{seed} {name}: skipped, {missing}", flush=True)
            continue
        built = time.monotonic()
        if ask.blend:
            scene.render.resolution_x = scene.render.resolution_y = ask.size
            os.makedirs(ask.out, exist_ok=True)
            bpy.ops.wm.save_as_mainfile(filepath=os.path.abspath(os.path.join(ask.out, f"s{seed:04d}.blend")), check_existing=False)
            byte_size = 0
        elif ask.preview:
            image = passes.render(scene, ask.size, ask.size, ask.preview, seed)
            byte_size = storage.write(ask.out, seed, "preview", storage.reference(image))
        elif counts:
            byte_size = render_auxiliaries(ask, seed, scene, counts)
        else:
            byte_size = render(ask, seed, scene)
        print(f"s{seed} {name}: built in {built - begin:.0f} s, rendered in {time.monotonic() - built:.0f} s, "
              f"{byte_size / 1024:.0f} KiB", flush=True)


if __name__ == "__main__":
    main()
