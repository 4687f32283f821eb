"""Open Image Denoise on the images of a scene, as `xrds upscale --denoise-first` runs it: needs pyoidn (bench/oidn-requirements.txt)."""
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


def filtered(images, flags):
    """The filter's image [3, h, w], on the images' device, of {name: image [3, h, w]}."""
    import oidn
    arrays = {name: np.ascontiguousarray(image.float().permute(1, 2, 0).cpu().numpy()) for name, image in images.items()}
    return torch.from_numpy(oidn.filtered(device(), arrays, flags)[0]).permute(2, 0, 1).to(next(iter(images.values())).device)


def denoised_guides(aux, first_lights=()):
    """The auxiliary images [6 or more, h, w], of which albedo and normal, the first six, are denoised, each by its own filter, and then the
    lights that begin at `first_lights`, with those two for guides. What an albedo has above 1, as that of lights and background may, stays as it is."""
    albedo = aux[:3].float()
    inside = albedo.clamp(0, 1)
    found = torch.cat([filtered({"albedo": inside}, {}) + albedo - inside, filtered({"normal": aux[3:6]}, {}), aux[6:].float()])
    for first in first_lights:
        found[first:first + 3] = denoised(found[first:first + 3], found)
    return found


def denoised(colour, guides):
    """Radiance [3, h, w] of a noisy one and denoised guides [6 or more, h, w]."""
    images = {"color": pipeline.finite(colour), "albedo": guides[:3].clamp(0, 1), "normal": guides[3:6]}
    return filtered(images, {"hdr": True, "cleanAux": True})


def denoised_low(colour, guides, scale):
    """The same of the low-resolution colour [3, h, w], with box means of denoised guides [6 or more, s*h, s*w]."""
    return denoised(colour, pipeline.box_mean(guides[None].float(), scale)[0])


def denoised_full(full, merged, guides, scale):
    """The same of the full-resolution colour [3, s*h, s*w], brought to the level of the merged one [3, h, w] before."""
    return denoised(pipeline.levelled_colour(full, merged, scale), guides)
