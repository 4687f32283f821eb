"""Frames denoised and then upscaled by networks one after the other, where these cannot stand in front of the upscaler on the device."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Optional

import numpy

from . import _native
from ._arrays import Array, Result, readable, writable
from ._colour import levelled
from ._held import OnDevice
from ._layers import LayerRun
from ._mirror import mirrors
from ._models import Model
from ._progress import Progress, steps
from ._repair import filled, plain

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

    def __init__(self, networks: Sequence[OnDevice]) -> None:
        self._all = networks

    @property
    def device_bytes(self) -> int:
        return sum(network.device_bytes for network in self._all)

    def close(self) -> None:
        for network in self._all:
            network.close()


class Passes(Networks):
    """A denoiser of colours, of whose passes over mirrored images the mean is taken."""

    def __init__(self, model: Model, width: int, height: int, passes: int, network: Make) -> None:
        self._passes = passes
        self._upright = network(width, height, model)
        turns = passes == 8 and width != height
        self._turned = network(height, width, model) if turns else self._upright
        super().__init__([self._upright, self._turned] if turns else [self._upright])

    def __call__(self, image: Array, guides: list[Result], progress: Optional[Progress]) -> Result:
        """guides: as guides_of() has them."""
        given = plain(image)
        mean: Result = numpy.zeros_like(given)
        for mirror, part in zip(mirrors(self._passes), steps(progress, self._passes)):
            turned = [mirror.image(guide, is_normal=place == 1) for place, guide in enumerate(guides)]
            network = self._turned if mirror.transposed else self._upright
            mean += mirror.back(through(network, mirror.image(given), turned, part) / numpy.float32(self._passes))
        return mean


class DenoisedFirst(Networks):
    """The networks of Upscaler(denoise_first=...), made ready apart."""

    def __init__(self, model: Model, width: int, height: int, networks: list[Optional[Model]], passes: int, network: Make) -> None:
        """networks: those of networks_in_front(); network: how one of a size is made ready."""
        self._model, self._passes = model, passes
        self.filled = 0, 0
        """Pixels of the last frame that were not finite: of its colour, and of the other images."""
        wide, high = model.scale * width, model.scale * height
        colour, *guides = networks
        assert colour is not None
        self._colour = Passes(colour, width, height, passes, network)
        self._guides = {name: network(wide, high, one) for name, one in zip(("albedo", "normal"), guides) if one is not None}
        is_light = model.scale > 1 and any(name in RADIANCE for name in model.inputs)
        self._full = Passes(colour, wide, high, passes, network) if is_light else self._colour
        super().__init__([self._colour, *([self._full] if is_light else []), *self._guides.values()])

    def run(
        self, upscaler: _native.Upscaler, frame: Array, arrays: dict[str, Array], layers: Optional[LayerRun], output: _native.Image,
        progress: Optional[Progress],
    ) -> list[tuple[float, int, int]]:
        """Upscales a frame that was denoised. frame: the colour, merged where the model takes that of full resolution; arrays: the
        images that the model takes."""
        noisy = layers.noisy() if layers else []
        lights = [name for name in self._model.inputs if name in RADIANCE]
        mixes = self._passes > 1 and "colour" in self._model.inputs and not layers
        heard = iter(steps(progress, len(self._guides) + len(lights) + len(noisy) + 2 + mixes))
        colour, bad = filled(frame, True)
        images, others = dict(arrays), 0
        for name in self._model.inputs:
            if name != "depth":
                images[name], count = filled(arrays[name], name in RADIANCE)
                others += count
        for name, network in self._guides.items():
            part = next(heard)
            images[name] = clean_albedo(network, images[name], part) if name == "albedo" else through(network, images[name], [], part)
        if "colour" in lights:
            images["colour"] = levelled(readable(images["colour"], "full_colour"), readable(colour, "colour"))
        clean_guides: dict[str, Array] = {name: images[name] for name in ("albedo", "normal") if name in self._model.inputs}
        guides = guides_of(clean_guides)
        for name in lights:
            images[name] = self._full(images[name], guides, next(heard))
        means = guides_of({name: _box_mean(plain(guide), self._model.scale) for name, guide in clean_guides.items()})
        clean = _with_alpha(self._colour(colour, means, next(heard)), frame)
        if layers:
            layers.put([self._colour(image, means, next(heard)) for image in noisy])
        self.filled = bad, others
        inputs = [readable(images[name], name) for name in self._model.inputs]
        if layers:
            return upscaler.run_layers(readable(clean, "colour"), inputs, output, layers.sets(), next(heard))
        if not mixes:
            upscaler.run(readable(clean, "colour"), inputs, output, next(heard))
            return []
        given = [readable(arrays[name], name) for name in self._model.inputs]
        self._mix(upscaler, readable(frame, "colour"), given, clean, inputs, output, heard)
        return []

    def _mix(
        self, upscaler: _native.Upscaler, frame: _native.Image, given: list[_native.Image], clean: Result, inputs: list[_native.Image],
        output: _native.Image, heard: Iterator[Optional[Progress]],
    ) -> None:
        """Makes a share of the picture of the images with their noise, as the command does in an ensemble."""
        noisy = numpy.empty((output.height, output.width, 3), numpy.float32)
        upscaler.run(frame, given, writable(noisy, "result"), next(heard))
        whole = numpy.empty((output.height, output.width, clean.shape[2]), numpy.float32)
        upscaler.run(readable(clean, "colour"), inputs, writable(whole, "result"), next(heard))
        picture = numpy.ascontiguousarray(whole[..., :3])
        _native.add_noisy_share(writable(picture, "picture"), readable(noisy, "noisy"), upscaler.exposure)
        whole[..., :3] = picture
        both = readable(whole, "picture")
        _native.merge_colour(both, both, 1, 1, output)  # of itself: written into the type and the layout of the output


def _with_alpha(image: Result, given: Array) -> Result:
    """With the alpha of the array, if it has one."""
    array = given if isinstance(given, numpy.ndarray) else numpy.from_dlpack(given)
    return image if array.shape[2] < 4 else numpy.concatenate([image, array[..., 3:].astype(numpy.float32)], 2)


def _box_mean(image: Result, scale: int) -> Result:
    """The means of scale x scale pixels, summed in the order of the command."""
    share = numpy.float32(1 / scale**2)
    mean: Result = numpy.zeros_like(image[::scale, ::scale])
    for y in range(scale):
        for x in range(scale):
            mean += share * image[y::scale, x::scale]
    return mean
