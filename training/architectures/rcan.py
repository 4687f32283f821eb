"""Zhang et al. 2018, "Image Super-Resolution Using Very Deep Residual Channel Attention Networks"."""
import dataclasses

import torch.nn as nn

from network import conv3x3

from . import common
from .common import Normed, count, names_of_basicsr, rename, steps_of, taken_mean, upsampler


@dataclasses.dataclass(frozen=True)
class Config(common.Config):
    architecture: str = "rcan"
    reduction: int = 16     # of channel attention


FIELDS = ("groups", "blocks", "reduction", "range")
PAPER = {"rcan": Config(channels=64, groups=10, blocks=20, range=255)}
MILLIONS = {"rcan": (15.6, 0.005)}
GOLDEN = {
    "rcan_s2": (2, (10, 13), Config(scale=2, channels=16, groups=2, blocks=2, reduction=4, range=255)),
    "rcan_s8": (3, (5, 6), Config(scale=8, channels=16, groups=1, blocks=1, reduction=8)),
}


class ChannelAttention(nn.Module):
    """x times sigmoid(W_U relu(W_D mean(x))), equations 7 and 8."""

    def __init__(self, channels, reduction):
        super().__init__()
        self.conv_du = nn.Sequential(nn.Conv2d(channels, channels // reduction, 1), nn.ReLU(), nn.Conv2d(channels // reduction, channels, 1), nn.Sigmoid())

    def forward(self, x):
        return x * self.conv_du(x.mean((2, 3), keepdim=True))


class Rcab(nn.Module):
    """The residual channel attention block, equation 9."""

    def __init__(self, channels, reduction):
        super().__init__()
        self.body = nn.Sequential(conv3x3(channels, channels), nn.ReLU(), conv3x3(channels, channels), ChannelAttention(channels, reduction))

    def forward(self, x):
        return self.body(x) + x


class ResidualGroup(nn.Module):
    """B blocks and a convolution, plus x."""

    def __init__(self, blocks):
        super().__init__()
        self.body = nn.Sequential(*blocks)

    def forward(self, x):
        return self.body(x) + x


class Network(Normed):
    """Figure 2."""

    def __init__(self, config):
        super().__init__(config)
        c = config.channels
        self.head = nn.Sequential(conv3x3(3, c))
        group = lambda: ResidualGroup([*(Rcab(c, config.reduction) for _ in range(config.blocks)), conv3x3(c, c)])
        self.body = nn.Sequential(*(group() for _ in range(config.groups)), conv3x3(c, c))
        self.tail = nn.Sequential(upsampler(c, config.steps), conv3x3(c, 3))

    def network(self, x):
        x = self.head(x)
        return self.tail(self.body(x) + x)


def rename_basicsr(tensors):
    blocks = count(tensors, r"body\.0\.residual_group\.(\d+)\.")
    block = r"body\.(\d+)\.residual_group\.(\d+)\.rcab\."
    rename(tensors, names_of_basicsr(count(tensors, r"body\.(\d+)\.")) | {
        r"body\.(\d+)\.conv\.(\w+)": rf"body.\1.body.{blocks}.\2",
        block + r"([02]\.\w+)": r"body.\1.body.\2.body.\3",
        block + r"3\.attention\.1\.(\w+)": r"body.\1.body.\2.body.3.conv_du.0.\3",
        block + r"3\.attention\.3\.(\w+)": r"body.\1.body.\2.body.3.conv_du.2.\3"})


def config_of_checkpoint(tensors, transfer):
    if "body.0.residual_group.0.rcab.0.weight" in tensors:
        rename_basicsr(tensors)
    gates = [value for name, value in tensors.items() if name.endswith("conv_du.0.weight")]
    if not gates:
        return None
    taken_mean(tensors, 255)
    return Config(scale=2 ** steps_of(tensors, "tail.0."), channels=tensors["head.0.weight"].shape[0],
                  groups=count(tensors, r"body\.(\d+)\.") - 1, blocks=count(tensors, r"body\.0\.body\.(\d+)\.") - 1,
                  reduction=gates[0].shape[1] // gates[0].shape[0], range=255, transfer=transfer)
