"""Scenes in memory and random crops of them."""
import pathlib

import torch

import denoise
import metrics
import pipeline
import shards

BORDER = 2      # low-resolution pixels around a crop, for the 5 x 5 kernels

# How often a sample count of the auxiliary images is drawn (0: converged), and of the colour by scale. Counts that a scene
# lacks are imitated by scaling the noise of one that it has.
AUX_SHARES = {16: 0.5, 8: 0.05, 4: 0.15, 2: 0.05, 1: 0.15, 0: 0.1}
FULL_SHARES = {1: 0.3, 2: 0.15, 4: 0.3, 8: 0.1, 16: 0.15}      # the auxiliary render's, of models that take its colour too
COLOUR_SHARES = {1: {1: 1, 2: 2, 4: 3, 8: 3, 16: 2}, 2: {16: 0.8, 4: 0.2}, 4: {64: 0.75, 16: 0.25}, 8: {64: 0.6, 256: 0.4}}


# At scale 1 colour and auxiliary images come from one render, so that their noise goes together; so often they do in training.
SAME_RENDER_SHARE = 0.85
IMITATED = (0.5, 1, 2, 4)       # sample counts over that of a render that its noise, scaled, may stand for at scale 1


class Scene:
    """One scene at one scale, half precision: colours {spp: [3, h, w]}, aux {spp, 0 converged: [A, H, W]} without the colour,
    full {spp: [3, H, W]} the full-resolution noisy colour of the same renders, for models that take it, target [3, H, W];
    exposure {spp: number}; base_error: mean square sRGB error of the untrained base. At scale 1 the noise of the one colour
    is scaled to imitate more counts, and `aux` has every count of the colour."""

    def __init__(self, decoded, config, device):
        scale = config.scale
        self.colours = {spp: image.to(device) for (s, spp), image in decoded["colour"].items() if s == scale}
        if scale == 8 and not self.colours:     # four pixels of scale 4 are one of scale 8, but for the pixel filter
            self.colours = {4 * spp: pipeline.box_mean(image[None].float(), 2)[0].half().to(device)
                            for (s, spp), image in decoded["colour"].items() if s == 4}
        self.target = decoded["target"].to(device)
        self.first_lights = config.first_lights
        self.aux = {spp: pipeline.own_aux(image, config).to(device) for spp, image in decoded["aux"].items()}
        self.full = {spp: image.to(device) for (s, spp), image in decoded["colour"].items() if s == 1 and config.full and spp in self.aux}
        self.denoised = {}      # what Open Image Denoise made of images, as they are asked for
        if scale == 1:
            self.imitate_renders()
        self.exposure = {spp: pipeline.auto_exposure(image.float()) for spp, image in self.colours.items()}
        if self.colours:
            most = max(self.colours)
            base = pipeline.baseline(self.colours[most].float()[None], self.noisy_aux(16)[None].float(), config, self.exposure[most])[0]
            self.base_error = (metrics.srgb(base) - metrics.srgb(self.target.float())).square().mean().item()

    def imitate_renders(self):
        for have, colour in list(self.colours.items()):
            for spp in {int(have * factor) for factor in IMITATED} & set(COLOUR_SHARES[1]):
                share = (have / spp) ** 0.5
                self.colours[spp] = torch.lerp(self.target.float(), colour.float(), share).clamp(min=0).half()
                self.aux[spp] = torch.lerp(self.aux[0].float(), self.aux[have].float(), share).half()

    def noisy_aux(self, spp):
        """[A, H, W] at `spp` samples (0: converged): the render of the nearest count, its noise scaled by sqrt(have / spp)."""
        if spp == 0 or spp in self.aux:
            return self.aux[spp]
        have, share = nearest_render(self.aux, spp)
        return torch.lerp(self.aux[0].float(), self.aux[have].float(), share).half()

    def noisy_render(self, spp):
        """(aux [A, H, W], full [3, H, W], samples) of one render, its noise scaled like noisy_aux's: that of the nearest count that has a
        colour. `samples` is the count of as much noise, more than spp where the noise would be more than doubled."""
        if spp in self.full:
            return self.aux[spp], self.full[spp], spp
        have, share = nearest_render(self.full, spp)
        aux = torch.lerp(self.aux[0].float(), self.aux[have].float(), share)
        full = torch.lerp(self.target.float(), self.full[have].float(), share).clamp(min=0)
        return aux, full, have / share ** 2

    def denoised_colour(self, spp, count, scale):
        """Low-resolution colour [3, h, w] of spp samples, merged where the model takes the full-resolution one, as denoise.py makes it with the
        denoised_aux() of `count` samples (0: converged), which must be the scene's own."""
        return self.denoised_once((spp, count), lambda: denoise.denoised_low(self.given_colour(spp, count, scale), self.denoised_aux(count), scale))

    def denoised_full(self, spp, count, scale):
        """The same of the full-resolution colour [3, H, W]."""
        return self.denoised_once((spp, count, "full"), lambda: denoise.denoised_full(
            self.full[count].float(), self.given_colour(spp, count, scale), self.denoised_aux(count), scale))

    def denoised_aux(self, count):
        """The auxiliary images [A, H, W] of a render, denoised; converged ones as they are."""
        return self.denoised_once(count, lambda: denoise.denoised_guides(self.aux[count], self.first_lights)) if count else self.aux[0].float()

    def given_colour(self, spp, count, scale):
        """Low-resolution colour [3, h, w] of spp samples, merged with that of `count` where the model takes it."""
        colour = self.colours[spp].float()
        return pipeline.merged_colour(colour, spp, self.full[count].float(), count, scale) if count in self.full else colour

    def denoised_once(self, key, make):
        if key not in self.denoised:
            self.denoised[key] = make().half()
        return self.denoised[key].float()


def nearest_render(counts, spp):
    """(have, share): the count, but 0, whose noise stands for that of spp samples, the next fewer one if there is one, and the factor of it."""
    fewer = [have for have in counts if 0 < have < spp]
    have = max(fewer) if fewer else min(have for have in counts if have)
    return have, min(2.0, (have / spp) ** 0.5)


class Scenes:
    """The scenes of shard folders that have colour of the model's scale and its auxiliary images, the full-resolution colour too if the
    model takes it; refresh() adds those of new shards."""

    def __init__(self, folders, config, device="cpu"):
        self.folders, self.config, self.device = [pathlib.Path(folder) for folder in folders], config, device
        self.scenes, self.read = [], set()
        self.refresh()

    def refresh(self):
        for path in sorted(path for folder in self.folders for path in folder.glob("*.npz")):
            if path not in self.read:
                self.read.add(path)
                for _, decoded in shards.read_shard(path):
                    if any(len(aux) < pipeline.channels_for(self.config) for aux in decoded["aux"].values()):
                        continue
                    scene = Scene(decoded, self.config, self.device)
                    if scene.colours and (scene.full or not self.config.full):
                        self.scenes.append(scene)

    def __len__(self):
        return len(self.scenes)


def cut(image, y, x, size, border, scale):
    """[c, h * scale, w * scale] -> size + 2 border low-resolution pixels from (y - border, x - border); outside of the image its
    outermost low-resolution pixels are repeated."""
    height, width = image.shape[-2] // scale, image.shape[-1] // scale
    top, left, bottom, right = y - border, x - border, y + size + border, x + size + border
    if top >= 0 and left >= 0 and bottom <= height and right <= width:
        return image[:, top * scale:bottom * scale, left * scale:right * scale]
    inside = torch.arange(scale, device=image.device)
    def places(first, end, count):
        pixels = torch.arange(first, end, device=image.device).clamp(0, count - 1)
        return (pixels[:, None] * scale + inside).flatten()
    return image[:, places(top, bottom, height)][:, :, places(left, right, width)]


def aux_images(crop):
    """The images of a crop that hold auxiliary channels."""
    return [crop[key] for key in ("aux", "clean") if key in crop]


def mirror(crop, axis, normal):
    """Mirrors a crop (axis 1: upside down, 2: left to right); the normal's component along it changes sign."""
    crop = {key: value.flip(axis) for key, value in crop.items()}
    for aux in aux_images(crop) if normal is not None else ():
        aux[normal + (1 if axis == 1 else 0)].neg_()
    return crop


def transpose(crop, normal):
    """Mirrors a crop on its main diagonal: rows run down, the normal's y points up."""
    crop = {key: value.transpose(1, 2).clone() for key, value in crop.items()}
    for aux in aux_images(crop) if normal is not None else ():
        aux[normal:normal + 2] = -aux[normal:normal + 2].flip(0)
    return crop


def random_rotation(generator):
    """A rotation matrix [3, 3], uniform."""
    q, r = torch.linalg.qr(torch.randn(3, 3, generator=generator))
    q = q * r.diagonal().sign()
    return q * q.det()


class Crops:
    """Endless random crops of `size` x `size` low-resolution pixels."""

    def __init__(self, scenes, size, seed, colour_shares=None, aux_shares=None, denoised_share=0.0):
        self.scenes, self.size, self.config, self.denoised_share = scenes, size, scenes.config, denoised_share
        self.colour_shares = colour_shares or COLOUR_SHARES[self.config.scale]
        self.aux_shares = aux_shares or (FULL_SHARES if self.config.full else AUX_SHARES)
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

    def one(self):
        (scene, count), size, scale = self.scene_and_render(), self.size, self.config.scale
        shares = {spp: share for spp, share in self.colour_shares.items() if spp in scene.colours}
        spp = self.drawn(shares) if shares else max(scene.colours)
        colour, exposure = scene.colours[spp], scene.exposure[spp]
        y, x = (self.pick(extent - size + 1) for extent in colour.shape[-2:])
        high = {"target": (scene.target, 0)}        # images of full resolution and their borders
        if self.config.full:
            aux, full, samples = scene.noisy_render(count)
            if self.number() < self.denoised_share and count in scene.full:
                colour, full, aux = scene.denoised_colour(spp, count, scale), scene.denoised_full(spp, count, scale), scene.denoised_aux(count)
            else:
                colour = pipeline.merged_colour(colour.float(), spp, full.float(), samples, scale)
            exposure = pipeline.auto_exposure(colour)
            high.update(aux=(aux, BORDER), full=(full, BORDER))
        elif self.config.aux_inputs:
            same = scale == 1 and self.number() < SAME_RENDER_SHARE
            count = spp if same else self.drawn(self.aux_shares)
            aux = scene.noisy_aux(count)
            if self.denoised_share and count in scene.aux and self.number() < self.denoised_share:
                colour, aux = scene.denoised_colour(spp, count, scale), scene.denoised_aux(count)
                exposure = pipeline.auto_exposure(colour)
            high["aux"] = aux, BORDER
        if self.config.aux_kernels:
            high["clean"] = scene.aux[0], 0
        crop = {"colour": cut(colour, y, x, size, BORDER, 1), **{key: cut(image, y, x, size, border, scale) for key, (image, border) in high.items()}}
        crop = self.varied({key: image.float() for key, image in crop.items()})
        crop["exposure"] = torch.tensor(exposure * 2 ** (self.number() - 0.5), device=colour.device)
        crop["base_error"] = torch.tensor(scene.base_error, device=colour.device)
        return crop

    def varied(self, crop):
        """Mirrored, turned, its colours exchanged, the light tinted, and in a quarter the normals in other axes than the camera's."""
        first = {kind: 3 * k for k, kind in enumerate(self.config.guides)}
        for axis in (1, 2):
            crop = mirror(crop, axis, first.get("normal")) if self.number() < 0.5 else crop
        crop = transpose(crop, first.get("normal")) if self.number() < 0.5 else crop
        order = torch.randperm(3, generator=self.random).to(crop["colour"].device)
        tint = torch.exp(0.15 * torch.randn(3, 1, 1, generator=self.random)).to(crop["colour"])
        for key in {"colour", "target", "full"} & crop.keys():
            crop[key] = crop[key][order] * tint
        turn = random_rotation(self.random).to(crop["colour"]) if "normal" in first and self.number() < 0.25 else None
        for aux in aux_images(crop):
            if "albedo" in first:
                at = slice(first["albedo"], first["albedo"] + 3)
                aux[at] = aux[at][order]
            for light in self.config.first_lights:
                aux[light:light + 3] = aux[light:light + 3][order] * tint
            if turn is not None:
                at = slice(first["normal"], first["normal"] + 3)
                aux[at] = torch.einsum("ij,jyx->iyx", turn, aux[at])
        return crop

    def batch(self, count):
        """{colour [n, 3, h + 4, w + 4], aux [n, A, s(h + 4), s(w + 4)] or absent, target [n, 3, sh, sw], clean (converged aux)
        [n, A, sh, sw] with aux_kernels, full [n, 3, s(h + 4), s(w + 4)] of models that take it, whose colour is merged with it,
        exposure [n], base_error [n]}"""
        crops = [self.one() for _ in range(count)]
        return {key: torch.stack([crop[key] for crop in crops]) for key in crops[0]}
