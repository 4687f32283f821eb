# SPDX-License-Identifier: GPL-3.0-or-later
"""What the artist chooses, kept in the scene."""
import functools
import zlib

import bpy

AUTO = "AUTO"


@functools.lru_cache(maxsize=None)
def _devices():
    """Enum items; Blender needs them alive. Their numbers are of the device itself: a list in other order changes nothing."""
    items = [(AUTO, "Automatic", "The fastest device", 0)]
    try:
        import xrds

        items += [(found.uuid, found.name, f"{found.kind}, {found.driver}", _number(found.uuid)) for found in xrds.devices()]
    except (ImportError, RuntimeError):  # the first is reported by the panel, the second when rendering
        pass
    return items


@functools.lru_cache(maxsize=None)
def device_problem():
    """Why nothing can be upscaled on this machine, as a sentence; None: there is a device."""
    import xrds

    try:
        found = xrds.devices()
    except RuntimeError as error:
        return str(error)
    return None if found else "No Vulkan device was found. Install the driver of your GPU, or Mesa's lavapipe to use the processor, and start Blender again."


@functools.lru_cache(maxsize=None)
def _models(scale):
    items = [(AUTO, "Automatic", "The model that suits samples and guides", 0)]
    try:
        import xrds

        items += [(name, name.replace(f"xrds-x{scale}-", ""), name, _number(name)) for name in xrds.models() if name.startswith(f"xrds-x{scale}-") and _usable(xrds.Model(name))]
    except (ImportError, RuntimeError):
        pass
    return items


def _usable(model):
    """Whether the two renders have what it takes."""
    return set(model.inputs) <= {"albedo", "normal", "colour"}


@functools.lru_cache(maxsize=None)
def needs_light(model):
    """Whether a model takes the colour of the full-resolution render."""
    import xrds

    return "colour" in xrds.Model(model).inputs


def _number(text):
    return zlib.crc32(text.encode()) & 0x7FFFFFFF


class XRDS_Settings(bpy.types.PropertyGroup):
    scale: bpy.props.EnumProperty(
        name="Scale", description="Sides of the result over those of the low-resolution render", default="4",
        items=[("1", "1x", "A single render of the full resolution, whose noise is taken out"), ("2", "2x", "Most detail"), ("4", "4x", "The usual choice"),
               ("8", "8x", "Fastest, least detail")])
    samples: bpy.props.IntProperty(name="Samples", description="Of a pixel of the render that brings the light: that of low resolution, or the only one", default=64, min=1, max=65536)
    guides: bpy.props.EnumProperty(
        name="Guides", description="How albedo and normals of the full resolution are rendered", default="CYCLES",
        items=[("CYCLES", "Path Traced", "With all light: its colour is merged into the result, which is better"),
               ("CHEAP", "Cheap", "Without light, behind mirrors and glass too: about a third of the time")])
    guide_samples: bpy.props.IntProperty(name="Guides' Samples", description="Of a pixel of the full-resolution render", default=16, min=1, max=4096)
    steady: bpy.props.BoolProperty(
        name="Stable over Time", description="Animations: merge each frame with up to five before and five after it, along the motion of the Vector pass", default=True)
    denoise: bpy.props.BoolProperty(
        name="Denoise First", description="Open Image Denoise takes the noise out of the renders before the network does its work", default=True)
    model: bpy.props.EnumProperty(name="Model", description="The network that upscales", items=lambda settings, context: _models(int(settings.scale)))
    device: bpy.props.EnumProperty(name="Device", description="The Vulkan device that upscales", items=lambda settings, context: _devices())
