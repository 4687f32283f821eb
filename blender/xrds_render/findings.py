# SPDX-License-Identifier: GPL-3.0-or-later
"""What looks wrong in the images of a frame, as sentences for the artist. Runs in the process of worker.py, without Blender."""
import contextlib
import warnings

import numpy as np


def of_images(light, guides):
    """Of the low-resolution colour and its lights, and of albedo and normal: {name: [height, width, 3]}, as they were rendered."""
    found = []
    if broken := _counted({**light, **guides}, lambda image: ~np.isfinite(image)):
        found.append(f"Pixels are not finite, and count as their neighbours: {broken}.")
    if negative := _counted(light, lambda image: image < 0):
        found.append(f"Pixels are negative, as by lamps of negative strength, and count as 0: {negative}.")
    return found


def of_model(model, images):
    """Of albedo or normal that a chosen model takes. Without a choice xrds takes one that does without, and says so."""
    empty = [name for name in ("albedo", "normal") if model and name in images and (images[name] == images[name][0, 0]).all()]
    return [f"The {name} is the same everywhere, and tells the model nothing: Automatic takes one that does without." for name in empty[:1]]


@contextlib.contextmanager
def of_package(found):
    """Within it, what the package xrds warns of is added to a list."""
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        yield
    found += [str(one.message) for one in said if one.category is UserWarning]


def _counted(images, wrong):
    """As "3 in Combined, 1 in Emit"."""
    counts = {name: int(wrong(image).any(-1).sum()) for name, image in images.items()}
    return ", ".join(f"{count} in {name}" for name, count in counts.items() if count)
