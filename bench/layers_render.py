"""Renders a Blender scene with every light pass, light groups and Cryptomatte, for bench/layers.py and docs/layers.md.

    blender -b SCENE.blend -P bench/layers_render.py -- DIR [--size 384] [--low 64] [--full 16] [--reference 1024]

DIR/low.exr: a quarter of the size to a side, `--low` samples a pixel; DIR/full.exr: the size, `--full` samples;
DIR/reference.exr: the size, `--reference` samples, until the noise is below 0.02. Files that are there stay. 32-bit floats.
"""
import argparse
import os
import sys

import bpy

PASSES = [f"{kind}_{part}" for kind in ("diffuse", "glossy", "transmission") for part in ("direct", "indirect", "color")]
PASSES += ["emit", "environment", "z", "normal", "object_index", "cryptomatte_object", "cryptomatte_material"]


def arguments():
    parser = argparse.ArgumentParser(prog="layers_render.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder")
    parser.add_argument("--size", type=int, default=384)
    parser.add_argument("--low", type=int, default=64)
    parser.add_argument("--full", type=int, default=16)
    parser.add_argument("--reference", type=int, default=1024)
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:])


def configure(scene):
    """Every layer of light, and ids; the world in a light group of its own, all lamps in another."""
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.use_denoising = False
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.image_settings.color_depth = "32"
    scene.render.image_settings.exr_codec = "ZIP"
    scene.render.resolution_percentage = 100
    layer = bpy.context.view_layer
    for name in PASSES:
        setattr(layer, "use_pass_" + name, True)
    layer.cycles.denoising_store_passes = True
    layer.cycles.use_pass_volume_direct = layer.cycles.use_pass_volume_indirect = True
    for name in ("sky", "lamps"):
        layer.lightgroups.add().name = name
    if scene.world:
        scene.world.lightgroup = "sky"
    for index, thing in enumerate(scene.objects):
        thing.pass_index = index
        thing.lightgroup = "lamps"


def render(scene, path, size, samples, seed, threshold=0.0):
    if os.path.exists(path):
        return
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.cycles.samples, scene.cycles.seed = samples, seed
    scene.cycles.use_adaptive_sampling, scene.cycles.adaptive_threshold = threshold > 0, threshold
    scene.render.filepath = path + ".part.exr"
    bpy.ops.render.render(write_still=True)
    os.replace(path + ".part.exr", path)


def main():
    ask = arguments()
    scene = bpy.context.scene
    configure(scene)
    folder = os.path.abspath(ask.folder)
    os.makedirs(folder, exist_ok=True)
    render(scene, os.path.join(folder, "low.exr"), ask.size // 4, ask.low, 1)
    render(scene, os.path.join(folder, "full.exr"), ask.size, ask.full, 2)
    render(scene, os.path.join(folder, "reference.exr"), ask.size, ask.reference, 3, threshold=0.02)


if __name__ == "__main__":
    main()
