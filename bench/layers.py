"""How well the layers of Cycles in a multi-layer EXR add up to its Combined.

    python3 bench/layers.py FILE ...

Prints for the passes, (Dir + Ind) Col over the kinds plus Emit, Env and volumes, and for the light groups: the sum of the errors over
that of the colour, and the largest error of a channel of a pixel over its value. Needs numpy and OpenEXR.
"""
import sys

import numpy
import OpenEXR


def layer(channels, name):
    """[h, w, 3] in double precision, or 0 where there is none."""
    for key, channel in channels.items():
        if key.endswith("." + name):  # R, G and B as one
            return channel.pixels[..., :3].astype(numpy.float64)
    return 0.0


def report(path):
    channels = OpenEXR.File(path).channels()
    colour = layer(channels, "Combined")
    passes = sum((layer(channels, kind + "Dir") + layer(channels, kind + "Ind")) * layer(channels, kind + "Col")
                 for kind in ("Diff", "Gloss", "Trans"))
    passes = passes + sum(layer(channels, name) for name in ("Emit", "Env", "VolumeDir", "VolumeInd"))
    names = {key.split(".")[1] for key in channels if ".Combined_" in key}
    for what, total in (("passes", passes), ("light groups", sum(layer(channels, name) for name in names))):
        error = numpy.abs(total - colour)
        print(f"{path}: {what}: {error.sum() / colour.sum():.1e}, at most {(error / numpy.maximum(colour, 1e-12)).max():.1e}")


for path in sys.argv[1:]:
    report(path)
