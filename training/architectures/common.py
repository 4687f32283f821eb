"""What the architectures share: their configuration, the range of colours, the way up, and reading sizes out of checkpoints."""
import dataclasses
import re

import torch
import torch.nn as nn

from network import conv3x3

DIV2K_MEAN = (0.4488, 0.4371, 0.4040)


@dataclasses.dataclass(frozen=True)
class Config:
    """The metadata fields of the model file, to which an architecture adds its own. `groups`: RCAN's residual groups, SwinIR's RSTB,
    MSSPL's RDG; `blocks`: of each of them, or EDSR's. `window`: the multiple to which frames are padded (padded()). What an
    architecture does not have is at its default."""
    architecture: str
    scale: int = 4
    channels: int = 64
    groups: int = 1
    blocks: int = 16
    window: int = 4
    transfer: str = "log1p"
    range: int = 1
    aux_inputs: tuple = ()

    @property
    def steps(self):
        return self.scale.bit_length() - 1

    @property
    def aux_width(self):
        return 3 * len(self.aux_inputs)


class Normed(nn.Module):
    """body(range (x - mean)) / range + mean; EDSR and RCAN keep this in sub_mean and add_mean."""

    def __init__(self, config):
        super().__init__()
        self.config = config
        self.mean = nn.Parameter(torch.tensor(DIV2K_MEAN))

    def forward(self, x):
        mean = self.mean.view(1, 3, 1, 1)
        return self.network((x - mean) * self.config.range) / self.config.range + mean


def upsampler(channels, steps):
    """`steps` times a convolution to 4 C channels and pixel_shuffle(2); parameters 0, 2, 4, ..."""
    return nn.Sequential(*(layer for _ in range(steps) for layer in (conv3x3(channels, 4 * channels), nn.PixelShuffle(2))))


def count(tensors, pattern):
    """One more than the largest number that the pattern captures among the names."""
    found = [int(match[1]) for name in tensors if (match := re.match(pattern, name))]
    if not found:
        raise ValueError(f"no tensor is named like {pattern}")
    if max(found) >= len(tensors):
        raise ValueError(f"a tensor named like {pattern} has the number {max(found)}, of {len(tensors)} tensors in all")
    return max(found) + 1


def steps_of(tensors, prefix):
    """log2 of the scale: doublings 0, 2, ... behind the prefix. Raises ValueError where one is no doubling."""
    numbers = sorted(int(name[len(prefix):].split(".")[0]) for name in tensors if name.startswith(prefix) and name.endswith(".weight"))
    for number in numbers:
        outputs, inputs = tensors[f"{prefix}{number}.weight"].shape[:2]
        if outputs != 4 * inputs:
            raise ValueError(f"{prefix}{number} is no doubling: scale 3 and direct upsamplers are not supported")
    return len(numbers)


def rename(tensors, names):
    """Gives each tensor whose whole name a pattern of `names` matches the name beside it, in which \\1 is what the pattern captured."""
    for old in list(tensors):
        for pattern, new in names.items():
            if re.fullmatch(pattern, old):
                tensors[re.sub(pattern, new, old)] = tensors.pop(old)
                break


def names_of_basicsr(blocks):
    """What BasicSR calls the outer layers of EDSR and RCAN; the bodies have so many blocks or groups. Its mean and its range, 255, are in its code."""
    return {r"conv_first\.(\w+)": r"head.0.\1", r"conv_after_body\.(\w+)": rf"body.{blocks}.\1",
            r"upsample\.(\d+\.\w+)": r"tail.0.\1", r"conv_last\.(\w+)": r"tail.1.\1"}


def taken_mean(tensors, value_range):
    """Takes the mean shift of EDSR and RCAN out of the tensors, as `mean`. Raises ValueError where it is another map."""
    bias = tensors.get("sub_mean.bias")
    mean = torch.tensor(DIV2K_MEAN) if bias is None else -bias / value_range
    for name in ("sub_mean", "add_mean"):
        weight = tensors.pop(name + ".weight", torch.eye(3))
        if not torch.allclose(weight.view(3, 3), torch.eye(3)):
            raise ValueError(f"{name} does more than to shift the mean")
        tensors.pop(name + ".bias", None)
    tensors["mean"] = mean
