# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in the way of a render, as a sentence for the artist."""
import glob
import os
import re
import sys

import bpy

from . import frame, layers, passes, temporal, upscaler
from .settings import AUTO, device_problem, needs_light

LONGEST_NAME = 64  # bytes of a channel in a file of Blender before 5.0, which cuts longer ones
BYTES_PER_PIXEL = 4 * 40  # ten passes of four floats, at full resolution
IMAGE_ENDINGS = frozenset({".exr", ".png", ".jpg", ".jpeg", ".tif", ".tiff", ".hdr", ".bmp", ".tga", ".webp", ".jp2", ".mp4", ".mkv", ".avi", ".mov", ".webm"})


def wheels():
    """Those that the extension carries for this Python."""
    tag = f"-cp{sys.version_info[0]}{sys.version_info[1]}-"
    found = sorted(glob.glob(os.path.join(os.path.dirname(__file__), "wheels", "*.whl")))
    return [wheel for wheel in found if tag in wheel or ("-abi3-" in wheel and sys.version_info >= (3, 12))]


def package_problem():
    try:
        import xrds  # noqa: F401
    except ImportError as error:
        if not wheels():
            return (f"This Blender has Python {sys.version_info[0]}.{sys.version_info[1]}, for which the extension carries no package. "
                    "Make it with one: scripts/blender_extension.sh.")
        return f"The package xrds, which does the work, cannot be loaded: {error}. Install the extension again."
    return None


def _output(scene):
    """(path before the number of the frame, digits of that, path behind it): the last signs # of the name stand for the number, as in Blender."""
    root, ending = os.path.splitext(bpy.path.abspath(scene.render.filepath))
    if ending.lower() not in IMAGE_ENDINGS:
        root += ending
    number = re.search("(#+)([^#]*)$", os.path.basename(root))
    return (root[:-len(number[0])], len(number[1]), number[2]) if number else (root, 4, "")


def output_file(scene, frame):
    """Where the result goes: the scene's output path, with the number of the frame and _xrds."""
    before, digits, behind = _output(scene)
    return os.path.abspath(f"{before}{'-' if frame < 0 else ''}{abs(frame):0{digits}d}{behind}_xrds.exr")


def renders_folder(scene):
    """Where the renders of an animation that is stable over time are kept while they are needed."""
    before, _, behind = _output(scene)
    return os.path.abspath(f"{before}{behind and behind + '_'}xrds_renders")


def _memory():
    """Bytes of this machine; None where it does not tell."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return None


def _scene_problem(scene):
    if scene.render.engine != "CYCLES" or not hasattr(scene, "cycles"):
        return "Choose Cycles as the Render Engine: albedo and normals come from it."
    if scene.camera is None and not any(marker.camera for marker in scene.timeline_markers):
        return "The scene has no camera. Add one with Add > Camera."
    if bpy.data.scenes.get(scene.name) != scene:
        return "This linked scene has the name of a scene of this file, which would be rendered in its place. Rename that one."
    if scene.render.use_multiview:
        return "Stereoscopy is on, and only one view can be upscaled. Switch it off in the Output properties."
    if not any(layer.use for layer in scene.view_layers):
        return "No view layer is used for rendering. Switch one on in the View Layer properties."
    return None


def _name_problem(scene):
    """Channels have the names of view layer, pass and component."""
    if bpy.app.version >= (5, 0):
        return None
    for layer in scene.view_layers:
        names = [frame.LONGEST_PASS, *(aov.name for aov in layer.aovs), *(layers.LIGHT_GROUP + group.name for group in getattr(layer, "lightgroups", ()))]
        longest = max(names, key=lambda name: len(name.encode()))
        if layer.use and len(f"{layer.name}.{longest}.R".encode()) > LONGEST_NAME:
            return (f"The names of view layer '{layer.name}' and its pass '{longest}' are too long: together {LONGEST_NAME - 3} bytes fit into a file of this Blender. "
                    "Choose shorter ones.")
    return None


def _size_problem(scene, settings):
    scale = int(settings.scale)
    width, height = passes.size(scene, scale)
    if min(width, height) < 8:
        return f"The colour would be rendered with {width} x {height} pixels, at least 8 x 8 are needed. Choose a smaller scale or a larger resolution."
    pixel = BYTES_PER_PIXEL + (temporal.BYTES_PER_PIXEL if steady(scene) else 0)
    needed, there = scale * width * scale * height * pixel, _memory()
    if there is not None and needed > there:
        return (f"A frame of {scale * width} x {scale * height} needs about {needed / 1e9:.0f} GB of memory, and this machine has {there / 1e9:.0f} GB. "
                "Choose a smaller resolution.")
    return None


def _output_problem(scene):
    if not scene.render.filepath:
        return "The Output path is empty. Choose one in the Output properties."
    if bpy.app.version >= (4, 5) and "{" in scene.render.filepath:
        return "The Output path has a template in braces, which only Blender's own renders replace. Write it out in the Output properties."
    if scene.render.filepath.startswith("//") and not bpy.data.filepath:
        return "The Output path begins beside the .blend file, which is not saved yet. Save it, or choose another path in the Output properties."
    folder = os.path.dirname(output_file(scene, 0))
    while not os.path.exists(folder) and os.path.dirname(folder) != folder:
        folder = os.path.dirname(folder)
    if not os.path.isdir(folder) or not os.access(folder, os.W_OK):
        return f"Nothing can be written into '{folder}'. Choose another path in the Output properties."
    return None


def _choice_problem(settings):
    if not settings.device:
        return "The chosen device is missing. Choose another one."
    if not settings.model:
        return "The chosen model is missing, or for another scale. Choose another one."
    if settings.model != AUTO and not passes.has_light(settings) and needs_light(settings.model):
        return "The chosen model takes the light of the guides. Choose path-traced guides, or another model."
    return None


def unsteady(scene):
    """Why the frames of an animation are not merged with each other, as a sentence; None: they are."""
    if scene.render.use_motion_blur:
        return "Animations are not stable over time: Cycles has no Vector pass with Motion Blur. Switch that off, or put up with flicker."
    if scene.frame_step != 1:
        return "Animations are not stable over time: the Vector pass leads to the next frame, and the scene's Frame Step leaves frames out."
    return None


def steady(scene):
    """Whether the frames of an animation are merged with those around them."""
    return scene.xrds.steady and unsteady(scene) is None


def problem(scene):
    """The first thing that stands in the way, or None."""
    settings = scene.xrds
    return package_problem() or upscaler.problem() or device_problem() or _scene_problem(scene) or _name_problem(scene) or _size_problem(scene, settings) or _choice_problem(settings) or _output_problem(scene)


def _animated(scene):
    """Whether animation or drivers set what the two renders are asked for."""
    curves, there = [], scene.animation_data
    if there:
        curves.extend(there.drivers)
    if there and there.action and hasattr(there.action, "fcurves"):
        curves.extend(there.action.fcurves)
    elif there and there.action:  # Blender 5
        curves.extend(curve for layer in there.action.layers for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves)
    return any(curve.data_path.startswith(("cycles.", "render.", "view_layers[")) for curve in curves)


def notes(scene):
    """What the result will not be as an artist may expect, as sentences."""
    render, scale = scene.render, int(scene.xrds.scale)
    width, height = (scale * side for side in passes.size(scene, scale))
    asked = tuple(side * render.resolution_percentage // 100 for side in (render.resolution_x, render.resolution_y))
    if scene.render.engine != "CYCLES":
        return
    if (width, height) != asked:
        yield f"Rendered with {width} x {height} pixels: sides are whole multiples of the scale."
    if scene.xrds.steady and unsteady(scene):
        yield unsteady(scene)
    if scene.xrds.guides == "CHEAP" and not passes.single(scene.xrds) and passes.shows_shadows(scene):
        yield "The guides are path-traced: shadows of shadow catchers in alpha, and passes of shadows, are made of light."
    if _animated(scene):
        yield "Render settings are animated or driven: the renders take them as they are, samples and passes, too."
    if render.use_freestyle:
        yield "Freestyle's lines are left out: render them by themselves."
    if render.use_border:
        yield "The render region is ignored: the whole frame is rendered."
    if render.use_compositing and getattr(scene, "compositing_node_group", None) or getattr(scene, "use_nodes", False) and bpy.app.version < (5, 0):
        yield "The compositor does not run: open the result in it."
