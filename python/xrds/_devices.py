from __future__ import annotations

import dataclasses
from typing import Optional, Union

from . import _native
from ._progress import Progress, heard


@dataclasses.dataclass(frozen=True)
class DeviceDescription:
    """A Vulkan device."""

    name: str
    kind: str
    """"discrete", "integrated", "virtual", "cpu" or "other"."""
    uuid: str
    """32 hexadecimal digits, the same after a restart."""
    driver: str
    api_version: str
    kernel_family: str
    """Of the kernels that it runs: "plain", "lane", "tile", "matrix" or "fused"."""
    memory: int
    """Bytes."""


def devices() -> list[DeviceDescription]:
    """The Vulkan devices of this machine; the place of each is what Device takes as its number.

    Raises Error where there is no Vulkan loader. Safe in any thread.
    """
    return [DeviceDescription(**fields) for fields in _native.devices()]


class Device:
    """A Vulkan device, opened for compute. Frames of one device wait for each other.

    select: its number in devices(), a part of its name, or its UUID; None: the best one.
    cache_folder: of compiled programs; None: the user's cache folder.
    kernel_family: None: what suits the device.
    progress: hears how programs are made, see Progress.

    Raises Error if no such device is found, naming those there are. Safe in any thread.
    """

    def __init__(
        self,
        select: Union[str, int, None] = None,
        *,
        cache_folder: Optional[str] = None,
        kernel_family: Optional[str] = None,
        progress: Optional[Progress] = None,
    ) -> None:
        chosen = None if select is None else str(select)
        self._native = _native.Device(chosen, cache_folder, kernel_family, heard(progress))

    def description(self) -> DeviceDescription:
        """What this device is."""
        return DeviceDescription(**self._native.fields())

    def close(self) -> None:
        """Gives it back now, or with the last upscaler on it. It is of no more use; without it, this comes by itself."""
        self._native.close()
