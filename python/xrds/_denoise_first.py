"""Frames with layers, denoised and then upscaled: networks one after the other, as each light goes through the denoiser by itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Optional

import numpy

from . import _native
from ._arrays import Array, Result, readable, writable
from ._colour import levelled
from ._layers import LayerRun, plain
from ._models import Model
from ._progress import Progress, steps

if TYPE_CHECKING:
    from ._upscaler import Upscaler

Make = Callable[[int, int, Model], "Upscaler"]
RADIANCE = ("diffuse", "glossy", "colour")  # inputs that are light


def through(network: Upscaler, image: Array, guides: list[Result], progress: Optional[Progress]) -> Result:
    """What a network of one size makes of an image, in 32 bits."""
    clean = numpy.empty((network.height, network.width, 3), numpy.float32)
    with network._lock:
        network._native.run(
            readable(image, "image"), [readable(guide, "guide") for guide in guides], writable(clean, "result"), progress
        )
    return clean


def clean_albedo(network: Upscaler, albedo: Array, progress: Optional[Progress]) -> Result:
    """An albedo, or a colour pass, without its noise; what it has above 1, as that of lights may, stays."""
    given = plain(albedo)
    inside = given.clip(0, 1)
    clean: Result = through(network, inside, [], progress) + (given - inside)
    return clean


def guides_of(images: Mapping[str, Array]) -> list[Result]:
    """What a denoiser of colours takes of images: the albedo, from 0 to 1, and the normal, those that are there."""
    return [plain(images[name]).clip(0, 1) if name == "albedo" else plain(images[name]) for name in ("albedo", "normal") if name in images]


class Networks:
    """What stands on a device together."""

    def __init__(self, networks: list[Upscaler]) -> None:
        self._all = networks

    @property
    def device_bytes(self) -> int:
        return sum(network.device_bytes for network in self._all)

    def close(self) -> None:
        for network in self._all:
            network.close()


class DenoisedFirst(Networks):
    """The networks of Upscaler(denoise_first=...) for frames with layers."""

    def __init__(self, model: Model, width: int, height: int, networks: list[Optional[Model]], upscaler: Make, network: Make) -> None:
        """networks: those of networks_in_front(); upscaler, network: how one of a size is made ready."""
        self._model = model
        wide, high = model.scale * width, model.scale * height
        colour, *guides = networks
        assert colour is not None
        self._upscaler = upscaler(width, height, model)
        self._colour = network(width, height, colour)
        self._guides = {name: network(wide, high, one) for name, one in zip(("albedo", "normal"), guides) if one is not None}
        is_light = model.scale > 1 and any(name in RADIANCE for name in model.inputs)
        self._full = network(wide, high, colour) if is_light else self._colour
        full = [self._full] if is_light else []
        super().__init__([self._upscaler, self._colour, *full, *self._guides.values()])

    @property
    def upscaler(self) -> _native.Upscaler:
        return self._upscaler._native

    def run(
        self, frame: Array, arrays: dict[str, Array], layers: LayerRun, output: _native.Image, progress: Optional[Progress]
    ) -> list[tuple[float, int, int]]:
        """frame: the colour, merged where the model takes that of full resolution; arrays: the images that the model takes."""
        noisy = layers.noisy()
        lights = [name for name in self._model.inputs if name in RADIANCE]
        heard = iter(steps(progress, len(self._guides) + len(lights) + len(noisy) + 2))
        images = {name: plain(arrays[name]) for name in self._model.inputs}
        for name, network in self._guides.items():
            part = next(heard)
            images[name] = clean_albedo(network, images[name], part) if name == "albedo" else through(network, images[name], [], part)
        if "colour" in images:
            images["colour"] = levelled(readable(images["colour"], "full_colour"), readable(frame, "colour"))
        guides = guides_of(images)
        for name in lights:
            images[name] = through(self._full, images[name], guides, next(heard))
        means = [_box_mean(guide, self._model.scale) for guide in guides]
        clean = through(self._colour, frame, means, next(heard))
        layers.put([through(self._colour, image, means, next(heard)) for image in noisy])
        inputs = [readable(images[name], name) for name in self._model.inputs]
        with self._upscaler._lock:
            return self._upscaler._native.run_layers(readable(clean, "colour"), inputs, output, layers.sets(), next(heard))


def _box_mean(image: Result, scale: int) -> Result:
    """The means of scale x scale pixels, summed in the order of the command."""
    share = numpy.float32(1 / scale**2)
    mean: Result = numpy.zeros_like(image[::scale, ::scale])
    for y in range(scale):
        for x in range(scale):
            mean += share * image[y::scale, x::scale]
    return mean
