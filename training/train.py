"""Trains a model.

    python training/train.py SHARD_FOLDER... --validation VAL_FOLDER --output RUN_FOLDER --minutes 75

RUN_FOLDER receives checkpoint.pt (resumed from when it exists) and log.txt; export.py turns the checkpoint into a model
file. The learning rate is a cosine over --minutes, or over --steps. Shards that appear while it runs are used too.
"""
import argparse
import copy
import math
import os
import pathlib
import time

import torch

import arithmetic
import dataset
import evaluate
import metrics
import pipeline
import weights
from network import Network, NetworkConfig, initialise

ROBUST_BETA = 0.1
VALIDATION_SPP = {1: (4, 4), 2: (16, 16), 4: (64, 16), 8: (64, 16)}     # scale: colour, auxiliary images


def arguments_of_command_line():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("train", type=pathlib.Path, nargs="+", help="folders of shards (shards.py)")
    parser.add_argument("--validation", type=pathlib.Path, help="folder of OpenEXR scenes")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--minutes", type=float, default=75)
    parser.add_argument("--steps", type=int, help="end after so many steps, whatever the time")
    model = parser.add_argument_group("model")
    model.add_argument("--scale", type=int, default=4)
    model.add_argument("--channels", type=int, default=32)
    model.add_argument("--aux-channels", type=int, default=16)
    model.add_argument("--head-channels", type=int, default=32)
    model.add_argument("--groups", type=int, default=3)
    model.add_argument("--blocks", type=int, default=1)
    model.add_argument("--aux", default="albedo,normal", help="auxiliary inputs, empty for none")
    model.add_argument("--base", default="guided")
    model.add_argument("--block", default="rdst")
    model.add_argument("--cross", default="attention")
    model.add_argument("--kernels", type=int, default=5)
    model.add_argument("--aux-kernels", type=int, default=0)
    model.add_argument("--aux-skip", type=int, default=1)
    model.add_argument("--output-side", type=int, default=3, help="3 or 1: of the output convolution")
    model.add_argument("--start", type=pathlib.Path, help="model file or checkpoint whose fitting weights to start from")
    parser.add_argument("--crop", type=int, default=32, help="low-resolution pixels a side, a multiple of the window")
    parser.add_argument("--batch", type=int, default=4)
    parser.add_argument("--rate", type=float, default=5e-4)
    parser.add_argument("--warm-up", type=int, default=200, help="steps")
    parser.add_argument("--tone", type=float, default=0.2, help="weight of the tone-mapped square error beside the robust loss")
    parser.add_argument("--ratio", type=float, default=0.2, help="weight of the square of the logarithm of the result's ratio to the reference")
    parser.add_argument("--aux-loss", type=float, default=1.0, help="weight of the robust loss of the filtered auxiliary images")
    parser.add_argument("--smape", action="store_true", help="SMAPE instead of the robust loss")
    parser.add_argument("--aux-spp", type=int, help="train on this count of the auxiliary images alone (0: converged)")
    parser.add_argument("--colour-spp", type=int, help="train on this count of the colour alone")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--evaluate-every", type=float, default=3, help="minutes")
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    parser.add_argument("--precision", default="auto", choices=("auto", *arithmetic.TYPES),
                        help="of the network's arithmetic; auto times both on the device and takes the faster one")
    return parser.parse_args()


def config_of(options):
    return NetworkConfig(scale=options.scale, channels=options.channels, aux_channels=options.aux_channels,
                         aux_inputs=tuple(options.aux.split(",")) if options.aux else (), groups=options.groups, blocks=options.blocks,
                         head_channels=options.head_channels, base=options.base, block=options.block, cross=options.cross,
                         kernels=options.kernels, aux_skip=options.aux_skip, aux_kernels=options.aux_kernels, output_side=options.output_side)


def forward(network, batch, device, precision):
    """(result, target, aux) of a batch: exposed linear radiance [b, 3, H, W], and the auxiliary images [b, A, H, W] that it was made of,
    None without. The network runs in the precision, the rest in float32."""
    config = network.config
    inner, high = slice(dataset.BORDER, -dataset.BORDER), slice(config.scale * dataset.BORDER, -config.scale * dataset.BORDER)
    exposed = batch["exposure"].view(-1, 1, 1, 1) * batch["colour"]
    aux = batch.get("aux")
    bordered = pipeline.network_colour(exposed, pipeline.clamped_albedo(aux, config), config)
    channels_last = lambda image: None if image is None else image.contiguous(memory_format=torch.channels_last)
    with arithmetic.autocast(device, precision):
        raw = network(channels_last(bordered[:, :, inner, inner]), channels_last(None if aux is None else aux[:, :, high, high]))
    residual, logits, aux_logits = pipeline.split_output(raw.float(), config)
    if aux_logits is not None:      # the border keeps its noise: only crops have one
        side = config.aux_kernels // 2
        rows, columns = (slice(high.start - side, extent - high.start + side) for extent in aux.shape[-2:])
        aux = aux.clone()
        aux[:, :, high, high] = pipeline.filtered(pipeline.inner_neighbours(aux[:, :, rows, columns], config.aux_kernels), aux_logits)
        bordered = pipeline.network_colour(exposed, pipeline.clamped_albedo(aux, config), config)
    base = crop_base(bordered, aux, logits, config)
    aux = None if aux is None else aux[:, :, high, high]
    ceiling = pipeline.inner_ceiling(bordered, config)
    result = pipeline.to_radiance(residual, base, ceiling, pipeline.clamped_albedo(aux, config), 1.0, config)
    return result, batch["exposure"].view(-1, 1, 1, 1) * batch["target"], aux


def crop_base(bordered, aux, logits, config):
    """The base image of crops [b, 3, sh, sw] whose colour and auxiliary images have a border."""
    scale, border = config.scale, config.scale * dataset.BORDER
    high = slice(border, -border)
    if config.base == "none":
        return None
    if config.base != "guided":
        return pipeline.bicubic(bordered, scale)[:, :, high, high]
    with torch.no_grad():
        guides = pipeline.guides_of(aux, config)
        means = pipeline.inner_neighbours(pipeline.box_mean(guides, scale))
        log_weights = pipeline.bilateral_log_weights(guides[:, :, high, high].contiguous(), means, scale)
    return pipeline.kernel_average(pipeline.inner_neighbours(bordered), pipeline.with_learned(log_weights, logits))


def robust_loss(difference):
    """The paper's equation 8: mean |x-y| / (beta + |x-y|)."""
    return (difference.abs() / (ROBUST_BETA + difference.abs())).mean()


def losses(result, target, batch, smape):
    """(robust, tone, ratio): the paper's loss of exposed radiance (or SMAPE); the mean square error of the clamped sRGB image at the
    file's exposure over that of the untrained base on the same scene, the gradient of mean PSNR; and the mean square logarithm of
    (x + 0.1) / (y + 0.1), the only one of the three that a pixel far too bright does not leave nearly unmoved."""
    difference = result - target
    robust = (difference.abs() / (result.abs() + target.abs() + 0.01)).mean() if smape else robust_loss(difference)
    exposure = batch["exposure"].view(-1, 1, 1, 1)
    square = (metrics.srgb(result / exposure) - metrics.srgb(target / exposure)).square().mean((1, 2, 3))
    ratio = (torch.log(result.clamp(min=0) + 0.1) - torch.log(target + 0.1)).square().mean()
    return robust, (square / (batch["base_error"] + 1e-4)).mean(), ratio


def start_from(network, path):
    """Takes over every weight of another model that fits by name and shape; returns how many tensors did.

    A model of another scale lends the last step of its deshuffles to the last, and its last upscaling step to further ones.
    """
    if path.suffix == ".pt":
        state = torch.load(path, map_location="cpu", weights_only=False)
        source, other = state["average"], state["config"]
    else:
        loaded, _ = weights.load_model(path)
        source, other = loaded.state_dict(), loaded.config
    taken, own = 0, network.state_dict()
    for name, tensor in own.items():
        parts = name.split(".")
        if parts[0] == "deshuffle" and int(parts[2]) == network.config.steps - 1:
            parts[2] = str(other.steps - 1)
        if parts[0] == "up" and int(parts[1]) >= other.steps:
            parts[1] = str(other.steps - 1)
        found = source.get(".".join(parts))
        if name == "out.weight" and found is not None and found.shape[2] != tensor.shape[2]:    # 3 x 3 to 1 x 1, or back
            found = found.sum((2, 3), keepdim=True) if tensor.shape[2] == 1 else torch.nn.functional.pad(found, (1, 1, 1, 1))
        if found is not None and found.shape == tensor.shape:
            tensor.copy_(found)
            taken += 1
        elif found is not None and parts[0] in ("out", "fuse", "aux_conv"):     # fewer inputs or outputs: the leading ones are the same
            common = tuple(slice(min(a, b)) for a, b in zip(found.shape, tensor.shape))
            if name == "aux_conv.weight":
                tensor.zero_()      # a further auxiliary input changes nothing at first
            tensor[common] = found[common]
    return taken


class Training:
    """Network, its running average, optimizer and counters: everything that a checkpoint holds."""

    def __init__(self, config, options):
        self.network = Network(config)
        initialise(self.network, torch.Generator().manual_seed(options.seed))
        self.taken = start_from(self.network, options.start) if options.start else 0
        self.network.to(options.device, memory_format=torch.channels_last)
        self.average = copy.deepcopy(self.network).requires_grad_(False)
        self.optimizer = torch.optim.Adam(self.network.parameters(), lr=options.rate, betas=(0.9, 0.99), fused=True)
        self.step, self.seconds, self.scenes = 0, 0.0, 0

    def save(self, path, options):
        state = {"config": self.network.config, "network": self.network.state_dict(), "average": self.average.state_dict(),
                 "optimizer": self.optimizer.state_dict(), "step": self.step, "seconds": self.seconds, "scenes": self.scenes,
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

    def progress(self, options):
        """Share of the budget that is spent."""
        return self.step / options.steps if options.steps else self.seconds / (60 * options.minutes)


def only(spp):
    return None if spp is None else {spp: 1}


def train(training, scenes, options, report):
    """Runs until the budget is spent; evaluates, saves and looks for new shards every few minutes."""
    crops = dataset.Crops(scenes, options.crop, options.seed + 1000 * (training.step + 1), only(options.colour_spp), only(options.aux_spp))
    last = time.monotonic()
    next_report, next_checkpoint = last + 30, last + options.evaluate_every * 60
    sums, count = torch.zeros(3), 0
    while (progress := training.progress(options)) < 1:
        rate = options.rate * min(1, (training.step + 1) / options.warm_up) * (0.01 + 0.99 * 0.5 * (1 + math.cos(math.pi * progress)))
        for group in training.optimizer.param_groups:
            group["lr"] = rate
        batch = crops.batch(options.batch)
        result, target, aux = forward(training.network, batch, options.device, options.precision)
        robust, tone, ratio = losses(result, target, batch, options.smape)
        loss = robust + options.tone * tone + options.ratio * ratio
        if "clean" in batch:
            loss = loss + options.aux_loss * robust_loss(aux - batch["clean"])
        training.optimizer.zero_grad(set_to_none=True)
        loss.backward()
        norm = torch.nn.utils.clip_grad_norm_(training.network.parameters(), 1.0)
        if torch.isfinite(norm):
            training.optimizer.step()
            training.update_average()
        training.step += 1
        sums, count = sums + torch.stack([robust.detach(), tone.detach(), ratio.detach()]).cpu(), count + 1
        now = time.monotonic()
        training.seconds, last = training.seconds + now - last, now
        if now > next_report:
            report(f"{training.seconds / 60:6.2f} min  step {training.step:6d}  rate {rate:.2e}  robust {sums[0] / count:.5f}  "
                   f"tone {sums[1] / count:.4f}  ratio {sums[2] / count:.4f}  gradient {norm:.3f}")
            sums, count, next_report = torch.zeros(3), 0, now + 30
        ended = training.progress(options) >= 1
        if now > next_checkpoint or ended:
            training.scenes = len(scenes)
            training.save(options.output / "checkpoint.pt", options)
            if options.validation:
                report(validation_line(training.average, options))
            if not ended and (before := len(scenes)) != (scenes.refresh() or len(scenes)):
                report(f"  {len(scenes) - before} new scenes, {len(scenes)} in all")
            last = time.monotonic()
            next_checkpoint = last + options.evaluate_every * 60


def validation_line(network, options):
    """Averaged weights on the validation folder, in float32: mean PSNR, RelMSE, and PSNR of each scene; then PSNR with aux of 1 spp."""
    config = network.config
    colour_spp, aux_spp = VALIDATION_SPP[config.scale]

    def rows_of(aux_spp, colour_spp):
        rows = []
        for _, colour, aux, target in evaluate.cases_of(options.validation, config.scale, colour_spp, aux_spp):
            aux = pipeline.own_aux(aux, config)[None].to(options.device) if config.aux_inputs else None
            result, _, _ = pipeline.upscale(network, colour[None].to(options.device), aux)
            rows.append(metrics.all_metrics(result[0].cpu(), target))
        return rows

    mean = lambda rows, key: sum(row[key] for row in rows) / len(rows)
    with torch.no_grad():
        rows = rows_of(aux_spp, colour_spp)
        line = (f"  validation  PSNR {mean(rows, 'psnr'):.3f}  RelMSE {mean(rows, 'relmse'):.4f}  "
                + " ".join(f"{row['psnr']:.2f}" for row in rows))
        if config.scale > 1 and config.aux_inputs:
            line += f"  aux 1 spp {mean(rows_of(1, colour_spp), 'psnr'):.3f}"
    return line


def main():
    options = arguments_of_command_line()
    options.output.mkdir(parents=True, exist_ok=True)
    torch.set_num_threads(options.threads)
    options.precision, precision_line = arithmetic.choose(options.precision, options.device)
    config = config_of(options)
    training = Training(config, options)
    checkpoint = options.output / "checkpoint.pt"
    with open(options.output / "log.txt", "a") as log:
        def report(line):
            print(line, flush=True)
            print(line, file=log, flush=True)
        report(" ".join(f"{key}={value}" for key, value in vars(options).items() if key not in ("train", "validation", "output", "start")))
        report(precision_line)
        if checkpoint.exists():
            training.load(checkpoint, options)
            report(f"resumed at step {training.step}")
        elif options.start:
            report(f"{training.taken} tensors of {options.start.stem}")
        scenes = dataset.Scenes(options.train, config, options.device)
        report(f"{len(scenes)} scenes, {sum(p.numel() for p in training.network.parameters())} parameters")
        if options.validation:
            report(validation_line(training.average, options))
        train(training, scenes, options, report)


if __name__ == "__main__":
    main()
