"""Layers of light that are upscaled with a picture and still add up to it."""

from __future__ import annotations

import warnings
from typing import Mapping, Optional, Union

import numpy

from . import _native
from ._arrays import Array, Result, readable, writable
from ._errors import ArgumentError

Layers = Mapping[str, Union[Array, tuple[Array, Array]]]
Light = tuple[_native.Image, _native.Image, int, bool]
Colour = tuple[_native.Image, _native.Image, _native.Image]

_COLOUR_OF = {"Dir": "Col", "Ind": "Col", " Direct": " Color", " Indirect": " Color"}  # Cycles, and Blender 5
_COLOURS = ("Col", " Color")
_WITHOUT_ALBEDO = ("emit", "env", "emission", "environment", "volumedir", "volumeind", "volume direct", "volume indirect")
_GROUP = "combined_"  # a light group of Cycles: all groups together are the colour once more
_WHOLE = "combined"
_MOST = 1.05  # of the colour that layers may make up


class LayerRun:
    """The layers of one frame on their way through the library."""

    def __init__(self, layers: Layers, low: _native.Image, scale: int) -> None:
        self.results: dict[str, Result] = {}
        self._shape = (scale * low.height, scale * low.width, 3)
        self.whole: Optional[_native.Image] = None
        passes = {name: layers[name] for name in layers if name.endswith(_COLOURS)}
        colours = [self._colour(name, both) for name, both in passes.items()]
        lights: list[Light] = []
        groups: list[Light] = []
        for name, array in layers.items():
            if name in passes:
                continue
            if isinstance(array, tuple):
                raise ArgumentError(f"The layer {name} is a pair, expected one array: only STEMCol has two.")
            colour, own = _colour_of(name), _own(name)
            if own == _WHOLE:
                self.whole = readable(array, name)
                continue
            place = list(passes).index(colour) if colour in passes else -1
            light = readable(array, name), self._result(name), place, own not in _WITHOUT_ALBEDO
            (groups if own.startswith(_GROUP) else lights).append(light)
        self.sets = [(some, with_colours) for some, with_colours in ((lights, colours), (groups, [])) if some]
        if not self.sets:
            raise ArgumentError("The layers hold no light: leave them out, or give at least one.")

    def _colour(self, name: str, both: Union[Array, tuple[Array, Array]]) -> Colour:
        if not isinstance(both, tuple) or len(both) != 2:
            raise ArgumentError(f"The layer {name} is a colour pass, expected (low, full): those of both renders.")
        return readable(both[0], f"low {name}"), readable(both[1], f"full {name}"), self._result(name)

    def _result(self, name: str) -> _native.Image:
        self.results[name] = numpy.empty(self._shape, numpy.float32)
        return writable(self.results[name], name)

    def hear(self, reports: list[tuple[float, int, int]]) -> None:
        """Warns where the layers hold more light than the colour."""
        most = max(share for share, _, _ in reports)
        if most > _MOST:
            warnings.warn(
                f"The layers add up to {100 * most:.0f} % of the colour: each gets its share of it. Leave out what is the "
                "sum of others.",
                stacklevel=4,
            )


def _own(name: str) -> str:
    """The name without its view layer, in lower case."""
    return name.rpartition(".")[2].lower()


def _colour_of(name: str) -> Optional[str]:
    """The name of the colour pass that multiplies a light, or None."""
    for end, colour in _COLOUR_OF.items():
        if name.endswith(end):
            return name.removesuffix(end) + colour
    return None
