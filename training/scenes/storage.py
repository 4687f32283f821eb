"""Names of a scene's files, what each keeps, and how many bits of it."""
import os

import exr
import passes

LOW = ((4, 1), (4, 4), (4, 16), (4, 64), (2, 1), (2, 2), (2, 4), (2, 16), (8, 64), (8, 256))  # scale, samples
AUX = (1, 2, 4, 8, 16)
REFERENCE = 256


def path(folder, seed, kind):
    return os.path.join(folder, f"s{seed:04d}_{kind}.exr")


def low_kind(scale, samples):
    return f"{'' if scale == 4 else f'x{scale}'}lr{samples}"


def finished(folder, seed):
    """The reference is written last, so it stands for the whole scene."""
    return os.path.exists(path(folder, seed, "gt"))


def colour(image):
    """Low-resolution colour to store, as rendered."""
    return passes.colour(image)


def auxiliaries(image, albedo_bits=5, normal_step=1 / 64):
    """Noisy albedo (to `albedo_bits` of half's ten), normal (on a grid) and depth to store: half of their bytes."""
    kept = {name: exr.rounded(image[name], albedo_bits) for name in passes.ALBEDO}
    kept.update((name, exr.on_grid(image[name], normal_step)) for name in passes.NORMAL)
    kept.update((name, exr.rounded(image[name], albedo_bits)) for name in passes.DEPTH)
    return kept


def lights(image):
    """The diffuse and glossy light to store, to eight bits; nothing of a render without these passes."""
    return {name: exr.rounded(image[name], 8) for name in passes.LIGHTS if name in image}


def noisy(image):
    """A full-resolution render of few samples: its colour, albedo, normal, depth and lights."""
    return {**passes.colour(image, 8), **auxiliaries(image), **lights(image)}


def reference(image):
    """Reference to store: colour to eight bits (0.2 %), albedo, normal and depth finer than the noisy ones."""
    return {**passes.colour(image, 8), **auxiliaries(image, 7, 1 / 128), **lights(image)}


def write(folder, seed, kind, channels):
    os.makedirs(folder, exist_ok=True)
    target = path(folder, seed, kind)
    exr.write(target, channels)
    return os.path.getsize(target)
