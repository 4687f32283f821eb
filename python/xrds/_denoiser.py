from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Optional, Union, overload

import numpy

from ._arrays import Array, Result, readable, writable
from ._devices import Device
from ._errors import ArgumentError
from ._held import Held, OnDevice
from ._layers import LayerRun, Layers
from ._oidn import Path, networks_alone
from ._progress import Progress, heard, steps
from ._repair import filled, plain
from ._upscaler import AnyDevice, Upscaler, _listed, _one_of, flag

_INPUTS = ((), ("albedo",), ("albedo", "normal"))


class _Networks:
    """What stands on a device together."""

    def __init__(self, networks: Sequence[OnDevice]) -> None:
        self._all = networks

    @property
    def device_bytes(self) -> int:
        return sum(network.device_bytes for network in self._all)

    def close(self) -> None:
        for network in self._all:
            network.close()


class Denoiser(Held[_Networks]):
    """Open Image Denoise's networks made ready for renders of one size on a device: slow once, then fast for each.

    width, height: of all images, pixels.
    inputs: the images that come with the colour: ("albedo", "normal"), ("albedo",) or ().
    guides: "prefilter": albedo and normal are denoised first, each by a network of its own; "noisy": they stay as they are; "clean": so they do, and have no noise.
    quality: "high": the largest networks that there are; "balanced", "fast": the base ones, the small ones.
    ldr: the colour is linear from 0 to 1 and stays so; else it is radiance without bound. Not with exposure.
    denoisers: folder of the networks; None: denoiser_folder(), where import_oidn() puts them.
    The others are those of Upscaler.

    A frame: `denoiser(colour, albedo=albedo, normal=normal)`. Threads that use one denoiser wait for each other. Raises
    ArgumentError for options that cannot be, OutOfMemory, and Error, as where a network is missing.
    """

    def __init__(
        self,
        width: int,
        height: int,
        *,
        inputs: tuple[str, ...] = ("albedo", "normal"),
        guides: str = "prefilter",
        quality: str = "high",
        ldr: bool = False,
        denoisers: Optional[Path] = None,
        device: AnyDevice = None,
        precision: str = "fp32",
        exposure: Optional[float] = None,
        memory: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> None:
        self.width, self.height, self.inputs = width, height, tuple(inputs)
        if self.inputs not in _INPUTS:
            raise ArgumentError(f"A denoiser takes albedo and normal, albedo, or nothing beside the colour, not {_listed(self.inputs)}.")
        _one_of(guides, "guides", ("prefilter", "noisy", "clean"))
        _one_of(quality, "quality", ("high", "balanced", "fast"))
        if flag(ldr, "ldr") and exposure is not None:
            raise ArgumentError("The exposure is of radiance without bound: it cannot go with ldr.")
        colour, prefilters = networks_alone(self.inputs, guides, quality, ldr, denoisers)
        self.device = device if isinstance(device, Device) else Device(device, progress=progress)
        options = {"device": self.device, "precision": precision, "memory": memory, "tiles": "exact", "tune": "never"}
        self._prefilters = {
            name: Upscaler(width, height, model, progress=progress, **options)  # type: ignore[arg-type]
            for name, model in prefilters.items()
        }
        self._colour = Upscaler(width, height, colour, exposure=exposure, progress=progress, **options)  # type: ignore[arg-type]
        super().__init__(_Networks([*self._prefilters.values(), self._colour]))

    @overload
    def __call__(
        self, colour: Array, *, albedo: Optional[Array] = ..., normal: Optional[Array] = ..., layers: None = ..., out: Optional[Array] = ..., progress: Optional[Progress] = ...
    ) -> Result: ...

    @overload
    def __call__(
        self, colour: Array, *, albedo: Optional[Array] = ..., normal: Optional[Array] = ..., layers: Layers, out: Optional[Array] = ..., progress: Optional[Progress] = ...
    ) -> tuple[Result, dict[str, Result]]: ...

    def __call__(
        self,
        colour: Array,
        *,
        albedo: Optional[Array] = None,
        normal: Optional[Array] = None,
        layers: Optional[Layers] = None,
        out: Optional[Array] = None,
        progress: Optional[Progress] = None,
    ) -> Union[Result, tuple[Result, dict[str, Result]]]:
        """Takes the noise out of a render; the images are those of xrds.denoise(), of which it takes `inputs`.

        Returns `out`, or a new numpy array of the colour's shape and type; with layers (xrds.denoise() says which) also them. Raises
        ArgumentError for an image that is missing, too many, or of a wrong shape, TypeError for what is no array of floats. After an
        exception `out` holds anything.
        """
        return self._run(colour, albedo, normal, layers, out, progress)

    def _run(
        self,
        colour: Array,
        albedo: Optional[Array],
        normal: Optional[Array],
        layers: Optional[Layers],
        out: Optional[Array],
        progress: Optional[Progress],
    ) -> Union[Result, tuple[Result, dict[str, Result]]]:
        images: dict[str, Array] = {name: array for name, array in (("albedo", albedo), ("normal", normal)) if array is not None}
        if tuple(images) != self.inputs:
            raise ArgumentError(f"This denoiser takes {_listed(self.inputs)}, and got {_listed(tuple(images))}.")
        for name, array in {"colour": colour, **images}.items():
            image = readable(array, name)
            if (image.width, image.height) != (self.width, self.height):
                raise ArgumentError(f"The {name} is {image.width} x {image.height} pixels, expected {self.width} x {self.height}.")
        images = {name: filled(array, False)[0] for name, array in images.items()}
        run = None if layers is None else LayerRun(layers, colour, readable(colour, "colour"), 1, paired=False)
        noisy = run.noisy() if run else []
        passes = run.passes if run and "albedo" in self._prefilters else []
        told = iter(steps(heard(progress), len(self._prefilters) + len(passes) + len(noisy) + 1))
        for name, prefilter in self._prefilters.items():
            images[name] = _through(prefilter, images[name], [], next(told))
        if run:
            clean = [_clean_albedo(self._prefilters["albedo"], image, next(told)) for image in passes]
            guides = _guides_of(images)
            run.put([_through(self._colour, image, guides, next(told)) for image in noisy], clean or None)
        picture = self._colour._run(colour, None, images, run, out, next(told))
        return (picture, run.results) if run else picture


def _through(network: Upscaler, image: Array, guides: list[Result], progress: Optional[Progress]) -> Result:
    """What a network of one size makes of an image, in 32 bits."""
    clean = numpy.empty((network.height, network.width, 3), numpy.float32)
    with network._lock:
        network._native.run(
            readable(image, "image"), [readable(guide, "guide") for guide in guides], writable(clean, "result"), progress
        )
    return clean


def _clean_albedo(network: Upscaler, albedo: Array, progress: Optional[Progress]) -> Result:
    """An albedo, or a colour pass, without its noise; what it has above 1, as that of lights may, stays."""
    given = plain(albedo)
    inside = given.clip(0, 1)
    clean: Result = _through(network, inside, [], progress) + (given - inside)
    return clean


def _guides_of(images: Mapping[str, Array]) -> list[Result]:
    """What a denoiser of colours takes of images: the albedo, from 0 to 1, and the normal, those that are there."""
    return [plain(images[name]).clip(0, 1) if name == "albedo" else plain(images[name]) for name in ("albedo", "normal") if name in images]
