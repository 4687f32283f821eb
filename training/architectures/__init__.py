"""The networks that Hou & Liu 2023 compare with, and more of that kind, as PyTorch modules: each in the file of its name.

Parameter names are those of the official repositories (EDSR-PyTorch, RCAN, SwinIR) and those in the model file, but for the mean
that some keep in two convolutions or in their code: here it is the parameter `mean` [3], in units of the image.
Each module takes colour [batch, 3, h, w] (MSSPL auxiliary images [batch, A, s h, s w] too), h and w multiples of `window`, and
returns [batch, 3, s h, s w]. `mean` is subtracted and `range` multiplied before the network and undone behind it.

A file holds:
    Config                  its configuration
    Network                 the module, made of a Config
    FIELDS                  what its model file states, beside architecture, scale, channels and transfer
    PAPER                   the sizes of the paper, at scale 4, by name
    MILLIONS                the published millions of parameters of these, and within which share they are met; optional
    GOLDEN                  small ones by name: seed, (h, w) of the low-resolution colour, Config; golden_networks.py writes their files
    config_of_checkpoint    (tensors, transfer) -> the Config of a checkpoint of the official repository, or None if it is of another
                            network; changes the tensors to those of the model file. Raises ValueError on sizes that are not supported;
                            optional
"""
import dataclasses
import importlib
import pkgutil

import torch
import torch.nn as nn
import torch.nn.functional as F
from safetensors import safe_open
from safetensors.torch import save_file

FOUND = [found.name for found in pkgutil.iter_modules(__path__) if found.name != "common"]
ARCHITECTURES = {name: importlib.import_module("." + name, __name__) for name in FOUND}
PAPER = {name: config for module in ARCHITECTURES.values() for name, config in module.PAPER.items()}
GOLDEN = {name: case for module in ARCHITECTURES.values() for name, case in module.GOLDEN.items()}
MILLIONS = {name: count for module in ARCHITECTURES.values() for name, count in getattr(module, "MILLIONS", {}).items()}


def metadata_of(config):
    """The fields of the model file that its architecture has."""
    fields = dataclasses.asdict(config) | {"aux_inputs": ",".join(config.aux_inputs)}
    names = ("architecture", "scale", "channels", "transfer", *ARCHITECTURES[config.architecture].FIELDS)
    return {"format": "xrds", "version": "1", **{name: str(fields[name]) for name in names}}


def padded(x, config, scale=1):
    """The image [b, c, h, w] as the engine pads it: SwinIR's to whole windows by reflection, of others the rows alone, to a multiple of
    four pixels by edge replication. `scale`: of the auxiliary images."""
    height, width = x.shape[2:]
    unit = config.window * scale
    if getattr(ARCHITECTURES[config.architecture], "PADS_BY_REFLECTION", False):
        return F.pad(x, (0, -width % unit, 0, -height % unit), mode="reflect")
    return F.pad(x, (0, -width % unit, 0, 0), mode="replicate")


def network_of(config):
    """The module of the configuration, with PyTorch's initialization."""
    return ARCHITECTURES[config.architecture].Network(config)


def config_of(metadata):
    """metadata_of()'s inverse."""
    Config = ARCHITECTURES[metadata["architecture"]].Config
    values = {field.name: field.type(metadata[field.name]) for field in dataclasses.fields(Config) if field.name in metadata and field.type is not tuple}
    return Config(**values, aux_inputs=tuple(filter(None, metadata.get("aux_inputs", "").split(","))))


def config_of_checkpoint(tensors, transfer):
    """The configuration that the tensors of an official checkpoint are of; they are changed to those of the model file. Raises ValueError."""
    convertible = {name: module for name, module in ARCHITECTURES.items() if hasattr(module, "config_of_checkpoint")}
    for module in convertible.values():
        if config := module.config_of_checkpoint(tensors, transfer):
            return config
    raise ValueError("its tensors have the names of none of " + ", ".join(convertible))


def load_model(path):
    """The network of a model file, in evaluation mode."""
    with safe_open(path, framework="pt") as file:
        network = network_of(config_of(file.metadata()))
        network.load_state_dict({name: file.get_tensor(name) for name in file.keys()})
    return network.eval()


def save_random(config, path):
    """Writes a model file of random parameters, PyTorch's initialization."""
    torch.manual_seed(1)
    save_file(network_of(config).state_dict(), path, {**metadata_of(config), "license": "MIT", "data": "random parameters"})


def multiply_accumulates(config, height, width):
    """Multiplications of convolutions and linear layers for an output of height x width pixels (attention products not counted)."""
    total = 0

    def count(module, _, output):
        nonlocal total
        axis = 1 if isinstance(module, nn.Conv2d) else -1
        total += output.numel() // output.shape[axis] * module.weight.numel()

    with torch.device("meta"):
        network = network_of(config)
        for module in network.modules():
            if isinstance(module, (nn.Conv2d, nn.Linear)):
                module.register_forward_hook(count)
        inputs = [torch.empty(1, 3, height // config.scale, width // config.scale)]
        if config.aux_inputs:
            inputs.append(torch.empty(1, config.aux_width, height, width))
        network(*inputs)
    return total
