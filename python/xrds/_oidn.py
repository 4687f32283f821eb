"""The networks of Open Image Denoise, out of the user's own library."""

from __future__ import annotations

import os
import pathlib
from typing import Optional, Union

from . import _native
from ._errors import Error

Path = Union[str, "os.PathLike[str]"]


def import_oidn(library: Path, folder: Optional[Path] = None) -> list[pathlib.Path]:
    """Reads the networks of Open Image Denoise out of its library, and writes each as a model file.

    library: libOpenImageDenoise_core.so of a package of the system or of `pip install pyoidn`, or one file NAME.tza.
    folder: made if it is not there; None: denoiser_folder(), where `xrds denoise` looks for them.

    Returns the files. Each is a Model of scale 1, whose "colour" is what it takes the noise out of: Upscaler runs it.
    Raises Error if the library is none or is damaged, or a file cannot be written.
    """
    target = denoiser_folder() if folder is None else pathlib.Path(folder)
    return [pathlib.Path(file) for file in _native.import_oidn(os.fspath(library), os.fspath(target))]


def denoiser_folder() -> pathlib.Path:
    """$XRDS_DENOISERS, else the folder of the user's data. Raises Error if the environment names none."""
    folder = _native.denoiser_folder()
    if not folder:
        raise Error("The environment names no folder for denoisers: set XRDS_DENOISERS, or give a folder.")
    return pathlib.Path(folder)
