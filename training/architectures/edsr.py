"""Lim et al. 2017, "Enhanced Deep Residual Networks for Single Image Super-Resolution"."""
import dataclasses

import torch.nn as nn

from network import conv3x3

from . import common
from .common import Normed, count, names_of_basicsr, rename, steps_of, taken_mean, upsampler


@dataclasses.dataclass(frozen=True)
class Config(common.Config):
    architecture: str = "edsr"
    residual_divisor: int = 1   # 1 / its residual scaling


FIELDS = ("blocks", "residual_divisor", "range")
PAPER = {
    "edsr": Config(channels=256, blocks=32, residual_divisor=10, range=255),
    "edsr_baseline": Config(channels=64, blocks=16, range=255),
}
MILLIONS = {"edsr": (43, 0.005), "edsr_baseline": (1.5, 0.02)}
GOLDEN = {
    "edsr_s4": (0, (9, 14), Config(channels=16, blocks=2, residual_divisor=10, range=255)),
    "edsr_s1_linear": (1, (8, 7), Config(scale=1, channels=12, blocks=1, transfer="none")),
}


class ResidualBlock(nn.Module):
    """x + conv3x3(relu(conv3x3(x))) / divisor, no batch normalization (figure 2c)."""

    def __init__(self, channels, divisor):
        super().__init__()
        self.body = nn.Sequential(conv3x3(channels, channels), nn.ReLU(), conv3x3(channels, channels))
        self.divisor = divisor

    def forward(self, x):
        return self.body(x) / self.divisor + x


class Network(Normed):
    """Figure 3."""

    def __init__(self, config):
        super().__init__(config)
        c = config.channels
        self.head = nn.Sequential(conv3x3(3, c))
        self.body = nn.Sequential(*(ResidualBlock(c, config.residual_divisor) for _ in range(config.blocks)), conv3x3(c, c))
        self.tail = nn.Sequential(upsampler(c, config.steps), conv3x3(c, 3))

    def network(self, x):
        x = self.head(x)
        return self.tail(self.body(x) + x)


def config_of_checkpoint(tensors, transfer):
    if {"conv_after_body.weight", "body.0.conv1.weight"} <= tensors.keys():
        rename(tensors, names_of_basicsr(count(tensors, r"body\.(\d+)\."))
               | {r"body\.(\d+)\.conv1\.(\w+)": r"body.\1.body.0.\2", r"body\.(\d+)\.conv2\.(\w+)": r"body.\1.body.2.\2"})
    if "head.0.weight" not in tensors or any(".conv_du." in name for name in tensors):
        return None
    taken_mean(tensors, 255)
    channels = tensors["head.0.weight"].shape[0]
    # The residual scaling is in the code: 0.1 of the wide network, 1 of the baseline.
    return Config(scale=2 ** steps_of(tensors, "tail.0."), channels=channels, blocks=count(tensors, r"body\.(\d+)\.") - 1, range=255,
                  residual_divisor=10 if channels >= 256 else 1, transfer=transfer)
