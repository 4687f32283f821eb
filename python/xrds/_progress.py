from __future__ import annotations

from collections.abc import Callable

Progress = Callable[[str, float], object]
"""A function that hears what goes on and the share of it that is done, in [0, 1]: "loading" while the driver reads
programs, "compiling" while one for CPUs compiles what its cache lacks (minutes, once), "tuning" while the fastest
kernels are found, "upscaling". Returning False ends the call with Cancelled; what it raises ends the call, too. It is
called in the thread of the call and cannot make another call of this package."""
