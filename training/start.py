"""What training starts from: random weights, or those of another model."""
import math

import torch
import torch.nn as nn

import weights
from pipeline import PREFILTER_STEP

AUX_CENTRE = 7.0     # first logit of the pixel itself in the kernel of the auxiliary images: nearly no filter; so in a prefilter that the start lacks
BLEND_START = -3.0   # first logit of the share that the full-resolution colour has in the base image: a twentieth


def initialise(network, generator):
    """Starting point of training: variance-preserving, last layers of residual paths small, the output zero."""
    small = ("proj", "fc2", "conv2", "conv", "body_conv")
    for name, module in network.named_modules():
        if isinstance(module, (nn.Conv2d, nn.Linear)):
            fan_in = module.weight[0].numel()
            gain = 0.1 if name.split(".")[-1] in small else 1.0
            with torch.no_grad():
                module.weight.normal_(0, gain / math.sqrt(fan_in), generator=generator)
                module.bias.zero_()
    with torch.no_grad():
        network.out.weight.zero_()
        network.out.bias.zero_()
        residual, logits, aux_logits, colour_logits = network.out.bias.split(network.config.output_parts)
        if network.config.aux_kernels:
            aux_logits[len(aux_logits) // 2] = AUX_CENTRE
        if network.config.colour_kernels:
            colour_logits[-1] = BLEND_START
        if network.config.prefilter:
            network.prefilter.weight.zero_()
            for level, bias in enumerate(network.prefilter.bias.split(25)):     # each tap counts as the pixels it is the mean of, half as much
                bias.fill_(level * math.log(PREFILTER_STEP))


def take_inputs(weight, found, inputs, other):
    """The first layer of the auxiliary branch [Ca, A, 3, 3]: each image takes the weights that it has in the other model, none those of zero."""
    weight.zero_()
    for k, kind in enumerate(inputs):
        if kind in other:
            first = 3 * other.index(kind)
            weight[:, 3 * k:3 * k + 3] = found[:, first:first + 3]


def take_outputs(tensor, found, parts, other):
    """Weight or bias of the output layer: each part of its channels (`output_parts`) takes those of the other model, if it has as many."""
    for own, theirs in zip(tensor.split(parts), found.split(other)):
        if len(own) == len(theirs):
            own.copy_(theirs)


def read_start(path):
    """(tensors by name, configuration) of a checkpoint or model file. Raises ValueError on any other file."""
    try:
        if path.suffix == ".pt":
            state = torch.load(path, map_location="cpu", weights_only=False)
            return state["average"], state["config"]
        loaded, _ = weights.load_model(path)
        return loaded.state_dict(), loaded.config
    except Exception as error:      # of the readers of three formats
        raise ValueError(f"{path} is no model that training can start from ({type(error).__name__}: {error})") from error


def start_from(network, path):
    """Takes over every weight of another model that fits by name and shape; returns how many tensors did.

    A model of another scale lends the last step of its deshuffles to the last, and its last upscaling step to further ones. Inputs and
    outputs that the other lacks start at zero, at initialise()'s biases; a prefilter at nearly the colour itself.
    """
    source, other = read_start(path)
    config, taken, own = network.config, 0, network.state_dict()
    if config.prefilter and not other.prefilter:
        own["prefilter.bias"][12] = AUX_CENTRE
    for name, tensor in own.items():
        parts = name.split(".")
        if parts[0] == "deshuffle" and int(parts[2]) == config.steps - 1:
            parts[2] = str(other.steps - 1)
        if parts[0] == "up" and int(parts[1]) >= other.steps:
            parts[1] = str(other.steps - 1)
        found = source.get(".".join(parts))
        if found is None:
            continue
        if name == "out.weight" and found.shape[2] != tensor.shape[2]:    # 3 x 3 to 1 x 1, or back
            found = found.sum((2, 3), keepdim=True) if tensor.shape[2] == 1 else nn.functional.pad(found, (1, 1, 1, 1))
        taken += found.shape == tensor.shape
        if name == "aux_conv.weight" and len(found) == len(tensor):
            take_inputs(tensor, found, config.aux_inputs, other.aux_inputs)
        elif parts[0] == "out" and found.shape[1:] == tensor.shape[1:]:
            take_outputs(tensor, found, config.output_parts, other.output_parts)
        elif found.shape == tensor.shape:
            tensor.copy_(found)
        elif parts[0] in ("out", "fuse", "aux_conv"):     # fewer inputs or outputs: the leading ones are the same
            common = tuple(slice(min(a, b)) for a, b in zip(found.shape, tensor.shape))
            tensor[common] = found[common]
    return taken
