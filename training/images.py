"""OpenEXR images as float32 tensors [channels, height, width]; channel names of Cycles, and the plain names R, G, B."""
import numpy
import OpenEXR
import torch

import pipeline
from network import LIGHTS

# For each image the endings of its channel names, in order of preference; {} is R, G, B or X, Y, Z.
LAYERS = {
    "colour": ("Combined.{rgb}", "{rgb}", "beauty.{rgb}"),
    "albedo": ("Denoising Albedo.{rgb}", "albedo.{rgb}", "Albedo.{rgb}"),
    "normal": ("Denoising Normal.{xyz}", "normal.{xyz}", "Normal.{xyz}", "normal.{rgb}", "N.{xyz}"),
    "depth": ("Denoising Depth.Z", "Depth.Z", "depth.Z"),
    "diffuse direct": ("DiffDir.{rgb}", "Diffuse Direct.{rgb}"),
    "diffuse indirect": ("DiffInd.{rgb}", "Diffuse Indirect.{rgb}"),
    "glossy direct": ("GlossDir.{rgb}", "Glossy Direct.{rgb}"),
    "glossy indirect": ("GlossInd.{rgb}", "Glossy Indirect.{rgb}"),
}
KINDS = ("albedo", "normal", "depth", "diffuse", "glossy")
OPTIONAL = KINDS[2:]


def channels_of(path):
    """{name: float32 array [height, width]} of all parts: Blender 5 writes one for each pass."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: numpy.asarray(channel.pixels, numpy.float32) for part in file.parts for name, channel in part.channels.items()}


def holds(channels, kind):
    """The names of the image's channels, those of direct and indirect light one after the other; nothing if the file has none."""
    if kind in LIGHTS:
        direct, indirect = (holds(channels, f"{kind} {path}") for path in ("direct", "indirect"))
        return direct + indirect if direct and indirect else []
    for pattern in LAYERS[kind]:
        endings = list(dict.fromkeys(pattern.format(rgb=a, xyz=b) for a, b in zip("RGB", "XYZ")))
        for prefix in sorted({name[:-len(endings[0])] for name in channels if name.endswith(endings[0])}, key=len):
            names = [prefix + ending for ending in endings]
            if prefix[-1:] in ("", ".") and all(name in channels for name in names):
                return names
    return []


def read_exr(path, *kinds):
    """The images named in `kinds` (colour, albedo, normal, diffuse and glossy light [3, height, width], depth [1, height, width]), a tensor
    for one kind, else a tuple. Raises ValueError if there is none."""
    channels = channels_of(path)

    def find(kind):
        names = holds(channels, kind)
        if not names:
            raise ValueError(f"{path} has no {kind}; its channels are {', '.join(sorted(channels))}")
        found = torch.from_numpy(numpy.stack([channels[name] for name in names]))
        return found[:3] + found[3:] if kind in LIGHTS else found

    found = tuple(find(kind) for kind in kinds)
    return found[0] if len(found) == 1 else found


def read_auxiliary(path, kinds=KINDS):
    """[3 k, H, W]: albedo, normal, relative depth, diffuse and glossy light, or those of `kinds`; without what the file has not of the last three."""
    channels = channels_of(path)
    kinds = [kind for kind in kinds if kind not in OPTIONAL or holds(channels, kind)]
    found = zip(kinds, read_exr(path, *kinds) if len(kinds) > 1 else [read_exr(path, *kinds)])
    return torch.cat([pipeline.relative_depth(image) if kind == "depth" else image for kind, image in found])


def write_exr(path, image):
    """Writes [3, height, width] as float32 R, G, B."""
    pixels = numpy.ascontiguousarray(image.permute(1, 2, 0).float().numpy())
    OpenEXR.File({"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}, {"RGB": pixels}).write(str(path))
