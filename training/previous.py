"""A trial: does a network that takes the warped previous result do better than the temporal filter in front of one that does not?

    python training/previous.py train SHARD_FOLDER RUN.pt [--plain] [--steps 2000]
    python training/previous.py measure SEQUENCE_FOLDER RUN.pt [--plain] [--filter]

Starts from models/xrds-x4-live. The previous result comes in the place of a full model's noisy colour, with kernels of 3 x 3 and a share; where guides
disagree, and before the first frame, in its place the low-resolution colour. --plain: the same training without it, to compare with. Scenes of
shards do not move: their previous result is that of another render, with a third one before it, read between pixels and spoilt in places. Sequences are those of
bench/temporal_scenes.py with the guides of their references; --filter: with the Python package's TemporalFilter in front, its history the last result alone. docs/temporal.md
says what came out. Several threads on a busy machine need OMP_WAIT_POLICY=PASSIVE.
"""
import argparse
import copy
import dataclasses
import pathlib
import random
import sys

import numpy as np
import torch
import torch.nn.functional as F

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT / "bench"))
import dataset  # noqa: E402
import metrics  # noqa: E402
import pipeline  # noqa: E402
import start  # noqa: E402
import temporal  # noqa: E402
import weights  # noqa: E402
from network import Network  # noqa: E402
from train import follow, rate_at, robust_loss  # noqa: E402

MODEL = ROOT / "models" / "xrds-x4-live.safetensors"
SCALE, SIDE = 4, 32                       # of the model; low-resolution pixels of a crop
ALBEDO, NORMAL = 0.2, 0.35                # differences that make the weight of a previous pixel 1 / e
KEPT, ALONE = 6, 0.12                     # crops for which a previous result is used; share of crops without one


def network_of(plain):
    base, _ = weights.load_model(MODEL)
    if plain:
        return base
    network = Network(dataclasses.replace(base.config, aux_inputs=("albedo", "normal", "colour"), colour_kernels=3))
    start.initialise(network, torch.Generator().manual_seed(1))
    start.start_from(network, MODEL)
    return network


def at(height, width, x, y):
    """(grid for grid_sample, inside [1, 1, h, w]) of the pixels that are (x, y) further on."""
    down, along = torch.meshgrid(torch.arange(height) + 0.0, torch.arange(width) + 0.0, indexing="ij")
    along, down = along + x, down + y
    inside = (along >= 0) & (down >= 0) & (along <= width - 1) & (down <= height - 1)
    return torch.stack([2 * along / (width - 1) - 1, 2 * down / (height - 1) - 1], -1)[None], inside[None, None].float()


def read(image, grid, mode="bilinear"):
    return F.grid_sample(image, grid, mode=mode, padding_mode="border", align_corners=True)


def enlarged(low):
    return low.repeat_interleave(SCALE, 2).repeat_interleave(SCALE, 3)


def brought(previous, guides_before, guides, motion, instead):
    """The previous result where it is now, `instead` where the means of 3 x 3 guides differ."""
    grid, inside = at(*guides.shape[-2:], motion[..., 0], motion[..., 1])
    far = F.avg_pool2d(F.pad(read(guides_before, grid) - guides, (1,) * 4, mode="replicate"), 3, 1).square()
    weight = inside * torch.exp(-far[:, :3].sum(1, True) / ALBEDO ** 2 - far[:, 3:].sum(1, True) / NORMAL ** 2)
    return weight * read(previous, grid) + (1 - weight) * instead


def upscaled(network, low, guides, previous):
    """(exposed radiance, exposure)."""
    exposure = pipeline.auto_exposure(low[0])
    full = previous * exposure if network.config.full else None
    return pipeline.exposed_result(network, network.config, low * exposure, guides, full, exposure)[0], exposure


class History:
    """Previous results of scenes, made by the running average."""

    def __init__(self, network, scenes, rng):
        self.network, self.scenes, self.rng, self.kept = network, scenes, rng, {}

    @torch.no_grad()
    def of(self, index):
        """(result [1, 3, H, W], samples of the colour that follows)."""
        if index not in self.kept or self.kept[index][2] == 0:
            scene = self.scenes[index]
            counts = list(scene.colours)
            self.rng.shuffle(counts)
            result, guides = None, scene.aux[0].float()[None]
            for count in counts[-self.rng.randrange(1, len(counts)):]:
                low = scene.colours[count].float()[None]
                found, exposure = upscaled(self.network, low, guides, enlarged(low) if result is None else result)
                result = found / exposure
            self.kept[index] = [result, counts[0], KEPT]
        self.kept[index][2] -= 1
        return self.kept[index][:2]


def spoilt(result, rng):
    """A whole result as a moving camera would have it: read between pixels, wrong in places, brighter or darker."""
    height, width = result.shape[-2:]
    if rng.random() < 0.8:
        x, y = rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5)
        result = read(read(result, at(height, width, x, y)[0], "bicubic"), at(height, width, -x, -y)[0]).clamp(min=0)
    wrong = result.clone()
    for _ in range(rng.choice((0, 0, 4, 8, 12))):
        rows, columns = (slice(first, first + rng.randrange(8, 72)) for first in (rng.randrange(height - 72), rng.randrange(width - 72)))
        other = result.roll((rng.randrange(-24, 25), rng.randrange(-24, 25)), (2, 3)) if rng.random() < 0.5 else result * 2 ** rng.uniform(-1.5, 1.5)
        wrong[..., rows, columns] = other[..., rows, columns]
    return wrong * (2 ** rng.uniform(-0.5, 0.5) if rng.random() < 0.2 else 1)


def crop(scene, rng, previous):
    """(colour, guides, target, previous result) of a random place; previous: whole result and samples, or none."""
    samples = previous[1] if previous else rng.choice([count for count in scene.colours if count <= 16])
    height, width = scene.colours[samples].shape[-2:]
    y, x = rng.randrange(height - SIDE + 1), rng.randrange(width - SIDE + 1)
    cut = lambda image, scale: image.float()[..., scale * y:scale * (y + SIDE), scale * x:scale * (x + SIDE)].reshape(1, -1, scale * SIDE, scale * SIDE)
    low = cut(scene.colours[samples], 1)
    before = cut(spoilt(previous[0], rng), SCALE) if previous and rng.random() > ALONE else enlarged(low)
    return low, cut(scene.aux[0], SCALE), cut(scene.target, SCALE), before


def train(options):
    rng, network = random.Random(1), network_of(options.plain)
    average, optimizer = copy.deepcopy(network).eval(), torch.optim.Adam(network.parameters(), lr=options.rate, betas=(0.9, 0.99))
    plain = dataclasses.replace(network.config, aux_inputs=("albedo", "normal"), colour_kernels=0)
    scenes = dataset.Scenes([options.folder], plain).scenes
    history = History(average, scenes, rng)
    for step in range(options.steps):
        optimizer.param_groups[0]["lr"] = rate_at(options.rate, step, 100, step / options.steps, 0.02)
        optimizer.zero_grad()
        for _ in range(options.batch):
            index = rng.randrange(len(scenes))
            low, guides, target, before = crop(scenes[index], rng, None if options.plain else history.of(index))
            result, exposure = upscaled(network, low, guides, before)
            ratio = torch.log(result.clamp(min=0) + 0.1) - torch.log(target * exposure + 0.1)
            square = (metrics.srgb(result / exposure) - metrics.srgb(target)).square().mean()
            (robust_loss(result - target * exposure) + 60 * square + 0.2 * ratio.square().mean()).div(options.batch).backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimizer.step()
        follow(average, network, step, 0.995)
    torch.save(average.state_dict(), options.run)


def planar(image):
    return torch.from_numpy(np.ascontiguousarray(image.transpose(2, 0, 1)))[None].float()


def packed(image):
    return np.ascontiguousarray(image[0].permute(1, 2, 0).numpy())


class Filter:
    """The last result of the Python package's TemporalFilter, whose counts are frames."""

    def __init__(self, width, height):
        import xrds
        self.xrds, self.merging, self.before = xrds, xrds.TemporalFilter(width, height, SCALE), []

    def merged(self, low, guides, depth, motion):
        frame = self.xrds.TemporalFrame(packed(low), None, packed(guides[:, :3]), packed(guides[:, 3:]), depth, motion.numpy())
        found = self.merging(frame, self.before)
        self.before = [found]
        return planar(found.colour)


@torch.no_grad()
def measure(options):
    network = network_of(options.plain)
    network.load_state_dict(torch.load(options.run))
    network.eval()
    for folder in sorted(path for path in options.folder.iterdir() if path.is_dir()):
        sequence = temporal.Sequence(options.folder, folder.name)
        sequence.read()
        merging, results, last, guides_before = None, [], None, None
        for number in range(sequence.length):
            low = planar(temporal.layers(sequence.files["low"][number], "Combined")[0])
            guides = torch.cat([planar(sequence.albedo[number]), planar(sequence.normal[number])], 1)
            motion = torch.from_numpy(np.ascontiguousarray(temporal.to_previous(sequence.vector[number]))).float()
            if options.filter:
                merging = merging or Filter(low.shape[-1], low.shape[-2])
                depth, = temporal.layers(sequence.files["reference"][number], "Denoising Depth")
                low = merging.merged(low, guides, np.ascontiguousarray(depth[..., 0]), motion)
            before = enlarged(low) if last is None else brought(last, guides_before, guides, motion, enlarged(low))
            result, exposure = upscaled(network, low, guides, before)
            last, guides_before = result / exposure, guides
            results.append(packed(last))
        found = [temporal.psnr(*pair) for pair in zip(results, sequence.references)]
        print(f"{folder.name}: {np.mean(found):.2f} dB, flicker {sequence.flicker(results):.4f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("verb", choices=("train", "measure"))
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("run", type=pathlib.Path)
    parser.add_argument("--plain", action="store_true")
    parser.add_argument("--filter", action="store_true")
    parser.add_argument("--steps", type=int, default=2000)
    parser.add_argument("--batch", type=int, default=4)
    parser.add_argument("--rate", type=float, default=8e-4)
    options = parser.parse_args()
    torch.set_num_threads(1)
    return train(options) if options.verb == "train" else measure(options)


if __name__ == "__main__":
    main()
