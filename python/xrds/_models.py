from __future__ import annotations

import os
import pathlib
from typing import Optional, Union

from . import _native


class Model:
    """A model: a shipped one by its name, as "xrds-x4-compact", or a .safetensors file. Never changes; safe to share.

    Raises Error if there is none, with the names of those there are, or the file is not one.
    """

    def __init__(self, name_or_file: Union[str, "os.PathLike[str]"]) -> None:
        self.name = pathlib.PurePath(name_or_file).stem if _is_file(name_or_file) else os.fspath(name_or_file)
        self._native = _native.Model(os.fspath(name_or_file))

    @property
    def scale(self) -> int:
        """Output pixels to a side of a colour pixel."""
        return self._native.scale

    @property
    def inputs(self) -> tuple[str, ...]:
        """The images that it takes beside the colour: "albedo", "normal", "depth", "diffuse", "glossy", "colour" (that
        of the full-resolution render)."""
        return tuple(self._native.inputs)

    def metadata(self, key: str) -> Optional[str]:
        """A field of the file's metadata, as "license"; None if it has none."""
        return self._native.metadata(key)


def models() -> list[str]:
    """The names of the shipped models, of which the README has a table."""
    return sorted({file.stem for folder in _native.model_folders() for file in pathlib.Path(folder).glob("*.safetensors")})


def _is_file(name_or_file: Union[str, "os.PathLike[str]"]) -> bool:
    return os.fspath(name_or_file).endswith(".safetensors")
