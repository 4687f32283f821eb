"""Renders albedo, normal and depth of a Blender file at full resolution, cheaply, for `xrds upscale`.

    blender -b SCENE.blend -P scripts/blender_guides.py -- guides.exr [--samples 16] [--percent 100] [--recipe mirrors]
    xrds upscale colour.exr guides.exr -o result.exr --aux-colour never

The colour comes from a render of the same camera and frame at a quarter or half of the resolution. Cycles writes a colour beside
the passes of its denoising data; without light it is of no use, which --aux-colour never says. The recipes, by what they leave out of a path:

    full       nothing: the scene as it is
    direct     every bounce
    mirrors    light, and every bounce but those of mirrors and glass, behind which the guides show what is seen
    flat       light and every bounce
    eevee      paths: EEVEE's rasterizer. It needs a display and is for GPUs. Its layers must be named, --albedo ViewLayer.DiffCol --normal
               ViewLayer.Normal; metals have no albedo in them, and mirrors and glass show themselves

Shadow catchers have the same albedo, normal and depth in all recipes of Cycles. Their alpha on a transparent film, and passes of shadows, are made of
light: only `full` has them right.

`bench/guides.py` measures their cost and what each does to the result. The .blend file is not changed.
"""
import argparse
import os
import sys
import tempfile
import time

import bpy

RECIPES = ("full", "direct", "mirrors", "flat", "eevee")


def arguments():
    parser = argparse.ArgumentParser(prog="blender_guides.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("output", help="multi-layer EXR file to write")
    parser.add_argument("--samples", type=int, default=16, help="a pixel")
    parser.add_argument("--percent", type=int, default=100, help="of the resolution that the scene states")
    parser.add_argument("--recipe", choices=RECIPES, default="mirrors")
    parser.add_argument("--frame", type=int, help="default: the file's current one")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else ["--help"])


def without_light(scene, put=setattr):
    """No lamp, no surface and no sky is sampled; the sky stays what the camera sees behind the scene. Lamps may be in background scenes and instances."""
    for item in bpy.data.objects:
        if item.type == "LIGHT":
            put(item, "hide_render", True)
    for material in bpy.data.materials:
        if hasattr(material.cycles, "emission_sampling"):
            put(material.cycles, "emission_sampling", "NONE")
        else:       # Blender before 3.5
            put(material.cycles, "sample_as_light", False)
    if scene.world:
        put(scene.world.cycles, "sampling_method", "NONE")


def bounces(scene, glossy, transmission, put=setattr):
    """At most so many of mirrors and of glass, none of other surfaces. Transparent surfaces, such as leaves, stay."""
    limits = {"max": max(glossy, transmission), "diffuse": 0, "volume": 0, "glossy": glossy, "transmission": transmission}
    for kind, limit in limits.items():
        put(scene.cycles, f"{kind}_bounces", limit)
    for kind in ("reflective", "refractive"):
        put(scene.cycles, f"caustics_{kind}", False)


def rasterize(scene, samples):
    """EEVEE, without what only its colour would show."""
    engines = {item.identifier for item in type(scene.render).bl_rna.properties["engine"].enum_items}
    scene.render.engine = "BLENDER_EEVEE_NEXT" if "BLENDER_EEVEE_NEXT" in engines else "BLENDER_EEVEE"
    scene.eevee.taa_render_samples = samples
    for effect in ("use_soft_shadows", "use_shadows", "use_ssr", "use_raytracing", "use_gtao", "use_bloom"):
        if hasattr(scene.eevee, effect):
            setattr(scene.eevee, effect, False)


def apply(recipe, scene, put=setattr):
    """Sets the scene by put(owner, name, value): the extension in blender/ keeps what was there."""
    if recipe in ("mirrors", "flat", "eevee"):
        without_light(scene, put)
    if recipe == "mirrors":
        bounces(scene, min(scene.cycles.glossy_bounces, 4), min(scene.cycles.transmission_bounces, 8), put)
    elif recipe in ("direct", "flat"):
        bounces(scene, 0, 0, put)


def configure(scene, ask):
    """Passes, samples and file; whatever would change or filter the passes goes."""
    scene.render.engine = "CYCLES"
    if ask.recipe == "eevee":
        rasterize(scene, ask.samples)
    scene.render.resolution_percentage = ask.percent
    scene.render.use_compositing = scene.render.use_sequencer = False
    scene.cycles.samples = ask.samples
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.view_layers.update()
    for layer in scene.view_layers:
        layer.cycles.denoising_store_passes = True
        for name in dir(layer):
            if name.startswith("use_pass_"):
                setattr(layer, name, False)
        if ask.recipe == "eevee":
            layer.use_pass_diffuse_color = layer.use_pass_normal = layer.use_pass_z = True
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):     # Blender 5
        settings.media_type = "MULTI_LAYER_IMAGE"
    settings.file_format, settings.color_depth = "OPEN_EXR_MULTILAYER", "16"
    settings.exr_codec = "ZIP"
    scene.render.use_file_extension = False
    scene.render.filepath = os.path.abspath(ask.output)


def cannot_write(output, why):
    return f"blender_guides.py: cannot write {output}: {why}"


def require_folder(output):
    """Ends where the output's folder, or that in which Blender would make it, takes no files: asked before the render."""
    folder = os.path.dirname(os.path.abspath(output))
    while not os.path.exists(folder):
        folder = os.path.dirname(folder)
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        sys.exit(cannot_write(output, error.strerror))


def main():
    ask = arguments()
    require_folder(ask.output)
    scene = bpy.context.scene
    if scene.camera is None:
        sys.exit("blender_guides.py: the scene has no camera")
    if ask.frame is not None:
        scene.frame_set(ask.frame)
    apply(ask.recipe, scene)
    configure(scene, ask)
    start, processor_start = time.monotonic(), time.process_time()
    try:
        bpy.ops.render.render(write_still=True)
    except RuntimeError as error:
        sys.exit(cannot_write(ask.output, str(error).removeprefix("Error: ").splitlines()[0]))
    print(f"blender_guides: {ask.recipe}, {ask.samples} samples, {time.monotonic() - start:.2f} s, {time.process_time() - processor_start:.2f} s "
          f"of processors, {ask.output}", flush=True)


if __name__ == "__main__":
    main()
