"""The order of the paper's Table 1 with small, equal trainings: its network and those that it compares with, at compact sizes.

    python training/rivals.py SHARD_FOLDER... --validation VAL_FOLDER --output FOLDER [--steps 400] [--seeds 1 2] [--only NAME ...]

All see the same crops in the same order, with the same loss, rate and number of steps, scale 4, and have about as many multiply-adds; EDSR, RCAN
and SwinIR take the colour alone, MSSPL and ours albedo and normal, too. A finished run is a line of FOLDER/results.json and is not trained again. Afterwards a
Markdown table is printed: PSNR and RelMSE of the averaged weights on the validation folder, colour at 64, albedo and normal at 16 samples.
docs/training.md says what came out.
"""
import argparse
import copy
import json
import pathlib
import statistics

import torch

import architectures
import arithmetic
import cost
import dataset
import evaluate
import metrics
import pipeline
import start
import train
from architectures import edsr, msspl, rcan, swinir
from crops import Crops
from network import Network, NetworkConfig

GUIDES = ("albedo", "normal")
OURS = dict(channels=32, aux_channels=16, blocks=1)
CONFIGS = {
    "EDSR": edsr.Config(channels=48, blocks=16),
    "RCAN": rcan.Config(channels=48, groups=4, blocks=4, reduction=8),
    "SwinIR": swinir.Config(channels=72, groups=4, blocks=6, window=8, head_channels=12, upsampler="pixelshuffledirect"),
    "MSSPL": msspl.Config(channels=36, groups=3, blocks=5, aux_inputs=GUIDES),
    "Hou & Liu": NetworkConfig(base="none", **OURS),
    "compact": NetworkConfig(kernels=5, aux_skip=1, **OURS),
}
SCENES = CONFIGS["compact"]     # whose crops all are trained on
CROP, BATCH, RATE, WARM_UP, TONE, RATIO = 32, 4, 5e-4, 100, 0.2, 0.2      # those of ablations.py


def is_ours(config):
    return isinstance(config, NetworkConfig)


def network_of(config, seed):
    if not is_ours(config):
        torch.manual_seed(seed)
        return architectures.network_of(config)
    network = Network(config)
    start.initialise(network, torch.Generator().manual_seed(seed))
    return network


def radiance(network, exposed, aux):
    """Exposed radiance [b, 3, 4 h, 4 w] that a network of others makes of e I [b, 3, h, w] and the guides [b, 6, 4 h, 4 w]: T of both its image and its result."""
    config = network.config
    x = architectures.padded(pipeline.transform(exposed, config.transfer), config)
    inputs = [x, architectures.padded(aux, config, config.scale)] if config.aux_inputs else [x]
    height, width = (config.scale * extent for extent in exposed.shape[2:])
    found = network(*inputs)[:, :, :height, :width].float()
    return pipeline.inverse_transform(found.clamp(0, pipeline.TRANSFORMED_MAX), config.transfer)


def forward(network, batch, precision):
    """(result, target) of a batch of crops, exposed radiance."""
    if is_ours(network.config):
        return train.forward(network, batch, "cpu", precision)[:2]
    exposure = batch["exposure"].view(-1, 1, 1, 1)
    inner = lambda key, border: batch[key][:, :, border:-border, border:-border]
    with arithmetic.autocast("cpu", precision):
        result = radiance(network, exposure * inner("colour", dataset.BORDER), inner("aux", SCENES.scale * dataset.BORDER))
    return result, exposure * batch["target"]


@torch.no_grad()
def result_of(network, case):
    """Radiance [3, H, W] of a case of the validation folder."""
    if is_ours(network.config):
        return evaluate.result_of(network, case)
    exposure = pipeline.auto_exposure(case.colour)
    return radiance(network, exposure * case.colour[None], pipeline.own_aux(case.aux, SCENES)[None])[0] / exposure


def trained(config, scenes, steps, seed, precision):
    """The average of the recent weights after a training."""
    network = network_of(config, seed)
    average, optimizer = copy.deepcopy(network).eval(), torch.optim.Adam(network.parameters(), lr=RATE, betas=(0.9, 0.99), fused=True)
    crops = Crops(scenes, CROP, seed)
    for step in range(steps):
        optimizer.param_groups[0]["lr"] = train.rate_at(RATE, step, WARM_UP, step / steps)
        batch = crops.batch(BATCH)
        robust, tone, ratio = train.losses(*forward(network, batch, precision), batch, False)
        optimizer.zero_grad(set_to_none=True)
        (robust + TONE * tone + RATIO * ratio).backward()
        torch.nn.utils.clip_grad_norm_(network.parameters(), 1.0)
        optimizer.step()
        train.follow(average, network, step)
    return average


def giga(config):
    count = cost.multiply_accumulates if is_ours(config) else architectures.multiply_accumulates
    return count(config, 1024, 1024) / 1e9


def table(results, names):
    lines = ["| network | takes | G multiply-adds | M parameters | PSNR dB by seed | mean | RelMSE |", "|---|---|--:|--:|---|--:|--:|"]
    for name in names:
        config, rows = CONFIGS[name], [row for row in results if row["name"] == name]
        if not rows:
            continue
        psnr, takes = [row["psnr"] for row in rows], "colour, albedo, normal" if config.aux_inputs else "colour"
        parameters = sum(parameter.numel() for parameter in network_of(config, 1).parameters()) / 1e6
        lines.append(f"| {name} | {takes} | {giga(config):.1f} | {parameters:.2f} | {', '.join(f'{value:.2f}' for value in psnr)} | "
                     f"{statistics.mean(psnr):.2f} | {statistics.mean(row['relmse'] for row in rows):.4f} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("train", type=pathlib.Path, nargs="+", help="folders of shards (shards.py)")
    parser.add_argument("--validation", type=pathlib.Path, required=True)
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--steps", type=int, default=400)
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--only", nargs="*", choices=CONFIGS, default=list(CONFIGS))
    options = parser.parse_args()
    torch.set_num_threads(1)
    options.output.mkdir(parents=True, exist_ok=True)
    path = options.output / "results.json"
    results = json.loads(path.read_text()) if path.exists() else []
    precision, line = arithmetic.choose("auto", "cpu")
    print(line, flush=True)
    scenes = dataset.Scenes(options.train, SCENES)
    for seed in options.seeds:
        for name in options.only:
            key = {"name": name, "seed": seed, "steps": options.steps, "scenes": len(scenes)}
            if any(key.items() <= row.items() for row in results):
                continue
            network = trained(CONFIGS[name], scenes, options.steps, seed, precision)
            rows = [metrics.all_metrics(result_of(network, case), case.reference) for case in evaluate.cases_of(options.validation, 4, 64, 16)]
            mean = evaluate.mean_of(rows)
            results.append({**key, "psnr": mean["psnr"], "relmse": mean["relmse"]})
            path.write_text(json.dumps(results, indent=1))
            print(f"{name}, seed {seed}: PSNR {mean['psnr']:.3f}  RelMSE {mean['relmse']:.4f}", flush=True)
    print(table([row for row in results if row["steps"] == options.steps], options.only))


if __name__ == "__main__":
    main()
