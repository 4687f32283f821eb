"""Layers of light that are made with a picture and still add up to it."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import NamedTuple, Optional, Union

import numpy

from . import _native
from ._arrays import Array, Result, readable, writable
from ._errors import ArgumentError
from ._repair import finite_radiance, plain

Layers = Mapping[str, Union[Array, tuple[Array, Array]]]
Light = tuple[_native.Image, _native.Image, int, bool]
Colour = tuple[_native.Image, _native.Image, _native.Image]
Set = tuple[list[Light], list[Colour], _native.Image]

_COLOUR_OF = {"Dir": "Col", "Ind": "Col", " Direct": " Color", " Indirect": " Color"}  # Cycles, and Blender 5
_COLOURS = ("Col", " Color")
_WITHOUT_ALBEDO = ("emit", "env", "emission", "environment", "volumedir", "volumeind", "volume direct", "volume indirect")
_GROUP = "combined_"  # a light group of Cycles: all groups together are the colour once more
_WHOLE = "combined"
_MOST = 1.05  # of the colour that layers may make up
_ROUNDING, _LEAST_MISSING = 1 / 256, 0.01  # of the colour: what layers may lack of it at a pixel, and in all


class _Light(NamedTuple):
    name: str
    pixels: Array  # [h, w, 3]
    colour: Optional[str]  # the pass that multiplies it
    follows_albedo: bool


class LayerRun:
    """The layers of one frame on their way through the library: their results are in `results` once sets() were run."""

    def __init__(self, layers: Layers, colour: Array, low: _native.Image, scale: int, paired: bool = True) -> None:
        """colour: what they are part of, where they do not say; low: the same; paired: colour passes are of both renders."""
        if not isinstance(layers, Mapping):
            raise TypeError(f"The layers are of type {type(layers).__name__}, expected a dict of arrays by their names, or None.")
        self.results: dict[str, Result] = {}
        self._shape = (scale * low.height, scale * low.width, 3)
        self._whole, self._low = colour, low
        self._size = low.width, low.height
        self._passes = {name: self._pass(name, given, paired) for name, given in layers.items() if name.endswith(_COLOURS)}
        lights: list[_Light] = []
        groups: list[_Light] = []
        for name, array in layers.items():
            if name in self._passes:
                continue
            if isinstance(array, tuple):
                raise ArgumentError(f"The layer {name} is a pair, expected one array: only STEMCol has two.")
            own = _own(name)
            self._check(array, name)
            if own == _WHOLE:
                self._whole, self._low = array, readable(array, name)
                continue
            stem = _colour_of(name)
            light = _Light(name, array, stem if stem in self._passes else None, own not in _WITHOUT_ALBEDO)
            (groups if own.startswith(_GROUP) else lights).append(light)
        self._groups = [some for some in (lights, groups) if some]
        if not self._groups:
            raise ArgumentError("The layers hold no light: leave them out, or give at least one.")
        self._wholes: list[_native.Image] = []  # of each group, once it was denoised

    @property
    def passes(self) -> list[Array]:
        """The colour passes, of the first render."""
        return [low for low, _ in self._passes.values()]

    def noisy(self) -> list[Array]:
        """The images to take the noise out of: lights that are not black, and what of the whole is in no light."""
        self._whole = finite_radiance(self._whole)
        self._groups = [[light._replace(pixels=finite_radiance(light.pixels)) for light in lights] for lights in self._groups]
        self._passes = {name: (finite_radiance(low), finite_radiance(full)) for name, (low, full) in self._passes.items()}
        self._rests = [self._rest(lights) for lights in self._groups]
        self._lit = [[bool(_nonnegative(light.pixels).any()) for light in lights] for lights in self._groups]
        found: list[Array] = []
        for lights, lit, rest in zip(self._groups, self._lit, self._rests):
            found += [light.pixels for light, is_lit in zip(lights, lit) if is_lit]
            found += [rest.astype(numpy.float32)] if rest.any() else []
        return found

    def put(self, clean: list[Result], passes: Optional[list[Result]] = None) -> None:
        """Takes what became of noisy(), and of passes() in the place of both renders'."""
        if passes is not None:
            self._passes = {name: (one, one) for name, one in zip(self._passes, passes)}
        images = iter(clean)
        for place, (lights, lit, rest) in enumerate(zip(self._groups, self._lit, self._rests)):
            made = [light._replace(pixels=next(images)) if is_lit else light for light, is_lit in zip(lights, lit)]
            self._groups[place] = made
            whole = (next(images) if rest.any() else rest) + sum(self._radiance(light) for light in made)
            self._wholes.append(readable(whole.astype(numpy.float32), "whole"))

    def sets(self) -> list[Set]:
        """What the library takes. Colour passes belong to the first of two sets, light groups have none."""
        names = list(self._passes)
        found: list[Set] = []
        for place, lights in enumerate(self._groups):
            used = names if any(light.colour for light in lights) or not found else []
            colours = [(readable(low, f"low {name}"), readable(full, f"full {name}"), self._result(name)) for name, (low, full) in self._passes.items() if name in used]
            some = [
                (readable(light.pixels, light.name), self._result(light.name), names.index(light.colour) if light.colour else -1, light.follows_albedo)
                for light in lights
            ]
            found.append((some, colours, self._wholes[place] if self._wholes else self._low))
        return found

    def hear(self, reports: list[tuple[float, int, int]]) -> None:
        """Warns where the layers hold more light than the colour."""
        most = max(share for share, _, _ in reports)
        if most > _MOST:
            warnings.warn(
                f"The layers add up to {100 * most:.0f} % of the colour: each gets its share of it. Leave out what is the "
                "sum of others.",
                stacklevel=4,
            )

    def _pass(self, name: str, given: Union[Array, tuple[Array, Array]], paired: bool) -> tuple[Array, Array]:
        if paired and (not isinstance(given, tuple) or len(given) != 2):
            raise ArgumentError(f"The layer {name} is a colour pass, expected (low, full): those of both renders.")
        if not paired and isinstance(given, tuple):
            raise ArgumentError(f"The layer {name} is a pair, expected one array: there is one render.")
        low, full = given if isinstance(given, tuple) else (given, given)
        self._check(low, f"low {name}" if paired else name)
        readable(full, f"full {name}")
        return low, full

    def _check(self, array: Array, name: str) -> None:
        image = readable(array, name)
        if (image.width, image.height) != self._size:
            raise ArgumentError("The {} is {} x {} pixels, expected {} x {}.".format(name, image.width, image.height, *self._size))

    def _result(self, name: str) -> _native.Image:
        self.results[name] = numpy.empty(self._shape, numpy.float32)
        return writable(self.results[name], name)

    def _radiance(self, light: _Light) -> Result:
        pixels = _nonnegative(light.pixels)
        return pixels if light.colour is None else pixels * _nonnegative(self._passes[light.colour][0])

    def _rest(self, lights: list[_Light]) -> Result:
        whole = _nonnegative(self._whole)
        rest = whole - sum(self._radiance(light) for light in lights)
        rest[rest <= _ROUNDING * whole] = 0
        return rest if rest.sum() >= _LEAST_MISSING * whole.sum() else numpy.zeros_like(rest)


def _nonnegative(array: Array) -> Result:
    """In double precision, 0 for what is negative."""
    return plain(array).astype(numpy.float64).clip(0)


def _own(name: str) -> str:
    """The name without its view layer, in lower case."""
    return name.rpartition(".")[2].lower()


def _colour_of(name: str) -> Optional[str]:
    """The name of the colour pass that multiplies a light, or None."""
    for end, colour in _COLOUR_OF.items():
        if name.endswith(end):
            return name.removesuffix(end) + colour
    return None
