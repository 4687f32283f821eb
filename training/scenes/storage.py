"""Names of a scene's files, what each keeps, and how many bits of it."""
import os

import exr
import passes

LOW = ((4, 16), (4, 64), (2, 16), (8, 64))  # scale, samples
AUX = (1, 4, 16)
REFERENCE = 256


def path(folder, seed, kind):
    return os.path.join(folder, f"s{seed:04d}_{kind}.exr")


def low_kind(scale, samples):
    return f"{'' if scale == 4 else f'x{scale}'}lr{samples}"


def finished(folder, seed):
    """The reference is written last, so it stands for the whole scene."""
    return os.path.exists(path(folder, seed, "gt"))


def keep(image, colour=False, aux=False, colour_bits=8):
    """The channels to store. Colour keeps `colour_bits` of half's ten (0.2 % at eight); albedo and normals lie on a
    grid far below their noise, which halves the files."""
    kept = passes.colour(image, colour_bits) if colour else {}
    if aux:
        kept.update(passes.auxiliaries(image, 1 / 256, 1 / 128))
    return kept


def write(folder, seed, kind, channels):
    os.makedirs(folder, exist_ok=True)
    target = path(folder, seed, kind)
    exr.write(target, channels)
    return os.path.getsize(target)
