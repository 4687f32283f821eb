"""Zhang et al. 2018, "Residual Dense Network for Image Super-Resolution", with the names of tensors of EDSR-PyTorch's port."""
import dataclasses

import torch
import torch.nn as nn
import torch.nn.functional as F

from network import conv3x3

from . import common
from .common import Normed, count, upsampler


@dataclasses.dataclass(frozen=True)
class Config(common.Config):
    architecture: str = "rdn"
    layers: int = 8     # C: convolutions of a block
    growth: int = 64    # G: channels of each


FIELDS = ("blocks", "layers", "growth", "range")
PAPER = {
    "rdn": Config(channels=64, blocks=16, layers=8, growth=64, range=255),      # B
    "rdn_a": Config(channels=64, blocks=20, layers=6, growth=32, range=255),
}
MILLIONS = {"rdn": (22.271, 0.0001), "rdn_a": (5.579, 0.0001)}    # counted by hand from the paper's section 5
GOLDEN = {"rdn_s4": (11, (7, 10), Config(channels=12, blocks=2, layers=3, growth=16, range=255))}


class DenseLayer(nn.Module):
    """[x, relu(conv3x3(x))], equation 4."""

    def __init__(self, inputs, growth):
        super().__init__()
        self.conv = nn.Sequential(conv3x3(inputs, growth))

    def forward(self, x):
        return torch.cat([x, F.relu(self.conv(x))], 1)


class DenseBlock(nn.Module):
    """RDB: the layers, a 1x1 convolution, plus x: equations 5 to 7."""

    def __init__(self, config):
        super().__init__()
        channels = [config.channels + k * config.growth for k in range(config.layers + 1)]
        self.convs = nn.Sequential(*(DenseLayer(inputs, config.growth) for inputs in channels[:-1]))
        self.LFF = nn.Conv2d(channels[-1], config.channels, 1)

    def forward(self, x):
        return self.LFF(self.convs(x)) + x


class Network(Normed):
    """Figure 2. The port subtracts no mean: it is zero there."""

    def __init__(self, config):
        super().__init__(config)
        nn.init.zeros_(self.mean)
        c, growth = config.channels, config.growth
        self.SFENet1 = conv3x3(3, c)
        self.SFENet2 = conv3x3(c, c)
        self.RDBs = nn.ModuleList(DenseBlock(config) for _ in range(config.blocks))
        self.GFF = nn.Sequential(nn.Conv2d(config.blocks * c, c, 1), conv3x3(c, c))
        self.UPNet = nn.Sequential(conv3x3(c, 4 * growth), nn.PixelShuffle(2), *upsampler(growth, config.steps - 1), conv3x3(growth, 3))

    def network(self, x):
        first = self.SFENet1(x)
        features = [self.SFENet2(first)]
        for block in self.RDBs:
            features.append(block(features[-1]))
        return self.UPNet(self.GFF(torch.cat(features[1:], 1)) + first)


def config_of_checkpoint(tensors, transfer):
    if "SFENet1.weight" not in tensors:
        return None
    steps, growth = count(tensors, r"UPNet\.(\d+)\.") // 2, tensors["RDBs.0.convs.0.conv.0.weight"].shape[0]
    if tensors["UPNet.0.weight"].shape[0] != 4 * growth:
        raise ValueError("UPNet.0 is no doubling: scale 3 is not supported")
    tensors["mean"] = torch.zeros(3)
    return Config(scale=2 ** steps, channels=tensors["SFENet1.weight"].shape[0], blocks=count(tensors, r"RDBs\.(\d+)\."),
                  layers=count(tensors, r"RDBs\.0\.convs\.(\d+)\."), growth=growth, range=255, transfer=transfer)
