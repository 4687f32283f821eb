"""Renders frames that are half or more background, to measure `xrds upscale --skip` on.

blender -b --factory-startup -noaudio -P bench/skip_scenes.py -- --scene sky --out DIR
Writes NAME_lr64.exr (colour at a quarter of the size; NAME_x2lr64.exr and so on for --scale 2), NAME_aux16.exr and NAME_gt.exr, as
`xrds bench quality` reads them.
"""
import argparse
import math
import os
import sys
import time
from random import Random

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "samples", "scenes"))
import exr  # noqa: E402
import outdoor  # noqa: E402
import passes  # noqa: E402
import studio  # noqa: E402
from shading import plain, plaster, wood, world  # noqa: E402
from shapes import box, light, look, mesh, place, sheet_mesh  # noqa: E402


def clear(scene):
    g = world(scene)
    air = g.add("TexSky", {}, sky_type="NISHITA", sun_disc=False, sun_elevation=math.radians(38), sun_rotation=2.2)
    g.finish(g.add("Background", {"Color": air, "Strength": 0.12}))


def blocks():
    """Weathered blocks and posts on rough ground, below a wide sky."""
    random = Random(5)
    ground = sheet_mesh("ground", 160, 160, (200, 200), lambda x, y: outdoor.lie(x, y + 70), outdoor.ground())
    place("ground", ground, (0, 70, -0.1))
    walls = [plaster(f"wall{i}", colour) for i, colour in enumerate(((0.6, 0.52, 0.4), (0.45, 0.2, 0.13), (0.3, 0.35, 0.38)))]
    timber = wood("timber", (0.1, 0.06, 0.03), (0.4, 0.28, 0.16), scale=2, roughness=0.8)
    for i in range(16):
        x, y = random.uniform(-14, 14), random.uniform(8, 40)
        size = [random.uniform(0.5, 2.2) for _ in range(3)]
        box(f"block{i}", size, (x, y, size[2] / 2), random.choice(walls), (0, 0, random.uniform(0, 3)), 0.03)
        box(f"post{i}", (0.1, 0.1, 2.0), (x + 1.7, y - 1, 0.8), timber, (0, 0, random.uniform(0, 3)), 0.01)
    light("SUN", (-30, -13, 20), (0, 0, 0), 3.2, (1.0, 0.88, 0.7), 0.0095)
    look((0, -4, 1.6), (0, 20, 5.2), 32)


def sky(scene):
    clear(scene)
    blocks()


def clouds(scene):
    outdoor.sky(scene, 31, 247)
    blocks()


def filled(scene):
    """The backdrop of the sample, with the wares filling the middle."""
    studio.even(scene, (0.25, 0.27, 0.3), 0.3)
    studio.wares()


def sweep(scene):
    """The wares on a white sweep: background of lit geometry, as noisy as the rest."""
    studio.even(scene, (0.5, 0.5, 0.5), 0.5)
    bend = [(y, 0.0) for y in range(-9, 4)] + [(4 + 2.5 * math.sin(a / 16 * math.pi), 2.5 - 2.5 * math.cos(a / 16 * math.pi)) for a in range(9)]
    bend += [(6.5, 2.5 + z) for z in (1, 4, 9)]
    points = [(x, y, z) for y, z in bend for x in (-14, 14)]
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(bend) - 1)]
    place("sweep", mesh("sweep", points, faces, plain("paper", (0.75, 0.75, 0.76), 0.9), smooth=True))
    studio.wares()


SCENES = {"sky": sky, "clouds": clouds, "studio": filled, "sweep": sweep}


def arguments():
    parser = argparse.ArgumentParser(prog="skip_scenes.py", description=__doc__)
    parser.add_argument("--scene", required=True, choices=SCENES)
    parser.add_argument("--out", required=True)
    parser.add_argument("--width", type=int, default=1024)
    parser.add_argument("--height", type=int, default=576)
    parser.add_argument("--scale", type=int, default=4, help="of the colour")
    parser.add_argument("--reference-samples", type=int, default=512)
    parser.add_argument("--kinds", nargs="+", default=("lr", "aux", "gt"), choices=("lr", "aux", "gt"))
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:])


def main():
    ask = arguments()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    SCENES[ask.scene](scene)
    passes.configure(scene)
    passes.expose(scene, ask.width // 4, ask.height // 4)     # whatever the scale, so that all pictures of a scene agree
    os.makedirs(ask.out, exist_ok=True)

    def store(kind, width, height, samples, seed, keep, threshold=0.0):
        begin = time.monotonic()
        exr.write(os.path.join(ask.out, f"{ask.scene}_{kind}.exr"), keep(passes.render(scene, width, height, samples, seed, threshold)))
        print(f"{ask.scene}_{kind}: {samples} spp, {time.monotonic() - begin:.1f} s", flush=True)

    if "lr" in ask.kinds:
        kind = "lr64" if ask.scale == 4 else f"x{ask.scale}lr64"
        store(kind, ask.width // ask.scale, ask.height // ask.scale, 64, 1, passes.colour)
    if "aux" in ask.kinds:
        store("aux16", ask.width, ask.height, 16, 2, passes.auxiliaries)
    if "gt" in ask.kinds:
        store("gt", ask.width, ask.height, ask.reference_samples, 3,
              lambda image: {**passes.colour(image), **passes.auxiliaries(image)}, threshold=0.015)


main()
