# SPDX-License-Identifier: GPL-3.0-or-later
"""What the renders of a frame are asked for: two, or at scale 1 a single one."""
from . import guides
from .recorder import COLOUR_SETTINGS

# Flags of a view layer whose passes hold light: they come from the low-resolution render.
LIGHT_FLAGS = tuple(f"use_pass_{kind}_{part}" for kind in ("diffuse", "glossy", "transmission", "subsurface", "volume") for part in ("direct", "indirect")) + (
    "use_pass_emit", "use_pass_environment")
MOTION_FLAGS = {"Vector": "use_pass_vector", "Depth": "use_pass_z"}  # by what frames are merged


def single(settings):
    """Whether one render is all: colour and guides."""
    return settings.scale == "1"


def renders(settings):
    """[(kind, function that configures it, what the artist reads)] of a frame."""
    return [("full", configure_full, "Render")] if single(settings) else [("low", configure_low, "Colour"), ("full", configure_full, "Guides")]


def samples(settings):
    """(of the colour, of the guides)"""
    return settings.samples, settings.samples if single(settings) else settings.guide_samples


def _objects(scene):
    """Those of the scene, and of the collections that it has instances of."""
    for item in scene.objects:
        yield item
        if item.instance_collection:
            yield from item.instance_collection.all_objects


def shows_shadows(scene):
    """Whether what the result takes from the guides' render shows shadows: alpha or the pass of shadow catchers, and Blender 3.4's Shadow."""
    layers = scene.view_layers
    catching = scene.render.film_transparent or any(layer.cycles.use_pass_shadow_catcher for layer in layers)
    catchers = (item for item in _objects(scene) if item.is_shadow_catcher and item.type != "LIGHT")  # lights have the flag for what they light
    return any(layer.use_pass_shadow for layer in layers) or catching and any(not item.hide_render for item in catchers)


def cheap(settings):
    """Whether the guides are rendered without light."""
    return not single(settings) and settings.guides == "CHEAP" and not shows_shadows(settings.id_data)


def has_light(settings):
    """Whether the guides bring light of their own, to be merged into the colour."""
    return not single(settings) and not cheap(settings)


def size(scene, scale):
    """(width, height) of the low-resolution render: of the scene's size, rounded up to whole multiples of the scale."""
    render = scene.render
    return tuple(-(-(side * render.resolution_percentage // 100) // scale) for side in (render.resolution_x, render.resolution_y))


def flags(layer):
    """(owner, name) of the switches of its passes; Cycles has some of its own."""
    return [(owner, name) for owner in (layer, layer.cycles) for name in dir(owner) if name.startswith("use_pass_")]


def _configure(scene, width, height, samples, path, put, keep):
    """What both renders share: nothing filters or replaces the passes, and they are stored as they are."""
    render, cycles = scene.render, scene.cycles
    keep(render.image_settings)
    settings = render.image_settings
    for name in COLOUR_SETTINGS:
        if hasattr(settings, name):
            keep(getattr(settings, name))
    if hasattr(settings, "media_type"):  # Blender 5
        put(settings, "media_type", "MULTI_LAYER_IMAGE")
    put(settings, "file_format", "OPEN_EXR_MULTILAYER")
    put(settings, "color_depth", "32")
    put(settings, "exr_codec", "NONE")
    for name, value in {"use_exr_interleave": True, "use_preview": False, "color_management": "FOLLOW_SCENE"}.items():
        if hasattr(settings, name):
            put(settings, name, value)
    for name, value in {
        "resolution_x": width, "resolution_y": height, "resolution_percentage": 100, "use_border": False, "use_compositing": False, "use_sequencer": False, "use_freestyle": False, "use_stamp": False,
        "use_file_extension": False, "use_overwrite": True, "use_placeholder": False, "filepath": path,
    }.items():
        put(render, name, value)
    for name, value in {"samples": samples, "use_adaptive_sampling": False, "use_denoising": False, "time_limit": 0}.items():
        put(cycles, name, value)
    if hasattr(cycles, "use_sample_subset"):  # newer Blenders
        put(cycles, "use_sample_subset", False)
    for layer in scene.view_layers:
        put(layer, "samples", 0)  # those of the scene


def configure_low(scene, settings, path, recorder, merges=False):
    """The colour: light passes alone, with the colours that multiply them. merges: frames are merged with each other, so each needs noise of its own."""
    if merges:
        recorder.put(scene.cycles, "use_animated_seed", True)
    _configure(scene, *size(scene, int(settings.scale)), settings.samples, path, recorder.put, recorder.keep)
    for layer in scene.view_layers:
        recorder.put(layer.cycles, "denoising_store_passes", False)
        for owner, flag in flags(layer):
            if flag == MOTION_FLAGS["Vector"]:  # as in the guides: Cycles 3.4 draws some textures otherwise with it
                recorder.put(owner, flag, merges or getattr(owner, flag))
            elif flag not in LIGHT_FLAGS:
                recorder.put(owner, flag, flag == "use_pass_combined")
        _with_colours(layer, recorder.put)


def configure_full(scene, settings, path, recorder, merges=False):
    """The guides: every pass but light, which a path-traced one has in its Combined alone; to merge frames, those that tell how they move, too. At scale 1
    the only render, with its light."""
    if merges:
        recorder.put(scene.cycles, "use_animated_seed", True)
    scale = int(settings.scale)
    width, height = size(scene, scale)
    if cheap(settings):
        guides.apply("mirrors", scene, recorder.put)
    _configure(scene, scale * width, scale * height, samples(settings)[1], path, recorder.put, recorder.keep)
    for layer in scene.view_layers:
        recorder.put(layer.cycles, "denoising_store_passes", True)
        recorder.put(layer, "use_pass_combined", True)
        _with_colours(layer, recorder.put)
        for owner, flag in flags(layer):
            if not single(settings) and flag in LIGHT_FLAGS:
                recorder.put(owner, flag, False)
        for flag in MOTION_FLAGS.values() if merges else ():
            recorder.put(layer, flag, True)


def _with_colours(layer, put):
    for kind in ("diffuse", "glossy", "transmission", "subsurface"):
        parts = [getattr(layer, f"use_pass_{kind}_{part}", False) for part in ("direct", "indirect")]
        if any(parts):
            put(layer, f"use_pass_{kind}_color", True)
