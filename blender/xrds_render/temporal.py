# SPDX-License-Identifier: GPL-3.0-or-later
"""Animations that are stable over time: which renders a frame needs, where they are kept, and what they are merged to."""
import json
import os
import re

from . import exr
from .layers import layer_of, layers_of, load, stack

NOTE = "settings.json"
FILE = re.compile(r"(-?\d+)_(?:low|full)\.exr(?:\.part\.exr)?")  # of a render, whole or not
RADIUS = 5  # frames before and after that are worth it
BYTES_PER_PIXEL = (2 * RADIUS + 1) * 56  # of the full resolution: colour, albedo, normal, depth and motion of all of them


def needed(frames, missing):
    """The frames to render: those without a result, and those that they are merged with."""
    around = {number for other in missing for number in range(other - RADIUS, other + RADIUS + 1)}
    return [number for number in frames if number in around]


def file_of(folder, number, kind):
    """Where a render is kept: the "low" or the "full" one of a frame."""
    return os.path.join(folder, f"{number}_{kind}.exr")


class Renders:
    """The files of renders, in a folder beside the results until nothing needs them: a stopped animation goes on with them.

    Renders of other settings are thrown away, and where no result is there to go on from those of another state, the file of the scene and its
    time; None: nobody knows. Both are plain values.
    """

    def __init__(self, folder, settings, state, goes_on):
        self.folder, self.state = folder, state
        note = os.path.join(folder, NOTE)
        before = _read(note) or {}
        if before.get("settings") != settings or not (goes_on or state and before.get("state") == state):
            self.forget(None)
        os.makedirs(folder, exist_ok=True)
        with exr.naming(note), open(note, "w") as file:
            json.dump({"settings": settings, "state": state}, file)

    def file(self, number, kind):
        return file_of(self.folder, number, kind)

    def has(self, number, kind):
        return os.path.exists(self.file(number, kind))

    def forget(self, before):
        """Removes those of frames before this one; None: everything that is of this class, and then the folder if nothing else is in it."""
        if not os.path.isdir(self.folder):
            return
        for name in os.listdir(self.folder):
            found = FILE.fullmatch(name)
            if name == NOTE and before is None or found and (before is None or int(found[1]) < before):
                os.remove(os.path.join(self.folder, name))
        if before is None and not os.listdir(self.folder):
            os.rmdir(self.folder)


def _read(path):
    try:
        with open(path) as file:
            return json.load(file)
    except (OSError, ValueError):
        return None


class Surroundings:
    """The images of frames, read once each, and the filter that merges them. It stays in worker.py's process."""

    def __init__(self, folder, frames, wish):
        self._folder, self._frames, self._wish = folder, frozenset(frames), wish
        self._read, self._filters, self._device = {}, {}, None

    @property
    def device(self):
        """Opened once for merging and upscaling."""
        import xrds

        self._device = self._device or xrds.Device(self._wish.device)
        return self._device

    def merged(self, number, layer):
        """A view layer of a frame, merged with those around it, as an xrds.TemporalFrame."""
        import xrds

        self._read = {one: images for one, images in self._read.items() if abs(one - number) <= RADIUS}
        present = self._of(number)[layer]
        height, width = present.colour.shape[:2]
        scale = present.depth.shape[0] // height
        if layer not in self._filters:
            self._filters[layer] = xrds.TemporalFilter(width, height, scale, device=self.device)
        return self._filters[layer](present, self._row(number, -1, layer), self._row(number, 1, layer))

    def _row(self, number, step, layer):
        """Those before or after a frame, the nearest first, as far as there are any."""
        row = []
        for other in range(number + step, number + step * (RADIUS + 1), step):
            if other not in self._frames or layer not in self._of(other):
                break
            row.append(self._of(other)[layer])
        return row

    def _of(self, number):
        if number not in self._read:
            full = load(file_of(self._folder, number, "full"))
            low = full if self._wish.single else load(file_of(self._folder, number, "low"))
            self._read[number] = {layer.name: self._images(low, layer, full, layer_of(full, layer.name)) for layer in layers_of(low, self._wish.layers)}
        return self._read[number]

    def _images(self, low, low_layer, full, layer):
        import xrds

        to_previous, to_next = xrds.cycles_motion(stack(full, layer.passes["Vector"], "XYZW"))
        colour, light = stack(low, low_layer.passes["Combined"], "RGB"), None
        if self._wish.has_light:
            light = stack(full, layer.passes["Combined"], "RGB")
            colour = xrds.merge_colour(colour, light, samples=self._wish.samples)
        return xrds.TemporalFrame(
            colour, light, stack(full, layer.passes["Denoising Albedo"], "RGB"), stack(full, layer.passes["Denoising Normal"], "XYZ"),
            stack(full, layer.passes["Depth"], "Z")[..., 0], to_previous, to_next)
