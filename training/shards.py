"""Scenes in few compact files: a shard is a zip of LZMA arrays that numpy opens without unpacking it.

    python training/shards.py SCENE_FOLDER... --output SHARD_FOLDER [--megabytes 56] [--noisy-every 3] [--noisy-bits 3]

Packs the scenes of folders of OpenEXR files (layout in README.md) that no shard of SHARD_FOLDER holds yet into
scenes-NNN.npz. A 256 x 256 scene with everything takes about half a megabyte:
colour as half floats with fewer bits, converged albedo and normal on a fine grid, noisy ones as their difference from
those on a coarser grid; of depth, where there is any, the relative depth. Every array is stored as the differences along its rows, low bytes before high bytes.
"""
import argparse
import pathlib
import re
import zipfile

import numpy as np
import torch

import images
import pipeline

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
    """{array name: uint8 array} of one scene. turn: every third (`noisy_every`th) keeps the full-resolution noisy colour of one sample
    count, the next third the 4 spp colour of scale 2."""
    kinds = kinds_of(folder, scene)
    counts = [kind for kind in kinds if re.fullmatch(r"aux\d+", kind)]
    auxiliary = {kind: images.read_auxiliary(kinds[kind]) for kind in counts + ["gt"]}
    guides = {kind: torch.cat([image[:3].clamp(0, pipeline.ALBEDO_MAX), image[3:6]]) for kind, image in auxiliary.items()}
    depths = {kind: image[7:8] for kind, image in auxiliary.items() if len(image) > 6}      # of the planes the middle one
    converged = grid_codes(guides["gt"], CONVERGED_STEP)
    arrays = {"target": half_codes(images.read_exr(kinds["gt"], "colour"), REFERENCE_BITS), "aux": converged}
    if depths:      # a reference without depth takes that of the most samples
        best = max(depths, key=lambda kind: (kind == "gt", len(kind), kind))
        arrays["depth"] = grid_codes(depths[best], DEPTH_STEP)
    for kind in counts:
        difference = guides[kind] - torch.from_numpy(converged).float() * CONVERGED_STEP
        arrays[kind] = grid_codes(difference, noisy_step(int(kind[3:])))
        if kind in depths:
            difference = depths[kind] - torch.from_numpy(arrays["depth"]).float() * DEPTH_STEP
            arrays[kind.replace("aux", "depth")] = grid_codes(difference, noisy_step(int(kind[3:])) / 4)
    if turn % noisy_every == 0:
        chosen = f"aux{NOISY_COLOUR_SPP[turn // noisy_every % 3]}"
        chosen = chosen if chosen in counts else counts[0]
        arrays[f"x1lr{chosen[3:]}"] = half_codes(images.read_exr(kinds[chosen], "colour"), noisy_bits)
    if turn % 3 != 1:
        kinds.pop("x2lr4", None)
    for kind, path in kinds.items():
        if "lr" in kind:
            arrays[kind] = half_codes(images.read_exr(path, "colour"), LOW_BITS if kind.startswith("x2") else REFERENCE_BITS)
    return {name: packed(codes) for name, codes in arrays.items()}


def with_depth(aux, relative):
    """Albedo and normal [6, H, W] and the planes of the relative depth [1, H, W] or None, float16."""
    return (aux if relative is None else torch.cat([aux, pipeline.depth_planes(relative.clamp(0, 1))])).half()


def decode(arrays):
    """What encode made -> {"target", "colour": {(scale, spp): [3, h, w]}, "aux": {spp, 0 converged: [9, H, W], [6, H, W] without
    depth}}, float16."""
    scene = {"colour": {}, "aux": {}}
    half = lambda name: torch.from_numpy(unpacked(arrays[name])).view(torch.float16)
    grid = lambda name, step: torch.from_numpy(unpacked(arrays[name])).float() * step
    converged = grid("aux", CONVERGED_STEP)
    relative = grid("depth", DEPTH_STEP) if "depth" in arrays else None
    for name in arrays:
        if match := re.fullmatch(r"aux(\d+)", name):
            noisy = converged + grid(name, noisy_step(int(match[1])))
            depth = name.replace("aux", "depth")
            scene["aux"][int(match[1])] = with_depth(noisy, relative + grid(depth, noisy_step(int(match[1])) / 4) if depth in arrays else None)
        elif match := re.fullmatch(r"(?:x(\d+))?lr(\d+)", name):
            scene["colour"][int(match[1] or 4), int(match[2])] = half(name)
    scene["target"], scene["aux"][0] = half("target"), with_depth(converged, relative)
    return scene


def read_shard(path):
    """Yields (scene name, decoded scene)."""
    with np.load(path) as shard:
        if shard.zip.comment != format_of_shards():
            raise ValueError(f"{path} was packed by another version of shards.py; pack its scenes again")
        names = sorted({entry.split("/")[0] for entry in shard.files})
        for name in names:
            prefix = name + "/"
            yield name, decode({entry[len(prefix):]: shard[entry] for entry in shard.files if entry.startswith(prefix)})


def scenes_in(path):
    with zipfile.ZipFile(path) as shard:
        return {entry.split("/")[0] for entry in shard.namelist()}


def write_shard(path, scenes, byte_limit, noisy_every=3, noisy_bits=NOISY_BITS):
    """Writes (folder, scene name) pairs until the list ends or the shard is full, whole or not at all; returns what is left."""
    part, scenes = path.with_suffix(".part"), list(scenes)
    with zipfile.ZipFile(part, "w", zipfile.ZIP_LZMA) as shard:
        shard.comment = format_of_shards()
        while scenes and shard.start_dir < byte_limit:
            folder, name = scenes.pop(0)
            for kind, array in encode(folder, name, int(name[1:]), noisy_every, noisy_bits).items():
                with shard.open(f"{name}/{kind}.npy", "w") as entry:
                    np.lib.format.write_array(entry, np.ascontiguousarray(array), allow_pickle=False)
    part.rename(path)
    return scenes


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", type=pathlib.Path, nargs="+")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--megabytes", type=float, default=56, help="size at which the next shard begins")
    parser.add_argument("--noisy-every", type=int, default=3, help="every n-th scene keeps a full-resolution noisy colour (1: all, to train scale 1)")
    parser.add_argument("--noisy-bits", type=int, default=NOISY_BITS, help="of half's ten that it keeps (6: to train models that take it too)")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)
    shards = sorted(options.output.glob("scenes-*.npz"))
    present = set().union(*(scenes_in(path) for path in shards))
    wanted = [(folder, path.name[:-len("_gt.exr")]) for folder in options.folders for path in sorted(folder.glob("*_gt.exr"))]
    wanted = [scene for scene in wanted if scene[1] not in present]
    while wanted:
        path = options.output / f"scenes-{len(shards):03}.npz"
        left = write_shard(path, wanted, options.megabytes * 1e6, options.noisy_every, options.noisy_bits)
        print(f"{path.name}: {len(wanted) - len(left)} scenes, {path.stat().st_size / 1e6:.1f} MB", flush=True)
        shards.append(path)
        wanted = left


if __name__ == "__main__":
    main()
