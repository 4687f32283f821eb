"""Open Image Denoise on the colours of a scene, as `xrds upscale --denoise-first` runs it: needs pyoidn (bench/oidn-requirements.txt)."""
import functools
import pathlib
import sys

import numpy as np
import torch

import pipeline

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "bench"))


@functools.cache
def device():
    import pyoidn
    device = pyoidn.Device(pyoidn.OIDN_DEVICE_TYPE_CPU)
    device.commit()
    return device


def denoised(colour, aux):
    """Radiance [3, h, w] of a noisy one and its albedo and normal [6 or more, h, w], which are denoised first, each by its own filter."""
    import oidn
    array = lambda image: np.ascontiguousarray(image.float().permute(1, 2, 0).numpy())
    images = {"color": array(pipeline.finite(colour)), "albedo": array(aux[:3].clamp(0, 1)), "normal": array(aux[3:6])}
    return torch.from_numpy(oidn.denoise(device(), images, prefilter=True)[0]).permute(2, 0, 1)


def denoised_low(colour, aux, scale):
    """The same of the low-resolution colour [3, h, w], with box means of the auxiliary images [6 or more, s*h, s*w]."""
    return denoised(colour, pipeline.box_mean(aux[None].float(), scale)[0])
