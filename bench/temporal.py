"""Measures `xrds upscale --temporal` on the sequences of bench/temporal_scenes.py, beside its rivals.

    python3 bench/temporal.py FOLDER OUT [--xrds build/release/cli/xrds] [--strips bench/images] [--rdg COPY_OF_ITS_REPOSITORY] [--only still light] [--ways temporal]
    python3 bench/tables.py write

Upscales every sequence with and without --temporal, denoises the full-resolution render of as many samples with Open Image Denoise, and
takes the median of three frames of xrds alone, brought together by the Vector pass; writes bench/results/temporal.json, of which bench/tables.py makes
the table of bench/temporal.md. Needs bench/oidn-requirements.txt; `pip install cvvdp` adds ColorVideoVDP, --rdg another rival (bench/rdg.py); --only and --ways measure some
sequences and ways anew and keep the figures of the others.
"""
import argparse
import json
import pathlib
import struct
import subprocess
import zlib

import numpy as np

import tables
from temporal_tables import WAYS

CUT = 3          # frames of `orbit` that begin the sequence `cut`; those of `pan` follow
SAMPLES = "16,4"


def layers(path, *names):
    """Layers of an EXR file by their own names, each [height, width, channels]."""
    import OpenEXR
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name.split(".", 1)[-1]: np.asarray(channel.pixels, np.float32) for name, channel in file.channels().items()}
    letters = {"Combined": "RGB", "Denoising Albedo": "RGB", "Denoising Normal": "XYZ", "Denoising Depth": "Z", "Vector": "XYZW"}
    return [np.stack([channels[f"{name}.{letter}"] for letter in letters[name]], -1) for name in names]


def colour(path):
    import OpenEXR
    with OpenEXR.File(str(path)) as file:
        return np.asarray(file.channels()["RGB"].pixels, np.float32)


def srgb(linear):
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def linear(picture):
    return np.where(picture <= 0.04045, picture / 12.92, ((picture + 0.055) / 1.055) ** 2.4)


def psnr(x, y):
    return -10 * np.log10(np.square(srgb(x) - srgb(y)).mean())


def relmse(x, y):
    """docs/metrics.md, trimmed: without the worst 0.1 % of the pixels."""
    errors = np.sort((np.square(x.mean(-1) - y.mean(-1)) / (np.square(y.mean(-1)) + 0.01)).ravel())
    return errors[:max(1, int(0.999 * errors.size))].mean()


def warped(image, motion):
    """The image [h, w, c] read bilinearly at p + motion [h, w, 2], and where that lies inside of it."""
    height, width = image.shape[:2]
    y, x = np.mgrid[:height, :width].astype(np.float32)
    x, y = x + motion[..., 0], y + motion[..., 1]
    inside = (x >= 0) & (y >= 0) & (x <= width - 1) & (y <= height - 1)
    x, y = np.clip(x, 0, width - 1), np.clip(y, 0, height - 1)
    left, top = np.minimum(x.astype(int), width - 2), np.minimum(y.astype(int), height - 2)
    along, down = (x - left)[..., None], (y - top)[..., None]
    upper = (1 - along) * image[top, left] + along * image[top, left + 1]
    lower = (1 - along) * image[top + 1, left] + along * image[top + 1, left + 1]
    return (1 - down) * upper + down * lower, inside


def to_previous(vector):
    return vector[..., :2] * (1, -1)


def to_next(vector):
    return vector[..., 2:] * (-1, 1)


class Sequence:
    def __init__(self, folder, name):
        self.name = name
        if name == "cut":
            before, after = Sequence(folder, "orbit"), Sequence(folder, "pan")
            rest = min(after.length, CUT)
            self.files = {kind: before.files[kind][:CUT] + after.files[kind][:rest] for kind in before.files}
        else:
            count = len(list((folder / name).glob("reference.*.exr")))
            self.files = {kind: [folder / name / f"{kind}.{frame + 1:04d}.exr" for frame in range(count)] for kind in ("low", "guides", "full", "reference")}
        self.length = len(self.files["reference"])
        self.cuts = {CUT} if name == "cut" else set()

    def read(self):
        self.references, self.albedo, self.normal, self.vector = zip(*(
            layers(path, "Combined", "Denoising Albedo", "Denoising Normal", "Vector") for path in self.files["reference"]))

    def linked(self, out):
        """The inputs as one numbered series."""
        folder = out / self.name / "in"
        folder.mkdir(parents=True, exist_ok=True)
        for kind in ("low", "guides"):
            for frame, path in enumerate(self.files[kind]):
                link = folder / f"{kind}.{frame + 1:04d}.exr"
                link.unlink(missing_ok=True)
                link.symlink_to(path.resolve())
        return folder

    def flicker(self, results):
        """The root mean square, over frames and pixels that both of two frames show, of the change of the error along the motion (sRGB): what the result
        changes and its reference does not."""
        squares = []
        for frame in range(1, self.length):
            if frame in self.cuts:
                continue
            motion = to_previous(self.vector[frame])
            error = srgb(results[frame]) - srgb(self.references[frame])
            before, inside = warped(srgb(results[frame - 1]) - srgb(self.references[frame - 1]), motion)
            same = np.abs(warped(self.albedo[frame - 1], motion)[0] - self.albedo[frame]).sum(-1) < 0.15
            same &= np.abs(warped(self.normal[frame - 1], motion)[0] - self.normal[frame]).sum(-1) < 0.3
            squares.append(np.square(error - before).mean(-1)[inside & same].mean())
        return float(np.sqrt(np.mean(squares)))

    def deviation(self, results):
        """The standard deviation over time (sRGB), root mean square over the pixels: of a still camera under still light."""
        return float(np.sqrt(srgb(np.stack(results)).var(0).mean()))


def upscaled(program, sequence, out, *more):
    folder = sequence.linked(out)
    target = out / sequence.name / ("temporal" if more else "xrds")
    subprocess.run([program, "upscale", folder / "low.####.exr", folder / "guides.####.exr", "-o", target / "f.####.exr", "--samples", SAMPLES, "--quiet",
                    *more], check=True)
    return [colour(target / f"f.{frame + 1:04d}.exr") for frame in range(sequence.length)]


def median(sequence, results):
    """Of each frame and those before and after it, brought to it by the Vector pass of the noisy guides."""
    found = []
    for frame, result in enumerate(results):
        stack = [result]
        vector, = layers(sequence.files["guides"][frame], "Vector")
        for other, motion in ((frame - 1, to_previous(vector)), (frame + 1, to_next(vector))):
            if 0 <= other < len(results):
                moved, inside = warped(results[other], motion)
                stack.append(np.where(inside[..., None], moved, result))
        found.append(np.median(stack, 0) if len(stack) == 3 else result)
    return found


def denoised(sequence):
    import oidn
    import pyoidn
    device = pyoidn.Device()
    device.commit()
    return [oidn.denoise(device, oidn.read_layers(path), prefilter=True)[0] for path in sequence.files["full"]]


def by_rdg(sequence, checkout):
    import rdg
    frames = []
    for low, guides in zip(sequence.files["low"], sequence.files["guides"]):
        albedo, normal, depth, vector = layers(guides, "Denoising Albedo", "Denoising Normal", "Denoising Depth", "Vector")
        low_colour, = layers(low, "Combined")
        frames.append({"colour": low_colour, "albedo": np.clip(albedo, 0, 1), "normal": normal, "depth": depth, "motion": to_previous(vector)})
    ends = [*sorted(sequence.cuts), len(frames)]
    return [image for begin, end in zip([0, *ends], ends) for image in rdg.upscaled(checkout, frames[begin:end], srgb, linear)]


def video_score(results, references):
    """ColorVideoVDP in just-objectionable differences of 10, at 24 frames a second; none where it is not installed."""
    try:
        import pycvvdp
    except ImportError:
        return None
    stack = [np.stack([srgb(image) for image in images]).astype(np.float32) for images in (results, references)]
    return float(pycvvdp.cvvdp(display_name="standard_fhd").predict(*stack, dim_order="FHWC", frames_per_second=24)[0])


def save_png(path, picture):
    height, width = picture.shape[:2]
    pixels = (255 * picture + 0.5).astype(np.uint8)
    rows = b"".join(b"\1" + np.diff(row, axis=0, prepend=np.zeros((1, 3), np.uint8)).tobytes() for row in pixels)    # each less the one on its left

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def strip(sequence, results, first, count):
    """Frames side by side: xrds, --temporal, reference, from top to bottom."""
    frames = range(first, min(first + count, sequence.length))
    rows = [[images[frame] for frame in frames] for images in (results["xrds"], results["temporal"], sequence.references)]
    return np.concatenate([np.concatenate([srgb(image) for image in row], 1) for row in rows], 0)


def results_of(options, sequence):
    """{way: its frames} of the ways that are asked for; xrds alone always, which the others are compared with."""
    alone = upscaled(options.xrds, sequence, options.out)
    others = {"temporal": lambda: upscaled(options.xrds, sequence, options.out, "--temporal"), "median": lambda: median(sequence, alone),
              "oidn": lambda: denoised(sequence), "rdg": lambda: by_rdg(sequence, options.rdg)}
    return {"xrds": alone, **{way: make() for way, make in others.items() if way in options.ways and (way != "rdg" or options.rdg)}}


def measure(options):
    names = [path.name for path in sorted(options.folder.iterdir()) if path.is_dir()]
    whole = not options.only and set(options.ways) == set(WAYS)
    rows = {} if whole else json.loads((tables.RESULTS / "temporal.json").read_text())["sequences"]
    for name in options.only or names + ["cut"] * ({"orbit", "pan"} <= set(names)):
        sequence = Sequence(options.folder, name)
        if sequence.length < 3:
            print(f"{name}: {sequence.length} frames, left out", flush=True)
            continue
        sequence.read()
        results = results_of(options, sequence)
        row = rows.setdefault(name, {"frames": sequence.length, "ways": {}})
        for way in [way for way in WAYS if way in results and way in options.ways]:
            pairs = list(zip(results[way], sequence.references))
            found = {"psnr": [float(psnr(*pair)) for pair in pairs], "relmse": float(np.mean([relmse(*pair) for pair in pairs])),
                     "flicker": sequence.flicker(results[way]), "video": video_score(results[way], sequence.references)}
            if name == "still":
                found["deviation"] = sequence.deviation(results[way])
            row["ways"][way] = found
            print(name, way, {key: np.round(value, 4) for key, value in found.items() if value is not None}, flush=True)
        if options.strips and name in ("cut", "moving", "orbit"):
            save_png(options.strips / f"temporal_{name}.png", strip(sequence, results, CUT - 2 if name == "cut" else 0, 4 if name == "cut" else 3))
    tables.keep("temporal", {**tables.origin(), "command": "python3 bench/temporal.py FOLDER OUT --rdg COPY", "samples": SAMPLES, "sequences": rows})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="with a folder for each sequence")
    parser.add_argument("out", type=pathlib.Path, help="folder for results")
    parser.add_argument("--xrds", default=tables.ROOT / "build" / "release" / "cli" / "xrds")
    parser.add_argument("--strips", type=pathlib.Path, help="folder for pictures of some frames")
    parser.add_argument("--only", nargs="+", metavar="SEQUENCE")
    parser.add_argument("--ways", nargs="+", choices=WAYS, default=WAYS)
    parser.add_argument("--rdg", type=pathlib.Path, help="a copy of RDG's repository")
    measure(parser.parse_args())


if __name__ == "__main__":
    main()
