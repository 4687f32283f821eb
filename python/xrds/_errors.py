"""What goes wrong, as exceptions; the text of each is one sentence that says what failed and what to do."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Union


class Error(RuntimeError):
    """A failure of the world around the package: a file, a driver, no device."""


class ArgumentError(Error, ValueError):
    """What was given cannot be: a shape, an option. A ValueError, too."""


class OutOfMemory(Error):
    """The device, or the `memory` that it may take, or the host has no room for what was asked. Less may fit."""


class DeviceLost(Error):
    """A device stopped working. What was made on it is of no more use; it may be opened again."""


class Cancelled(Error):
    """The function that heard the progress returned False."""


def check_kind(values: Iterable[object], kind: Union[type, tuple[type, ...]], name: str, expected: str) -> None:
    """Raises TypeError unless all values are of the kind, such as numbers.Real."""
    for value in values:
        if not isinstance(value, kind):
            raise TypeError(f"The {name} is {value!r}, expected {expected}.")
