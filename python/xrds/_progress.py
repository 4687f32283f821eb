from __future__ import annotations

from collections.abc import Callable
from typing import Optional

Progress = Callable[[str, float], object]
"""A function that hears what goes on and the share of it that is done, in [0, 1]: "loading" while the driver reads
programs, "compiling" while one for CPUs compiles what its cache lacks (minutes, once), "tuning" while the fastest
kernels are found, "upscaling". Returning False ends the call with Cancelled; what it raises ends the call, too. It is
called in the thread of the call and cannot make another call of this package."""


def heard(progress: Optional[Progress]) -> Optional[Progress]:
    if progress is not None and not callable(progress):
        raise TypeError(f"The progress is {progress!r}, expected a function, or None.")
    return progress


def steps(progress: Optional[Progress], count: int) -> list[Optional[Progress]]:
    """What so many steps, one after the other, tell of their shares: the share of all of them."""

    def part(number: int) -> Optional[Progress]:
        return progress and (lambda stage, share: progress(stage, (number + share) / count))

    return [part(number) for number in range(count)]
