# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of renders: their view layers, and what passes mean. Needs numpy only."""
import os
import struct
import zlib

import numpy as np

from . import exr

# Light by the names of its passes: short ones before Blender 5, long ones from there on.
LIGHTS = frozenset(
    [f"{kind}{part}" for kind in ("Diff", "Gloss", "Trans", "Subsurface", "Volume") for part in ("Dir", "Ind")]
    + [f"{kind} {part}" for kind in ("Diffuse", "Glossy", "Transmission", "Subsurface", "Volume") for part in ("Direct", "Indirect")]
    + ["Emit", "Emission", "Env", "Environment"])
COLOURS = frozenset([f"{kind}Col" for kind in ("Diff", "Gloss", "Trans", "Subsurface")] + [f"{kind} Color" for kind in ("Diffuse", "Glossy", "Transmission", "Subsurface")])
LIGHT_GROUP = "Combined_"


def is_light(name):
    """Whether a pass is upscaled as light. The others are data of the full-resolution render."""
    return name in LIGHTS or name.startswith(LIGHT_GROUP)


def is_colour(name):
    """Whether a pass multiplies lights."""
    return name in COLOURS


class Damaged(RuntimeError):
    """A file of a render that is not whole, as when the disk was full."""


class Missing(RuntimeError):
    """A view layer that only one of two renders has."""


def load(path):
    """A render's file as an exr.Picture. Raises OSError, and Damaged: then it is removed, to be rendered again when an animation goes on."""
    try:
        return exr.load(path)
    except (ValueError, IndexError, KeyError, struct.error, zlib.error) as error:
        os.remove(path)
        raise Damaged(f"The render {path} is damaged: {error}. Is there room on the disk?") from error


class Layer:
    """The passes of a view layer in a file: {pass: {component: channel}}."""

    def __init__(self, picture, name):
        self.name = name
        self.passes = {}
        for channel in picture.channels:
            rest, _, component = channel.rpartition(".")
            layer, _, found = rest.rpartition(".")  # names of layers may have dots, as "Front.001", those of passes have none
            if layer == name:
                self.passes.setdefault(found, {})[component] = channel


def stack(picture, channels, components):
    """[height, width, components] of float32, or None where the pass is missing."""
    if not channels or any(one not in channels for one in components):
        return None
    return np.stack([picture.channels[channels[one]] for one in components], -1).astype(np.float32, copy=False)


def layer_of(picture, name):
    """The view layer of this name; Missing where the file has none."""
    for layer in layers_of(picture, [name]):
        return layer
    raise Missing(f"The view layer '{name}' was renamed or deleted after its colour was rendered, so that its guides are missing. Render it again.")


def layers_of(picture, names):
    """The view layers that a file has, of these names."""
    found = [Layer(picture, name) for name in names]
    return [layer for layer in found if "Combined" in layer.passes]
