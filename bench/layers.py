"""How well the layers of Cycles in a multi-layer EXR add up to its Combined, and how near each is to a reference.

    python3 bench/layers.py FILE ...
    python3 bench/layers.py --reference DIR/reference.exr DIR/low.exr DIR/full.exr DIR/out.exr

The first prints for the passes, (Dir + Ind) Col over the kinds plus Emit, Env and volumes, and for the light groups: the sum of the errors over
that of the colour, and the largest error of a channel of a pixel over its value. The second prints a table of Markdown: for each light that is
not black, its share of the colour, and the PSNR (docs/metrics.md) of the low-resolution layer scaled bicubically, of the noisy full-resolution one, and of the
upscaled one. Needs training/requirements.txt and OpenEXR.
"""
import argparse
import pathlib
import sys

import numpy
import OpenEXR

LIGHTS = [f"{kind}{part}" for kind in ("Diff", "Gloss", "Trans") for part in ("Dir", "Ind")] + ["Emit", "Env", "VolumeDir", "VolumeInd"]


def layer(channels, name):
    """[h, w, 3] in double precision, or 0 where there is none."""
    for key, channel in channels.items():
        if key.endswith("." + name):  # R, G and B as one
            return channel.pixels[..., :3].astype(numpy.float64)
    return 0.0


def channels_of(path):
    return OpenEXR.File(str(path)).channels()


def groups_of(channels):
    """The names of its light groups."""
    return sorted({key.split(".")[1] for key in channels if ".Combined_" in key})


def sums(path):
    channels = channels_of(path)
    colour = layer(channels, "Combined")
    passes = sum((layer(channels, kind + "Dir") + layer(channels, kind + "Ind")) * layer(channels, kind + "Col")
                 for kind in ("Diff", "Gloss", "Trans"))
    passes = passes + sum(layer(channels, name) for name in ("Emit", "Env", "VolumeDir", "VolumeInd"))
    for what, total in (("passes", passes), ("light groups", sum(layer(channels, name) for name in groups_of(channels)))):
        error = numpy.abs(total - colour)
        print(f"{path}: {what}: {error.sum() / colour.sum():.1e}, at most {(error / numpy.maximum(colour, 1e-12)).max():.1e}")


def planes(image):
    """[h, w, 3] as the tensor [3, h, w] that training/ computes with."""
    import torch

    return torch.from_numpy(numpy.ascontiguousarray(numpy.moveaxis(image, -1, 0))).float()


def against(reference, low, full, out):
    """The table of every light."""
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "training"))
    import metrics
    import pipeline

    reference, low, full, out = (channels_of(path) for path in (reference, low, full, out))
    total = layer(reference, "Combined").sum()
    print("| layer | of the colour | bicubic | noisy render | upscaled |\n|---|---|---|---|---|")
    for name in ("Combined", *LIGHTS, *groups_of(reference)):
        true, upscaled = planes(layer(reference, name)), planes(layer(out, name))
        if not true.any():
            continue
        scale = true.shape[-1] // layer(low, name).shape[1]
        scaled = pipeline.bicubic(planes(layer(low, name))[None], scale)[0].clamp(min=0)
        found = (metrics.psnr(image, true) for image in (scaled, planes(layer(full, name)), upscaled))
        share = (true.sum() if name.startswith("Combined") or name in LIGHTS[6:] else lit(reference, name).sum()) / total
        print(f"| {name} | {100 * share:.0f} % | " + " | ".join(f"{value:.2f}" for value in found) + " |")


def lit(channels, name):
    """A light times the colour of its kind: what it gives to the picture."""
    return layer(channels, name) * layer(channels, name[:-3] + "Col")


def main():
    parser = argparse.ArgumentParser(prog="layers.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+")
    parser.add_argument("--reference", help="compare LOW FULL OUT with this file")
    ask = parser.parse_args()
    if ask.reference:
        against(ask.reference, *ask.files)
    else:
        for path in ask.files:
            sums(path)


if __name__ == "__main__":
    main()
