"""Writes the averaged weights of a training checkpoint as a model file, and its card.

    python training/export.py RUN_FOLDER/checkpoint.pt models/xrds-x4-compact.safetensors --validation VAL_FOLDER

The card (same path, .md) states the size, the data, the command, and the metrics measured with the rounded weights.
"""
import argparse
import pathlib

import torch

import evaluate
import weights
from network import Network, multiply_accumulates

CARD = """# {name}

{channels} channels, {groups} groups of {blocks} block, scale {scale}, auxiliary inputs {aux}; base `{base}`, transfer `{transfer}`,
{kernels}auxiliary skip {aux_skip}. {parameters:,} parameters, {giga:.1f} G multiply-accumulates for a 1024 x 1024 output (attention products not counted).
Licence: MIT, weights included.

## Training
- Data: {data}
- {steps} steps of {batch} crops of {crop} x {crop} low-resolution pixels, {minutes:.0f} minutes on {threads} thread of a busy CPU in bfloat16, seed {seed}.
- Loss: {loss}
- Command: `{command}`

## Metrics
{scenes} validation scenes that were not trained on, but were looked at while the trainer was written; scale {scale}, colour at 64 samples
per pixel, albedo and normal at 16. Measured with the float16 weights of this file, in PyTorch, float32 (training/evaluate.py defines each number).

{table}

The same with other samples per pixel, mean PSNR in dB / mean RelMSE:

{other}

## Known limits
{limits}
"""

LIMITS = """- Trained on 72 scenes of 256 x 256 pixels of one renderer (Cycles), its pixel filter and its denoising albedo and normal.
- Normals must be in camera space: world-space normals were not seen.
- Auxiliary images of 1 to 4 samples per pixel put their noise into the result; see the table above. The same holds for mirrors, glass and
  depth of field, whose albedo and normal are noisy at 16: on s9004, a room of mirrors and glossy floors, the model gains less than 0.2 dB over its base.
- Reflections, refractions, shadows and caustics that the albedo and the normal do not show are only as sharp as the colour is."""

DATA = ("72 path-traced scenes (Blender Cycles 3.4, random table tops, interiors, scatter, architecture), references of at most 256 samples "
        "per pixel, colour at 64 and 16, albedo and normal at about 16, 4 and converged; crops, flips, colour permutations, exposure jitter.")


def table_of_other_samples(folder, scale, methods):
    """Markdown: mean PSNR / RelMSE for other sample counts of colour and auxiliary images."""
    lines = [f"| colour, aux spp | {' | '.join(methods)} |", "|---" * (len(methods) + 1) + "|"]
    for spp, aux_spp in ((64, 0), (64, 4), (64, 1), (16, 16)):
        results = evaluate.measure(folder, scale, spp, aux_spp, methods)
        means = [evaluate.mean_of(rows.values()) for rows in results.values()]
        cells = [f"{mean['psnr']:.2f} / {mean['relmse']:.4f}" for mean in means]
        lines.append(f"| {spp}, {aux_spp or 'converged'} | {' | '.join(cells)} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("checkpoint", type=pathlib.Path)
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("--validation", type=pathlib.Path, required=True)
    options = parser.parse_args()
    torch.set_num_threads(1)
    state = torch.load(options.checkpoint, map_location="cpu", weights_only=False)
    config, told = state["config"], state["options"]
    network = Network(config)
    network.load_state_dict(state["average"])
    provenance = {"license": "MIT", "data": DATA, "seed": told["seed"], "steps": str(state["step"])}
    weights.save_model(options.model, network, provenance)

    methods = evaluate.methods_of(config.scale, [options.model])
    results = evaluate.measure(options.validation, config.scale, 64, 16, methods)
    trained, guided = (evaluate.mean_of(results[name].values()) for name in (options.model.stem, "guided"))
    provenance["metrics"] = (f"validation of {len(results['guided'])} scenes, 64 spp colour, 16 spp aux: PSNR {trained['psnr']:.2f} dB "
                             f"(guided base {guided['psnr']:.2f}), RelMSE {trained['relmse']:.4f} ({guided['relmse']:.4f})")
    weights.save_model(options.model, network, provenance)
    loss = (f"{'SMAPE' if told['smape'] == 'True' else 'mean |x-y| / (0.1 + |x-y|) (equation 8 of the paper)'} of exposed linear radiance, plus {told['tone']} "
            "times the mean square error of the clamped sRGB image over that of the untrained base on the scene.")
    flags = " ".join(f"--{key.replace('_', '-')} {told[key]}" for key in
                     ("channels", "aux_channels", "groups", "blocks", "crop", "batch", "rate", "warm_up", "tone", "seed", "minutes"))
    card = CARD.format(
        name=options.model.stem, channels=config.channels, groups=config.groups, blocks=config.blocks, scale=config.scale,
        aux=" and ".join(config.aux_inputs), base=config.base, transfer=config.transfer,
        kernels="learned 5 x 5 kernels, " if config.kernels else "", aux_skip="on" if config.aux_skip else "off",
        parameters=sum(p.numel() for p in network.parameters()), giga=multiply_accumulates(config, 1024, 1024) / 1e9,
        data=DATA, steps=state["step"], batch=told["batch"], crop=told["crop"], minutes=state["seconds"] / 60, threads=told["threads"],
        seed=told["seed"], loss=loss, command=f"python training/train.py TRAIN_FOLDER --output RUN_FOLDER {flags}",
        scenes=len(results["guided"]), table=evaluate.tables(results),
        other=table_of_other_samples(options.validation, config.scale, methods), limits=LIMITS)
    options.model.with_suffix(".md").write_text(card)
    print(evaluate.tables(results))


if __name__ == "__main__":
    main()
