"""Liang et al. 2021, "SwinIR: Image Restoration Using Swin Transformer": classical or lightweight super-resolution."""
import dataclasses
import math

import torch
import torch.nn as nn

from network import SwinLayer, conv3x3, to_image, to_tokens

from . import common
from .common import DIV2K_MEAN, Normed, count, steps_of, upsampler


@dataclasses.dataclass(frozen=True)
class Config(common.Config):
    architecture: str = "swinir"
    head_channels: int = 30
    mlp_ratio: int = 2
    upsampler: str = "pixelshuffle"     # or pixelshuffledirect


FIELDS = ("groups", "blocks", "window", "head_channels", "mlp_ratio", "upsampler", "range")
PADS_BY_REFLECTION = True   # to whole windows
OF_CODE = ("attn_mask", "relative_position_index")  # buffers that follow from the sizes
PAPER = {
    "swinir": Config(channels=180, groups=6, blocks=6, window=8),
    "swinir_light": Config(channels=60, groups=4, blocks=6, window=8, head_channels=10, upsampler="pixelshuffledirect"),
}
MILLIONS = {"swinir": (11.9, 0.005), "swinir_light": (0.9, 0.04)}   # ours of the lightweight one has 0.93
GOLDEN = {
    "swinir_s4": (4, (13, 18), Config(channels=20, groups=2, blocks=2, window=4, head_channels=10)),
    "swinir_s4_light": (5, (9, 11), Config(channels=12, groups=1, blocks=2, window=4, head_channels=6, upsampler="pixelshuffledirect")),
    "swinir_s2_light": (6, (6, 8), Config(scale=2, channels=12, groups=1, blocks=1, window=4, head_channels=4,
                                          upsampler="pixelshuffledirect")),
    "swinir_s2_window8": (7, (9, 17), Config(scale=2, channels=16, groups=1, blocks=2, window=8, head_channels=8, mlp_ratio=4)),
}


class SwinGroup(nn.Module):
    """RSTB: Swin layers, every second one shifted, and a convolution, plus x."""

    def __init__(self, config):
        super().__init__()
        self.residual_group = nn.Module()
        self.residual_group.blocks = nn.ModuleList(SwinLayer(config.channels, config, b % 2 == 1, config.mlp_ratio) for b in range(config.blocks))
        self.conv = conv3x3(config.channels, config.channels)

    def forward(self, x):
        """[b, h, v, C]"""
        t = x
        for block in self.residual_group.blocks:
            t = block(t)
        return to_tokens(self.conv(to_image(t))) + x


class Network(Normed):
    """Figure 2."""

    def __init__(self, config):
        super().__init__(config)
        c, wide = config.channels, 64
        self.conv_first = conv3x3(3, c)
        self.patch_embed = nn.Module()
        self.patch_embed.norm = nn.LayerNorm(c)
        self.layers = nn.ModuleList(SwinGroup(config) for _ in range(config.groups))
        self.norm = nn.LayerNorm(c)
        self.conv_after_body = conv3x3(c, c)
        if config.upsampler == "pixelshuffle":
            self.conv_before_upsample = nn.Sequential(conv3x3(c, wide), nn.LeakyReLU())
            self.upsample = upsampler(wide, config.steps)
            self.conv_last = conv3x3(wide, 3)
        else:
            self.upsample = nn.Sequential(conv3x3(c, 3 * config.scale ** 2), nn.PixelShuffle(config.scale))

    def network(self, x):
        first = self.conv_first(x)
        t = self.patch_embed.norm(to_tokens(first))
        for layer in self.layers:
            t = layer(t)
        deep = self.conv_after_body(to_image(self.norm(t))) + first
        if self.config.upsampler == "pixelshuffledirect":
            return self.upsample(deep)
        return self.conv_last(self.upsample(self.conv_before_upsample(deep)))


def config_of_checkpoint(tensors, transfer):
    tables = [value for name, value in tensors.items() if name.endswith("relative_position_bias_table")]
    if "conv_first.weight" not in tensors or not tables:
        return None
    heads = tables[0]
    for name in [name for name in tensors if name.endswith(OF_CODE)]:
        del tensors[name]
    channels = tensors["conv_first.weight"].shape[0]
    if "conv_up1.weight" in tensors or "upsample.0.weight" not in tensors:
        raise ValueError("this SwinIR has neither the classical nor the lightweight upsampler: real-world, denoising and JPEG ones are not "
                         "supported")
    direct = "conv_before_upsample.0.weight" not in tensors
    scale = math.isqrt(tensors["upsample.0.weight"].shape[0] // 3) if direct else 2 ** steps_of(tensors, "upsample.")
    fc1 = tensors["layers.0.residual_group.blocks.0.mlp.fc1.weight"]
    tensors["mean"] = torch.tensor(DIV2K_MEAN)
    return Config(
        scale=scale, channels=channels, groups=count(tensors, r"layers\.(\d+)\."),
        blocks=count(tensors, r"layers\.0\.residual_group\.blocks\.(\d+)\."), window=int(heads.shape[0] ** 0.5 + 1.5) // 2,
        head_channels=channels // heads.shape[1], mlp_ratio=fc1.shape[0] // channels, transfer=transfer,
        upsampler="pixelshuffledirect" if direct else "pixelshuffle")
