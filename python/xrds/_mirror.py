"""The mirrored images of an ensemble, as include/xrds/mirror.h has them."""

from __future__ import annotations

from typing import NamedTuple

import numpy

from ._arrays import Result


class Mirror(NamedTuple):
    """First on the diagonal, then left to right and upside down."""

    left_right: bool
    upside_down: bool
    transposed: bool

    def image(self, image: Result, is_normal: bool = False) -> Result:
        """The mirrored image; the components of a normal turn along."""
        result = image.swapaxes(0, 1) if self.transposed else image
        result = result[:: -1 if self.upside_down else 1, :: -1 if self.left_right else 1]
        if not is_normal:
            return result
        x = -1 if self.left_right != self.transposed else 1
        y = -1 if self.upside_down != self.transposed else 1
        turned: Result = result[..., [1, 0, 2]] if self.transposed else result
        turned = turned * numpy.array([x, y, 1], numpy.float32)
        return turned

    def back(self, image: Result) -> Result:
        """The image that a mirrored one is of."""
        result = image[:: -1 if self.upside_down else 1, :: -1 if self.left_right else 1]
        return result.swapaxes(0, 1) if self.transposed else result


def mirrors(passes: int) -> list[Mirror]:
    """Those of an ensemble of 1, 2, 4 or 8 passes, the image as it is last."""
    diagonal = [Mirror(True, False, True), Mirror(False, True, True), Mirror(True, True, True), Mirror(False, False, True)]
    straight = [Mirror(True, False, False), Mirror(False, True, False), Mirror(True, True, False), Mirror(False, False, False)]
    return [*diagonal, *straight][-passes:]
