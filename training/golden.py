"""Writes golden files: small random models with the inputs and outputs of a double-precision forward pass.

    python training/golden.py tests/golden

NAME.model.safetensors is a model file; NAME.io.safetensors holds float32 images, channels last:
colour [h, w, 3] linear radiance, albedo, normal, full (the full-resolution colour), diffuse, glossy [H, W, 3] and aux [H, W, 3k] (further inputs) where the model
has them,
exposure [1], network [H, W, 3 (+ logits)] the raw cropped output, output [H, W, 3] linear radiance.
"""
import argparse
import math
import pathlib
import sys

import torch
import torch.nn as nn
from safetensors.torch import save_file

import pipeline
import weights
from network import LIGHTS, Network, NetworkConfig

SMALL = dict(channels=8, aux_channels=4, head_channels=4, groups=1, blocks=1, window=4)
ALBEDO, NORMAL, NONE = ("albedo",), ("normal",), ()
KEYS = {"albedo": "albedo", "normal": "normal", "colour": "full", "diffuse": "diffuse", "glossy": "glossy"}      # of auxiliary inputs, in the file of images

# name: ((h, w) of the low-resolution colour, fields that differ from SMALL)
CASES = {
    "s4_guided": ((11, 14), dict()),
    "s1_guided": ((9, 13), dict(scale=1)),
    "s2_guided": ((10, 7), dict(scale=2, groups=2)),
    "s8_guided": ((5, 6), dict(scale=8)),
    "s16_guided": ((2, 3), dict(scale=16)),
    "s4_guided_albedo": ((7, 9), dict(aux_inputs=ALBEDO)),
    "s4_guided_extra_aux": ((6, 5), dict(aux_inputs=("albedo", "normal", "extra"))),
    "s2_demodulated": ((9, 6), dict(scale=2, base="demodulated")),
    "s4_demodulated_albedo": ((5, 10), dict(base="demodulated", aux_inputs=ALBEDO)),
    "s4_bicubic": ((9, 6), dict(base="bicubic")),
    "s2_bicubic_normal": ((6, 11), dict(scale=2, base="bicubic", aux_inputs=NORMAL)),
    "s8_bicubic_noaux": ((5, 3), dict(scale=8, base="bicubic", aux_inputs=NONE)),
    "s4_none_noaux": ((9, 7), dict(base="none", aux_inputs=NONE)),
    "s1_none_noaux": ((6, 9), dict(scale=1, base="none", aux_inputs=NONE, blocks=2)),
    "s4_none_plain": ((7, 10), dict(base="none", transfer="none")),
    "s2_none_linear_albedo": ((8, 12), dict(scale=2, base="none", transfer="none", aux_inputs=ALBEDO)),
    "s2_bicubic_linear": ((7, 5), dict(scale=2, base="bicubic", transfer="none")),
    "s2_demodulated_linear": ((5, 7), dict(scale=2, base="demodulated", transfer="none")),
    "s2_guided_linear": ((5, 6), dict(scale=2, transfer="none")),
    "s4_one_pixel": ((1, 1), dict()),
    "s1_one_pixel": ((1, 1), dict(scale=1, base="none", transfer="none", channels=24)),
    "s16_one_pixel_kernels": ((1, 1), dict(scale=16, kernels=5, aux_skip=1)),
    "s2_three_groups": ((9, 10), dict(scale=2, groups=3)),
    "s2_two_blocks": ((10, 11), dict(scale=2, blocks=2)),
    "s2_two_groups_two_blocks": ((9, 9), dict(scale=2, groups=2, blocks=2)),
    "s2_window8": ((13, 18), dict(scale=2, window=8, blocks=2)),
    "s2_window2": ((5, 7), dict(scale=2, window=2)),
    "s4_window6": ((7, 13), dict(window=6)),
    "s2_one_head": ((9, 8), dict(scale=2, head_channels=8)),
    "s4_kernels": ((10, 7), dict(kernels=5)),
    "s4_aux_skip": ((7, 9), dict(aux_skip=1)),
    "s4_kernels_aux_skip": ((9, 6), dict(kernels=5, aux_skip=1, groups=2)),
    "s2_kernels_aux_skip_albedo": ((9, 6), dict(scale=2, kernels=5, aux_skip=1, aux_inputs=ALBEDO)),
    "s1_kernels_aux_skip": ((6, 10), dict(scale=1, kernels=5, aux_skip=1)),
    "s4_compact_width": ((16, 24), dict(channels=32, aux_channels=16, head_channels=32, window=8)),
    "s4_compact": ((9, 12), dict(channels=32, aux_channels=16, head_channels=32, window=8, kernels=5, aux_skip=1)),
    "s2_paper_width": ((8, 16), dict(scale=2, channels=64, aux_channels=32, head_channels=32, window=8)),
    "s2_rdb": ((9, 10), dict(scale=2, block="rdb")),
    "s4_rdb_two_blocks": ((6, 7), dict(block="rdb", blocks=2, channels=16)),
    "s2_rstb": ((7, 11), dict(scale=2, block="rstb")),
    "s4_rstb_two_blocks": ((9, 6), dict(block="rstb", blocks=2, groups=2)),
    "s2_concat": ((9, 7), dict(scale=2, cross="concat", groups=2)),
    "s4_concat_noaux": ((7, 6), dict(cross="concat", base="bicubic", aux_inputs=NONE)),
    "s2_rdb_concat_noaux": ((6, 9), dict(scale=2, block="rdb", cross="concat", base="none", aux_inputs=NONE)),
    "s4_aux_kernels3": ((7, 9), dict(aux_kernels=3)),
    "s4_aux_kernels5": ((5, 6), dict(kernels=5, aux_skip=1, aux_kernels=5)),
    "s2_aux_kernels5": ((9, 7), dict(scale=2, kernels=5, aux_skip=1, aux_kernels=5)),
    "s1_aux_kernels5": ((11, 9), dict(scale=1, kernels=5, aux_skip=1, aux_kernels=5)),
    "s1_aux_kernels5_unpadded": ((8, 12), dict(scale=1, aux_kernels=5, base="demodulated", aux_inputs=ALBEDO)),
    "s4_one_pixel_aux_kernels": ((1, 1), dict(kernels=5, aux_skip=1, aux_kernels=3)),
    "s2_aux_kernels_normal_first": ((5, 7), dict(scale=2, aux_kernels=3, base="demodulated",
                                                 aux_inputs=("normal", "albedo"), transfer="none")),
    "s4_compact_aux_kernels": ((9, 12), dict(channels=32, aux_channels=16, head_channels=32, window=8, kernels=5,
                                             aux_skip=1, aux_kernels=5)),
    "s2_rdb_concat_aux_kernels": ((9, 11), dict(scale=2, block="rdb", cross="concat", blocks=2, groups=2, kernels=5,
                                                aux_skip=1, aux_kernels=3)),
    "s4_rstb_concat_aux_kernels": ((6, 5), dict(block="rstb", cross="concat", blocks=2, kernels=5, aux_skip=1,
                                                aux_kernels=5)),
    "s2_output1": ((7, 10), dict(scale=2, kernels=5, aux_skip=1, aux_kernels=3, output_side=1)),
    "s4_compact_output1": ((9, 12), dict(channels=32, aux_channels=16, head_channels=32, window=8, groups=1, kernels=5,
                                         aux_skip=1, aux_kernels=5, output_side=1)),
    "s1_output1_noaux": ((10, 7), dict(scale=1, base="none", aux_inputs=NONE, output_side=1)),
    "s4_depth": ((8, 9), dict(kernels=5, aux_skip=1, aux_kernels=5, output_side=1, aux_inputs=("albedo", "normal", "depth"))),
    "s4_full": ((7, 9), dict(kernels=5, aux_skip=1, aux_kernels=5, colour_kernels=5, output_side=1, aux_inputs=("albedo", "normal", "colour"))),
    "s2_full_colour_first": ((9, 6), dict(scale=2, colour_kernels=3, transfer="none", aux_inputs=("colour", "albedo"))),
    "s2_full_input_alone": ((6, 7), dict(scale=2, base="bicubic", aux_inputs=("colour", "normal"))),
    "s2_prefilter1": ((13, 9), dict(scale=2, block="rstb", kernels=5, aux_skip=1, aux_kernels=5, prefilter=1, output_side=1)),
    "s2_prefilter3": ((33, 29), dict(scale=2, kernels=5, prefilter=3, aux_inputs=ALBEDO)),
    "s1_prefilter2": ((15, 17), dict(scale=1, kernels=5, aux_skip=1, aux_kernels=3, prefilter=2, transfer="none")),
    "s4_full_prefilter2": ((11, 9), dict(kernels=5, aux_skip=1, aux_kernels=5, colour_kernels=5, prefilter=2, output_side=1,
                                         aux_inputs=("albedo", "normal", "colour"))),
    "s2_one_pixel_full_prefilter": ((1, 1), dict(scale=2, kernels=5, aux_kernels=3, colour_kernels=3, prefilter=3,
                                                 aux_inputs=("colour", "normal", "albedo"))),
    "s4_lights": ((8, 7), dict(kernels=5, aux_skip=1, aux_kernels=3, colour_kernels=5,
                               aux_inputs=("albedo", "normal", "colour", "diffuse", "glossy"))),
    "s2_lights_alone": ((5, 8), dict(scale=2, base="bicubic", transfer="none", aux_inputs=("glossy", "normal", "diffuse"))),
    "s1_restrained": ((11, 14), dict(scale=1, kernels=5, aux_skip=1, aux_kernels=3, denoised_darker=75, denoised_brighter=25)),
}


def randomise(network, generator):
    """Well-scaled random parameters: activations and attention scores of order one, no term negligible."""
    def normal(parameter, mean, deviation):
        with torch.no_grad():
            parameter.normal_(mean, deviation, generator=generator)
    ends = ("proj", "fc2", "conv2", "conv", "body_conv")
    for name, module in network.named_modules():
        if isinstance(module, (nn.Conv2d, nn.Linear)):
            gain = 0.6 if name.split(".")[-1] in ends else 1.2
            normal(module.weight, 0, gain / math.sqrt(module.weight[0].numel()))
            normal(module.bias, 0, 0.1)
        elif isinstance(module, nn.LayerNorm):
            normal(module.weight, 1, 0.2)
            normal(module.bias, 0, 0.2)
        elif hasattr(module, "relative_position_bias_table"):
            normal(module.relative_position_bias_table, 0, 0.5)


def random_radiance(size, generator):
    """[1, 3, y, x] with a wide dynamic range: zeros, values above 50."""
    h, w = size
    normal = lambda *shape: torch.randn(shape, generator=generator)
    colour = torch.exp(1.5 * normal(1, 1, h, w) + 0.4 * normal(1, 3, h, w))
    if h * w > 1:
        flat = colour.view(3, -1)
        picks = torch.randperm(h * w, generator=generator)
        flat[:, picks[0]] = 0
        flat[0, picks[1]] = 0
        flat[:, picks[2]] = torch.tensor([55.0, 80.0, 61.0])
    return colour


def random_inputs(size, config, generator):
    """Radiance, blocky albedo and unit normals with noise, float32: colour [1, 3, y, x] and the auxiliary inputs of the model in its order."""
    h, w = size
    normal = lambda *shape: torch.randn(shape, generator=generator)
    colour = random_radiance(size, generator)
    height, width = h * config.scale, w * config.scale
    patches = lambda: nn.functional.interpolate(normal(1, 3, 2 * h, 2 * w), size=(height, width), mode="nearest")
    aux = []
    for kind in config.aux_inputs:
        if kind == "albedo":
            image = (0.5 + 0.3 * patches() + 0.05 * normal(1, 3, height, width)).clamp(min=0)
            image[0, :, 0, 0] = 6.0      # above the clamp
        elif kind == "normal":
            image = patches() * 0.3 + torch.tensor([0.0, 0.0, 1.0]).view(1, 3, 1, 1)
            image = nn.functional.normalize(image, dim=1) + 0.05 * normal(1, 3, height, width)
        elif kind in ("colour", *LIGHTS):
            image = random_radiance((height, width), generator)
            image[0, 1, 0, 0] = -1.0     # counts as 0
        else:
            image = patches()
        aux.append(image)
    return colour, aux


def given(config, images):
    """What pipeline.upscale takes of the auxiliary inputs [1, 3, H, W] in the model's order: (aux, full), None for what there is not."""
    guides = [image for kind, image in zip(config.aux_inputs, images) if kind != "colour"]
    full = [image for kind, image in zip(config.aux_inputs, images) if kind == "colour"]
    return torch.cat(guides, 1) if guides else None, full[0] if full else None


def outputs_of(network, colour, guides, exposure, full):
    """(radiance, raw output) as of a colour that was denoised before."""
    output, raw, _ = pipeline.upscale(network, colour, guides, exposure, full)
    return pipeline.restrained(output, colour, network.config), raw


def channels_last(image):
    """[1, c, y, x] -> float32 [y, x, c]"""
    return image[0].permute(1, 2, 0).float().contiguous()


def write_case(folder, name, size, fields, seed):
    config = NetworkConfig(**{**SMALL, **fields})
    generator = torch.Generator().manual_seed(seed)
    network = Network(config)
    randomise(network, generator)
    colour, aux = random_inputs(size, config, generator)
    exposure = float(torch.tensor(pipeline.auto_exposure(colour[0])))
    guides, full = given(config, [image.double() for image in aux])

    # One pass sets the scale of the output layer (residual of 0.4, logits of 1.2 RMS), the second is recorded. The scale
    # is bounded: where a pixel's output is small by cancellation, a large one would amplify the rounding errors too.
    with torch.no_grad():
        _, raw, _ = pipeline.upscale(network.double(), colour.double(), guides, exposure, full)
        rms = raw.square().mean((0, 2, 3)).sqrt()
        wanted = torch.tensor([0.4] * 3 + [1.2] * (raw.shape[1] - 3))
        gain = (wanted / rms).clamp(max=2)
        network.out.weight.mul_(gain.view(-1, 1, 1, 1))
        network.out.bias.mul_(gain)
        path = folder / f"{name}.model.safetensors"
        weights.save_model(path, network, {"license": "MIT", "data": "random parameters", "seed": str(seed)})
        network, _ = weights.load_model(path, torch.float64)
        output, raw = outputs_of(network, colour.double(), guides, exposure, full)
    tensors = {"colour": channels_last(colour), "exposure": torch.tensor([exposure]),
               "network": channels_last(raw), "output": channels_last(output)}
    extra = [image for kind, image in zip(config.aux_inputs, aux) if kind not in KEYS]
    tensors.update({KEYS[kind]: channels_last(image) for kind, image in zip(config.aux_inputs, aux) if kind in KEYS})
    if extra:
        tensors["aux"] = channels_last(torch.cat(extra, 1))
    if not all(torch.isfinite(value).all() for value in tensors.values()):
        raise ArithmeticError(f"{name} is not finite")
    save_file(tensors, folder / f"{name}.io.safetensors")
    return raw, output


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("names", nargs="*", help="cases to write; all by default")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    torch.set_num_threads(1)
    unknown = set(arguments.names) - set(CASES)
    if unknown:
        sys.exit(f"unknown cases: {', '.join(sorted(unknown))}")
    for seed, (name, (size, fields)) in enumerate(CASES.items(), 1):
        if not arguments.names or name in arguments.names:
            raw, output = write_case(arguments.folder, name, size, fields, seed)
            print(f"{name:32} raw RMS {raw[:, :3].square().mean().sqrt():6.3f}  output median {output.median():8.4f} max {output.max():10.3f}")


if __name__ == "__main__":
    main()
