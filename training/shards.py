"""Scenes in few compact files: a shard is a zip of LZMA arrays that numpy opens without unpacking it.

    python training/shards.py SCENE_FOLDER... --output SHARD_FOLDER [--megabytes 56] [--noisy-every 3] [--noisy-bits 3]
    python training/shards.py SCENE_FOLDER... --complete OLD_SHARD_FOLDER --output SHARD_FOLDER [--noisy-bits 6]

Packs the scenes of folders of OpenEXR files (layout in README.md) that no shard of SHARD_FOLDER holds yet into
scenes-NNN.npz. A 256 x 256 scene with everything takes about half a megabyte:
colour as half floats with fewer bits, converged albedo and normal on a fine grid, noisy ones as their difference from
those on a coarser grid; of depth, where there is any, the relative depth. Every array is stored as the differences along its rows, low bytes before high bytes.
"""
import argparse
import itertools
import pathlib
import re
import sys
import zipfile

import numpy as np
import torch

import arguments
import images
import pipeline
from arguments import number

REFERENCE_BITS, LOW_BITS, NOISY_BITS = 6, 5, 3      # kept of half's ten; --noisy-bits chooses others than NOISY_BITS
CONVERGED_STEP = torch.tensor([1 / 128] * 3 + [1 / 64] * 3).view(6, 1, 1)      # albedo, normal
DEPTH_STEP = 1 / 256
NOISY_STEP = {1: 1 / 16, 4: 1 / 24}                 # others: 1 / 40
RADIANCE_MAX = 6e4
NOISY_COLOUR_SPP = (4, 1, 16)       # full-resolution noisy colour: one count of a scene, in turn


def kinds_of(folder, scene):
    """{kind: path} of a scene's files, such as "gt", "aux16", "lr64", "x2lr16"."""
    return {path.stem[len(scene) + 1:]: path for path in sorted(pathlib.Path(folder).glob(f"{scene}_*.exr"))}


def half_codes(image, bits):
    """Radiance [c, h, w] -> the bit patterns of half floats rounded to `bits` bits behind the leading one, int16."""
    finite = torch.nan_to_num(image, 0, RADIANCE_MAX, 0).clamp(0, RADIANCE_MAX)
    codes = finite.half().view(torch.int16).int()
    step = 1 << (10 - bits)
    return ((codes + step // 2) // step * step).short().numpy()


def format_of_shards():
    """What a shard must have been written with, for its codes to mean what they say: the archive's comment."""
    return f"xrds scenes 1, steps {CONVERGED_STEP.flatten().tolist()} {sorted(NOISY_STEP.items())}".encode()


def noisy_step(spp):
    return NOISY_STEP.get(spp, 1 / 40)


def grid_codes(image, step):
    return (torch.nan_to_num(image, 0, 0, 0) / step).round().clamp(-32768, 32767).short().numpy()


def packed(codes):
    """int16 [c, h, w] -> bytes [2, c, h, w] of the row-wise differences."""
    difference = np.diff(codes.astype(np.int32), axis=-1, prepend=0).astype(np.int16)
    difference = (difference << 1) ^ (difference >> 15)         # small magnitudes of either sign: small codes
    return difference.view(np.uint8).reshape(*codes.shape, 2).transpose(3, 0, 1, 2)


def unpacked(planes):
    difference = np.ascontiguousarray(planes.transpose(1, 2, 3, 0)).view(np.uint16)[..., 0]
    difference = (difference >> 1).astype(np.int16) ^ -(difference & 1).astype(np.int16)
    return np.cumsum(difference, axis=-1, dtype=np.int16)


def encode(folder, scene, turn, noisy_every=3, noisy_bits=NOISY_BITS):
    """{array name: uint8 array} of one scene. turn: every third (`noisy_every`th; 0: every one, and of all counts) keeps the full-resolution
    noisy colour of one sample count, the next third the 4 spp colour of scale 2."""
    kinds = kinds_of(folder, scene)
    reference = images.read_auxiliary(kinds["gt"])
    auxiliary = auxiliary_of(kinds)
    arrays = {"target": half_codes(images.read_exr(kinds["gt"], "colour"), REFERENCE_BITS), "aux": grid_codes(guides_of(reference), CONVERGED_STEP)}
    depths = {int(kind[3:]): image[7:8] for kind, image in [*auxiliary.items(), ("aux0", reference)] if len(image) > 6}      # of the planes the middle one
    if depths:      # a reference without depth takes that of the most samples
        arrays["depth"] = grid_codes(depths[0] if 0 in depths else depths[max(depths)], DEPTH_STEP)
    arrays.update(light_arrays({"aux0": reference, **auxiliary}, noisy_bits))
    arrays.update(noisy_arrays(auxiliary, arrays))
    arrays.update((f"x1lr{spp}", half_codes(images.read_exr(kinds[f"aux{spp}"], "colour"), noisy_bits))
                  for spp in noisy_colours_of(kinds, turn, noisy_every))
    if noisy_every and turn % 3 != 1:
        kinds.pop("x2lr4", None)
    for kind, path in kinds.items():
        if "lr" in kind:
            arrays[kind] = half_codes(images.read_exr(path, "colour"), LOW_BITS if kind.startswith("x2") else REFERENCE_BITS)
    return {name: packed(codes) for name, codes in arrays.items()}


def auxiliary_of(kinds):
    """{"auxK": image [6 or 9, H, W]} of the noisy full-resolution renders among a scene's files."""
    return {kind: images.read_auxiliary(path) for kind, path in kinds.items() if re.fullmatch(r"aux\d+", kind)}


def guides_of(image):
    """Albedo, clamped, and normal [6, H, W]."""
    return torch.cat([image[:3].clamp(0, pipeline.ALBEDO_MAX), image[3:6]])


def noisy_arrays(auxiliary, converged):
    """Codes of the noisy images as their differences from the converged ones, the codes "aux" and, where there is depth, "depth"."""
    arrays, clean = {}, torch.from_numpy(converged["aux"]).float() * CONVERGED_STEP
    for kind, image in auxiliary.items():
        step = noisy_step(int(kind[3:]))
        arrays[kind] = grid_codes(guides_of(image) - clean, step)
        if len(image) > 6 and "depth" in converged:
            difference = image[7:8] - torch.from_numpy(converged["depth"]).float() * DEPTH_STEP
            arrays[kind.replace("aux", "depth")] = grid_codes(difference, step / 4)
    return arrays


def light_arrays(auxiliary, bits):
    """Codes of the diffuse and glossy light of {"auxK": image [15, H, W]}; nothing of images without."""
    return {kind.replace("aux", "light"): half_codes(image[9:], bits) for kind, image in auxiliary.items() if len(image) > 9}


def noisy_colours_of(kinds, turn, noisy_every):
    """The sample counts whose full-resolution colour a scene keeps."""
    counts = [int(kind[3:]) for kind in kinds if re.fullmatch(r"aux\d+", kind)]
    if not noisy_every:
        return counts
    chosen = NOISY_COLOUR_SPP[turn // noisy_every % 3]
    return [chosen if chosen in counts else counts[0]] if turn % noisy_every == 0 else []


def completed(packed_arrays, folder, scene, noisy_bits):
    """The arrays of a packed scene {name: uint8 array} and those of the full-resolution renders of `folder`, colour included."""
    kinds = kinds_of(folder, scene)
    converged = {name: unpacked(packed_arrays[name]) for name in ("aux", "depth") if name in packed_arrays}
    auxiliary = auxiliary_of(kinds)
    arrays = {**noisy_arrays(auxiliary, converged), **light_arrays(auxiliary, noisy_bits)}
    arrays.update((f"x1lr{spp}", half_codes(images.read_exr(kinds[f"aux{spp}"], "colour"), noisy_bits)) for spp in noisy_colours_of(kinds, 0, 0))
    return {**packed_arrays, **{name: packed(codes) for name, codes in arrays.items()}}


def whole_aux(aux, relative, light):
    """Albedo and normal [6, H, W], the planes of the relative depth [1, H, W] or None, and then the lights [6, H, W] or None, float16."""
    depth = [] if relative is None else [pipeline.depth_planes(relative.clamp(0, 1))]
    return torch.cat([aux, *depth, *([light] if depth and light is not None else [])]).half()


def decode(arrays):
    """What encode made -> {"target", "colour": {(scale, spp): [3, h, w]}, "aux": {spp, 0 converged: [15, H, W], [9, H, W] without
    lights, [6, H, W] without depth}}, float16."""
    scene = {"colour": {}, "aux": {}}
    half = lambda name: torch.from_numpy(unpacked(arrays[name])).view(torch.float16)
    grid = lambda name, step: torch.from_numpy(unpacked(arrays[name])).float() * step
    converged = grid("aux", CONVERGED_STEP)
    relative = grid("depth", DEPTH_STEP) if "depth" in arrays else None
    light = lambda spp: half(f"light{spp}") if f"light{spp}" in arrays else None
    for name in arrays:
        if match := re.fullmatch(r"aux(\d+)", name):
            noisy = converged + grid(name, noisy_step(int(match[1])))
            depth = name.replace("aux", "depth")
            scene["aux"][int(match[1])] = whole_aux(noisy, relative + grid(depth, noisy_step(int(match[1])) / 4) if depth in arrays else None, light(match[1]))
        elif match := re.fullmatch(r"(?:x(\d+))?lr(\d+)", name):
            scene["colour"][int(match[1] or 4), int(match[2])] = half(name)
    scene["target"], scene["aux"][0] = half("target"), whole_aux(converged, relative, light(0))
    return scene


def read_shard(path, names=None):
    """Yields (scene name, decoded scene), of the named scenes or of all."""
    for name, arrays in read_packed(path, names):
        yield name, decode(arrays)


def read_packed(path, names=None):
    """Yields (scene name, {array name: uint8 array}), of the named scenes or of all."""
    with np.load(path) as shard:
        if shard.zip.comment != format_of_shards():
            raise ValueError(f"{path} was packed by another version of shards.py; pack its scenes again")
        for name in sorted({entry.split("/")[0] for entry in shard.files} if names is None else names):
            prefix = name + "/"
            yield name, {entry[len(prefix):]: shard[entry] for entry in shard.files if entry.startswith(prefix)}


def scenes_in(path):
    try:
        with zipfile.ZipFile(path) as shard:
            return {entry.split("/")[0] for entry in shard.namelist()}
    except zipfile.BadZipFile as error:
        raise ValueError(f"{path} is no shard, or damaged") from error


def write_shard(path, scenes, byte_limit):
    """Writes (scene name, {array name: uint8 array}) pairs until the iterator ends or the shard is full, whole or not at all; returns their number."""
    part, count = path.with_suffix(".part"), 0
    with zipfile.ZipFile(part, "w", zipfile.ZIP_LZMA) as shard:
        shard.comment = format_of_shards()
        for name, arrays in scenes:
            for kind, array in arrays.items():
                with shard.open(f"{name}/{kind}.npy", "w") as entry:
                    np.lib.format.write_array(entry, np.ascontiguousarray(array), allow_pickle=False)
            count += 1
            if shard.start_dir >= byte_limit:
                break
    part.rename(path)
    return count


def packed_anew(options, present):
    """Yields the scenes of folders of renders that no shard holds yet."""
    for folder in options.folders:
        for path in sorted(folder.glob("*_gt.exr")):
            name = path.name[:-len("_gt.exr")]
            if name not in present:
                present.add(name)
                yield name, encode(folder, name, int(name[1:]), options.noisy_every, options.noisy_bits)


def packed_completed(options, present):
    """Yields the scenes of the shards `--complete` that have full-resolution renders in a folder, with these."""
    for path in sorted(options.complete.glob("*.npz")):
        for name, arrays in read_packed(path):
            folder = next((folder for folder in options.folders if any(folder.glob(f"{name}_aux*.exr"))), None)
            if folder and name not in present:
                yield name, completed(arrays, folder, name, options.noisy_bits)


def main():
    parser = arguments.Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=arguments.folder, nargs="+")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--megabytes", type=number(float, 0, above=True), default=56, help="size at which the next shard begins")
    parser.add_argument("--noisy-every", type=number(int, 0), default=3, help="every n-th scene keeps a full-resolution noisy colour (1: all, to train scale 1; 0: all, and all sample counts)")
    parser.add_argument("--noisy-bits", type=number(int, 1, 10), default=NOISY_BITS, help="of half's ten that it keeps (6: to train models that take it too)")
    parser.add_argument("--complete", type=arguments.folder, metavar="SHARDS", help="folder of shards whose scenes get the full-resolution renders of "
                        "the scene folders, of all counts, in new shards")
    options = parser.parse_args()
    try:
        pack(options)
    except (ValueError, OSError) as error:      # of a file that is no such image
        sys.exit(f"shards.py: {error}")


def pack(options):
    """Writes shards. Raises ValueError where there is nothing to pack, or a scene cannot be."""
    pattern, example = ("*_aux*.exr", "s0012_aux16.exr") if options.complete else ("*_gt.exr", "s0012_gt.exr")
    paths = [path for folder in options.folders for path in folder.glob(pattern)]
    if not paths:
        raise ValueError(f"{', '.join(map(str, options.folders))} has no files such as {example}")
    for path in paths:
        if not re.fullmatch(r".\d+_.*", path.name):
            raise ValueError(f"{path} must be named by a letter and a number, as {example}")
    options.output.mkdir(parents=True, exist_ok=True)
    shards = sorted(options.output.glob("scenes-*.npz"))
    present = set().union(*(scenes_in(path) for path in shards))
    scenes = (packed_completed if options.complete else packed_anew)(options, present)
    for first in scenes:
        path = options.output / f"scenes-{len(shards):03}.npz"
        count = write_shard(path, itertools.chain([first], scenes), options.megabytes * 1e6)
        print(f"{path.name}: {count} scenes, {path.stat().st_size / 1e6:.1f} MB", flush=True)
        shards.append(path)


if __name__ == "__main__":
    main()
