"""Frames of an animation, merged along their motion."""

from __future__ import annotations

import dataclasses
import numbers
from typing import Any, Optional, Sequence

import numpy
import numpy.typing

from . import _native
from ._arrays import Array, Result, readable, writable
from ._devices import Device
from ._errors import ArgumentError, check_kind
from ._held import Held
from ._upscaler import AnyDevice

_IMAGES = ("colour", "full_colour", "albedo", "normal")


@dataclasses.dataclass(frozen=True)
class TemporalFrame:
    """A frame to merge, or what became of it. Frames that are merged with each other have the same images.

    Images and numbers are float16 or float32, as those of upscale(), pixels of images that are not finite count as their
    neighbours, too. [h, w] is the low, [s h, s w] the full resolution.
    """

    colour: Array
    """[h, w, 3] linear radiance."""
    full_colour: Optional[Array] = None
    """[s h, s w, 3] linear radiance."""
    albedo: Optional[Array] = None
    """[s h, s w, 3]."""
    normal: Optional[Array] = None
    """[s h, s w, 3]."""
    depth: Optional[Array] = None
    """[s h, s w] distances in any unit; at least 1e8, 0 or less: background."""
    to_previous: Optional[Array] = None
    """[s h, s w, 2] pixels of the full resolution from what a pixel shows to where the frame before shows it: x to the
    right, y down. None: frames before cannot be used. What is not finite counts as gone. cycles_motion() makes both."""
    to_next: Optional[Array] = None
    """[s h, s w, 2] the same to the frame after."""
    low_counts: Optional[Array] = None
    """[h, w]: how many frames a pixel of the colour is the mean of; None: one."""
    full_counts: Optional[Array] = None
    """[s h, s w]: the same of the full-resolution colour."""


class TemporalFilter(Held[_native.TemporalFilter]):
    """Merges each frame of an animation with those around it, before the upscaler sees it: less flicker and noise.

    width, height: of the low-resolution colour, pixels; scale: 1, 2, 4, 8 or 16.
    device: a Device, or what Device takes; None: the best one.

    `merged = filter(frame, before, after)`. Threads that use one filter wait for each other. Raises ArgumentError,
    OutOfMemory and Error.
    """

    RADIUS, RADIUS_OF_STILL = 5, 10
    """Frames before and after that are worth it, and while most of the picture stands still."""

    def __init__(self, width: int, height: int, scale: int, *, device: AnyDevice = None) -> None:
        check_kind([width, height, scale], numbers.Integral, "size or scale", "a whole number")
        if not (0 < width < 2**32 and 0 < height < 2**32 and 0 < scale < 2**32):
            raise ArgumentError(f"There is no frame of {width} x {height} pixels to merge for scale {scale}.")
        self.width, self.height, self.scale = width, height, scale
        self.device = device if isinstance(device, Device) else Device(device)
        super().__init__(_native.TemporalFilter(self.device._native, width, height, scale))

    def __call__(
        self, present: TemporalFrame, before: Sequence[TemporalFrame] = (), after: Sequence[TemporalFrame] = ()
    ) -> TemporalFrame:
        """The frame merged with those before and those after it, of both the nearest first.

        Returns the same with new images [.., .., 3] of float32, of those that `present` has, and both counts. Upscale
        them with `merged=True` if the colour was that of merge_colour(). The result depends on these frames alone. For
        live pictures `before` is the last result alone. Raises ArgumentError for images and numbers of a wrong shape.
        """
        images: dict[str, Result] = {
            name: numpy.empty((*self._size(name != "colour"), 3), numpy.float32)
            for name in _IMAGES
            if getattr(present, name) is not None
        }
        counts = {
            "low_counts": numpy.empty(self._size(False), numpy.float32),
            "full_counts": numpy.empty(self._size(True), numpy.float32),
        }
        result = _native.TemporalFrame(
            **{name: writable(images[name], name) if name in images else None for name in _IMAGES},
            depth=None,
            to_previous=None,
            to_next=None,
            low_counts=counts["low_counts"],
            full_counts=counts["full_counts"],
        )
        now, past, future = self._given(present), [*map(self._given, before)], [*map(self._given, after)]
        with self._lock:
            self._native.run(now, past, future, result)
        return dataclasses.replace(present, **images, **counts)

    def _size(self, full: bool) -> tuple[int, int]:
        factor = self.scale if full else 1
        return factor * self.height, factor * self.width

    def _given(self, frame: TemporalFrame) -> _native.TemporalFrame:
        full, low = self._size(True), self._size(False)
        images = {name: getattr(frame, name) for name in _IMAGES}
        return _native.TemporalFrame(
            **{name: None if image is None else readable(image, name) for name, image in images.items()},
            depth=_numbers(frame.depth, "depth", full),
            to_previous=_numbers(frame.to_previous, "to_previous", (*full, 2)),
            to_next=_numbers(frame.to_next, "to_next", (*full, 2)),
            low_counts=_numbers(frame.low_counts, "low_counts", low),
            full_counts=_numbers(frame.full_counts, "full_counts", full),
        )


def cycles_motion(vector: Array) -> tuple[Result, Result]:
    """(to_previous, to_next) of a TemporalFrame, out of Cycles' pass Vector [height, width, 4].

    Cycles makes that pass where motion blur is off. Raises ArgumentError.
    """
    motion = _floats(vector)
    if motion.ndim != 3 or motion.shape[2] != 4:
        raise ArgumentError(f"The vector has the shape {list(motion.shape)}, expected [height, width, 4].")
    signs = numpy.array([1, -1, -1, 1], numpy.float32)
    signed = motion * signs
    return signed[..., :2], signed[..., 2:]


def _numbers(array: Optional[Array], name: str, shape: tuple[int, ...]) -> Optional[numpy.typing.NDArray[Any]]:
    if array is None:
        return None
    numbers = _floats(array)
    if numbers.shape != shape:
        raise ArgumentError(f"The {name} has the shape {list(numbers.shape)}, expected {list(shape)}.")
    # Writable, as the library takes counts of either kind.
    return numpy.require(numbers, numpy.float32, ["C", "W"])


def _floats(array: Array) -> numpy.typing.NDArray[Any]:
    found = array if isinstance(array, numpy.ndarray) else numpy.from_dlpack(array)
    return numpy.asarray(found, numpy.float32)
