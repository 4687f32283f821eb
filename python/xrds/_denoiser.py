from __future__ import annotations

from typing import Optional

import numpy

from ._arrays import Array, Result, readable
from ._devices import Device
from ._errors import ArgumentError
from ._held import Held
from ._oidn import Path, networks_alone
from ._progress import Progress
from ._upscaler import AnyDevice, Upscaler, _listed, _one_of

_INPUTS = ((), ("albedo",), ("albedo", "normal"))


class _Networks:
    """What stands on the device: the colour's network last."""

    def __init__(self, networks: list[Upscaler]) -> None:
        self._networks = networks

    @property
    def device_bytes(self) -> int:
        return sum(network.device_bytes for network in self._networks)

    def close(self) -> None:
        for network in self._networks:
            network.close()


class Denoiser(Held[_Networks]):
    """Open Image Denoise's networks made ready for renders of one size on a device: slow once, then fast for each.

    width, height: of all images, pixels.
    inputs: the images that come with the colour: ("albedo", "normal"), ("albedo",) or ().
    guides: "prefilter": albedo and normal are denoised first, each by a network of its own, where both are there; "noisy": they stay
    as they are; "clean": so they do, and have no noise.
    quality: "high": the largest networks that there are; "balanced", "fast": the base ones, the small ones.
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
        denoisers: Optional[Path] = None,
        device: AnyDevice = None,
        precision: str = "fp32",
        exposure: Optional[float] = None,
        memory: Optional[int] = None,
        progress: Optional[Progress] = None,
    ) -> None:
        self.width, self.height, self.inputs = width, height, tuple(inputs)
        if self.inputs not in _INPUTS:
            raise ArgumentError(f"A denoiser takes albedo and normal, albedo, or nothing beside the colour, not {_listed(self.inputs)}.")
        _one_of(guides, "guides", ("prefilter", "noisy", "clean"))
        _one_of(quality, "quality", ("high", "balanced", "fast"))
        colour, prefilters = networks_alone(self.inputs, guides, quality, denoisers)
        self.device = device if isinstance(device, Device) else Device(device, progress=progress)
        options = {"device": self.device, "precision": precision, "memory": memory, "tiles": "exact", "tune": "never"}
        self._prefilters = {
            name: Upscaler(width, height, model, progress=progress, **options)  # type: ignore[arg-type]
            for name, model in prefilters.items()
        }
        self._colour = Upscaler(width, height, colour, exposure=exposure, progress=progress, **options)  # type: ignore[arg-type]
        super().__init__(_Networks([*self._prefilters.values(), self._colour]))

    def __call__(
        self,
        colour: Array,
        *,
        albedo: Optional[Array] = None,
        normal: Optional[Array] = None,
        out: Optional[Array] = None,
        progress: Optional[Progress] = None,
    ) -> Result:
        """Takes the noise out of a render; the images are those of xrds.denoise(), of which it takes `inputs`.

        Returns `out`, or a new numpy array of the colour's shape and type. Raises ArgumentError for an image that is missing, too many, or
        of a wrong shape, TypeError for what is no array of floats. After an exception `out` holds anything.
        """
        images = {name: array for name, array in (("albedo", albedo), ("normal", normal)) if array is not None}
        if tuple(images) != self.inputs:
            raise ArgumentError(f"This denoiser takes {_listed(self.inputs)}, and got {_listed(tuple(images))}.")
        for name, array in {"colour": colour, **images}.items():
            image = readable(array, name)
            if (image.width, image.height) != (self.width, self.height):
                raise ArgumentError(f"The {name} is {image.width} x {image.height} pixels, expected {self.width} x {self.height}.")
        steps = len(self._prefilters) + 1

        def part(number: int) -> Optional[Progress]:
            return progress and (lambda stage, share: progress(stage, (number + share) / steps))

        for number, (name, prefilter) in enumerate(self._prefilters.items()):
            clean = numpy.empty((self.height, self.width, 3), numpy.float32)
            images[name] = prefilter(images[name], out=clean, progress=part(number))
        return self._colour(colour, albedo=images.get("albedo"), normal=images.get("normal"), out=out, progress=part(steps - 1))
