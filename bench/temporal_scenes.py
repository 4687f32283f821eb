"""Renders the sequences that bench/temporal.py measures `xrds upscale --temporal` on. What is there already is left out.

blender -b --factory-startup -noaudio -P bench/temporal_scenes.py -- --out DIR --hdri DIR [--frames 8] [--sequences still pan]

Writes DIR/SEQUENCE/low.NNNN.exr (colour at a quarter of the size, 16 samples), guides.NNNN.exr (colour, albedo, normal, depth and Vector, 4 samples),
full.NNNN.exr (a full-resolution render of as many samples as both together: 5) and reference.NNNN.exr. Scenes are those of training/scenes, of seeds that
no training saw. The sequence `cut` is not rendered: its frames are those of `orbit`, then those of `pan`.
"""
import argparse
import math
import os
import sys
import time
from random import Random

import bpy
from mathutils import Matrix, Vector

sys.dont_write_bytecode = True
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
sys.path[:0] = [os.path.join(ROOT, "training", "scenes"), os.path.join(ROOT, "samples", "scenes")]
import exr  # noqa: E402
import passes  # noqa: E402
import render as generator  # noqa: E402

MOTION = tuple(f"ViewLayer.Vector.{c}" for c in "XYZW")
LOW, GUIDES, FULL = 16, 4, 5      # samples a pixel
LENGTH = 24                       # frames that the animations are made for


def linear(owner, path, first, last):
    """Animates a property from one value at frame 1 to another at frame LENGTH, in a straight line."""
    for frame, value in ((1, first), (LENGTH, last)):
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)
    for curve in owner.id_data.animation_data.action.fcurves:
        for key in curve.keyframe_points:
            key.interpolation = "LINEAR"
        curve.extrapolation = "LINEAR"


def still(scene, random):
    pass


def pan(scene, random):
    camera = scene.camera
    turn = camera.rotation_euler.copy()
    turn.z += math.radians(22)
    linear(camera, "rotation_euler", camera.rotation_euler.copy(), turn)


def orbit(scene, random, degrees=26):
    """Around the point that the camera looks at, in the distance of what it sees there."""
    camera = scene.camera
    bpy.context.view_layer.update()
    ahead = camera.matrix_world.to_quaternion() @ Vector((0, 0, -1))
    hit = scene.ray_cast(bpy.context.evaluated_depsgraph_get(), camera.location, ahead)
    middle = hit[1] if hit[0] else camera.location + 3 * ahead
    pivot = bpy.data.objects.new("pivot", None)
    scene.collection.objects.link(pivot)
    pivot.location = middle
    bpy.context.view_layer.update()
    camera.parent = pivot
    camera.matrix_parent_inverse = Matrix.Translation(middle).inverted()
    linear(pivot, "rotation_euler", (0, 0, 0), (0, 0, math.radians(degrees)))


def moving(scene, random):
    """Every second thing walks and turns; some bend while they do."""
    things = [o for o in scene.objects if o.type == "MESH" and max(o.dimensions) < 1.0 and o.name.startswith("thing")]
    for number, thing in enumerate(things):
        if number % 2:
            continue
        reach = 2.5 * max(thing.dimensions)
        angle = random.uniform(0, math.tau)
        linear(thing, "location", thing.location.copy(), thing.location + reach * Vector((math.cos(angle), math.sin(angle), 0.2)))
        turn = thing.rotation_euler.copy()
        turn.z += random.choice((-2, 2))
        linear(thing, "rotation_euler", thing.rotation_euler.copy(), turn)
        if number % 4 == 0:
            bend = thing.modifiers.new("bend", "SIMPLE_DEFORM")
            bend.deform_method, bend.deform_axis = "TWIST", "Z"
            linear(bend_owner(thing), '["twist"]', -1.0, 1.0)
            driver = bend.driver_add("angle").driver
            variable = driver.variables.new()
            variable.name, variable.targets[0].id, variable.targets[0].data_path = "twist", thing, '["twist"]'
            driver.expression = "twist"


def bend_owner(thing):
    thing["twist"] = 0.0
    return thing


def light(scene, random):
    """Lamps and world between half and one and a half of their strength; lamps walk."""
    for lamp in [o for o in scene.objects if o.type == "LIGHT"]:
        linear(lamp.data, "energy", 0.5 * lamp.data.energy, 1.5 * lamp.data.energy)
        linear(lamp, "location", lamp.location.copy(), lamp.location + Vector((0.6, -0.4, 0)))
    for node in scene.world.node_tree.nodes:
        if node.type == "BACKGROUND":
            strength = node.inputs["Strength"]
            linear(strength, "default_value", strength.default_value, 0.3 * strength.default_value)


def slow_orbit(scene, random):
    orbit(scene, random, 14)


# Name: family, seed of the scene, what moves.
SEQUENCES = {"still": ("interior", 44000, still), "pan": ("architecture", 44003, pan), "orbit": ("table_top", 44001, orbit), "moving": ("scatter", 44002, moving),
             "light": ("table_top", 44011, light), "thin": ("vegetation", 44004, pan), "glass": ("glass_metal", 44006, slow_orbit)}


def arguments():
    parser = argparse.ArgumentParser(prog="temporal_scenes.py", description=__doc__)
    parser.add_argument("--out", required=True)
    parser.add_argument("--hdri", default="")
    parser.add_argument("--models", default="")
    parser.add_argument("--frames", type=int, default=8)
    parser.add_argument("--sequences", nargs="+", default=list(SEQUENCES), choices=SEQUENCES)
    parser.add_argument("--width", type=int, default=192)
    parser.add_argument("--height", type=int, default=128)
    parser.add_argument("--reference-samples", type=int, default=128)
    parser.add_argument("--threads", type=int, default=1)
    ask = parser.parse_args(sys.argv[sys.argv.index("--") + 1:])
    ask.size, ask.lights = ask.width, False
    return ask


def guides(image):
    return {**passes.colour(image), **{name: image[name] for name in (*passes.ALBEDO, *passes.NORMAL, *passes.DEPTH, *MOTION)}}


def main():
    ask = arguments()
    for number, name in enumerate(ask.sequences):
        family, seed, animate = SEQUENCES[name]
        folder = os.path.join(ask.out, name)
        os.makedirs(folder, exist_ok=True)

        def path(kind, frame):
            return os.path.join(folder, f"{kind}.{frame:04d}.exr")
        if os.path.exists(path("reference", ask.frames)):
            continue
        scene = generator.compose(ask, seed, family)
        bpy.context.view_layer.use_pass_vector = True
        scene.render.use_motion_blur = False
        scene.camera.data.dof.use_dof = False    # the Vector pass knows nothing of it
        animate(scene, Random(seed))
        low = ask.width // 4, ask.height // 4
        full = ask.width, ask.height

        def store(kind, frame, size, samples, keep, threshold=0.0):
            if os.path.exists(path(kind, frame)):
                return
            begin = time.monotonic()
            seeds = {"low": 1, "guides": 2, "full": 3, "reference": 4}
            image = passes.render(scene, *size, samples, 1000 * seed % 1000003 + 10 * frame + seeds[kind], threshold)
            exr.write(path(kind, frame), keep(image))
            print(f"{name} {frame} {kind}: {samples} spp, {time.monotonic() - begin:.1f} s", flush=True)

        for frame in range(1, ask.frames + 1):
            scene.frame_set(frame)
            store("low", frame, low, LOW, passes.colour)
            store("guides", frame, full, GUIDES, guides)
            store("full", frame, full, FULL, lambda image: {**passes.colour(image), **passes.auxiliaries(image)})
            if animate is still and frame > 1:    # one reference, of more samples
                os.symlink(os.path.basename(path("reference", 1)), path("reference", frame))
            else:
                store("reference", frame, full, ask.reference_samples * (4 if animate is still else 1), guides, threshold=0.01)


if __name__ == "__main__":
    main()
