"""Pixels that are not finite, filled as the library and the command do it: before a denoiser sees them."""

from __future__ import annotations

import numpy

from ._arrays import Array, Result


def plain(array: Array) -> Result:
    """Three channels of an array of any library, in 32 bits."""
    image = array if isinstance(array, numpy.ndarray) else numpy.from_dlpack(array)
    return image[..., :3].astype(numpy.float32)


def filled(array: Array, is_radiance: bool) -> tuple[Result, int]:
    """plain() with each pixel that is not finite as the mean of its finite neighbours, ring by ring, and how many these
    were. Of radiance what is negative is 0 before."""
    image = plain(array)
    finite = numpy.isfinite(image).all(-1)
    if is_radiance:
        image[finite] = numpy.where(image[finite] < 0, numpy.float32(0), image[finite])
    count = int(finite.size - numpy.count_nonzero(finite))
    image[~finite] = 0
    while not finite.all():
        height, width = finite.shape
        around, known = numpy.pad(image.astype(numpy.float64), ((1, 1), (1, 1), (0, 0))), numpy.pad(finite, 1)
        sums, found = numpy.zeros(image.shape), numpy.zeros(finite.shape)
        for y in range(3):
            for x in range(3):
                sums += around[y : y + height, x : x + width]  # 0 where nothing is known
                found += known[y : y + height, x : x + width]
        ring = ~finite & (found > 0)
        if not ring.any():
            break
        image[ring] = (sums[ring] / found[ring][:, None]).astype(numpy.float32)
        finite |= ring
    return image, count


def finite_radiance(array: Array) -> Result:
    return filled(array, True)[0]
