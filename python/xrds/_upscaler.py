from __future__ import annotations

import numbers
import os
from typing import NamedTuple, Optional, Union, overload

import numpy

from . import _native
from ._arrays import Array, Result, output_for, readable, refuse_overlap, writable
from ._colour import Samples, merged_or_none
from ._devices import Device
from ._errors import ArgumentError, check_kind
from ._held import Held
from ._layers import LayerRun, Layers
from ._models import Model
from ._oidn import Path, networks_in_front
from ._progress import Progress, heard

AnyModel = Union[Model, str, "os.PathLike[str]"]
AnyDevice = Union[Device, str, int, None]
Skip = Union[float, str, None]

_SAFE_SKIP = 0.005  # loses at most 0.05 dB: bench/skip.md
_TUNE = {"auto": 0, "never": 1, "now": 2}
_PRECISIONS = ("fp32", "fp16")


class Repairs(NamedTuple):
    """Pixels of a frame that were not finite: how many."""

    colour: int
    """Filled from their neighbours."""
    auxiliary: int
    """The same, of the other images."""
    output: int
    """Of the network: they show the picture without it. With precision="fp16" fp32 has a larger range."""


class Upscaler(Held[_native.Upscaler]):
    """A model made ready for frames of one size on a device: slow once, then fast for each frame.

    width, height: of the low-resolution colour, pixels.
    model: a Model, the name of a shipped one, or a file.
    device: a Device, or what Device takes; None: the best one.
    precision: "fp32", or "fp16": half the memory.
    exposure: factor on the colour for the network, 1e-30 to 1e30; None: from the mean log luminance of each frame.
    skip: windows of the frame that change by less are interpolated without the network; "safe": 0.005. None, "off": none are.
    keep_unchanged: windows whose inputs did not change since the last run keep their result, for sequences.
    ensemble: passes over mirrored images, 1, 2, 4 or 8.
    memory: bytes of the device at most, as 64e6; a larger frame is cut into tiles. None: three quarters.
    tiles: "bounded", or "exact": with the bits of the whole frame, for more work.
    wrap: the left and right edges continue into each other: a panorama. Not with skip, nor ensemble=8.
    tune: "auto", "never" or "now": whether the device's fastest kernels are found before, minutes on a CPU.
    denoise_first: Open Image Denoise's networks take the noise out of all images first, on the same device: True: those of
    denoiser_folder(), where import_oidn() puts them; or a folder. With ensemble (of which so many passes are theirs, too),
    skip, keep_unchanged, wrap or memory, or where they find no room together, they run one after the other, and `memory` is
    for each. So they do for frames with layers, each of which goes through the denoiser: they are made ready anew.
    clean_guides: with denoise_first: albedo and normal have no noise.
    denoised_colour: the colour was denoised before: of what the model changes in it only the part is taken that its file
    states ("denoised_darker", "denoised_brighter"; of most models all). With denoise_first it is so in any case.
    progress: hears how it is made ready, see Progress.

    A frame: `upscaler(colour, albedo=albedo, normal=normal)`. Threads that use one upscaler wait for each other. Raises
    ArgumentError for options that cannot be, OutOfMemory, and Error.
    """

    def __init__(
        self,
        width: int,
        height: int,
        model: AnyModel = "xrds-x4-compact",
        *,
        device: AnyDevice = None,
        precision: str = "fp32",
        exposure: Optional[float] = None,
        skip: Skip = None,
        keep_unchanged: bool = False,
        ensemble: int = 1,
        memory: Optional[float] = None,
        tiles: str = "bounded",
        wrap: bool = False,
        tune: str = "auto",
        denoise_first: Union[bool, Path] = False,
        clean_guides: bool = False,
        denoised_colour: bool = False,
        progress: Optional[Progress] = None,
    ) -> None:
        options = _options(precision, exposure, skip, ensemble, memory, tune)
        options.exact_tiles = _one_of(tiles, "tiles", ("bounded", "exact")) == "exact"
        options.wrap = flag(wrap, "wrap")
        options.keep_unchanged = flag(keep_unchanged, "keep_unchanged")
        options.denoised_colour = flag(denoised_colour, "denoised_colour")
        if flag(clean_guides, "clean_guides") and (denoise_first is False or denoise_first is None):
            raise ArgumentError("clean_guides says that albedo and normal have no noise to take out: give denoise_first, too, or leave it out.")
        self.width, self.height = _size(width, "width"), _size(height, "height")
        self.model = model if isinstance(model, Model) else Model(model)
        self.device = device if isinstance(device, Device) else Device(device, progress=progress)
        denoisers: list[Optional[Model]] = []
        if denoise_first is not False and denoise_first is not None:
            folder = None if denoise_first is True else denoise_first
            denoisers = networks_in_front(self.model.inputs, folder, clean_guides)
        options.separate_denoisers = memory is not None
        networks = [network._native if network else None for network in denoisers]
        super().__init__(
            _native.Upscaler(self.device._native, self.model._native, self.width, self.height, options, networks, heard(progress))
        )

    @overload
    def __call__(
        self, colour: Array, *, albedo: Optional[Array] = ..., normal: Optional[Array] = ..., depth: Optional[Array] = ...,
        diffuse: Optional[Array] = ..., glossy: Optional[Array] = ..., full_colour: Optional[Array] = ...,
        samples: Optional[Samples] = ..., merged: bool = ..., layers: None = ..., out: Optional[Array] = ..., progress: Optional[Progress] = ...,
    ) -> Result: ...

    @overload
    def __call__(
        self, colour: Array, *, albedo: Optional[Array] = ..., normal: Optional[Array] = ..., depth: Optional[Array] = ...,
        diffuse: Optional[Array] = ..., glossy: Optional[Array] = ..., full_colour: Optional[Array] = ...,
        samples: Optional[Samples] = ..., merged: bool = ..., layers: Layers, out: Optional[Array] = ..., progress: Optional[Progress] = ...,
    ) -> tuple[Result, dict[str, Result]]: ...

    def __call__(
        self,
        colour: Array,
        *,
        albedo: Optional[Array] = None,
        normal: Optional[Array] = None,
        depth: Optional[Array] = None,
        diffuse: Optional[Array] = None,
        glossy: Optional[Array] = None,
        full_colour: Optional[Array] = None,
        samples: Optional[Samples] = None,
        merged: bool = False,
        layers: Optional[Layers] = None,
        out: Optional[Array] = None,
        progress: Optional[Progress] = None,
    ) -> Union[Result, tuple[Result, dict[str, Result]]]:
        """Upscales one frame; the images are those of xrds.upscale(), of which the model takes `model.inputs`.

        Returns `out`, or a new numpy array [scale height, scale width, channels of the colour] of the colour's type;
        with layers (xrds.upscale() says which) also them. Raises ArgumentError for an image that is missing, too many,
        or of a wrong shape, TypeError for what is no array of floats. After an exception `out` holds anything.
        """
        arrays = _named(albedo, normal, depth, diffuse, glossy, full_colour)
        given = _given(arrays)
        low = readable(colour, "colour")
        run = LayerRun(layers, colour, low, self.scale) if layers is not None else None
        both: Optional[Array] = colour if flag(merged, "merged") else None
        if "colour" in given and self.scale > 1 and not merged:
            both = merged_or_none(low, given["colour"], samples)
        picture = self._run(colour, both, arrays, run, out, progress)
        return (picture, run.results) if run else picture

    @property
    def scale(self) -> int:
        """Output pixels to a side of a colour pixel."""
        return self.model.scale

    @property
    def exposure(self) -> float:
        """The exposure of the last frame; of that before while one is made, and 0 before the first."""
        with self._lock:
            return self._native.exposure

    @property
    def repairs(self) -> Repairs:
        """Pixels of the last frame that were not finite."""
        with self._lock:
            return Repairs(*self._native.repairs)

    def _run(
        self,
        colour: Array,
        merged: Optional[Array],
        arrays: dict[str, Array],
        layers: Optional[LayerRun],
        out: Optional[Array],
        progress: Optional[Progress],
    ) -> Result:
        heard(progress)
        low = readable(colour, "colour")
        if (low.width, low.height) != (self.width, self.height):
            raise ArgumentError(
                f"The colour is {low.width} x {low.height} pixels, expected {self.width} x {self.height}: "
                "make an upscaler of that size."
            )
        inputs = self._chosen(_given(arrays), merged is not None)
        result = output_for(low, self.scale, out)
        output = writable(result, "out")
        refuse_overlap(output, [low, *inputs])
        frame = low if merged is None else readable(merged, "colour")
        with self._lock:
            if layers is None:
                self._native.run(frame, inputs, output, progress)
                return result
            reports = self._native.run_layers(frame, inputs, output, layers.sets(), progress)
        layers.hear(reports)
        return result

    def _chosen(self, given: dict[str, _native.Image], merged: bool) -> list[_native.Image]:
        """The images of the model in its order."""
        wanted = self.model.inputs
        takes = f"The model {self.model.name} takes {_listed(wanted)}"
        for name in wanted:
            if name not in given:
                raise ArgumentError(f"{takes}, but no {_argument(name)} was given.")
        if "colour" in wanted and not merged:
            raise ArgumentError(f"{takes}, but the full_colour is not merged: give samples=(LOW, FULL).")
        for name in given:
            if name not in wanted and name != "colour":  # which is merged into the other
                raise ArgumentError(f"{takes}, and no {_argument(name)}.")
        return [given[name] for name in wanted]


def _named(
    albedo: Optional[Array],
    normal: Optional[Array],
    depth: Optional[Array],
    diffuse: Optional[Array],
    glossy: Optional[Array],
    full_colour: Optional[Array],
) -> dict[str, Array]:
    """The arrays that there are, by the names that models have for them."""
    arrays = {
        "albedo": albedo,
        "normal": normal,
        "depth": depth,
        "diffuse": diffuse,
        "glossy": glossy,
        "colour": full_colour,
    }
    return {name: array for name, array in arrays.items() if array is not None}


def _given(arrays: dict[str, Array]) -> dict[str, _native.Image]:
    return {name: readable(array, _argument(name)) for name, array in arrays.items()}


def _argument(name: str) -> str:
    return "full_colour" if name == "colour" else name


def _listed(names: tuple[str, ...]) -> str:
    return " and ".join(_argument(name) for name in names) or "the colour alone"


def _size(value: int, name: str) -> int:
    check_kind([value], numbers.Integral, name, "a whole number of pixels")
    if not 0 < value < 2**32:
        raise ArgumentError(f"The {name} is {value} pixels, expected 1 to {2**32 - 1}.")
    return value


def _options(
    precision: str,
    exposure: Optional[float],
    skip: Skip,
    ensemble: int,
    memory: Optional[float],
    tune: str,
) -> _native.UpscalerOptions:
    options = _native.UpscalerOptions()
    options.fp16 = _one_of(precision, "precision", _PRECISIONS) == "fp16"
    options.tune = _TUNE[_one_of(tune, "tune", tuple(_TUNE))]
    if exposure is not None:
        check_kind([exposure], numbers.Real, "exposure", "a number, or None")
        if not exposure > 0:
            raise ArgumentError(f"The exposure is {exposure}, expected a number from 1e-30 to 1e30, or None.")
        options.exposure = exposure
    if isinstance(skip, str):
        options.skip = _SAFE_SKIP if _one_of(skip, "skip", ("safe", "off")) == "safe" else 0
    elif skip is not None:
        check_kind([skip], numbers.Real, "skip", "'safe', 'off', a number, or None")
        options.skip = skip
    if ensemble not in (1, 2, 4, 8):
        raise ArgumentError(f"The ensemble is {ensemble}, expected 1, 2, 4 or 8.")
    if memory is not None:
        check_kind([memory], numbers.Real, "memory", "a number of bytes, or None")
        if not (0 < memory < 2**64 and memory == int(memory)):
            raise ArgumentError(f"The memory is {memory}, expected a whole number of bytes, or None.")
    options.ensemble = int(ensemble)
    options.memory = int(memory or 0)
    return options


def flag(value: bool, name: str) -> bool:
    check_kind([value], (bool, numpy.bool_), name, "True or False")
    return bool(value)


def _one_of(value: str, name: str, known: tuple[str, ...]) -> str:
    if value not in known:
        raise ArgumentError(f"The {name} is {value!r}, expected " + " or ".join(repr(one) for one in known) + ".")
    return value
