"""xrds upscales noisy low-resolution renders with the help of full-resolution albedo and normals, on any Vulkan device.

    import xrds
    picture = xrds.upscale(colour, albedo=albedo, normal=normal)

Arrays in and out are numpy's, or of any library with DLPack. See upscale() and denoise(); Upscaler,
Denoiser and TemporalFilter for sequences; devices().
"""

from . import _native
from ._arrays import Array, SupportsDlpack
from ._colour import Samples, merge_colour
from ._denoiser import Denoiser
from ._devices import Device, DeviceDescription, devices
from ._errors import ArgumentError, Cancelled, DeviceLost, Error, OutOfMemory
from ._frame import denoise, release, upscale
from ._layers import Layers
from ._models import Model, models
from ._oidn import can_denoise, denoiser_folder, import_oidn
from ._progress import Progress
from ._temporal import TemporalFilter, TemporalFrame, cycles_motion
from ._upscaler import Repairs, Upscaler

__version__ = _native.version()
__all__ = [
    "ArgumentError",
    "Array",
    "Cancelled",
    "Denoiser",
    "Device",
    "DeviceDescription",
    "DeviceLost",
    "Error",
    "Layers",
    "Model",
    "OutOfMemory",
    "Progress",
    "Repairs",
    "Samples",
    "SupportsDlpack",
    "TemporalFilter",
    "TemporalFrame",
    "Upscaler",
    "can_denoise",
    "cycles_motion",
    "denoise",
    "denoiser_folder",
    "devices",
    "import_oidn",
    "merge_colour",
    "models",
    "release",
    "upscale",
]
