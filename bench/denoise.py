"""Compares `xrds denoise` with Open Image Denoise itself on the same images: difference, time and memory.

    python3 bench/denoise.py XRDS LIBRARY VAL_FOLDER --spp 4 [--guides none,noisy,prefilter,clean]
        [--precision fp32] [--size 1024x1024] [--rounds 3] [--json FILE]

LIBRARY is libOpenImageDenoise_core.so, whose networks are imported into a temporary folder. For colour, albedo and normal of each sNNNN_auxK.exr of
K samples the relative RMS of the difference to Open Image Denoise's CPU device, RMS(xrds - oidn) / RMS(oidn): colour alone; with noisy, with
prefiltered and with clean guides. --size instead times frames of that size, made of the first image side by side: whole processes
in turn, each of which denoises the frame once to fill caches and then `--rounds` times, and the most memory that each process held, from the
kernel's account of its child. Needs bench/oidn-requirements.txt.
"""
import argparse
import json
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

import numpy

import oidn

GUIDES = {"none": ("color",), "noisy": ("color", "albedo", "normal"), "prefilter": ("color", "albedo", "normal"), "clean": ("color", "albedo", "normal")}


def of_oidn(device, images, guides):
    """(radiance, seconds)"""
    given = {name: images[name] for name in GUIDES[guides]}
    return oidn.denoise(device, given, clean_aux=guides == "clean", prefilter=guides == "prefilter")


def write_frame(path, images):
    import OpenEXR
    channels = {"R": images["color"][..., 0], "G": images["color"][..., 1], "B": images["color"][..., 2]}
    for layer, letters in (("albedo", "RGB"), ("normal", "XYZ")):
        channels.update({f"{layer}.{letter}": images[layer][..., i] for i, letter in enumerate(letters)})
    header = {"compression": OpenEXR.NO_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {name: numpy.ascontiguousarray(pixels) for name, pixels in channels.items()}).write(str(path))


def read_colour(path):
    import OpenEXR
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return numpy.stack([file.channels()[letter].pixels for letter in "RGB"], -1)


def run(command):
    """(output, most bytes that the process held)"""
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    text = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, command))} failed")
    return text, usage.ru_maxrss * 1024


def relative_rms(found, expected):
    return float(numpy.sqrt(((found - expected) ** 2).mean() / (expected ** 2).mean()))


def differences(arguments, folder, device):
    found = {}
    for path in sorted(arguments.folder.glob(f"s*_aux{arguments.spp}.exr")):
        images = oidn.read_layers(path)
        write_frame(folder / "frame.exr", images)
        for guides in arguments.guides.split(","):
            expected, _ = of_oidn(device, images, guides)
            run([arguments.xrds, "denoise", folder / "frame.exr", "-o", folder / "out.exr", "--guides", guides, "--precision", arguments.precision,
                 "--denoisers", folder, "--quiet"])
            found.setdefault(f"{guides} {arguments.precision}", []).append(relative_rms(read_colour(folder / "out.exr"), expected))
            print(f"{path.name} {guides}: {found[f'{guides} {arguments.precision}'][-1]:.2e}", flush=True)
    for case, values in found.items():
        print(f"{case:16} {len(values)} images: mean {statistics.mean(values):.2e}, largest {max(values):.2e}")
    return found


def tiled(images, size):
    width, height = map(int, size.split("x"))
    repeat = lambda image: numpy.ascontiguousarray(
        numpy.tile(image, (-(-height // image.shape[0]), -(-width // image.shape[1]), 1))[:height, :width])
    return {name: repeat(image) for name, image in images.items()}


def one_of_oidn(path, guides, rounds):
    """In a process of its own: prints the seconds of each round."""
    import pyoidn
    images = dict(numpy.load(path))
    device = pyoidn.Device(pyoidn.OIDN_DEVICE_TYPE_CPU)
    device.commit()
    for _ in range(rounds):
        print(of_oidn(device, images, guides)[1], flush=True)


def timings(arguments, folder):
    images = tiled(oidn.read_layers(sorted(arguments.folder.glob(f"s*_aux{arguments.spp}.exr"))[0]), arguments.size)
    write_frame(folder / "frame.exr", images)
    numpy.savez(folder / "frame.npz", **images)
    found = {}
    for guides in arguments.guides.split(","):
        ours, theirs, our_bytes, their_bytes = [], [], [], []
        command = [arguments.xrds, "denoise", folder / "frame.exr", "-o", folder / "out.exr", "--guides", guides, "--precision", arguments.precision,
                   "--denoisers", folder]
        run(command)
        for _ in range(arguments.rounds):
            text, held = run(command)
            ours.append(float(re.search(r"^([\d.]+) s of the device", text, re.M)[1]))
            our_bytes.append(held)
            text, held = run([sys.executable, __file__, "--one", str(folder / "frame.npz"), guides])
            theirs.append(float(text.split()[-1]))
            their_bytes.append(held)
        ratios = [a / b for a, b in zip(ours, theirs)]
        print(f"{arguments.size} {guides} {arguments.precision}: xrds {statistics.median(ours):.2f} s, oidn {statistics.median(theirs):.2f} s, "
              f"paired ratio {statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f}); "
              f"process at most {max(our_bytes) / 1e6:.0f} MB, oidn's {max(their_bytes) / 1e6:.0f} MB", flush=True)
        found[guides] = {"xrdsSeconds": ours, "oidnSeconds": theirs, "xrdsBytes": our_bytes, "oidnBytes": their_bytes}
    return found


def main():
    if sys.argv[1:2] == ["--one"]:
        return one_of_oidn(sys.argv[2], sys.argv[3], 2)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("xrds", type=pathlib.Path)
    parser.add_argument("library", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--spp", type=int, default=4)
    parser.add_argument("--size")
    parser.add_argument("--guides", default="none,noisy,prefilter")
    parser.add_argument("--precision", default="fp32")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", type=pathlib.Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run([arguments.xrds, "import", "oidn", arguments.library, "-o", folder])
        if arguments.size:
            found = timings(arguments, folder)
        else:
            import pyoidn
            device = pyoidn.Device(pyoidn.OIDN_DEVICE_TYPE_CPU)
            device.commit()
            found = differences(arguments, folder, device)
    if arguments.json:
        arguments.json.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
