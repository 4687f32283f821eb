"""Denoises full-resolution renders with Open Image Denoise, the peer that needs no low-resolution render.

    python3 bench/oidn.py VAL_FOLDER OUT_FOLDER --spp 4 [--clean-aux] [--prefilter] [--free-guides]
    xrds bench quality VAL_FOLDER --also "OIDN 4 spp=OUT_FOLDER/*_oidn4.exr"

Reads colour, albedo and normal of sNNNN_auxK.exr (K samples a pixel) and writes sNNNN_oidnK.exr, linear radiance. HDR
is on, the quality OIDN's highest. --clean-aux tells OIDN to trust albedo and normal; --prefilter denoises them first,
each by its own filter, and trusts them then, as OIDN's manual advises. --free-guides takes albedo and normal of the
reference sNNNN_gt.exr, as if they were rasterized. Seconds are those of the filters' execution, the
prefilters' included, once the first image has been run a time before. Needs bench/oidn-requirements.txt.
"""
import argparse
import pathlib
import statistics
import time

import numpy
import OpenEXR
import pyoidn

LAYERS = {"color": ("Combined", "RGB"), "albedo": ("Denoising Albedo", "RGB"), "normal": ("Denoising Normal", "XYZ")}


def read_layers(path):
    """{image: float32 array [height, width, 3]} of a render by Cycles."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name.split(".", 1)[-1]: numpy.asarray(channel.pixels, numpy.float32)
                    for name, channel in file.channels().items()}
    images = {image: numpy.stack([channels[f"{layer}.{letter}"] for letter in letters], axis=-1)
              for image, (layer, letters) in LAYERS.items()}
    images["color"] = numpy.maximum(numpy.nan_to_num(images["color"]), 0)
    images["albedo"] = numpy.clip(images["albedo"], 0, 1)
    return {image: numpy.ascontiguousarray(pixels) for image, pixels in images.items()}


def write_exr(path, pixels):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": pixels}).write(str(path))


def check(device):
    if error := device.get_error():
        raise RuntimeError(f"Open Image Denoise: {error}")


def filtered(device, images, flags):
    """(the result, seconds of its execution) of OIDN's RT filter on {image: pixels}."""
    output = numpy.empty_like(next(iter(images.values())))
    with pyoidn.Filter(device, pyoidn.OIDN_FILTER_TYPE_RT) as filter:
        for name, pixels in {**images, "output": output}.items():
            filter.set_image(name, pixels, pyoidn.OIDN_FORMAT_FLOAT3)
        for name, value in flags.items():
            filter.set_bool(name, value)
        filter.set_quality(pyoidn.OIDN_QUALITY_HIGH)
        filter.commit()
        check(device)
        start = time.perf_counter()
        filter.execute()
        seconds = time.perf_counter() - start
        check(device)
    return output, seconds


def denoise(device, images, clean_aux=False, prefilter=False):
    """(radiance, seconds)"""
    images, total = dict(images), 0.0
    for name in ("albedo", "normal") if prefilter else ():
        images[name], seconds = filtered(device, {name: images[name]}, {})
        total += seconds
    result, seconds = filtered(device, images, {"hdr": True, "cleanAux": clean_aux or prefilter})
    return result, total + seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--spp", type=int, required=True, help="of the renders to denoise")
    parser.add_argument("--clean-aux", action="store_true")
    parser.add_argument("--prefilter", action="store_true")
    parser.add_argument("--free-guides", action="store_true")
    options = parser.parse_args()
    suffix = f"_aux{options.spp}.exr"
    renders = sorted(options.folder.glob("*" + suffix))
    if not renders:
        raise SystemExit(f"{options.folder} has no *{suffix}")
    options.output.mkdir(parents=True, exist_ok=True)
    times = []
    with pyoidn.Device(pyoidn.OIDN_DEVICE_TYPE_CPU) as device:
        device.commit()
        check(device)
        denoise(device, read_layers(renders[0]), options.clean_aux, options.prefilter)
        for render in renders:
            scene = render.name[:-len(suffix)]
            images = read_layers(render)
            if options.free_guides:
                images = {**read_layers(render.with_name(f"{scene}_gt.exr")), "color": images["color"]}
            result, seconds = denoise(device, images, options.clean_aux, options.prefilter)
            write_exr(options.output / f"{scene}_oidn{options.spp}.exr", result)
            times.append(seconds)
            print(f"{scene}  {result.shape[1]} x {result.shape[0]}  {seconds:.4f} s")
    print(f"Open Image Denoise {pyoidn.version.oidn_version}, {options.spp} spp: {len(times)} images, "
          f"median {statistics.median(times):.4f} s, least {min(times):.4f}, most {max(times):.4f}")


if __name__ == "__main__":
    main()
