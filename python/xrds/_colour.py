"""The colours of the two renders of a frame, merged into one."""

from __future__ import annotations

import math
import numbers
import warnings
from typing import Optional

import numpy

from . import _native
from ._arrays import Array, Result, output_for, readable, writable
from ._errors import ArgumentError, check_kind

Samples = tuple[float, float]
MOST_DIFFERENCE = 0.1  # of colours that are of the same light


def merge_colour(low: Array, full: Array, *, samples: Optional[Samples] = None, out: Optional[Array] = None) -> Result:
    """The mean of a low-resolution colour and that of the full-resolution render, weighted by samples.

    low: [height, width, 3 or 4] linear radiance; full: [scale height, scale width, 3] the same.
    samples: of a pixel of both, as (64, 16); None: estimated from the noise. Pixels that are not finite count as their neighbours.
    out: None: a new array of the type of `low`.

    Returns [height, width, channels of low]; its alpha is that of `low`. Raises ArgumentError. Safe in any thread.
    """
    image = readable(low, "colour")
    result = output_for(image, 1, out)
    merge_into(result, image, readable(full, "full_colour"), samples)
    return result


def merge_into(result: Result, low: _native.Image, full: _native.Image, samples: Optional[Samples]) -> None:
    of_low, of_full = checked(samples)
    _native.merge_colour(low, full, of_low, of_full, writable(result, "out"))


def merged_or_none(low: _native.Image, full: _native.Image, samples: Optional[Samples]) -> Optional[Result]:
    """In 32 bits; None, with a warning, where nobody says that the two belong together and they do not."""
    if samples is None:
        difference = _native.compare_colour(low, full)
        if difference > MOST_DIFFERENCE:
            warnings.warn(
                f"The full_colour differs from the colour by {100 * difference:.0f} %: it is of other light, and is not "
                "used; samples=(LOW, FULL) uses it.",
                stacklevel=3,
            )
            return None
    merged = numpy.empty((low.height, low.width, low.channels), numpy.float32)
    merge_into(merged, low, full, samples)
    return merged


def checked(samples: Optional[Samples]) -> Samples:
    if samples is None:
        return 0, 0
    if not hasattr(samples, "__len__"):
        raise TypeError(f"The samples are {samples!r}, expected two numbers, as (64, 16).")
    check_kind(samples, numbers.Real, "number of samples", "two numbers, as (64, 16)")
    if len(samples) != 2 or not all(0 < number < math.inf for number in samples):
        raise ArgumentError(f"The samples are {' and '.join(map(str, samples))}, expected two positive numbers.")
    low, full = samples
    return float(low), float(full)
