# SPDX-License-Identifier: GPL-3.0-or-later
"""From the files of the renders to that of the result. Runs in the process of worker.py, without Blender."""
from typing import NamedTuple, Optional

import numpy as np

from . import exr, findings
from .layers import is_colour, is_light, layer_of, layers_of, load, stack

DENOISING = "Denoising "
LONGEST_PASS = DENOISING + "Albedo"  # of those that every render has
LEVEL = 4  # of zlib: twice as fast as the usual 6 for 3 % more bytes


class Wish(NamedTuple):
    """What is to be made of two files, as plain values."""
    layers: tuple  # names of the view layers
    keeps_guides: frozenset  # those whose denoising data the user asked for
    samples: tuple  # of the colour and of the guides
    model: Optional[str]  # None: what suits; of a single render that is denoised, none after the denoiser
    device: Optional[str]  # UUID; None: the best
    has_light: bool  # the guides' colour is of the same light, and is merged
    half: bool  # 16 bits for light; data keep theirs
    denoise: bool  # both renders first, and each light
    drops: frozenset = frozenset()  # (view layer, pass) that nobody asked for
    single: bool = False  # one render is both: scale 1
    aovs: frozenset = frozenset()  # (view layer, name): data, whatever their names


def _lights(low, full, low_layer, full_layer, aovs):
    """What xrds.upscale() takes as its layers: light by the names of Cycles, colours with both sizes."""
    found = {}
    for name, channels in low_layer.passes.items():
        if (low_layer.name, name) in aovs:
            continue
        pixels = stack(low, channels, "RGB")
        if is_light(name):
            found[name] = pixels
        elif is_colour(name) and name in full_layer.passes:
            found[name] = (pixels, stack(full, full_layer.passes[name], "RGB"))
    return found


def _inputs(wish, full, layer):
    """The guides that the model takes."""
    given = {"albedo": stack(full, layer.passes.get(DENOISING + "Albedo"), "RGB"), "normal": stack(full, layer.passes.get(DENOISING + "Normal"), "XYZ")}
    if wish.has_light:
        given["full_colour"] = stack(full, layer.passes["Combined"], "RGB")
    return _taken(wish, given)


def _taken(wish, given):
    """Of images those that the model takes, or that are merged into its colour."""
    import xrds

    takes = (*xrds.Model(wish.model).inputs, "full_colour") if wish.model else given
    return {name: image for name, image in given.items() if name in takes and image is not None}


def _colours(wish, low, low_layer, full, layer, around):
    """What xrds.upscale() takes of a view layer: its colour, and by their names its images. around: (frame, what it is merged with), or None."""
    colour = stack(low, low_layer.passes["Combined"], "RGB")
    if around is None:
        return colour, {**_inputs(wish, full, layer), "device": wish.device}
    number, surroundings = around
    merged = surroundings.merged(number, layer.name)
    images = _taken(wish, {"albedo": merged.albedo, "normal": merged.normal, "full_colour": merged.full_colour})
    return merged.colour, {**images, "merged": wish.has_light, "device": surroundings.device}


def upscale(low_file, full_file, result_file, wish, progress, around=None):
    """Writes the result. progress(stage, share) returning False ends it with xrds.Cancelled. Raises what xrds and files do. Returns sentences about what looks wrong.

    around: (number, temporal.Surroundings) of a frame that is merged with those around it; None: it is made by itself.
    """
    import xrds

    full = load(full_file)
    low = full if wish.single else load(low_file)
    channels = dict(full.channels)
    low_layers, found = layers_of(low, wish.layers), []
    for place, low_layer in enumerate(low_layers):
        layer = layer_of(full, low_layer.name)
        lights = _lights(low, full, low_layer, layer, wish.aovs)
        options = {"layers": lights} if any(is_light(name) for name in lights) else {}
        colour, images = _colours(wish, low, low_layer, full, layer, around)
        if "layers" in options and around:
            lights["Combined"] = stack(low, low_layer.passes["Combined"], "RGB")  # what they are the sum of, which the merged colour is not
        def heard(stage, share, place=place):
            return progress(stage, (place + (share if stage == "upscaling" else 0)) / len(low_layers))

        of_layer = _findings(wish, low, low_layer, full, layer, lights, images)
        with findings.of_package(of_layer):
            if wish.single and wish.model is None and wish.denoise:  # a network after it is the artist's choice
                if options:
                    options = {"layers": {name: one[0] if isinstance(one, tuple) else one for name, one in lights.items()}}
                made = xrds.denoise(colour, albedo=images["albedo"], normal=images["normal"], device=images["device"], progress=heard, **options)
            else:
                made = xrds.upscale(colour, **images, samples=wish.samples, model=wish.model, denoise_first=wish.denoise, progress=heard, **options)
        found += [f"View layer '{layer.name}': {one}" if len(low_layers) > 1 else one for one in of_layer]
        picture, lights = made if "layers" in options else (made, {})
        _put(channels, layer.name, "Combined", picture, wish.half)
        _drop(channels, layer, lambda name: is_light(name) and name not in lights and (layer.name, name) not in wish.aovs)
        for name, pixels in lights.items():
            _put(channels, layer.name, name, pixels, wish.half)
        _drop(channels, layer, lambda name: (layer.name, name) in wish.drops)
        if layer.name not in wish.keeps_guides:
            _drop(channels, layer, lambda name: name.startswith(DENOISING))
    exr.save(result_file, exr.Picture(full.attributes, channels), LEVEL)
    return found


def _findings(wish, low, low_layer, full, layer, lights, images):
    """images: the guides, which frames around them may be merged into."""
    light = {name: image for name, image in lights.items() if is_light(name)}
    guides = {name: stack(full, layer.passes.get(name), components) for name, components in ((DENOISING + "Albedo", "RGB"), (DENOISING + "Normal", "XYZ"))}
    rendered = {name: image for name, image in guides.items() if image is not None}
    return findings.of_images({"Combined": stack(low, low_layer.passes["Combined"], "RGB"), **light}, rendered) + findings.of_model(wish.model, images)


def _drop(channels, layer, unwanted):
    for name, components in layer.passes.items():
        if unwanted(name):
            for channel in components.values():
                del channels[channel]


def _put(channels, layer, name, pixels, half):
    """The red, green and blue of a pass; what it has beside, as alpha, stays that of the guides."""
    stored = pixels.clip(0, 65504).astype(np.float16) if half else pixels
    for place, component in enumerate("RGB"):
        channels[f"{layer}.{name}.{component}"] = stored[..., place]
