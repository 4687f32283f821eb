"""Writes the averaged weights of a training checkpoint as a model file, and its card.

    python training/export.py RUN_FOLDER/checkpoint.pt models/xrds-x4-compact.safetensors --validation VAL_FOLDER

The card (same path, .md) states the size, the data, the command, and the metrics measured with the rounded weights.
"""
import argparse
import pathlib
import pickle
import sys

import torch

import arguments
import evaluate
import train
import weights
from cost import multiply_accumulates
from network import Network

CARD = """# {name}

{channels} channels, {groups} of {blocks} block, scale {scale}, auxiliary inputs {aux}; base `{base}`, transfer `{transfer}`,
{fields}. {parameters:,} parameters, {giga:.1f} G multiply-accumulates for a 1024 x 1024 output (attention products not counted).
Licence: {licence}

## Training
- Data: {data}
- {steps} steps of {batch} crops of {crop} x {crop} low-resolution pixels, {minutes:.0f} minutes on {device} in {precision}, seed {seed}{start}.
- Loss: {loss}
- Command: `{command}`

## Metrics
{scenes} that were not trained on; scale {scale}, colour at {spp} sample{plural}
per pixel, albedo and normal {aux_spp}{merged}. Measured with the float16 weights of this file, in PyTorch, float32 (training/evaluate.py defines each number).

{table}

The same with other samples per pixel, mean PSNR in dB / mean RelMSE:

{other}
{denoised}
## Known limits
{limits}
"""

LIMITS = """- Reflections, refractions, shadows and caustics that the auxiliary images do not show are only as sharp as the colour is."""

# (colour spp, aux spp; 0 is converged) that a card tabulates, by scale; the first pair in full.
SETTINGS = {1: ((4, 4), (1, 1), (2, 2), (8, 8), (16, 16)), 2: ((16, 16), (16, 0), (16, 4), (16, 1), (4, 1)),
            4: ((64, 16), (64, 0), (64, 4), (64, 1), (32, 2), (16, 16), (16, 1)), 8: ((64, 16), (64, 0), (64, 4), (64, 1), (256, 16))}
MERGED = ", whose render's colour is an input too; every method has the low-resolution colour merged with it, both weighted by their samples"


DENOISED = """
Denoised first by Open Image Denoise, as `xrds upscale --denoise-first` does it (converged auxiliary images stay as they are), on which {share} of the crops were trained:

{table}
"""


def table_of_other_samples(folder, scale, methods, settings, denoise_first=False):
    """Markdown: mean PSNR / RelMSE for other sample counts (colour, auxiliary images)."""
    lines = [f"| colour, aux spp | {' | '.join(methods)} |", "|---" * (len(methods) + 1) + "|"]
    for spp, aux_spp in settings:
        results = evaluate.measure(folder, scale, spp, aux_spp, methods, denoise_first=denoise_first)
        means = [evaluate.mean_of(rows.values()) for rows in results.values()]
        cells = [f"{mean['psnr']:.2f} / {mean['relmse']:.4f}" for mean in means]
        lines.append(f"| {spp}, {aux_spp or 'converged'} | {' | '.join(cells)} |")
    return "\n".join(lines)


def fields_of(config):
    """What the model has beyond network.md's plain form, in words."""
    named = [f"learned {config.kernels} x {config.kernels} kernels" if config.kernels else "",
             f"learned {config.aux_kernels} x {config.aux_kernels} filter of the auxiliary images" if config.aux_kernels else "",
             f"learned {config.colour_kernels} x {config.colour_kernels} filter of the full-resolution colour" if config.colour_kernels else "",
             f"prefilter of {config.prefilter} level{'s' * (config.prefilter > 1)}" if config.prefilter else "",
             "auxiliary skip" if config.aux_skip else "", "1 x 1 output convolution" if config.output_side == 1 else "", f"block `{config.block}`" if config.block != "rdst" else "",
             f"of a denoised colour {config.denoised_darker} % of what it darkens and {config.denoised_brighter} % of what it brightens" if min(config.denoised_darker, config.denoised_brighter) < 100 else ""]
    return ", ".join(filter(None, named)) or "plain"


def listed(names):
    """"a, b and c"."""
    return " and ".join([", ".join(names[:-1]), *names[-1:]]) if len(names) > 1 else "".join(names) or "none"


def precision_of(told):
    return told.get("precision", "bfloat16")        # what checkpoints that do not say it were trained in


def share_of_denoised(told):
    return float(told.get("denoised_share", 0))


def command_of(told, start):
    """The trainer's command line; what is at its default is named too."""
    keys = (*(field.name for field in train.MODEL_FIELDS), "aux", "crop", "batch", "rate", "warm_up", "tone", "ratio", "aux_loss",
            "colour_shares", "aux_shares", *(["denoised_share"] if share_of_denoised(told) else []), "seed", "minutes")
    flags = " ".join(f"--{key.replace('_', '-')} {told[key] or repr('')}" for key in keys if told.get(key, "None") != "None")
    flags += f" --precision {precision_of(told)}"
    return f"python training/train.py SHARD_FOLDER --output RUN_FOLDER {flags}" + (" --start CHECKPOINT" if start else "")


def read_checkpoint(path):
    """What Training.save() wrote. Ends with a sentence on any other file."""
    try:
        state = torch.load(path, map_location="cpu", weights_only=False)
        if isinstance(state, dict) and {"config", "options", "average"} <= state.keys():
            return state
        reason = "it is of another program"
    except (AttributeError, EOFError, ImportError, OSError, RuntimeError, ValueError, pickle.UnpicklingError) as error:
        reason = str(error).partition("\n")[0] or type(error).__name__
    sys.exit(f"export.py: {path} is no checkpoint of train.py: {reason}")


def settings_of(options, config):
    """[(samples of the colour, of the auxiliary images)] that the card tabulates. Ends with a sentence where the validation folder has no such scene."""
    asked = arguments.pairs_of(options.spp) if options.spp else SETTINGS.get(config.scale, ())
    settings = [pair for pair in asked if pair[1] or not config.full]       # a converged colour would be the result
    if not settings:
        sys.exit(f"export.py: --spp must name samples that a model of scale {config.scale} can be measured at")
    for pair in settings:
        if not evaluate.scenes_with(options.validation, config.scale, *pair):
            sys.exit(f"export.py: {evaluate.lacking(options.validation, config.scale, *pair)} (--spp chooses)")
    return settings


def main():
    parser = arguments.Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint", type=pathlib.Path)
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("--validation", type=arguments.folder, required=True)
    parser.add_argument("--spp", type=arguments.pairs, help="what the card tabulates, as 64-16,16-1: samples of the colour and of the auxiliary images (0: converged); the first in full")
    parser.add_argument("--start", default="another model", help="name of the model that training started from, for the card")
    parser.add_argument("--licence", default="not stated", help="of the weights, as MIT")
    parser.add_argument("--data", default="{scenes} scenes", help="what it was trained on; {scenes} is their number")
    parser.add_argument("--limits", help="of the data, a sentence among the known limits")
    options = parser.parse_args()
    torch.set_num_threads(1)
    state = read_checkpoint(options.checkpoint)
    config, told = state["config"], state["options"]
    (spp, aux_spp), *others = settings = settings_of(options, config)
    network = Network(config)
    network.load_state_dict(state["average"])
    data = options.data.replace("{scenes}", str(state["scenes"]))
    provenance = {"license": options.licence, "data": data, "seed": told["seed"], "steps": str(state["step"])}
    options.model.parent.mkdir(parents=True, exist_ok=True)
    weights.save_model(options.model, network, provenance)

    methods = evaluate.methods_of(config.scale, [options.model], merge=config.full)
    results = evaluate.measure(options.validation, config.scale, spp, aux_spp, methods)
    trained, guided = (evaluate.mean_of(results[name].values()) for name in (options.model.stem, "guided"))
    scenes = len(results["guided"])
    provenance["metrics"] = (f"validation of {scenes} scene{'s' * (scenes > 1)}, {spp} spp colour, {aux_spp} spp aux{', merged' * config.full}: PSNR {trained['psnr']:.2f} dB "
                             f"(guided base {guided['psnr']:.2f}), RelMSE {trained['relmse']:.4f} ({guided['relmse']:.4f})")
    weights.save_model(options.model, network, provenance)
    loss = (f"{'SMAPE' if told['smape'] == 'True' else 'mean |x-y| / (0.1 + |x-y|) (equation 8 of the paper)'} of exposed linear radiance, plus {told['tone']} "
            f"times the mean square error of the clamped sRGB image over that of the untrained base on the scene, plus {told['ratio']} times the "
            "mean square logarithm of (x + 0.1) / (y + 0.1)"
            + (f", plus {told['aux_loss']} times the robust loss of the filtered auxiliary images against the converged ones." if config.aux_kernels else "."))
    start = options.start if told["start"] != "None" else ""
    card = CARD.format(
        name=options.model.stem, channels=config.channels, groups=f"{config.groups} group{'s' * (config.groups > 1)}", blocks=config.blocks, scale=config.scale,
        aux=listed(["the full-resolution " * (kind == "colour") + kind for kind in config.aux_inputs]), base=config.base, transfer=config.transfer, fields=fields_of(config),
        parameters=sum(p.numel() for p in network.parameters()), giga=multiply_accumulates(config, 1024, 1024) / 1e9,
        data=data, licence=options.licence, steps=state["step"], batch=told["batch"], crop=told["crop"], minutes=state["seconds"] / 60,
        device="one thread of a busy CPU" if told["device"] == "cpu" else "a CUDA device", start=f", started from {start}" if start else "",
        precision=precision_of(told), seed=told["seed"], loss=loss, command=command_of(told, start), spp=spp, plural="s" * (spp > 1), aux_spp=f"at {aux_spp}" if aux_spp else "converged", merged=MERGED if config.full else "",
        scenes=f"{scenes} validation scene{'s' * (scenes > 1)}", table=evaluate.tables(results),
        denoised=DENOISED.format(share=f"{100 * share_of_denoised(told):.0f} %", table=table_of_other_samples(
            options.validation, config.scale, methods, settings, denoise_first=True)) if share_of_denoised(told) else "",
        other=table_of_other_samples(options.validation, config.scale, methods, others), limits=f"- {options.limits}\n{LIMITS}" if options.limits else LIMITS)
    options.model.with_suffix(".md").write_text(card)
    print(evaluate.tables(results))


if __name__ == "__main__":
    main()
