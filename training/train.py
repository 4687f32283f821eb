"""Trains a model with a guided base and learned kernels.

    python training/train.py TRAIN_FOLDER --validation VAL_FOLDER --output RUN_FOLDER --minutes 75

RUN_FOLDER receives checkpoint.pt (resumed from when it exists) and log.txt. The step count follows from --minutes: the
learning rate is a cosine over the time budget. export.py turns the checkpoint into a model file.
"""
import argparse
import copy
import math
import os
import pathlib
import time

import torch

import dataset
import evaluate
import metrics
import pipeline
from network import Network, NetworkConfig, initialise

ROBUST_BETA = 0.1


def arguments_of_command_line():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("train", type=pathlib.Path)
    parser.add_argument("--validation", type=pathlib.Path)
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--minutes", type=float, default=75)
    parser.add_argument("--channels", type=int, default=32)
    parser.add_argument("--aux-channels", type=int, default=16)
    parser.add_argument("--groups", type=int, default=3)
    parser.add_argument("--blocks", type=int, default=1)
    parser.add_argument("--scale", type=int, default=4)
    parser.add_argument("--crop", type=int, default=32, help="low-resolution pixels a side, a multiple of the window")
    parser.add_argument("--batch", type=int, default=4)
    parser.add_argument("--rate", type=float, default=4e-4)
    parser.add_argument("--warm-up", type=int, default=200, help="steps")
    parser.add_argument("--tone", type=float, default=0.1, help="weight of the tone-mapped square error beside the robust loss")
    parser.add_argument("--smape", action="store_true", help="SMAPE instead of the robust loss")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--evaluate-every", type=float, default=3, help="minutes")
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    return parser.parse_args()


def forward(network, batch, device):
    """(result, target) of a batch: exposed linear radiance [b, 3, H, W]. The network runs in bfloat16, the rest in float32."""
    config = network.config
    exposure = batch["exposure"].view(-1, 1, 1, 1)
    bordered = pipeline.transform(exposure * batch["colour"] / (batch["albedo_mean"] + pipeline.EPSILON), config.transfer)
    size = bordered.shape[-1] - 4
    x = bordered[:, :, 2:-2, 2:-2].contiguous(memory_format=torch.channels_last)
    aux = batch["aux"].contiguous(memory_format=torch.channels_last)
    with torch.autocast(device, torch.bfloat16):
        raw = network(x, aux)
    raw = raw.float()
    around = torch.stack([bordered[:, :, dy:dy + size, dx:dx + size] for dy in range(5) for dx in range(5)], 2)
    log_weights = batch["log_weights"]
    if config.kernels:
        log_weights = log_weights + raw[:, 3:].clamp(-pipeline.LOGIT_MAX, pipeline.LOGIT_MAX)
    transformed = pipeline.kernel_average(around, log_weights, config.scale) + raw[:, :3]
    return pipeline.to_radiance(transformed, batch["aux"][:, :3], 1.0, config), exposure * batch["target"]


def losses(result, target, batch, smape):
    """(robust, tone): the paper's equation 8, mean |x-y| / (beta + |x-y|), of exposed radiance; and the mean square error of the
    clamped sRGB image at the file's exposure over that of the untrained base on the same scene, the gradient of mean PSNR."""
    difference = (result - target).abs()
    robust = (difference / (result.abs() + target.abs() + 0.01 if smape else ROBUST_BETA + difference)).mean()
    exposure = batch["exposure"].view(-1, 1, 1, 1)
    square = (metrics.srgb(result / exposure) - metrics.srgb(target / exposure)).square().mean((1, 2, 3))
    return robust, (square / (batch["base_error"] + 1e-4)).mean()


class Training:
    """Network, its running average, optimizer and counters: everything that a checkpoint holds."""

    def __init__(self, config, options):
        self.network = Network(config)
        initialise(self.network, torch.Generator().manual_seed(options.seed))
        self.network.to(options.device, memory_format=torch.channels_last)
        self.average = copy.deepcopy(self.network).requires_grad_(False)
        self.optimizer = torch.optim.Adam(self.network.parameters(), lr=options.rate, betas=(0.9, 0.99), fused=True)
        self.step, self.seconds = 0, 0.0

    def save(self, path, options):
        state = {"config": self.network.config, "network": self.network.state_dict(), "average": self.average.state_dict(),
                 "optimizer": self.optimizer.state_dict(), "step": self.step, "seconds": self.seconds,
                 "options": {key: str(value) for key, value in vars(options).items()}}
        torch.save(state, path.with_suffix(".part"))
        os.replace(path.with_suffix(".part"), path)

    def load(self, path, options):
        state = torch.load(path, map_location=options.device, weights_only=False)
        self.network.load_state_dict(state["network"])
        self.average.load_state_dict(state["average"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.step, self.seconds = state["step"], state["seconds"]

    def update_average(self):
        decay = min(0.999, (1 + self.step) / (20 + self.step))
        with torch.no_grad():
            torch._foreach_lerp_(list(self.average.parameters()), list(self.network.parameters()), 1 - decay)


def train(training, scenes, options, report):
    """Runs until the time budget is spent; evaluates and saves every few minutes."""
    crops = dataset.Crops(scenes, options.crop, options.seed + 1000 * (training.step + 1))
    budget, last = options.minutes * 60, time.monotonic()
    next_report, next_checkpoint = time.monotonic() + 30, time.monotonic() + options.evaluate_every * 60
    sums, count = torch.zeros(2), 0
    while training.seconds < budget:
        progress = training.seconds / budget
        rate = options.rate * min(1, (training.step + 1) / options.warm_up) * (0.01 + 0.99 * 0.5 * (1 + math.cos(math.pi * progress)))
        for group in training.optimizer.param_groups:
            group["lr"] = rate
        batch = {key: value.to(options.device, non_blocking=True) for key, value in crops.batch(options.batch).items()}
        robust, tone = losses(*forward(training.network, batch, options.device), batch, options.smape)
        training.optimizer.zero_grad(set_to_none=True)
        (robust + options.tone * tone).backward()
        norm = torch.nn.utils.clip_grad_norm_(training.network.parameters(), 1.0)
        if torch.isfinite(norm):
            training.optimizer.step()
            training.update_average()
        training.step += 1
        sums, count = sums + torch.stack([robust.detach(), tone.detach()]).cpu(), count + 1
        now = time.monotonic()
        training.seconds, last = training.seconds + now - last, now
        if now > next_report:
            report(f"{training.seconds / 60:6.2f} min  step {training.step:6d}  rate {rate:.2e}  robust {sums[0] / count:.5f}  "
                   f"tone {sums[1] / count:.4f}  gradient {norm:.3f}")
            sums, count, next_report = torch.zeros(2), 0, now + 30
        if now > next_checkpoint or training.seconds >= budget:
            training.save(options.output / "checkpoint.pt", options)
            if options.validation:
                report(validation_line(training.average, options))
            last = time.monotonic() if options.device == "cpu" else last
            next_checkpoint = time.monotonic() + options.evaluate_every * 60


def validation_line(network, options):
    """Averaged weights on the validation folder, in float32: mean PSNR, RelMSE, and PSNR of each scene."""
    config, rows = network.config, []
    with torch.no_grad():
        for case in evaluate.cases_of(options.validation, config.scale, 64, 16):
            colour, aux, target = (image.to(options.device) for image in case[1:])
            result, _, _ = pipeline.upscale(network, colour[None], aux[None])
            rows.append(metrics.all_metrics(result[0].cpu(), target.cpu()))
    mean = lambda key: sum(row[key] for row in rows) / len(rows)
    return (f"  validation  PSNR {mean('psnr'):.3f}  RelMSE {mean('relmse'):.4f}  "
            + " ".join(f"{row['psnr']:.2f}" for row in rows))


def main():
    options = arguments_of_command_line()
    options.output.mkdir(parents=True, exist_ok=True)
    torch.set_num_threads(options.threads)
    config = NetworkConfig(scale=options.scale, channels=options.channels, aux_channels=options.aux_channels, groups=options.groups,
                           blocks=options.blocks, kernels=5, aux_skip=1)
    training = Training(config, options)
    checkpoint = options.output / "checkpoint.pt"
    with open(options.output / "log.txt", "a") as log:
        def report(line):
            print(line, flush=True)
            print(line, file=log, flush=True)
        report(" ".join(f"{key}={value}" for key, value in vars(options).items() if key not in ("train", "validation", "output")))
        if checkpoint.exists():
            training.load(checkpoint, options)
            report(f"resumed at step {training.step}")
        scenes = dataset.Scenes(options.train, config)
        report(f"{len(scenes)} scenes, {sum(p.numel() for p in training.network.parameters())} parameters")
        if options.validation:
            report(validation_line(training.average, options))
        train(training, scenes, options, report)


if __name__ == "__main__":
    main()
