"""Writes golden files of the networks in architectures/: small random models with a double-precision forward pass.

    python training/golden_networks.py tests/golden [NAME ...]

The files are those of golden.py, whose names say what they hold.
"""
import argparse
import pathlib

import torch
from safetensors.torch import save_file

import architectures
import pipeline
from golden import KEYS, channels_last


def randomise(network, generator):
    """Norms near the identity, the mean as it is, all else so that the variance of activations stays."""
    for name, value in network.named_parameters():
        noise = torch.randn(value.shape, generator=generator)
        fan_in = value[0].numel() if value.dim() > 1 and "table" not in name else 50
        if "norm" in name and name.endswith("weight"):
            value.data = 1 + 0.1 * noise
        elif name != "mean":
            value.data = 0.9 * noise / fan_in ** 0.5


def upscaled(network, colour, auxiliary, exposure):
    """(output, raw) [1, 3, s h, s w] of colour [1, 3, h, w] and auxiliary images by name: transformed, padded, and back."""
    config = network.config
    height, width = colour.shape[2:]
    radiance = lambda image: pipeline.transform(image * exposure, config.transfer)
    inputs = [architectures.padded(radiance(colour), config)]
    if config.aux_inputs:
        images = [radiance(auxiliary[name]) if name == "colour" else auxiliary[name] for name in config.aux_inputs]
        inputs.append(architectures.padded(torch.cat(images, 1), config, config.scale))
    raw = network(*inputs)[..., :config.scale * height, :config.scale * width]
    return pipeline.inverse_transform(raw, config.transfer) / exposure, raw


def random_auxiliary(config, size, generator):
    """{name: [1, 3, s h, s w]}"""
    shape = (1, 3, config.scale * size[0], config.scale * size[1])
    make = {"albedo": lambda: torch.rand(shape, generator=generator), "normal": lambda: 2 * torch.rand(shape, generator=generator) - 1,
            "colour": lambda: torch.exp(torch.randn(shape, generator=generator))}
    return {name: make[name]() for name in config.aux_inputs}


def write_case(folder, name, size, config, seed):
    generator = torch.Generator().manual_seed(seed)
    network = architectures.network_of(config)
    randomise(network, generator)
    for value in network.parameters():      # as the file holds them
        value.data = value.data.half().double()
    colour = torch.exp(torch.randn(1, 3, *size, generator=generator)).float()
    auxiliary = random_auxiliary(config, size, generator)
    exposure = float(torch.tensor(pipeline.auto_exposure(colour[0])))
    with torch.no_grad():
        output, raw = upscaled(network.double(), colour.double(), {key: value.double() for key, value in auxiliary.items()}, exposure)
    tensors = {"colour": channels_last(colour), "exposure": torch.tensor([exposure]), "network": channels_last(raw), "output": channels_last(output)}
    tensors |= {KEYS[key]: channels_last(value) for key, value in auxiliary.items()}
    if not all(torch.isfinite(value).all() for value in tensors.values()):
        raise ArithmeticError(f"{name} is not finite")
    save_file({key: value.detach().half().contiguous() for key, value in network.state_dict().items()}, folder / f"{name}.model.safetensors",
              {**architectures.metadata_of(config), "license": "MIT", "data": "random parameters", "seed": str(seed)})
    save_file(tensors, folder / f"{name}.io.safetensors")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("names", nargs="*", help="of architectures.GOLDEN; all by default")
    options = parser.parse_args()
    for name in options.names or architectures.GOLDEN:
        seed, size, config = architectures.GOLDEN[name]
        write_case(options.folder, name, size, config, seed)


if __name__ == "__main__":
    main()
