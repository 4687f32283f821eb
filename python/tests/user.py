"""What a user writes, for the type checker (test_types.py); it is never run."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

import xrds

colour: npt.NDArray[np.float32] = np.zeros((2, 3, 3), np.float32)
albedo: npt.NDArray[np.float16] = np.zeros((8, 12, 3), np.float16)


def hear(stage: str, share: float) -> bool:
    print(stage.upper(), 100 * share)
    return True


picture: npt.NDArray[np.float32] = xrds.upscale(colour, albedo=albedo, normal=albedo, samples=(64, 16), progress=hear)
both: tuple[npt.NDArray[np.float32], dict[str, npt.NDArray[np.float32]]] = xrds.upscale(
    colour, albedo=albedo, layers={"Emit": colour, "DiffCol": (colour, albedo)}
)
both = xrds.denoise(colour, layers={"Emit": colour})
names: list[str] = [device.name for device in xrds.devices()]
model = xrds.Model(Path("model.safetensors"))
scale: int = model.scale
with xrds.Upscaler(3, 2, model, device=xrds.Device("llvmpipe"), precision="fp16", skip="safe") as upscaler:
    upscaler(colour, albedo=albedo, normal=albedo, out=picture)
    used: int = upscaler.device_bytes
frame = xrds.TemporalFrame(colour, albedo=albedo, to_previous=xrds.cycles_motion(picture)[0])
with xrds.TemporalFilter(3, 2, 4, device="llvmpipe") as merging:
    calm: xrds.TemporalFrame = merging(frame, before=[frame])
xrds.upscale(calm.colour, albedo=calm.albedo, merged=True)
files: list[Path] = xrds.import_oidn("libOpenImageDenoise_core.so")
try:
    merged: npt.NDArray[np.float32] = xrds.merge_colour(colour, albedo)
except xrds.ArgumentError as error:
    text: str = str(error)
