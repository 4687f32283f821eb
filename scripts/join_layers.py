#!/usr/bin/env python3
"""Joins EXR files of one image each, as LuxCore and other renderers write them, into one that xrds takes.

    pip install OpenEXR        # 3.3 or later
    python3 scripts/join_layers.py full.exr rgb.exr albedo=albedo.exr normal=normal.exr --samples 16

The first file's R, G, B (and A) stay without a name, those of the others get the name before the equals sign.
"""

import argparse

import OpenEXR


def channels_of(argument: str) -> dict:
    name, _, path = argument.rpartition("=")
    channels = OpenEXR.File(path, separate_channels=True).channels()
    return {f"{name}.{own}" if name else own: channel.pixels for own, channel in channels.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("images", nargs="+", metavar="[NAME=]FILE")
    parser.add_argument("--samples", type=int, help="a pixel, which xrds reads")
    arguments = parser.parse_args()
    channels = {name: pixels for image in arguments.images for name, pixels in channels_of(image).items()}
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    if arguments.samples:
        header["samplesPerPixel"] = arguments.samples
    OpenEXR.File(header, channels).write(arguments.out)


if __name__ == "__main__":
    main()
