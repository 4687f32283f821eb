"""Trains a model.

    python training/train.py SHARD_FOLDER... --validation VAL_FOLDER --output RUN_FOLDER --minutes 75

RUN_FOLDER receives checkpoint.pt (resumed from when it exists) and log.txt; export.py turns the checkpoint into a model
file. The learning rate is a cosine over --minutes, or over --steps. Shards that appear while it runs are used too.
"""
import argparse
import copy
import dataclasses
import importlib.util
import math
import os
import pathlib
import sys
import time

import torch

import arguments
import arithmetic
import dataset
import evaluate
import images
import metrics
import pipeline
import shards
from arguments import number, pairs_of, shares_of
from crops import Crops
from network import Network, NetworkConfig
from start import initialise, start_from

MODEL_FIELDS = [field for field in dataclasses.fields(NetworkConfig) if field.name != "aux_inputs"]    # that is --aux
AUX_INPUTS = (*images.KINDS, "colour")     # that scenes may have
USUAL = dict(channels=32, aux_channels=16, blocks=1, kernels=5, aux_skip=1)      # defaults of the trainer, not of the file
ROBUST_BETA = 0.1
# What the report measures: sample counts of the colour and of the auxiliary images (0: converged), by scale; of full models the second.
VALIDATION_SPP = {1: "4-4", 2: "16-16,16-1", 4: "64-16,64-1", 8: "64-16,64-1"}
FULL_VALIDATION_SPP = {2: "16-4,4-1", 4: "64-16,64-4,16-1", 8: "64-16,64-4,64-1"}


def arguments_of_command_line():
    parser = arguments.Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("train", type=pathlib.Path, nargs="+", help="folders of shards (shards.py)")
    parser.add_argument("--validation", type=arguments.folder, help="folder of OpenEXR scenes")
    parser.add_argument("--validation-spp", type=arguments.pairs, help="what is measured on it, as 64-16,16-1: samples of the colour and of the auxiliary images (0: converged)")
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--minutes", type=number(float, 0, above=True), default=75)
    parser.add_argument("--steps", type=number(int, 1), help="end after so many steps, whatever the time")
    model = parser.add_argument_group("model (network.NetworkConfig tells what each field means)")
    model.add_argument("--aux", default="albedo,normal", help=f"auxiliary inputs of {', '.join(AUX_INPUTS)}; empty for none")
    for field in MODEL_FIELDS:
        model.add_argument("--" + field.name.replace("_", "-"), type=field.type, default=USUAL.get(field.name, field.default))
    model.add_argument("--start", type=pathlib.Path, help="model file or checkpoint whose fitting weights to start from")
    parser.add_argument("--crop", type=number(int, 1), default=32, help="low-resolution pixels a side, a multiple of the window")
    parser.add_argument("--batch", type=number(int, 1), default=4)
    parser.add_argument("--rate", type=number(float, 0), default=5e-4)
    parser.add_argument("--warm-up", type=number(int, 0), default=200, help="steps")
    parser.add_argument("--tone", type=number(float, 0), default=0.2, help="weight of the tone-mapped square error beside the robust loss")
    parser.add_argument("--ratio", type=number(float, 0), default=0.2, help="weight of the square of the logarithm of the result's ratio to the reference")
    parser.add_argument("--aux-loss", type=number(float, 0), default=1.0, help="weight of the robust loss of the filtered auxiliary images")
    parser.add_argument("--smape", action="store_true", help="SMAPE instead of the robust loss")
    parser.add_argument("--aux-shares", type=arguments.shares, help="how often each sample count of the auxiliary images is drawn (0: converged), as 1:0.3,4:0.7, or one count")
    parser.add_argument("--colour-shares", type=arguments.shares, help="the same of the colour; counts that a scene lacks are left out")
    parser.add_argument("--denoised-share", type=number(float, 0, 1), default=0.0,
                        help="of the crops, whose colours, albedo and normal Open Image Denoise has denoised (pyoidn)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=number(int, 1), default=1)
    parser.add_argument("--evaluate-every", type=number(float, 0), default=3, help="minutes")
    parser.add_argument("--device", type=arguments.device, default="cuda" if torch.cuda.is_available() else "cpu")
    parser.add_argument("--precision", default="auto", choices=("auto", *arithmetic.TYPES),
                        help="of the network's arithmetic; auto times both on the device and takes the faster one")
    options = parser.parse_args()
    try:
        config = config_of(options)
    except ValueError as error:
        parser.error(error)
    if not set(config.aux_inputs) <= set(AUX_INPUTS):
        parser.error(f"--aux must be of {', '.join(AUX_INPUTS)}, found {options.aux}")
    if options.crop % config.window:
        parser.error(f"--crop must be a multiple of the window, {config.window}, found {options.crop}")
    return options


def config_of(options):
    return NetworkConfig(aux_inputs=tuple(options.aux.split(",")) if options.aux else (),
                         **{field.name: getattr(options, field.name) for field in MODEL_FIELDS})


def forward(network, batch, device, precision):
    """(result, target, aux) of a batch: exposed linear radiance [b, 3, H, W], and the auxiliary images but for the colour that it was made
    of [b, A, H, W], None without. The network runs in the precision, the rest in float32."""
    config, exposure = network.config, batch["exposure"].view(-1, 1, 1, 1)
    if config.prefilter:
        return whole_image_forward(network, batch, device, precision)
    inner, high = slice(dataset.BORDER, -dataset.BORDER), slice(config.scale * dataset.BORDER, -config.scale * dataset.BORDER)
    exposed, exposed_full = exposure * batch["colour"], exposure * batch["full"] if config.full else None
    aux = pipeline.clamped_aux(batch.get("aux"), config)
    bordered = pipeline.network_colour(exposed, pipeline.clamped_albedo(aux, config), config)
    seen = pipeline.network_aux(aux, exposed_full, exposure, config)
    channels_last = lambda image: None if image is None else image.contiguous(memory_format=torch.channels_last)
    with arithmetic.autocast(device, precision):
        raw, _ = network(channels_last(bordered[:, :, inner, inner]), channels_last(None if seen is None else seen[:, :, high, high]))
    residual, logits, aux_logits, colour_logits = pipeline.split_output(raw.float(), config)
    noisy = aux
    if aux_logits is not None:      # the border keeps its noise: only crops have one
        aux = aux.clone()
        aux[:, :, high, high] = pipeline.filtered(crop_neighbours(noisy, config.aux_kernels, high), aux_logits)
        bordered = pipeline.network_colour(exposed, pipeline.clamped_albedo(aux, config), config)
    albedo = pipeline.clamped_albedo(aux, config)
    base = crop_base(bordered, aux, logits, config)
    if colour_logits is not None:
        around = (crop_neighbours(image, config.colour_kernels, high) for image in (exposed_full, pipeline.clamped_albedo(noisy, config)))
        base = pipeline.blended_neighbours(base, *around, colour_logits, config)
    ceiling = pipeline.inner_ceiling(bordered, config)
    albedo, aux = (None if image is None else image[:, :, high, high] for image in (albedo, aux))
    result = pipeline.to_radiance(residual, base, ceiling, albedo, 1.0, config)
    return result, exposure * batch["target"], aux


def whole_image_forward(network, batch, device, precision):
    """forward() of models whose kernels reach further than the border of a crop: a crop without its border is an image of its own."""
    config, exposure = network.config, batch["exposure"].view(-1, 1, 1, 1)

    def inner(key, border):
        return batch[key][:, :, border:-border, border:-border] if key in batch else None

    def run(*inputs):
        with arithmetic.autocast(device, precision):
            raw, prefilter = network(*(image.contiguous(memory_format=torch.channels_last) for image in inputs))
        return raw.float(), prefilter.float()

    high = config.scale * dataset.BORDER
    full = exposure * inner("full", high) if config.full else None
    result, _, aux = pipeline.exposed_result(run, config, exposure * inner("colour", dataset.BORDER), inner("aux", high), full, exposure)
    return result, exposure * batch["target"], aux


def crop_neighbours(image, side, high):
    """pipeline.neighbours of the pixels `high` of crops that have a border."""
    half = side // 2
    rows, columns = (slice(high.start - half, extent - high.start + half) for extent in image.shape[-2:])
    return pipeline.inner_neighbours(image[:, :, rows, columns], side)


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


def rate_at(rate, step, warm_up, progress, least=0.01):
    """The learning rate of a step: rising over `warm_up` steps, and a cosine from `rate` to the share `least` of it as progress goes from 0 to 1."""
    return rate * min(1, (step + 1) / max(1, warm_up)) * (least + (1 - least) * 0.5 * (1 + math.cos(math.pi * progress)))


@torch.no_grad()
def follow(average, network, step, most=0.999):
    """Moves the running average of the weights to those after that step; it keeps at most the share `most` of itself."""
    torch._foreach_lerp_(list(average.parameters()), list(network.parameters()), 1 - min(most, (1 + step) / (20 + step)))


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
        own, other = (dataclasses.asdict(config) for config in (self.network.config, state["config"]))
        if differences := [f"{name} {other[name]}" for name in own if own[name] != other[name]]:
            raise ValueError(f"{path} is of a model with {', '.join(differences)}: go on with that, or choose another --output")
        self.network.load_state_dict(state["network"])
        self.average.load_state_dict(state["average"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.step, self.seconds = state["step"], state["seconds"]

    def take_step(self, norm):
        """A step of the optimizer and of the average. Gradients whose norm is not finite change nothing: the fused optimizer is told so on the
        device, as a GradScaler tells it, since an `if` here would wait for the device in each step."""
        self.optimizer.found_inf = (~torch.isfinite(norm)).float()
        self.optimizer.step()
        self.update_average()

    def update_average(self):
        follow(self.average, self.network, self.step)

    def progress(self, options):
        """Share of the budget that is spent."""
        return self.step / options.steps if options.steps else self.seconds / (60 * options.minutes)


def train(training, crops, options, report):
    """Runs until the budget is spent; evaluates, saves and looks for new shards every few minutes."""
    scenes = crops.scenes
    last = time.monotonic()
    next_report, next_checkpoint = last + 30, last + options.evaluate_every * 60
    sums, count = torch.zeros(3, device=options.device), 0
    while (progress := training.progress(options)) < 1:
        rate = rate_at(options.rate, training.step, options.warm_up, progress)
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
        training.take_step(norm)
        training.step += 1
        sums, count = sums + torch.stack([robust.detach(), tone.detach(), ratio.detach()]), count + 1
        now = time.monotonic()
        training.seconds, last = training.seconds + now - last, now
        if now > next_report:
            report(f"{training.seconds / 60:6.2f} min  step {training.step:6d}  rate {rate:.2e}  robust {sums[0] / count:.5f}  "
                   f"tone {sums[1] / count:.4f}  ratio {sums[2] / count:.4f}  gradient {norm:.3f}")
            sums, count, next_report = torch.zeros_like(sums), 0, now + 30
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
    """Averaged weights on the validation folder, in float32: mean PSNR, RelMSE, and PSNR of each scene at the first of the sample counts that
    are measured; PSNR at the others, and of denoised colours if those are trained on."""
    config, counts = network.config, validation_counts(options, network.config)

    def rows_of(colour_spp, aux_spp, denoise_first=False):
        cases = evaluate.cases_of(options.validation, config.scale, colour_spp, aux_spp)
        if denoise_first:
            cases = (case.denoised(config.scale) for case in cases)
        return [metrics.all_metrics(evaluate.result_of(network, case, device=options.device), case.reference) for case in cases]

    mean = lambda rows, key: sum(row[key] for row in rows) / len(rows)
    with torch.no_grad():
        rows = rows_of(*counts[0])
        others = [f"  {colour_spp}-{aux_spp} {mean(rows_of(colour_spp, aux_spp), 'psnr'):.3f}" for colour_spp, aux_spp in counts[1:]]
        if options.denoised_share:
            others += [f"  denoised {colour_spp}-{aux_spp} {mean(rows_of(colour_spp, aux_spp, True), 'psnr'):.3f}" for colour_spp, aux_spp in counts]
    return (f"  validation  PSNR {mean(rows, 'psnr'):.3f}  RelMSE {mean(rows, 'relmse'):.4f}  "
            + " ".join(f"{row['psnr']:.2f}" for row in rows) + "".join(others))


def validation_counts(options, config):
    """[(samples of the colour, of the auxiliary images)] that are measured. Raises ValueError where the folder has no such scene."""
    settings = options.validation_spp or (FULL_VALIDATION_SPP if config.full else VALIDATION_SPP).get(config.scale)
    if not settings:
        raise ValueError(f"--scale {config.scale} has no usual samples to be measured at: choose them with --validation-spp")
    counts = pairs_of(settings)
    for pair in counts:
        if not evaluate.scenes_with(options.validation, config.scale, *pair):
            raise ValueError(f"{evaluate.lacking(options.validation, config.scale, *pair)} (--validation-spp chooses)")
    return counts


def check_scenes(scenes, options):
    """Raises ValueError where there is nothing to train on."""
    config, folders = scenes.config, ", ".join(map(str, options.train))
    if not scenes.read:
        raise ValueError(f"{folders} has no shards: shards.py makes them")
    if not len(scenes):
        wanted = [f"colour of scale {config.scale}", *config.guides, *["colour of the full resolution"] * config.full]
        raise ValueError(f"none of the {sum(len(shards.scenes_in(path)) for path in scenes.read)} scenes in {folders} has all that the model takes: {', '.join(wanted)}")
    counts = sorted({spp for scene in scenes.scenes for spp in scene.colours})
    if options.colour_shares and not shares_of(options.colour_shares).keys() & set(counts):
        raise ValueError(f"no scene has colour of the samples of --colour-shares; there are {', '.join(map(str, counts))}")
    for scene in scenes.scenes:
        height, width = (extent // config.scale for extent in scene.target.shape[-2:])
        if options.crop > min(height, width):
            raise ValueError(f"--crop {options.crop} is more than scene {scene.origin[1]} of {scene.origin[0].name} has at scale {config.scale}: {width} x {height} pixels")


def prepared(config, options, report):
    """(Training, Crops) to begin or to go on with. Raises ValueError on options that cannot be followed."""
    if options.denoised_share and not importlib.util.find_spec("pyoidn"):
        raise ValueError("--denoised-share needs Open Image Denoise: pip install -r bench/oidn-requirements.txt")
    if options.validation:
        validation_counts(options, config)
    training = Training(config, options)
    checkpoint = options.output / "checkpoint.pt"
    if checkpoint.exists():
        training.load(checkpoint, options)
        report(f"resumed at step {training.step}")
    elif options.start:
        report(f"{training.taken} tensors of {options.start.stem}")
    scenes = dataset.Scenes(options.train, config, options.device)
    check_scenes(scenes, options)
    report(f"{len(scenes)} scenes, {sum(p.numel() for p in training.network.parameters())} parameters")
    return training, Crops(scenes, options.crop, options.seed + 1000 * (training.step + 1),
                           shares_of(options.colour_shares), shares_of(options.aux_shares), options.denoised_share)


def main():
    options = arguments_of_command_line()
    options.output.mkdir(parents=True, exist_ok=True)
    torch.set_num_threads(options.threads)
    torch.backends.cudnn.benchmark = True       # every step has the same shapes
    options.precision, precision_line = arithmetic.choose(options.precision, options.device)
    with open(options.output / "log.txt", "a") as log:
        def report(line):
            print(line, flush=True)
            print(line, file=log, flush=True)
        report(" ".join(f"{key}={value}" for key, value in vars(options).items() if key not in ("train", "validation", "output", "start")))
        report(precision_line)
        try:
            training, crops = prepared(config_of(options), options, report)
        except ValueError as error:
            sys.exit(f"train.py: {error}")
        if options.validation:
            report(validation_line(training.average, options))
        train(training, crops, options, report)


if __name__ == "__main__":
    main()
