"""Random crops of scenes in memory, for training: drawn one by one, cut and varied a batch at a time.

A batch costs a device a few dozen kernels, whatever its size: each crop is a plain part of images that have their borders already
(dataset.Scene), and mirrors, turns, exchanged colours and tints are one gather and one product of small matrices for all of them.
"""
import dataclasses

import torch

import dataset
import pipeline
from dataset import BORDER


@dataclasses.dataclass
class Draw:
    """What one crop is cut from: keys of the scene's images, and how much of their noise is left of the auxiliary and the full-resolution one."""
    scene: dataset.Scene
    colour: tuple
    aux: tuple = None
    full: tuple = None
    share: float = 1.0


@dataclasses.dataclass
class Variation:
    """How the crops of a batch are varied; a mirror or transposition turns the normals along."""
    upside_down: torch.Tensor       # [n] of bool, as the next two
    mirrored: torch.Tensor
    transposed: torch.Tensor        # on the main diagonal, after the mirrors
    colours: torch.Tensor           # [n, 3, 3] permutations of red, green and blue
    tint: torch.Tensor              # [n, 3] of the light, after the permutation
    turns: torch.Tensor             # [n, 3, 3] rotations of the normals into other axes

    def normals(self):
        """[n, 3, 3]: rows run down and the normal's y points up, so that a transposition exchanges x and y and changes the sign of both."""
        signs = torch.ones(len(self.mirrored), 3)
        signs[:, 0] -= 2.0 * self.mirrored
        signs[:, 1] -= 2.0 * self.upside_down
        exchange = torch.tensor([[0.0, -1, 0], [-1, 0, 0], [0, 0, 1]])
        return self.turns @ torch.where(self.transposed[:, None, None], exchange, torch.eye(3)) @ torch.diag_embed(signs)

    def light(self):
        """[n, 3, 3]: what radiance is multiplied with."""
        return self.tint[:, :, None] * self.colours

    def auxiliary(self, inputs):
        """[n, A, A] for the auxiliary images of `inputs`, in that order."""
        own = {"albedo": self.colours, "normal": self.normals(), "diffuse": self.light(), "glossy": self.light()}
        found = torch.zeros(len(self.mirrored), 3 * len(inputs), 3 * len(inputs))
        for k, kind in enumerate(inputs):
            found[:, 3 * k:3 * k + 3, 3 * k:3 * k + 3] = own.get(kind, torch.eye(3))
        return found

    def places(self, height, width, device="cpu"):
        """[n, height * width] on the device: which pixel of a crop comes to each place of its varied one."""
        upside_down, mirrored, transposed = (coins.to(device)[:, None] for coins in (self.upside_down, self.mirrored, self.transposed))
        y, x = torch.arange(height, device=device), torch.arange(width, device=device)
        y = torch.where(upside_down, y.flip(0), y)
        x = torch.where(mirrored, x.flip(0), x)
        plain = y[:, :, None] * width + x[:, None, :]
        return torch.where(transposed[:, None], plain.transpose(1, 2), plain).flatten(1)


class Crops:
    """Endless random crops of `size` x `size` low-resolution pixels."""

    def __init__(self, scenes, size, seed, colour_shares=None, aux_shares=None, denoised_share=0.0):
        self.scenes, self.size, self.config, self.denoised_share = scenes, size, scenes.config, denoised_share
        if not colour_shares and self.config.scale not in dataset.COLOUR_SHARES:
            raise ValueError(f"--scale {self.config.scale} has no usual shares of the colour's samples: choose them with --colour-shares")
        self.colour_shares = colour_shares or dataset.COLOUR_SHARES[self.config.scale]
        self.aux_shares = aux_shares or (dataset.FULL_SHARES if self.config.full else dataset.AUX_SHARES)
        if self.config.full and 0 in self.aux_shares:
            raise ValueError("a model that takes the full-resolution colour cannot train on converged auxiliary images: their colour is the target")
        if denoised_share and self.config.guides[:2] != ("albedo", "normal"):
            raise ValueError("colours are denoised with albedo and normal, which must be the model's first auxiliary inputs")
        self.random = torch.Generator().manual_seed(seed)

    def number(self):
        return torch.rand((), generator=self.random).item()

    def pick(self, count):
        return min(int(self.number() * count), count - 1)

    def drawn(self, shares):
        """A key, as often as its share."""
        keys, values = list(shares), torch.tensor(list(shares.values()), dtype=torch.float)
        return keys[torch.multinomial(values, 1, generator=self.random).item()]

    def scene_and_render(self):
        """(scene, sample count of its auxiliary render, None of a model that does not take its colour). The noise of few samples is not made of
        that of more, which is too even and, cut off at 0, too bright: the scene is one whose own render has no more samples than the count."""
        scenes = self.scenes.scenes
        if not self.config.full:
            return scenes[self.pick(len(scenes))], None
        count = self.drawn(self.aux_shares)
        fitting = [scene for scene in scenes if min(scene.full) <= count] or scenes
        return fitting[self.pick(len(fitting))], count

    def draw(self):
        scene, count = self.scene_and_render()
        denoised = self.number() < self.denoised_share
        counts = scene.rendered if denoised else scene.colours      # a denoiser would see that the noise was scaled
        shares = {spp: share for spp, share in self.colour_shares.items() if spp in counts}
        spp = self.drawn(shares) if shares else max(counts)
        if self.config.full:
            if denoised and count in scene.full:
                return Draw(scene, scene.denoised_colour(spp, count), scene.denoised_aux(count), scene.denoised_full(spp, count))
            have, share = scene.nearest_full(count)
            return Draw(scene, scene.merged(spp, count), ("aux", have), ("full", have), share)
        if not self.config.aux_inputs:
            return Draw(scene, ("colour", spp))
        same = self.config.scale == 1 and self.number() < dataset.SAME_RENDER_SHARE
        count = spp if same else self.drawn(self.aux_shares)
        if denoised and count in scene.rendered_aux:
            return Draw(scene, scene.denoised_colour(spp, count), scene.denoised_aux(count))
        have, share = scene.nearest_aux(count)
        return Draw(scene, ("colour", spp), ("aux", have), share=share)

    def variation(self, count):
        coin = lambda share: torch.rand(count, generator=self.random) < share
        order = torch.rand(count, 3, generator=self.random).argsort(1)
        return Variation(coin(0.5), coin(0.5), coin(0.5), torch.eye(3)[order], torch.exp(0.15 * torch.randn(count, 3, generator=self.random)),
                         torch.where(coin(0.25)[:, None, None], random_rotations(count, self.random), torch.eye(3)))

    def batch(self, count):
        """{colour [n, 3, h + 4, w + 4], aux [n, A, s(h + 4), s(w + 4)] or absent, target [n, 3, sh, sw], clean (converged aux)
        [n, A, sh, sw] with aux_kernels, full [n, 3, s(h + 4), s(w + 4)] of models that take it, whose colour is merged with it,
        exposure [n], base_error [n]}, all float32 on the scenes' device."""
        draws, variation, config = [self.draw() for _ in range(count)], self.variation(count), self.config
        corners = [[self.pick(extent - 2 * BORDER - self.size + 1) for extent in draw.scene.bordered[draw.colour].shape[-2:]] for draw in draws]
        device, inner = draws[0].scene.target.device, slice(config.scale * BORDER, -config.scale * BORDER)
        there = lambda tensor: tensor.to(device, non_blocking=True)

        def cut(keys, scale):
            extent = scale * (self.size + 2 * BORDER)
            return torch.stack([draw.scene.bordered[key][:, scale * y:scale * y + extent, scale * x:scale * x + extent]
                                for draw, key, (y, x) in zip(draws, keys, corners)]).float()

        shares = torch.tensor([draw.share for draw in draws])
        def noisy(clean, keys):
            image = cut(keys, config.scale)
            return image if (shares == 1).all() else torch.lerp(clean, image, there(shares)[:, None, None, None])

        target = cut([("target",)] * count, config.scale)
        images = {"colour": cut([draw.colour for draw in draws], 1), "target": target[:, :, inner, inner]}
        if config.aux_inputs:
            clean = cut([("aux", 0)] * count, config.scale)
            images["aux"] = noisy(clean, [draw.aux for draw in draws])
            if config.aux_kernels:
                images["clean"] = clean[:, :, inner, inner]
        if config.full:
            images["full"] = noisy(target, [draw.full for draw in draws]).clamp(min=0)
        places = {shape: variation.places(*shape, device) for shape in {image.shape[-2:] for image in images.values()}}
        light, auxiliary = there(variation.light()), there(variation.auxiliary(config.guides)) if config.aux_inputs else None
        batch = {key: varied(image, places[image.shape[-2:]], light if len(image[0]) == 3 and key not in ("aux", "clean") else auxiliary)
                 for key, image in images.items()}
        exposures = [draw.scene.exposure(draw.colour) * 2 ** (self.number() - 0.5) for draw in draws]
        batch["exposure"] = there(torch.tensor(exposures))
        batch["base_error"] = there(torch.tensor([draw.scene.base_error for draw in draws]))
        return batch


def varied(image, places, matrices):
    """[n, c, h, w], its pixels taken from `places` [n, h * w], each multiplied with its crop's matrix [n, c, c]."""
    pixels = image.flatten(2).gather(2, places[:, None].expand(-1, image.shape[1], -1))
    return (matrices @ pixels).view(image.shape)


def random_rotations(count, generator):
    """Rotation matrices [n, 3, 3], uniform."""
    q, r = torch.linalg.qr(torch.randn(count, 3, 3, generator=generator))
    q = q * r.diagonal(dim1=1, dim2=2).sign()[:, None]
    return q * torch.linalg.det(q)[:, None, None]
