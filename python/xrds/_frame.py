"""upscale() and denoise(): one call, which keeps what it made ready for the next."""

from __future__ import annotations

import atexit
import os
import threading
import warnings
from collections.abc import Callable
from typing import Any, Optional, TypeVar, Union, overload

from . import _native
from ._arrays import Array, Result, is_constant, readable
from ._colour import Samples, checked, merged_or_none
from ._denoiser import Denoiser
from ._devices import Device
from ._errors import ArgumentError, DeviceLost, Error
from ._layers import LayerRun, Layers
from ._models import Model
from ._oidn import Path
from ._progress import Progress
from ._upscaler import AnyDevice, AnyModel, Skip, Upscaler, _argument, _given, _named, flag

_lock = threading.Lock()
_last: Optional[tuple[tuple[Any, ...], AnyDevice, Union[Upscaler, Denoiser]]] = None  # its key, the device asked for, itself
Kept = TypeVar("Kept", Upscaler, Denoiser)


@overload
def upscale(
    colour: Array, *, albedo: Optional[Array] = ..., normal: Optional[Array] = ..., depth: Optional[Array] = ...,
    diffuse: Optional[Array] = ..., glossy: Optional[Array] = ..., full_colour: Optional[Array] = ...,
    samples: Optional[Samples] = ..., merged: bool = ..., layers: None = ..., model: Optional[AnyModel] = ..., device: AnyDevice = ...,
    precision: str = ..., exposure: Optional[float] = ..., skip: Skip = ..., ensemble: int = ..., memory: Optional[float] = ...,
    tiles: str = ..., wrap: bool = ..., tune: str = ..., denoise_first: Union[bool, Path] = ..., clean_guides: bool = ..., denoised_colour: bool = ..., out: Optional[Array] = ..., progress: Optional[Progress] = ...,
) -> Result: ...


@overload
def upscale(
    colour: Array, *, albedo: Optional[Array] = ..., normal: Optional[Array] = ..., depth: Optional[Array] = ...,
    diffuse: Optional[Array] = ..., glossy: Optional[Array] = ..., full_colour: Optional[Array] = ...,
    samples: Optional[Samples] = ..., merged: bool = ..., layers: Layers, model: Optional[AnyModel] = ..., device: AnyDevice = ...,
    precision: str = ..., exposure: Optional[float] = ..., skip: Skip = ..., ensemble: int = ..., memory: Optional[float] = ...,
    tiles: str = ..., wrap: bool = ..., tune: str = ..., denoise_first: Union[bool, Path] = ..., clean_guides: bool = ..., denoised_colour: bool = ..., out: Optional[Array] = ..., progress: Optional[Progress] = ...,
) -> tuple[Result, dict[str, Result]]: ...


def upscale(
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
    model: Optional[AnyModel] = None,
    device: AnyDevice = None,
    precision: str = "fp32",
    exposure: Optional[float] = None,
    skip: Skip = None,
    ensemble: int = 1,
    memory: Optional[float] = None,
    tiles: str = "bounded",
    wrap: bool = False,
    tune: str = "auto",
    denoise_first: Union[bool, Path] = False,
    clean_guides: bool = False,
    denoised_colour: bool = False,
    out: Optional[Array] = None,
    progress: Optional[Progress] = None,
) -> Union[Result, tuple[Result, dict[str, Result]]]:
    """Upscales a noisy low-resolution render with the help of full-resolution albedo and normals.

    colour: [height, width, 3, or 4 with alpha] linear radiance. Images are float16 or float32 of any strides: numpy
    arrays, or what shares its memory by DLPack, as tensors of torch on the CPU.
    albedo, normal, depth, diffuse, glossy: [scale height, scale width, 3] of the full-resolution render, those that the
    model takes; normal in the camera's axes; depth also [scale height, scale width] of distances in any unit.
    full_colour: that of the same render, which is merged into the colour, weighted by `samples` a pixel of the two, as
    (64, 16); None: estimated from the noise, and not used, with a warning, where it is of other light.
    merged: the colour is that of merge_colour() or of a TemporalFilter already, and the full_colour is not merged again.
    layers: lights that the colour is the sum of, by their names: {"DiffDir": [height, width, 3], ...} of the
    low-resolution render. "DiffCol", a pair of [height, width, 3] and [scale height, scale width, 3] of the two renders,
    multiplies DiffDir and DiffInd; so do other stems, and "Diffuse Color" the lights "Diffuse Direct" and "Diffuse
    Indirect". Emit, Env and volumes do not follow the albedo, others without a colour do. "Combined" is what they are the sum of where
    that is not the colour, as of a TemporalFilter. Not with skip.
    model: a Model, the name of a shipped one, or a file; None: what suits the images and samples. An albedo
    or a normal that is the same everywhere tells nothing: then it is one that does without, with a warning.
    out: an array for the result, of which no byte is the inputs'; None: a new one.
    progress: hears how far it is, and can end it, see Progress. So does KeyboardInterrupt.
    The others are those of Upscaler.

    Returns `out`, or a numpy array [scale height, scale width, channels of colour] of the colour's type: linear
    radiance, finite whatever the inputs. Pixels that are not finite count as their neighbours.

    With layers: that and a dict of the same names, each a new float32 array [scale height, scale width, 3], never
    negative. They add up to the picture as those given do to the colour; if these are but a part of it, so are they. A
    colour pass is that of full resolution, raised in pixels where light has no place in it.

    What is made ready for a size is kept for the next call with the same size and options, until release(). Safe in any
    thread; threads wait for each other. Raises ArgumentError (a ValueError) for images and options that cannot be,
    TypeError for what is no array of floats, OutOfMemory, DeviceLost, Cancelled, and Error for everything else.
    """
    low = readable(colour, "colour")
    arrays = _named(albedo, normal, depth, diffuse, glossy, full_colour)
    given = _given(arrays)
    scale = _scale(low, given)
    both: Optional[Array] = colour if flag(merged, "merged") else None
    if "colour" in given and scale > 1 and not merged:
        both = merged_or_none(low, given["colour"], samples)
    options = {
        "precision": precision,
        "exposure": exposure,
        "skip": skip,
        "ensemble": ensemble,
        "memory": memory,
        "tiles": tiles,
        "wrap": wrap,
        "tune": tune,
        "denoise_first": denoise_first,
        "clean_guides": clean_guides,
        "denoised_colour": denoised_colour,
    }
    checked(samples)
    chosen = model if model is not None else _suitable(scale, given, both is not None, samples, skip)
    if model is None and (constant := _constant(arrays)) and (variant := _without(constant, scale)):
        warnings.warn(f"The {constant} is the same everywhere; taking model {variant}.", stacklevel=2)
        chosen = variant
        arrays = {name: array for name, array in arrays.items() if name == "colour" or (name == "albedo" and constant == "normal")}
    model_key = chosen if isinstance(chosen, Model) else os.fspath(chosen)
    upscaler = _kept(
        (Upscaler, low.width, low.height, model_key, *options.values(), os.environ.get("XRDS_DENOISERS")), device, progress,
        lambda opened: Upscaler(low.width, low.height, chosen, device=opened, progress=progress, **options),  # type: ignore[arg-type]
    )
    try:
        run = LayerRun(layers, colour, low, upscaler.scale) if layers is not None else None
        picture = upscaler._run(colour, both, arrays, run, out, progress)
        return (picture, run.results) if run else picture
    except DeviceLost:
        release()
        raise


@overload
def denoise(
    colour: Array, *, albedo: Optional[Array] = ..., normal: Optional[Array] = ..., layers: None = ..., guides: str = ..., quality: str = ..., ldr: bool = ...,
    denoisers: Optional[Path] = ..., device: AnyDevice = ..., precision: str = ..., exposure: Optional[float] = ..., memory: Optional[float] = ...,
    out: Optional[Array] = ..., progress: Optional[Progress] = ...,
) -> Result: ...


@overload
def denoise(
    colour: Array, *, albedo: Optional[Array] = ..., normal: Optional[Array] = ..., layers: Layers, guides: str = ..., quality: str = ..., ldr: bool = ...,
    denoisers: Optional[Path] = ..., device: AnyDevice = ..., precision: str = ..., exposure: Optional[float] = ..., memory: Optional[float] = ...,
    out: Optional[Array] = ..., progress: Optional[Progress] = ...,
) -> tuple[Result, dict[str, Result]]: ...


def denoise(
    colour: Array,
    *,
    albedo: Optional[Array] = None,
    normal: Optional[Array] = None,
    layers: Optional[Layers] = None,
    guides: str = "prefilter",
    quality: str = "high",
    ldr: bool = False,
    denoisers: Optional[Path] = None,
    device: AnyDevice = None,
    precision: str = "fp32",
    exposure: Optional[float] = None,
    memory: Optional[float] = None,
    out: Optional[Array] = None,
    progress: Optional[Progress] = None,
) -> Union[Result, tuple[Result, dict[str, Result]]]:
    """Takes the noise out of a render by Open Image Denoise's networks, once import_oidn() has read them.

    colour: [height, width, 3, or 4 with alpha] linear radiance. albedo, normal: [height, width, 3] of the same render, or clean ones; a normal
    needs an albedo. Arrays as upscale() takes them.
    layers: lights of this render that the colour is the sum of, by their names, as upscale() has them; a colour pass, "DiffCol", is one
    [height, width, 3].
    out: an array for the result, of which no byte is the inputs'; None: a new one.
    progress: hears how far it is, and can end it, see Progress. So does KeyboardInterrupt.
    The others are those of Denoiser.

    Returns `out`, or a numpy array of the colour's shape and type: linear radiance, finite whatever the inputs. With layers: that and a dict
    of the same names, each a new float32 array [height, width, 3], never negative: without their noise, they add up to the picture as
    those given do to the colour. With guides="prefilter" colour passes are without their noise, too.

    What is made ready for a size is kept for the next call with the same size and options, until release() or a call of upscale(). Safe in any
    thread; threads wait for each other. Raises what upscale() does.
    """
    low = readable(colour, "colour")
    inputs = tuple(name for name, array in (("albedo", albedo), ("normal", normal)) if array is not None)
    options = {
        "inputs": inputs,
        "guides": guides,
        "quality": quality,
        "ldr": ldr,
        "denoisers": None if denoisers is None else os.fspath(denoisers),
        "precision": precision,
        "exposure": exposure,
        "memory": memory,
    }
    denoiser = _kept(
        (Denoiser, low.width, low.height, *options.values(), os.environ.get("XRDS_DENOISERS")), device, progress,
        lambda opened: Denoiser(low.width, low.height, device=opened, progress=progress, **options),  # type: ignore[arg-type]
    )
    try:
        return denoiser._run(colour, albedo, normal, layers, out, progress)
    except DeviceLost:
        release()
        raise


def release() -> None:
    """Gives back what upscale() and denoise() keep for the next call, with its device. Safe in any thread."""
    global _last
    with _lock:
        _last = None


atexit.register(release)


def _scale(low: _native.Image, given: dict[str, _native.Image]) -> int:
    """The size of the images over that of the colour; 0 without images."""
    scale = 0
    for name, image in given.items():
        found = image.width // low.width
        if found == 0 or (image.width, image.height) != (found * low.width, found * low.height):
            raise ArgumentError(
                f"The {_argument(name)} is {image.width} x {image.height} pixels, expected a whole multiple of the "
                f"colour's {low.width} x {low.height}."
            )
        if scale not in (0, found):
            first = next(iter(given))
            raise ArgumentError(
                f"The {_argument(name)} is {image.width} x {image.height} pixels and the {_argument(first)} "
                f"{given[first].width} x {given[first].height}, expected one size."
            )
        scale = found
    return scale


def _suitable(scale: int, given: dict[str, _native.Image], merged: bool, samples: Optional[Samples], skip: Skip) -> str:
    skips = skip not in (None, "off", 0)  # the full models, and those of few samples, cannot
    inputs = [name for name in given if name != "colour" or (merged and not skips)]
    return _native.choose_model(scale, inputs, float(samples[0]) if samples and not skips else 0)


def _constant(arrays: dict[str, Array]) -> Optional[str]:
    """Of albedo and normal the first that is the same everywhere, and tells nothing."""
    return next((name for name in ("albedo", "normal") if name in arrays and is_constant(arrays[name])), None)


def _without(constant: str, scale: int) -> Optional[str]:
    """The model that does without it; None where none of the scale is shipped."""
    name = f"xrds-x{scale}-compact-" + ("plain" if constant == "albedo" else "albedo")
    try:
        _native.find_model(name)
    except Error:
        return None
    return name


def _kept(key: tuple[Any, ...], device: AnyDevice, progress: Optional[Progress], make: Callable[[Device], Kept]) -> Kept:
    """What the last call made if it fits, or something new on the same device."""
    global _last
    key = (*key, device)
    with _lock:
        if _last is not None and _last[0] == key:
            return _last[2]  # type: ignore[return-value]  # the key tells the class
        opened: AnyDevice = _last[2].device if _last is not None and _last[1] == device else device
        _last = None  # its memory first
    if not isinstance(opened, Device):
        opened = Device(opened, progress=progress)
    made = make(opened)
    with _lock:
        _last = (key, device, made)
    return made
