"""Frames for the tests: noise, and the samples of the repository."""

import os
import pathlib

import numpy
import OpenEXR

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODEL = "xrds-x4-nano"  # the fastest
FULL_MODEL = ROOT / "tests/golden/s4_full.model.safetensors"  # of random weights, takes the full colour, and is faster than xrds-x4-full


def noise(height, width, channels=3, seed=1):
    return numpy.random.default_rng(seed).uniform(0.05, 1, (height, width, channels)).astype(numpy.float32)


def frame(height=12, width=16, scale=4):
    """Colour, and albedo and normal by their names. So small a one is made ready soonest (docs/caches.md)."""
    size = scale * height, scale * width
    return noise(height, width), {"albedo": noise(*size, seed=2), "normal": noise(*size, seed=3)}


def layers(file):
    """The layers of an EXR file, [h, w, 3] each."""
    found = {}
    for name, channel in OpenEXR.File(os.fspath(file)).channels().items():
        layer, _, last = name.rpartition(".")
        if last == "X":
            planes = [OpenEXR.File(os.fspath(file)).channels()[f"{layer}.{axis}"].pixels for axis in "XYZ"]
            found[layer] = numpy.stack(planes, -1)
        elif last not in ("Y", "Z"):
            found[name] = channel.pixels
    return found


def small_denoisers(folder):
    """The folder, made, with small ones of random weights under the names of Open Image Denoise's."""
    folder.mkdir()
    for name, golden in {"rt_hdr_calb_cnrm_large": "hdr_albedo_normal_large", "rt_alb": "albedo_small", "rt_nrm": "normal_small"}.items():
        (folder / f"{name}.safetensors").write_bytes((ROOT / f"tests/golden/unet/{golden}.model.safetensors").read_bytes())
    return folder


def sample(name):
    """Colour, albedo and normal of a sample, as 32-bit floats."""
    colour = layers(ROOT / "samples" / f"{name}_lr64.exr")["ViewLayer.Combined"]
    full = layers(ROOT / "samples" / f"{name}_aux16.exr")
    images = colour, full["ViewLayer.Denoising Albedo"], full["ViewLayer.Denoising Normal"]
    return [image.astype(numpy.float32) for image in images]


def write(file, **images):
    """An EXR file with a layer for each image."""
    names = {"colour": "Combined", "beauty": "Combined", "albedo": "Albedo", "normal": "Normal"}
    channels = {f"{names.get(layer, layer)}.{axis}": image[..., i].copy() for layer, image in images.items()
                for i, axis in enumerate("XYZ" if layer == "normal" else "RGB")}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, channels).write(os.fspath(file))
