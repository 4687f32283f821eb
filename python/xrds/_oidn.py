"""The networks of Open Image Denoise, out of the user's own library."""

from __future__ import annotations

import os
import pathlib
from typing import Optional, Union

from . import _native
from ._errors import Error
from ._models import Model

Path = Union[str, "os.PathLike[str]"]

_SIZES = {"high": ("_large", ""), "balanced": ("",), "fast": ("_small", "")}  # ends of the files' names, by quality


def import_oidn(library: Path, folder: Optional[Path] = None) -> list[pathlib.Path]:
    """Reads the networks of Open Image Denoise out of its library, and writes each as a model file.

    library: libOpenImageDenoise_core.so of a package of the system or of `pip install pyoidn`, or one file NAME.tza.
    folder: made if it is not there; None: denoiser_folder(), where `xrds denoise` looks for them.

    Returns the files. Each is a Model of scale 1, whose "colour" is what it takes the noise out of: Upscaler runs it.
    Raises Error if the library is none or is damaged, or a file cannot be written.
    """
    target = denoiser_folder() if folder is None else pathlib.Path(folder)
    return [pathlib.Path(file) for file in _native.import_oidn(os.fspath(library), os.fspath(target))]


def can_denoise(folder: Optional[Path] = None) -> bool:
    """Whether the networks are there that `denoise_first` runs in front of models of albedo and normal.

    folder: None: denoiser_folder().
    """
    try:
        home = _home(folder)
    except Error:
        return False
    return all(_file(home, kind) for kind in _kinds(("albedo", "normal"), False) if kind)


def networks_in_front(inputs: tuple[str, ...], folder: Optional[Path], clean_guides: bool) -> list[Optional[Model]]:
    """The networks in front of a model with these inputs: of the colour, and of albedo and normal unless these are clean.

    folder: None: denoiser_folder(). Raises Error if one is missing.
    """
    home = _home(folder)
    return [_network(home, kind) if kind else None for kind in _kinds(inputs, clean_guides)]


def networks_alone(
    inputs: tuple[str, ...], guides: str, quality: str, ldr: bool, folder: Optional[Path]
) -> tuple[Model, dict[str, Model]]:
    """The network of a colour with these images, and those that take the noise out of them before.

    guides, quality, ldr: those of Denoiser. Raises Error if one is missing.
    """
    home, sizes = _home(folder), _SIZES[quality]
    prefilters = {name: kind for name, kind in (("albedo", "rt_alb"), ("normal", "rt_nrm")) if guides == "prefilter" and name in inputs}
    noisy = len(inputs) == 2 and guides == "noisy"
    colour = "rt_hdr_alb_nrm" if noisy else _kinds(inputs, True)[0]
    if ldr:
        colour = colour.replace("hdr", "ldr")
    return _network(home, colour, sizes), {name: _network(home, kind, sizes) for name, kind in prefilters.items()}


def _kinds(inputs: tuple[str, ...], clean_guides: bool) -> list[str]:
    """Of the colour, the albedo and the normal; empty: none."""
    guides = 0 if "albedo" not in inputs else 1 if "normal" not in inputs else 2
    return [
        "rt_hdr" + ("", "_alb", "_calb_cnrm")[guides],
        "" if clean_guides or "albedo" not in inputs else "rt_alb",
        "" if clean_guides or "normal" not in inputs else "rt_nrm",
    ]


def _home(folder: Optional[Path]) -> pathlib.Path:
    return denoiser_folder() if folder is None else pathlib.Path(folder)


def _file(folder: pathlib.Path, kind: str, sizes: tuple[str, ...] = _SIZES["high"]) -> Optional[pathlib.Path]:
    """Of its sizes the first that is there; None: there is none."""
    files = (folder / f"{kind}{size}.safetensors" for size in sizes)
    return next((file for file in files if file.exists()), None)


def _network(folder: pathlib.Path, kind: str, sizes: tuple[str, ...] = _SIZES["high"]) -> Model:
    file = _file(folder, kind, sizes)
    if file is None:
        raise Error(
            f"There is no network {kind} of Open Image Denoise in '{folder}': read them once out of your own copy with "
            "xrds.import_oidn(LIBRARY)."
        )
    return Model(file)


def denoiser_folder() -> pathlib.Path:
    """$XRDS_DENOISERS, else the folder of the user's data. Raises Error if the environment names none."""
    folder = _native.denoiser_folder()
    if not folder:
        raise Error("The environment names no folder for denoisers: set XRDS_DENOISERS, or give a folder.")
    return pathlib.Path(folder)
