"""Hou et al. 2021, "Fast Monte Carlo Rendering via Multi-Resolution Sampling", of which no weights are published."""
import dataclasses

import torch
import torch.nn as nn
import torch.nn.functional as F

from network import ConvBlock, conv3x3

from . import common


@dataclasses.dataclass(frozen=True)
class Config(common.Config):
    architecture: str = "msspl"


FIELDS = ("groups", "blocks", "aux_inputs")
PAPER = {"msspl": Config(channels=64, groups=3, blocks=5, aux_inputs=("albedo", "normal"))}
GOLDEN = {
    "msspl_s4": (8, (6, 7), Config(channels=16, groups=2, blocks=2, aux_inputs=("albedo", "normal"))),
    "msspl_s2_full": (9, (5, 10), Config(scale=2, channels=12, groups=1, blocks=1, aux_inputs=("colour", "albedo", "normal"))),
    "msspl_s8_noaux": (10, (5, 4), Config(scale=8, channels=8, groups=1, blocks=1)),
}


class Network(nn.Module):
    """The figure of the network: the low-resolution image and the downscaled high-resolution ones are fused, go through G groups of B
    residual dense blocks with short skips and a long skip, and are upscaled. The layers inside the modules are our reading:
    docs/networks.md."""

    def __init__(self, config):
        super().__init__()
        self.config = config
        c = config.channels
        self.conv = conv3x3(3, c)
        if config.aux_inputs:
            widths = [config.aux_width] + [c] * config.steps
            self.down = nn.ModuleList(conv3x3(4 * inputs, outputs) for inputs, outputs in zip(widths, widths[1:]))
            self.fusion = nn.Conv2d(2 * c, c, 1)
        self.groups = nn.ModuleList(nn.ModuleList(ConvBlock(config, b) for b in range(config.blocks)) for _ in range(config.groups))
        self.up = nn.ModuleList(conv3x3(c, 4 * c) for _ in range(config.steps))
        self.out = conv3x3(c, 3)

    def forward(self, x, aux=None):
        low = f = self.conv(x)
        if self.config.aux_inputs:
            for down in self.down:
                aux = F.relu(down(F.pixel_unshuffle(aux, 2)))
            f = self.fusion(torch.cat([low, aux], 1))
        for group in self.groups:
            skip = f
            for block in group:
                f = block(f)
            f = f + skip
        f = f + low
        for up in self.up:
            f = F.pixel_shuffle(up(f), 2)
        return self.out(f)
