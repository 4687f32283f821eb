"""Arrays of pixels, of any library that shares them by DLPack or the buffer protocol."""

from __future__ import annotations

from typing import Any, Optional, Protocol, Union, cast

import numpy
import numpy.typing

from . import _native
from ._errors import ArgumentError

Result = numpy.typing.NDArray[Any]  # of float16 or float32


class SupportsDlpack(Protocol):
    """An array of another library, as a torch.Tensor on the CPU."""

    def __dlpack__(self, *args: Any, **kwargs: Any) -> Any: ...

    def __dlpack_device__(self) -> Any: ...


Array = Union[numpy.typing.NDArray[Any], SupportsDlpack]


def readable(array: Array, name: str) -> _native.Image:
    if isinstance(array, numpy.ndarray) and not _can_be_shared(array):
        array = numpy.ascontiguousarray(array, array.dtype.newbyteorder("="))
    return _native.Image(array, name, False)


def is_constant(array: Array) -> bool:
    """Whether all of its pixels are the same."""
    image = array if isinstance(array, numpy.ndarray) else numpy.from_dlpack(array)
    return bool((image[0, ..., :3] == image[0, 0, :3]).all() and (image[..., :3] == image[0, 0, :3]).all())


def _can_be_shared(array: numpy.typing.NDArray[Any]) -> bool:
    """Whether DLPack can tell where its numbers are, and they are of this machine."""
    return array.dtype.isnative and not any(stride % array.itemsize for stride in array.strides)


def writable(array: Array, name: str) -> _native.Image:
    return _native.Image(array, name, True)


def output_for(low: _native.Image, scale: int, out: Optional[Array]) -> Result:
    """`out`, of whatever library, or a new array of the type and channels of the colour."""
    if out is not None:
        return cast(Result, out)
    return numpy.empty((scale * low.height, scale * low.width, low.channels), low.dtype)


def refuse_overlap(output: _native.Image, inputs: list[_native.Image]) -> None:
    for image in inputs:
        if output.overlaps(image):
            raise ArgumentError(f"The output shares memory with the {image.name}: give another array.")
