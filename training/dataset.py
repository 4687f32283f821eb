"""Scenes in memory and random crops of them, with what does not depend on the parameters computed once.

A scene folder holds sNNNN_gt.exr, sNNNN_auxK.exr and sNNNN_lrK.exr as training/README.md describes.
"""
import pathlib
import re

import torch

import images
import metrics
import pipeline

COLOUR_SPP = (64, 16)
AUX_TARGET_SPP = (16, 4, None)      # None: converged


def scenes_of(folder):
    """Sorted scene names in a folder of EXR files."""
    return sorted(path.name[:-len("_gt.exr")] for path in pathlib.Path(folder).glob("*_gt.exr"))


def finite(image):
    """Negative and non-finite radiance becomes 0."""
    return torch.nan_to_num(image, 0, 0, 0).clamp(min=0)


def sparsest_aux(folder, scene):
    """(samples per pixel K, path) of the scene's auxiliary render."""
    found = [(int(re.search(r"_aux(\d+)\.exr$", str(path)).group(1)), path)
             for path in pathlib.Path(folder).glob(f"{scene}_aux*.exr")]
    return max(found)


class Scenes:
    """All scenes of a folder as half-precision tensors.

    colour [S, spp, 3, h, w], target [S, 3, H, W], aux [S, variants, 6, H, W], log_weights [S, variants, 25, H, W] of the
    guided base, base_error [S] the mean squared sRGB error of that base.
    """

    def __init__(self, folder, config):
        self.scale = config.scale
        names = scenes_of(folder)
        rows = [self.read(pathlib.Path(folder), name, config) for name in names]
        self.colour, self.target, self.aux, self.log_weights, self.exposure, self.base_error = (
            torch.stack(column) for column in zip(*rows))

    def read(self, folder, name, config):
        target, albedo, normal = images.read_exr(folder / f"{name}_gt.exr", "colour", "albedo", "normal")
        colour = [finite(images.read_exr(folder / f"{name}_lr{spp}.exr", "colour")) for spp in COLOUR_SPP]
        spp, path = sparsest_aux(folder, name)
        converged = torch.cat([albedo, normal])
        noisy = torch.cat(images.read_exr(path, "albedo", "normal"))
        variants = []
        for wanted in AUX_TARGET_SPP:
            # The noise of K samples scaled by sqrt(K / wanted) has the variance of `wanted` samples.
            keep = 0.0 if wanted is None else min(1.0, (spp / wanted) ** 0.5)
            variants.append(torch.lerp(converged, noisy, keep))
        aux = pipeline.network_aux(torch.stack(variants), config)
        log_weights = torch.cat([pipeline.guided_log_weights(a[None, :3], a[None, 3:], self.scale) for a in aux])
        exposure = torch.tensor([pipeline.auto_exposure(c) for c in colour])
        base = pipeline.baseline(colour[0][None], aux[:1], config)[0]
        base_error = (metrics.srgb(base) - metrics.srgb(target)).square().mean()
        return (torch.stack(colour).half().clamp(max=6e4), finite(target).half().clamp(max=6e4), aux.half(), log_weights.half(),
                exposure, base_error)

    def __len__(self):
        return len(self.target)


def flip_axis(crop, axis):
    """Mirrors a crop (axis 1: upside down, 2: left to right); the normal's component along it changes sign."""
    flipped = {key: value.flip(axis + 1 if key == "log_weights" else axis) if value.ndim >= 3 else value
               for key, value in crop.items()}
    flipped["log_weights"] = flipped["log_weights"].flip(axis - 1)
    flipped["aux"] = flipped["aux"].clone()
    flipped["aux"][4 if axis == 1 else 3].neg_()
    return flipped


class Crops:
    """Endless random crops. One crop has `size` x `size` low-resolution pixels and a border of 2 for the kernels."""

    def __init__(self, scenes, size, seed):
        self.scenes, self.size = scenes, size
        self.random = torch.Generator().manual_seed(seed)

    def number(self):
        return torch.rand((), generator=self.random).item()

    def one(self):
        scenes, size, scale = self.scenes, self.size, self.scenes.scale
        pick = lambda count: min(int(self.number() * count), count - 1)
        s = pick(len(scenes))
        colour_variant = 0 if self.number() < 0.8 else 1
        aux_variant = 0 if (chance := self.number()) < 0.7 else 1 if chance < 0.85 else 2
        colour, aux = scenes.colour[s, colour_variant].float(), scenes.aux[s, aux_variant]
        h, w = colour.shape[-2:]
        y, x = pick(h - size + 1), pick(w - size + 1)
        high = lambda image: image[..., y * scale:(y + size) * scale, x * scale:(x + size) * scale].float()
        bordered = torch.nn.functional.pad(colour[None], (2, 2, 2, 2), mode="replicate")[0]
        albedo = torch.nn.functional.pad(pipeline.box_mean(aux[None, :3].float(), scale), (2, 2, 2, 2), mode="replicate")[0]
        low = lambda image: image[:, y:y + size + 4, x:x + size + 4]
        weights = high(scenes.log_weights[s, aux_variant]).view(5, 5, size * scale, size * scale)
        crop = {"colour": low(bordered), "albedo_mean": low(albedo), "aux": high(aux), "target": high(scenes.target[s]),
                "log_weights": weights}
        for axis in (1, 2):
            crop = flip_axis(crop, axis) if self.number() < 0.5 else crop
        order = torch.randperm(3, generator=self.random)
        for key in ("colour", "albedo_mean", "target"):
            crop[key] = crop[key][order]
        crop["aux"] = torch.cat([crop["aux"][:3][order], crop["aux"][3:]])
        crop["log_weights"] = crop["log_weights"].reshape(25, size * scale, size * scale)
        crop["exposure"] = scenes.exposure[s, colour_variant] * 2 ** (self.number() - 0.5)
        crop["base_error"] = scenes.base_error[s]
        return crop

    def batch(self, count):
        """{name: tensor [count, ...]}; colour and albedo_mean have the border."""
        crops = [self.one() for _ in range(count)]
        return {key: torch.stack([crop[key] for crop in crops]) for key in crops[0]}
