from __future__ import annotations

import threading
from types import TracebackType
from typing import Generic, Optional, Protocol, TypeVar


class OnDevice(Protocol):
    @property
    def device_bytes(self) -> int: ...
    def close(self) -> None: ...


Native = TypeVar("Native", bound=OnDevice)
Self = TypeVar("Self", bound="Held")  # type: ignore[type-arg]


class Held(Generic[Native]):
    """What holds memory of a device until it is closed. One thread at a time has it."""

    def __init__(self, native: Native) -> None:
        self._lock = threading.RLock()  # a progress that uses what runs is refused, not left waiting
        self._native = native

    @property
    def device_bytes(self) -> int:
        """Memory of the device that this holds."""
        with self._lock:
            return self._native.device_bytes

    def close(self) -> None:
        """Gives its memory back now. It is of no more use; without it, this comes by itself."""
        with self._lock:
            self._native.close()

    def __enter__(self: Self) -> Self:
        return self

    def __exit__(
        self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self.close()
