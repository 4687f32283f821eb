"""What Cycles is asked for, and the exposure."""
import os
import tempfile

import bpy
import numpy as np

import exr

COMBINED = tuple(f"ViewLayer.Combined.{c}" for c in "RGB")
ALBEDO = tuple(f"ViewLayer.Denoising Albedo.{c}" for c in "RGB")
NORMAL = tuple(f"ViewLayer.Denoising Normal.{c}" for c in "XYZ")
DEPTH = ("ViewLayer.Denoising Depth.Z",)
LIGHTS = tuple(f"ViewLayer.{part}.{c}" for part in ("DiffDir", "DiffInd", "GlossDir", "GlossInd") for c in "RGB")


def configure(scene, clamp=3.0, bounces=8, threads=0, lights=False):
    """The settings every render of a scene shares: no denoiser, no caustics, indirect light clamped. lights: with the passes LIGHTS."""
    scene.render.engine = "CYCLES"
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
    scene.render.image_settings.color_depth = "16"
    scene.render.image_settings.exr_codec = "ZIP"
    scene.render.threads_mode = "FIXED" if threads else "AUTO"
    scene.render.threads = threads or scene.render.threads
    scene.render.use_persistent_data = True
    layer = bpy.context.view_layer
    layer.cycles.denoising_store_passes = True
    layer.use_pass_diffuse_direct = layer.use_pass_diffuse_indirect = lights
    layer.use_pass_glossy_direct = layer.use_pass_glossy_indirect = lights
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_denoising = False
    cycles.max_bounces = bounces
    cycles.diffuse_bounces = min(bounces, 5)
    cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.transparent_max_bounces = 2 * bounces
    cycles.sample_clamp_indirect = clamp
    cycles.blur_glossy = 1.0
    cycles.caustics_reflective = cycles.caustics_refractive = False


def render(scene, width, height, samples, seed, threshold=0.0):
    """Renders and returns every channel Cycles stores; `threshold` > 0 samples adaptively up to `samples`."""
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.cycles.samples, scene.cycles.seed = samples, seed
    scene.cycles.use_adaptive_sampling = threshold > 0
    scene.cycles.adaptive_threshold = threshold
    scene.cycles.adaptive_min_samples = 0
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "render.exr")
        bpy.ops.render.render(write_still=True)
        return exr.read(scene.render.filepath)


def log_average(image):
    """exp(mean(log L)) over pixels with Rec. 709 luminance L > 1e-8; 0 if there are none."""
    red, green, blue = (image[name] for name in COMBINED)
    luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue
    lit = luminance[np.isfinite(luminance) & (luminance > 1e-8)]
    return float(np.exp(np.log(lit).mean())) if lit.size else 0.0


def scale_lights(factor):
    """Multiplies every light, emitting material and world background by `factor`."""
    for light in bpy.data.lights:
        light.energy *= factor
    trees = [owner.node_tree for owner in (*bpy.data.materials, *bpy.data.worlds) if owner.node_tree]
    for tree in trees:
        for node in tree.nodes:
            strength = {"EMISSION": "Strength", "BACKGROUND": "Strength", "BSDF_PRINCIPLED": "Emission Strength"}
            if node.type in strength:
                node.inputs[strength[node.type]].default_value *= factor


def expose(scene, width, height, target=0.18, samples=16):
    """Scales the lights until a small render's log-average luminance is `target`; returns the last one found."""
    for attempt in range(2):  # the second round corrects what the clamp changed
        found = log_average(render(scene, width, height, samples, seed=101 + attempt))
        if not found:
            break
        scale_lights(target / found)
    return found


def colour(image, bits=10):
    """The colour to store, without Cycles' alpha."""
    return {name: exr.rounded(image[name], bits) for name in COMBINED}


def full(image):
    """Colour, albedo and normal to store."""
    return {**colour(image), **auxiliaries(image)}


def auxiliaries(image, albedo_step=1 / 512, normal_step=1 / 512):
    """Albedo and normal to store, on a grid finer than their noise; albedo above 1 (lamps) keeps nine bits."""
    kept = {name: exr.on_grid(image[name], normal_step) for name in NORMAL}
    for name in ALBEDO:
        kept[name] = np.where(image[name] < 1, exr.on_grid(image[name], albedo_step), exr.rounded(image[name], 8))
    return kept
