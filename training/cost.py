"""The work of a model, counted on its layers without running them."""
import torch
import torch.nn as nn

from network import Network


def multiply_accumulates(config, height, width):
    """Multiplications of convolutions and linear layers for an output of height x width pixels (attention products not counted)."""
    total = 0

    def count(module, _, output):
        nonlocal total
        width_out = module.weight.shape[0]
        total += output.numel() // width_out * module.weight.numel()

    with torch.device("meta"):
        network = Network(config)
        for module in network.modules():
            if isinstance(module, (nn.Conv2d, nn.Linear)):
                module.register_forward_hook(count)
        x = torch.empty(1, 3, height // config.scale, width // config.scale)
        aux = torch.empty(1, config.aux_width, height, width) if config.aux_inputs else None
        network(x, aux)
    return total
