"""Makes a model file of a PyTorch checkpoint of the official repositories EDSR-PyTorch, RCAN or SwinIR.

    python training/convert.py edsr_x4.pt edsr-x4.safetensors [--transfer log1p]

The architecture and its sizes are found in the names and shapes of the tensors. Only tensors are read (weights_only): a pickle that
holds anything else is refused. These networks were trained on photographs; what a renderer's radiance is to them is --transfer.
"""
import argparse
import math
import pathlib
import re

import torch
from safetensors.torch import save_file

import architectures

WRAPPERS = ("params_ema", "params", "state_dict", "model")     # keys under which checkpoints keep their tensors
OF_CODE = ("attn_mask", "relative_position_index")     # buffers of SwinIR that follow from its sizes


def read_checkpoint(path):
    """The tensors by name. Raises pickle.UnpicklingError on a pickle of anything but tensors, ValueError on other contents."""
    stored = torch.load(path, map_location="cpu", weights_only=True)
    for key in WRAPPERS:
        if isinstance(stored, dict) and isinstance(stored.get(key), dict):
            stored = stored[key]
    if not isinstance(stored, dict) or not stored or not all(isinstance(value, torch.Tensor) for value in stored.values()):
        raise ValueError(f"{path} holds no tensors by name")
    return {name.removeprefix("module."): value.float() for name, value in stored.items()}


def count(tensors, pattern):
    """One more than the largest number that the pattern captures among the names."""
    found = [int(match[1]) for name in tensors if (match := re.match(pattern, name))]
    if not found:
        raise ValueError(f"no tensor is named like {pattern}")
    return max(found) + 1


def steps_of(tensors, prefix):
    """log2 of the scale: doublings 0, 2, ... behind the prefix. Raises ValueError where one is no doubling."""
    numbers = sorted(int(name[len(prefix):].split(".")[0]) for name in tensors if name.startswith(prefix) and name.endswith(".weight"))
    for number in numbers:
        outputs, inputs = tensors[f"{prefix}{number}.weight"].shape[:2]
        if outputs != 4 * inputs:
            raise ValueError(f"{prefix}{number} is no doubling: scale 3 and direct upsamplers are not supported")
    return len(numbers)


def taken_mean(tensors, value_range):
    """Takes the mean shift of EDSR and RCAN out of the tensors, as `mean`. Raises ValueError where it is another map."""
    bias = tensors.get("sub_mean.bias")
    mean = torch.tensor(architectures.DIV2K_MEAN) if bias is None else -bias / value_range
    for name in ("sub_mean", "add_mean"):
        weight = tensors.pop(name + ".weight", torch.eye(3))
        if not torch.allclose(weight.view(3, 3), torch.eye(3)):
            raise ValueError(f"{name} does more than to shift the mean")
        tensors.pop(name + ".bias", None)
    tensors["mean"] = mean


def config_of(tensors, transfer):
    """The configuration that the tensors are of; they are changed to those of the model file. Raises ValueError."""
    if "conv_first.weight" in tensors:
        heads = next(value for name, value in tensors.items() if name.endswith("relative_position_bias_table"))
        for name in [name for name in tensors if name.endswith(OF_CODE)]:
            del tensors[name]
        channels = tensors["conv_first.weight"].shape[0]
        if "conv_up1.weight" in tensors or "upsample.0.weight" not in tensors:
            raise ValueError("this SwinIR has neither the classical nor the lightweight upsampler: real-world, denoising and JPEG ones are not "
                             "supported")
        direct = "conv_before_upsample.0.weight" not in tensors
        scale = math.isqrt(tensors["upsample.0.weight"].shape[0] // 3) if direct else 2 ** steps_of(tensors, "upsample.")
        fc1 = tensors["layers.0.residual_group.blocks.0.mlp.fc1.weight"]
        tensors["mean"] = torch.tensor(architectures.DIV2K_MEAN)
        return architectures.Config(
            "swinir", scale=scale, channels=channels, groups=count(tensors, r"layers\.(\d+)\."),
            blocks=count(tensors, r"layers\.0\.residual_group\.blocks\.(\d+)\."), window=int(heads.shape[0] ** 0.5 + 1.5) // 2,
            head_channels=channels // heads.shape[1], mlp_ratio=fc1.shape[0] // channels, transfer=transfer,
            upsampler="pixelshuffledirect" if direct else "pixelshuffle")
    common = dict(scale=2 ** steps_of(tensors, "tail.0."), channels=tensors["head.0.weight"].shape[0], range=255, transfer=transfer)
    taken_mean(tensors, 255)
    last = count(tensors, r"body\.(\d+)\.") - 1     # the convolution behind the blocks
    gates = [value for name, value in tensors.items() if name.endswith("conv_du.0.weight")]
    if gates:
        return architectures.Config("rcan", groups=last, blocks=count(tensors, r"body\.0\.body\.(\d+)\.") - 1,
                                    reduction=gates[0].shape[1] // gates[0].shape[0], **common)
    # EDSR's residual scaling is in its code: 0.1 of the wide network, 1 of the baseline.
    return architectures.Config("edsr", blocks=last, residual_divisor=10 if common["channels"] >= 256 else 1, **common)


def convert(source, target, transfer="log1p"):
    """Writes the model file and returns its configuration. Raises ValueError on a checkpoint of another network."""
    tensors = read_checkpoint(source)
    try:
        config = config_of(tensors, transfer)
        architectures.network_of(config).load_state_dict(tensors)      # every tensor there, none too much
    except (KeyError, RuntimeError, StopIteration) as error:
        raise ValueError(f"{source} is no EDSR, RCAN or SwinIR: {error}") from error
    save_file({name: value.contiguous() for name, value in tensors.items()}, target,
              {**architectures.metadata_of(config), "license": "that of the checkpoint", "data": f"converted from {pathlib.Path(source).name}"})
    return config


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("target", type=pathlib.Path)
    parser.add_argument("--transfer", choices=("none", "log1p"), default="log1p")
    options = parser.parse_args()
    print(convert(options.source, options.target, options.transfer))


if __name__ == "__main__":
    main()
