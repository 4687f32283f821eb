"""The networks that Hou & Liu 2023 compare with, as PyTorch modules: EDSR, RCAN, SwinIR and MSSPL.

Parameter names are those of the official repositories (EDSR-PyTorch, RCAN, SwinIR) and those in the model file, but for the mean
that the first two keep in two convolutions and SwinIR in its code: here it is the parameter `mean` [3], in units of the image.
Each module takes colour [batch, 3, h, w] (MSSPL auxiliary images [batch, A, s h, s w] too), h and w multiples of `window`, and
returns [batch, 3, s h, s w]. `mean` is subtracted and `range` multiplied before the network and undone behind it.
"""
import dataclasses

import torch
import torch.nn as nn
import torch.nn.functional as F
from safetensors import safe_open
from safetensors.torch import save_file

from network import SwinLayer, conv3x3, to_image, to_tokens

DIV2K_MEAN = (0.4488, 0.4371, 0.4040)


@dataclasses.dataclass(frozen=True)
class Config:
    """The metadata fields of the model file. `groups`: RCAN's residual groups, SwinIR's RSTB, MSSPL's RDG; `blocks`: of each of
    them, or EDSR's. `window`: the multiple to which frames are padded (padded()). What an architecture does not have is at its
    default."""
    architecture: str
    scale: int = 4
    channels: int = 64
    groups: int = 1
    blocks: int = 16
    window: int = 4
    transfer: str = "log1p"
    range: int = 1
    residual_divisor: int = 1       # EDSR: 1 / its residual scaling
    reduction: int = 16             # RCAN: of channel attention
    head_channels: int = 30         # SwinIR
    mlp_ratio: int = 2              # SwinIR
    upsampler: str = "pixelshuffle"     # SwinIR; or pixelshuffledirect
    aux_inputs: tuple = ()          # MSSPL

    @property
    def steps(self):
        return self.scale.bit_length() - 1

    @property
    def aux_width(self):
        return 3 * len(self.aux_inputs)


PAPER = {   # the sizes of the papers, at scale 4
    "edsr": Config("edsr", channels=256, blocks=32, residual_divisor=10, range=255),
    "edsr_baseline": Config("edsr", channels=64, blocks=16, range=255),
    "rcan": Config("rcan", channels=64, groups=10, blocks=20, range=255),
    "swinir": Config("swinir", channels=180, groups=6, blocks=6, window=8),
    "swinir_light": Config("swinir", channels=60, groups=4, blocks=6, window=8, head_channels=10, upsampler="pixelshuffledirect"),
    "msspl": Config("msspl", channels=64, groups=3, blocks=5, aux_inputs=("albedo", "normal")),
}


def metadata_of(config):
    """The fields of the model file that its architecture has."""
    own = {"edsr": ("blocks", "residual_divisor", "range"), "rcan": ("groups", "blocks", "reduction", "range"),
           "swinir": ("groups", "blocks", "window", "head_channels", "mlp_ratio", "upsampler", "range"),
           "msspl": ("groups", "blocks", "aux_inputs")}[config.architecture]
    fields = dataclasses.asdict(config) | {"aux_inputs": ",".join(config.aux_inputs)}
    names = ("architecture", "scale", "channels", "transfer", *own)
    return {"format": "xrds", "version": "1", **{name: str(fields[name]) for name in names}}


def padded(x, config, scale=1):
    """The image [b, c, h, w] as the engine pads it: SwinIR's to whole windows by reflection, of others the rows alone, to a multiple of
    four pixels by edge replication. `scale`: of the auxiliary images."""
    height, width = x.shape[2:]
    unit = config.window * scale
    if config.architecture == "swinir":
        return F.pad(x, (0, -width % unit, 0, -height % unit), mode="reflect")
    return F.pad(x, (0, -width % unit, 0, 0), mode="replicate")


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


class ResidualBlock(nn.Module):
    """EDSR: x + conv3x3(relu(conv3x3(x))) / divisor, no batch normalization (figure 2c)."""

    def __init__(self, channels, divisor):
        super().__init__()
        self.body = nn.Sequential(conv3x3(channels, channels), nn.ReLU(), conv3x3(channels, channels))
        self.divisor = divisor

    def forward(self, x):
        return self.body(x) / self.divisor + x


class Edsr(Normed):
    """Lim et al. 2017, "Enhanced Deep Residual Networks for Single Image Super-Resolution", figure 3."""

    def __init__(self, config):
        super().__init__(config)
        c = config.channels
        self.head = nn.Sequential(conv3x3(3, c))
        self.body = nn.Sequential(*(ResidualBlock(c, config.residual_divisor) for _ in range(config.blocks)), conv3x3(c, c))
        self.tail = nn.Sequential(upsampler(c, config.steps), conv3x3(c, 3))

    def network(self, x):
        x = self.head(x)
        return self.tail(self.body(x) + x)


class ChannelAttention(nn.Module):
    """x times sigmoid(W_U relu(W_D mean(x))), equations 7 and 8 of RCAN."""

    def __init__(self, channels, reduction):
        super().__init__()
        self.conv_du = nn.Sequential(nn.Conv2d(channels, channels // reduction, 1), nn.ReLU(), nn.Conv2d(channels // reduction, channels, 1), nn.Sigmoid())

    def forward(self, x):
        return x * self.conv_du(x.mean((2, 3), keepdim=True))


class Rcab(nn.Module):
    """RCAN's residual channel attention block, equation 9."""

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


class Rcan(Normed):
    """Zhang et al. 2018, "Image Super-Resolution Using Very Deep Residual Channel Attention Networks", figure 2."""

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


class SwinIr(Normed):
    """Liang et al. 2021, "SwinIR: Image Restoration Using Swin Transformer", figure 2: classical or lightweight super-resolution."""

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


class DenseBlock(nn.Module):
    """RDB (Zhang et al. 2018): y_k = relu(conv3x3([x, y_1 .. y_{k-1}])), k = 1..3; conv1x1 of all, plus x."""

    def __init__(self, channels):
        super().__init__()
        self.grow = nn.ModuleList(conv3x3((k + 1) * channels, channels) for k in range(3))
        self.fuse = nn.Conv2d(4 * channels, channels, 1)

    def forward(self, x):
        t = x
        for grow in self.grow:
            t = torch.cat([t, F.relu(grow(t))], 1)
        return self.fuse(t) + x


class Msspl(nn.Module):
    """Hou et al. 2021, "Fast Monte Carlo Rendering via Multi-Resolution Sampling", figure of the network: the low-resolution image
    and the downscaled high-resolution ones are fused, go through G groups of B residual dense blocks with short skips and a long
    skip, and are upscaled. The layers inside the modules are our reading: docs/networks.md."""

    def __init__(self, config):
        super().__init__()
        self.config = config
        c = config.channels
        self.conv = conv3x3(3, c)
        if config.aux_inputs:
            widths = [config.aux_width] + [c] * config.steps
            self.down = nn.ModuleList(conv3x3(4 * inputs, outputs) for inputs, outputs in zip(widths, widths[1:]))
            self.fusion = nn.Conv2d(2 * c, c, 1)
        self.groups = nn.ModuleList(nn.ModuleList(DenseBlock(c) for _ in range(config.blocks)) for _ in range(config.groups))
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


def network_of(config):
    """The module of the configuration, with PyTorch's initialization."""
    return {"edsr": Edsr, "rcan": Rcan, "swinir": SwinIr, "msspl": Msspl}[config.architecture](config)


def config_of(metadata):
    """metadata_of()'s inverse."""
    values = {field.name: metadata[field.name] for field in dataclasses.fields(Config) if field.name in metadata}
    values["aux_inputs"] = tuple(filter(None, values.get("aux_inputs", "").split(",")))
    return Config(**{name: value if isinstance(value, tuple) else (str if Config.__annotations__[name] is str else int)(value) for name, value in values.items()})


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
