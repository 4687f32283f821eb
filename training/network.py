"""The network of Hou & Liu 2023 (Computer Graphics Forum, arXiv 2310.13235), section 3, as a PyTorch module.

Feature maps are [batch, channels, height, width]; attention works on [batch, height, width, channels].
Parameter names are the names in the model file, so `state_dict()` is the file's content (see weights.py).
"""
import dataclasses
import math

import torch
import torch.nn as nn
import torch.nn.functional as F


LIGHTS = ("diffuse", "glossy")      # auxiliary inputs that are radiance per albedo


@dataclasses.dataclass(frozen=True)
class NetworkConfig:
    """Every size and option of a model; the fields are the metadata keys of the model file.

    Symbols of the paper: scale s, channels C, aux_channels Ca, groups N, blocks B, window w, head_channels d.
    `kernels` = 5 adds 25 kernel logits to the 3 output channels; `aux_skip` = 1 feeds H_N to the output convolution;
    `aux_kernels` = 3 or 5 adds that many squared logits of a kernel that filters the auxiliary images for the base image and the output.
    `colour` in `aux_inputs` is the full-resolution noisy colour, `diffuse` and `glossy` its light without the surfaces' albedo; `colour_kernels` = 3 or 5 adds that many squared logits of a kernel that
    filters it, and the logit of its share in the base image.
    `prefilter` = 1, 2 or 3 levels adds 25 logits a level at low resolution, of the kernels that filter the colour before the base image is made.
    `output_side` = 1 makes the output convolution 1 x 1.
    `cross` = "concat" puts a 1x1 convolution of [f, e] in the place of the cross module XM.
    `denoised_darker` and `denoised_brighter` are the parts, percent, of what the network darkens and brightens in a colour that was denoised before that are taken.
    """
    scale: int = 4
    channels: int = 64
    aux_channels: int = 32
    aux_inputs: tuple = ("albedo", "normal")
    groups: int = 3
    blocks: int = 5
    window: int = 8
    head_channels: int = 32
    transfer: str = "log1p"
    base: str = "guided"
    block: str = "rdst"
    kernels: int = 0
    aux_skip: int = 0
    aux_kernels: int = 0
    colour_kernels: int = 0
    prefilter: int = 0
    output_side: int = 3
    cross: str = "attention"
    denoised_darker: int = 100
    denoised_brighter: int = 100

    def __post_init__(self):
        def require(condition, message):
            if not condition:
                raise ValueError(message)
        require(self.scale in (1, 2, 4, 8, 16), f"scale must be 1, 2, 4, 8 or 16, found {self.scale}")
        for name in ("channels", "aux_channels", "head_channels"):
            size = getattr(self, name)
            require(4 <= size <= 512 and size % 4 == 0, f"{name} must be a multiple of 4 up to 512, found {size}")
        require(self.channels % self.head_channels == 0,
                f"channels {self.channels} must be a multiple of head_channels {self.head_channels}")
        require(2 <= self.window <= 16 and self.window % 2 == 0, f"window must be an even number from 2 to 16, found {self.window}")
        for name in ("groups", "blocks"):
            require(1 <= getattr(self, name) <= 64, f"{name} must be from 1 to 64, found {getattr(self, name)}")
        require(len(set(self.aux_inputs)) == len(self.aux_inputs), f"aux_inputs must name each once, found {','.join(self.aux_inputs)}")
        require(self.block in BLOCKS, f"block must be one of {', '.join(BLOCKS)}, found {self.block!r}")
        require(self.cross in ("attention", "concat"), f"cross must be attention or concat, found {self.cross!r}")
        require(self.transfer in ("none", "log1p"), f"transfer must be none or log1p, found {self.transfer!r}")
        require(self.base in ("none", "bicubic", "demodulated", "guided"), f"unknown base {self.base!r}")
        require(self.base in ("none", "bicubic") or "albedo" in self.aux_inputs, f"base {self.base} needs albedo")
        require(self.kernels in (0, 5), f"kernels must be 0 or 5, found {self.kernels}")
        require(self.kernels == 0 or self.base == "guided", "learned kernels need base=guided")
        require(self.aux_kernels in (0, 3, 5), f"aux_kernels must be 0, 3 or 5, found {self.aux_kernels}")
        require(self.aux_kernels == 0 or self.base in ("demodulated", "guided"), "aux_kernels needs a base that demodulates")
        require(self.colour_kernels in (0, 3, 5), f"colour_kernels must be 0, 3 or 5, found {self.colour_kernels}")
        require(self.colour_kernels == 0 or self.base == "guided" and self.full, "colour_kernels needs base=guided and colour in aux_inputs")
        require(self.prefilter in (0, 1, 2, 3), f"prefilter must be 0, 1, 2 or 3, found {self.prefilter}")
        require(self.prefilter == 0 or self.base == "guided", "prefilter needs base=guided")
        require(not self.full or self.scale > 1, "colour in aux_inputs needs a scale above 1: at scale 1 the colour has full resolution already")
        require(self.output_side in (1, 3), f"output_side must be 1 or 3, found {self.output_side}")
        require(self.aux_skip in (0, 1), f"aux_skip must be 0 or 1, found {self.aux_skip}")
        require(self.aux_skip == 0 or self.aux_inputs, "aux_skip needs auxiliary inputs")
        for name in ("denoised_darker", "denoised_brighter"):
            share = getattr(self, name)
            require(0 <= share <= 100, f"{name} must be from 0 to 100, found {share}")
            require(share == 100 or self.scale == 1, f"{name} needs scale 1")

    @property
    def steps(self):
        """n = log2 s: the number of pixel (un)shuffles."""
        return self.scale.bit_length() - 1

    @property
    def full(self):
        """Whether the model takes the full-resolution noisy colour."""
        return "colour" in self.aux_inputs

    @property
    def guides(self):
        """The auxiliary inputs but for the colour."""
        return tuple(kind for kind in self.aux_inputs if kind != "colour")

    @property
    def first_lights(self):
        """First channels of the diffuse and glossy light among the guides."""
        return tuple(3 * index for index, kind in enumerate(self.guides) if kind in LIGHTS)

    @property
    def aux_width(self):
        """A: auxiliary input channels, three an input."""
        return 3 * len(self.aux_inputs)

    @property
    def output_parts(self):
        """Channels of the raw output: the residual, the kernel logits, the logits of the auxiliary images' kernels, those of the
        full-resolution colour's kernel and, last, of its share."""
        return 3, self.kernels ** 2, self.aux_kernels ** 2, self.colour_kernels ** 2 + (self.colour_kernels > 0)

    @property
    def output_width(self):
        return sum(self.output_parts)


def conv3x3(inputs, outputs):
    return nn.Conv2d(inputs, outputs, 3, padding=1)


def windows_of(x, w):
    """[b, h, v, c] -> [b * (h/w) * (v/w), w*w, c], windows in row-major order."""
    b, h, v, c = x.shape
    return x.view(b, h // w, w, v // w, w, c).transpose(2, 3).reshape(-1, w * w, c)


def image_of(windows, b, h, v, w):
    """Inverse of windows_of."""
    return windows.view(b, h // w, v // w, w, w, -1).transpose(2, 3).reshape(b, h, v, -1)


def relative_position_index(w):
    """[w*w, w*w] row of the bias table for (query token, key token): (yq-yk+w-1)(2w-1) + (xq-xk+w-1)."""
    y, x = torch.meshgrid(torch.arange(w), torch.arange(w), indexing="ij")
    y, x = y.flatten(), x.flatten()
    return (y[:, None] - y[None, :] + w - 1) * (2 * w - 1) + (x[:, None] - x[None, :] + w - 1)


def shift_mask(h, v, w, device):
    """[windows, w*w, w*w] additive mask of the shifted layout: -inf between tokens that the wrap-around brought together."""
    def regions(size):
        position = torch.arange(size, device=device)
        return (position >= size - w).int() + (position >= size - w // 2).int()
    region = (3 * regions(h)[:, None] + regions(v)[None, :]).view(1, h, v, 1)
    region = windows_of(region, w).squeeze(-1)
    same = region[:, :, None] == region[:, None, :]
    return torch.zeros(same.shape, device=device).masked_fill(~same, -math.inf)


class WindowAttention(nn.Module):
    """softmax(q k^T / sqrt(d) + bias) v in each w x w window and head, then a linear layer.

    cross=False: WMSA, q, k and v from x. cross=True: WMCA, k and v from `memory` (paper 3.2).
    """

    def __init__(self, width, config, cross=False):
        super().__init__()
        self.window, self.heads, self.cross = config.window, width // config.head_channels, cross
        self.scale = config.head_channels ** -0.5
        if cross:
            self.q = nn.Linear(width, width)
            self.kv = nn.Linear(width, 2 * width)
        else:
            self.qkv = nn.Linear(width, 3 * width)
        self.proj = nn.Linear(width, width)
        self.relative_position_bias_table = nn.Parameter(torch.zeros((2 * config.window - 1) ** 2, self.heads))
        self.register_buffer("index", relative_position_index(config.window), persistent=False)

    def bias(self):
        """[heads, w*w, w*w]"""
        tokens = self.window ** 2
        return self.relative_position_bias_table[self.index.view(-1)].view(tokens, tokens, -1).permute(2, 0, 1)

    def forward(self, x, memory=None, shifted=False):
        """x, memory: [b, h, v, c], h and v multiples of w. Returns [b, h, v, c]."""
        b, h, v, c = x.shape
        w, shift = self.window, self.window // 2
        if shifted:
            x = torch.roll(x, (-shift, -shift), (1, 2))
        x = windows_of(x, w)
        heads = lambda t, parts: t.view(x.shape[0], w * w, parts, self.heads, -1).permute(2, 0, 3, 1, 4)
        if self.cross:
            (q,) = heads(self.q(x), 1)
            k, value = heads(self.kv(windows_of(memory, w)), 2)
        else:
            q, k, value = heads(self.qkv(x), 3)
        scores = (q * self.scale) @ k.transpose(-2, -1) + self.bias()
        if shifted:
            mask = shift_mask(h, v, w, x.device).to(scores.dtype)
            scores = (scores.view(b, -1, *scores.shape[1:]) + mask[None, :, None]).view(scores.shape)
        x = (scores.softmax(-1).to(value.dtype) @ value).transpose(1, 2).reshape(x.shape)
        x = image_of(self.proj(x), b, h, v, w)
        return torch.roll(x, (shift, shift), (1, 2)) if shifted else x


class Mlp(nn.Module):
    """linear c -> ratio c, GELU (erf form), linear ratio c -> c."""

    def __init__(self, width, ratio):
        super().__init__()
        self.fc1 = nn.Linear(width, ratio * width)
        self.fc2 = nn.Linear(ratio * width, width)

    def forward(self, x):
        return self.fc2(F.gelu(self.fc1(x)))


class CrossModule(nn.Module):
    """XM of the paper's cross-modality group (figure 3): self attention, cross attention to the auxiliary features, MLP."""

    def __init__(self, config):
        super().__init__()
        c = config.channels
        self.norm1, self.self_attn = nn.LayerNorm(c), WindowAttention(c, config)
        if config.aux_inputs:
            self.norm2, self.norm_aux = nn.LayerNorm(c), nn.LayerNorm(c)
            self.cross_attn = WindowAttention(c, config, cross=True)
        self.norm3, self.mlp = nn.LayerNorm(c), Mlp(c, 4)

    def forward(self, f, e):
        """f, e: [b, h, v, C]; e is None without auxiliary input."""
        f = f + self.self_attn(self.norm1(f))
        if e is not None:
            f = f + self.cross_attn(self.norm2(f), self.norm_aux(e))
        return f + self.mlp(self.norm3(f))


class SwinLayer(nn.Module):
    """STL: u = t + WMSA(LN(t)); u + MLP_ratio(LN(u)), ratio 2 here and any in SwinIR."""

    def __init__(self, width, config, shifted, ratio=2):
        super().__init__()
        self.shifted = shifted
        self.norm1, self.attn = nn.LayerNorm(width), WindowAttention(width, config)
        self.norm2, self.mlp = nn.LayerNorm(width), Mlp(width, ratio)

    def forward(self, t):
        u = t + self.attn(self.norm1(t), shifted=self.shifted)
        return u + self.mlp(self.norm2(u))


def to_tokens(x):
    """[b, c, h, v] -> [b, h, v, c]; free when x is channels-last."""
    return x.permute(0, 2, 3, 1)


def to_image(x):
    """[b, h, v, c] -> [b, c, h, v]"""
    return x.permute(0, 3, 1, 2)


class ConvBlock(nn.Module):
    """RDB (residual dense network, Zhang et al. 2018): y_k = relu(conv3x3([x, y_1 .. y_{k-1}])), k = 1..3; conv1x1 of all, plus x."""

    def __init__(self, config, block):
        super().__init__()
        c = config.channels
        self.grow = nn.ModuleList(conv3x3((k + 1) * c, c) for k in range(3))
        self.fuse = nn.Conv2d(4 * c, c, 1)

    def forward(self, x):
        t = x
        for grow in self.grow:
            t = torch.cat([t, F.relu(grow(t))], 1)
        return self.fuse(t) + x


class SwinBlock(nn.Module):
    """RSTB (SwinIR, Liang et al. 2021) of three Swin layers of width C, and a residual 3x3 convolution."""

    def __init__(self, config, block):
        super().__init__()
        c = config.channels
        self.layers = nn.ModuleList(SwinLayer(c, config, shifted=(3 * block + k) % 2 == 1) for k in range(3))
        self.conv = conv3x3(c, c)

    def forward(self, x):
        t = to_tokens(x)
        for layer in self.layers:
            t = layer(t)
        return self.conv(to_image(t)) + x


class DenseBlock(nn.Module):
    """RDST: three Swin layers over a growing concatenation, fused by 1x1 convolutions, and a residual 3x3 convolution."""

    def __init__(self, config, block):
        super().__init__()
        c = config.channels
        self.layers = nn.ModuleList(SwinLayer((k + 1) * c, config, shifted=(3 * block + k) % 2 == 1) for k in range(3))
        self.grow = nn.ModuleList(nn.Conv2d((k + 1) * c, c, 1) for k in range(3))
        self.conv = conv3x3(c, c)

    def forward(self, x):
        t = x
        for k in range(3):
            y = self.grow[k](to_image(self.layers[k](to_tokens(t))))
            t = torch.cat([t, y], 1) if k < 2 else t
        return self.conv(y) + x


BLOCKS = {"rdst": DenseBlock, "rstb": SwinBlock, "rdb": ConvBlock}


class Group(nn.Module):
    """XDG: cross module, B blocks, a residual convolution."""

    def __init__(self, config):
        super().__init__()
        c = config.channels
        self.lr_conv = conv3x3(c, c)
        if config.aux_inputs:
            self.aux_conv = conv3x3(c, c)
        if config.cross == "attention":
            self.xm = CrossModule(config)
        elif config.aux_inputs:
            self.concat = nn.Conv2d(2 * c, c, 1)
        self.cross = config.cross
        self.blocks = nn.ModuleList(BLOCKS[config.block](config, b) for b in range(config.blocks))
        self.conv = conv3x3(c, c)

    def forward(self, f, d):
        e = None if d is None else self.aux_conv(d)
        x = g = self.joined(self.lr_conv(f), e)
        for block in self.blocks:
            g = block(g)
        return self.conv(g) + x

    def joined(self, f, e):
        """X [b, C, h, v]: what colour and auxiliary features make together."""
        if self.cross == "attention":
            return to_image(self.xm(to_tokens(f), None if e is None else to_tokens(e)))
        return f if e is None else self.concat(torch.cat([f, e], 1))


class AuxBlock(nn.Module):
    """H_i = H_{i-1} + conv3x3(relu(conv3x3(H_{i-1})))."""

    def __init__(self, width):
        super().__init__()
        self.conv1, self.conv2 = conv3x3(width, width), conv3x3(width, width)

    def forward(self, h):
        return h + self.conv2(F.relu(self.conv1(h)))


def deshuffle_layers(config):
    """Convolutions of deshuffle_i: n steps of unshuffle by 2 and conv3x3 to Ca, the last to C; one conv for s = 1."""
    c, ca, n = config.channels, config.aux_channels, config.steps
    if n == 0:
        return nn.ModuleList([conv3x3(ca, c)])
    return nn.ModuleList(conv3x3(4 * ca, c if j == n - 1 else ca) for j in range(n))


class Network(nn.Module):
    """The whole network: padded transformed colour and auxiliary images in, residual and kernel logits out."""

    def __init__(self, config):
        super().__init__()
        self.config = config
        c, ca = config.channels, config.aux_channels
        self.lr_conv = conv3x3(3, c)
        if config.aux_inputs:
            self.aux_conv = conv3x3(config.aux_width, ca)
            self.aux_blocks = nn.ModuleList(AuxBlock(ca) for _ in range(config.groups))
            self.deshuffle = nn.ModuleList(deshuffle_layers(config) for _ in range(config.groups + 1))
        self.groups = nn.ModuleList(Group(config) for _ in range(config.groups))
        self.fuse = conv3x3(2 * c if config.aux_inputs else c, c)
        self.body_conv, self.up_pre = conv3x3(c, c), conv3x3(c, c)
        self.up = nn.ModuleList(conv3x3(c, 4 * c) for _ in range(config.steps))
        if config.prefilter:
            self.prefilter = nn.Conv2d(c, 25 * config.prefilter, 1)
        side = config.output_side
        self.out = nn.Conv2d(c + (ca if config.aux_skip else 0), config.output_width, side, padding=side // 2)

    def deshuffled(self, i, h):
        """D_i [b, C, h, w'] from H_i [b, Ca, s*h, s*w']."""
        for j, conv in enumerate(self.deshuffle[i]):
            h = F.relu(h) if j > 0 else h
            h = conv(F.pixel_unshuffle(h, 2) if self.config.steps else h)
        return h

    def forward(self, x, aux=None):
        """x: [b, 3, h, w'] transformed colour; aux: [b, A, s*h, s*w'] or None. Returns the raw output [b, output_width, s*h, s*w'] and the
        logits of the prefilter [b, 25 * prefilter, h, w'], None without.

        h and w' must be multiples of the window (pipeline.pad_inputs).
        """
        f0 = f = self.lr_conv(x)
        h = d = None
        if self.config.aux_inputs:
            h = self.aux_conv(aux)
            d = self.deshuffled(0, h)
        for i, group in enumerate(self.groups):
            f = group(f, d)
            if h is not None:
                h = self.aux_blocks[i](h)
                d = self.deshuffled(i + 1, h)
        u = self.fuse(f if d is None else torch.cat([f, d], 1))
        u = self.body_conv(u) + f0
        prefilter = self.prefilter(u) if self.config.prefilter else None
        u = F.leaky_relu(self.up_pre(u), 0.01)
        for conv in self.up:
            u = F.pixel_shuffle(conv(u), 2)
        return self.out(torch.cat([u, h], 1) if self.config.aux_skip else u), prefilter
