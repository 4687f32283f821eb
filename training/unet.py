"""The U-Nets of Open Image Denoise as docs/denoise.md describes them, in PyTorch, and golden files of small ones with random weights.

    python training/unet.py tests/golden/unet

NAME.model.safetensors is a model file of the architecture `oidn`; NAME.io.safetensors holds float32 images, channels last: colour [h, w, 3],
albedo and normal where the model has them, exposure [1], network [h, w, 3] the raw cropped output and output [h, w, 3].
"""
import argparse
import math
import pathlib

import torch
import torch.nn as nn
import torch.nn.functional as F
from safetensors import safe_open
from safetensors.torch import save_file

LEVELS = 4
# Of each size the convolutions of encoder_0 .. encoder_4 and decoder_0 .. decoder_3, with their channels.
LAYOUTS = {
    "base": ([[("enc_conv0", 32), ("enc_conv1", 32)], [("enc_conv2", 48)], [("enc_conv3", 64)], [("enc_conv4", 80)],
              [("enc_conv5a", 96), ("enc_conv5b", 96)]],
             [[("dec_conv1a", 64), ("dec_conv1b", 32), ("dec_conv0", 3)], [("dec_conv2a", 64), ("dec_conv2b", 64)],
              [("dec_conv3a", 96), ("dec_conv3b", 96)], [("dec_conv4a", 112), ("dec_conv4b", 112)]]),
    "small": ([[("enc_conv0", 32), ("enc_conv1", 32)], [("enc_conv2", 32)], [("enc_conv3", 32)], [("enc_conv4", 32)],
               [("enc_conv5a", 32), ("enc_conv5b", 32)]],
              [[("dec_conv1a", 32), ("dec_conv1b", 32), ("dec_conv0", 3)], [("dec_conv2a", 64), ("dec_conv2b", 32)],
               [("dec_conv3a", 64), ("dec_conv3b", 64)], [("dec_conv4a", 64), ("dec_conv4b", 64)]]),
    "large": ([[("enc_conv1a", 64), ("enc_conv1b", 64)], [("enc_conv2a", 96), ("enc_conv2b", 96)],
               [("enc_conv3a", 128), ("enc_conv3b", 128)], [("enc_conv4a", 192), ("enc_conv4b", 192)],
               [("enc_conv5a", 256), ("enc_conv5b", 256)]],
              [[("dec_conv1a", 64), ("dec_conv1b", 64), ("dec_conv1c", 3)], [("dec_conv2a", 96), ("dec_conv2b", 96)],
               [("dec_conv3a", 128), ("dec_conv3b", 128)], [("dec_conv4a", 192), ("dec_conv4b", 192)]]),
}
GUIDES = {"": 0, "albedo": 1, "albedo,normal": 2}


class UNet(nn.Module):
    """x_0: [1, 3 + 3 guides, H, W] between 0 and 1, H and W multiples of 16; returns [1, 3, H, W]. `divisor` narrows all widths, for tests."""

    def __init__(self, size, guides, divisor=1):
        super().__init__()
        self.encoders, self.decoders = LAYOUTS[size]
        widths = [3 + 3 * guides]
        for level, convs in enumerate(self.encoders):
            width = widths[level]
            for name, channels in convs:
                self.add_module(name, nn.Conv2d(width, channels // divisor, 3, padding=1))
                width = channels // divisor
            widths.append(width)
        below = widths[LEVELS + 1]
        for level in reversed(range(LEVELS)):
            width = below + widths[level]
            for name, channels in self.decoders[level]:
                outputs = channels if channels == 3 else channels // divisor
                self.add_module(name, nn.Conv2d(width, outputs, 3, padding=1))
                width = outputs
            below = width

    def chain(self, convs, x):
        for name, _ in convs:
            x = F.relu(getattr(self, name)(x))
        return x

    def forward(self, x):
        levels = [x]
        for level in range(LEVELS):
            levels.append(F.max_pool2d(self.chain(self.encoders[level], levels[level]), 2))
        y = self.chain(self.encoders[LEVELS], levels[LEVELS])
        for level in reversed(range(LEVELS)):
            y = self.chain(self.decoders[level], torch.cat([F.interpolate(y, scale_factor=2, mode="nearest"), levels[level]], 1))
        return y


# The perceptually uniform curve: a y; b y^c + d from y0 on; e log(y + f) + g from y1 on.
A, B, C, D, E, G = 1.41283765e3, 1.64593172, 4.31384981e-1, -2.94139609e-3, 1.92653254e-1, 9.98620152e-1
SHIFT, Y0, Y1, X0, X1 = 6.26026094e-3, 1.57945760e-6, 3.22087631e-2, 2.23151711e-3, 3.70974749e-1
MOST = E * math.log(65504 + SHIFT) + G


def encoded(kind, y):
    """What the network sees of a colour (hdr, times the exposure before; ldr), an albedo or a normal."""
    if kind == "normal":
        return y.clamp(-1, 1) / 2 + 0.5
    if kind != "hdr":
        y = y.clamp(0, 1)
        return torch.where(y <= 0.0031308, 12.92 * y, 1.055 * y.clamp(min=1e-9) ** (1 / 2.4) - 0.055)
    y = y.clamp(min=0)
    middle, high = B * y.clamp(min=1e-30) ** C + D, E * torch.log(y + SHIFT) + G
    return torch.where(y <= Y0, A * y, torch.where(y <= Y1, middle, high)) / MOST


def decoded(kind, x):
    x = x.clamp(min=0)
    if kind == "normal":
        return (2 * x - 1).clamp(max=1)
    if kind != "hdr":
        return torch.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4).clamp(max=1)
    x = x * MOST
    return torch.where(x <= X0, x / A, torch.where(x <= X1, ((x - D).clamp(min=0) / B) ** (1 / C), torch.exp((x - G) / E) - SHIFT))


def binned_exposure(colour):
    """0.18 over the geometric mean of the luminances of bins of about 16 x 16 pixels of a colour [1, 3, h, w]."""
    luminance = (colour[0].clamp(min=0) * torch.tensor([0.212671, 0.715160, 0.072169], dtype=colour.dtype).view(3, 1, 1)).sum(0)
    h, w = luminance.shape
    rows, columns = -(-h // 16), -(-w // 16)
    means = [luminance[i * h // rows:(i + 1) * h // rows, j * w // columns:(j + 1) * w // columns].mean().item()
             for i in range(rows) for j in range(columns)]
    logs = [math.log(mean) for mean in means if mean > 1e-8]
    return 0.18 / math.exp(sum(logs) / len(logs)) if logs else 1.0


def denoise(network, kind, colour, guides, exposure=1.0):
    """The whole pass over images [1, 3, h, w]: (picture, raw output), both [1, 3, h, w]."""
    h, w = colour.shape[-2:]
    seen = [encoded(kind, colour * exposure if kind == "hdr" else colour)]
    seen += [encoded("normal", guide) if i else guide.clamp(0, 1) for i, guide in enumerate(guides)]
    raw = network(F.pad(torch.cat(seen, 1), (0, -w % 16, 0, -h % 16)))[..., :h, :w]
    return decoded(kind, raw) / (exposure if kind == "hdr" else 1), raw


def save(path, network, metadata):
    save_file({name: value.detach().half().contiguous() for name, value in network.state_dict().items()}, path,
              {"format": "xrds", "version": "1", "architecture": "oidn", "scale": "1", **metadata})


def load(path, dtype=torch.float64):
    """(network, metadata) of a model file of the architecture `oidn`."""
    with safe_open(path, framework="pt") as file:
        metadata, tensors = file.metadata(), {name: file.get_tensor(name) for name in file.keys()}
    network = UNet(metadata["size"], GUIDES[metadata["aux_inputs"]], int(metadata.get("width_divisor", 1)))
    network.load_state_dict(tensors)
    return network.to(dtype).eval(), metadata


# name: ((h, w), size, input, guides, divisor)
CASES = {
    "hdr_small": ((21, 37), "small", "hdr", "", 8),
    "hdr_albedo_base": ((16, 32), "base", "hdr", "albedo", 4),
    "hdr_albedo_normal_large": ((35, 18), "large", "hdr", "albedo,normal", 8),
    "ldr_albedo_normal_small": ((1, 1), "small", "ldr", "albedo,normal", 8),
    "albedo_small": ((17, 30), "small", "albedo", "", 8),
    "normal_small": ((40, 19), "small", "normal", "", 8),
}


def write_case(folder, name, seed):
    size, layout, kind, guides, divisor = CASES[name]
    generator = torch.Generator().manual_seed(seed)
    normal = lambda *shape: torch.randn(shape, generator=generator, dtype=torch.float64)
    network = UNet(layout, GUIDES[guides], divisor).double()
    with torch.no_grad():
        for parameter in network.parameters():
            spread = 1.4 / math.sqrt(parameter[0].numel()) if parameter.dim() > 1 else 0.1
            parameter.copy_(spread * normal(*parameter.shape))
        last = getattr(network, network.decoders[0][-1][0])
        last.weight.mul_(0.2)
        last.bias.fill_(0.4)
    save(folder / f"{name}.model.safetensors", network, {"size": layout, "input": kind, "aux_inputs": guides, "width_divisor": str(divisor),
                                                         "license": "MIT", "data": f"random parameters, seed {seed}"})
    images = {"hdr": torch.exp(1.5 * normal(1, 3, *size)), "ldr": torch.rand(1, 3, *size, generator=generator, dtype=torch.float64)}
    images["albedo"] = images["ldr"] * 1.2 - 0.1
    images["normal"] = F.normalize(normal(1, 3, *size), dim=1)
    images = {key: value.float().double() for key, value in images.items()}
    network, _ = load(folder / f"{name}.model.safetensors")
    exposure = float(torch.tensor(binned_exposure(images["hdr"]))) if kind == "hdr" else 1.0
    given = [images[guide] for guide in guides.split(",") if guide]
    with torch.no_grad():
        output, raw = denoise(network, kind, images[kind], given, exposure)
    last = lambda image: image[0].permute(1, 2, 0).float().contiguous()
    tensors = {"colour": last(images[kind]), "exposure": torch.tensor([exposure]), "network": last(raw), "output": last(output)}
    tensors.update({guide: last(images[guide]) for guide in guides.split(",") if guide})
    save_file(tensors, folder / f"{name}.io.safetensors")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    target = parser.parse_args().folder
    target.mkdir(parents=True, exist_ok=True)
    for number, case in enumerate(CASES):
        write_case(target, case, 2900 + number)
