"""Scenes in memory; crops.py cuts batches from them."""
import concurrent.futures
import multiprocessing
import os
import pathlib

import torch

import denoise
import metrics
import pipeline
import shards

BORDER = 2      # low-resolution pixels around a crop, for the 5 x 5 kernels
LOW_RESOLUTION = ("colour", "merged", "denoised")      # kinds of images of a scene

# How often a sample count of the auxiliary images is drawn (0: converged), and of the colour by scale. Counts that a scene
# lacks are imitated by scaling the noise of one that it has.
AUX_SHARES = {16: 0.5, 8: 0.05, 4: 0.15, 2: 0.05, 1: 0.15, 0: 0.1}
FULL_SHARES = {1: 0.3, 2: 0.15, 4: 0.3, 8: 0.1, 16: 0.15}      # the auxiliary render's, of models that take its colour too
COLOUR_SHARES = {1: {1: 1, 2: 2, 4: 3, 8: 3, 16: 2}, 2: {16: 0.8, 4: 0.2}, 4: {64: 0.75, 16: 0.25}, 8: {64: 0.6, 256: 0.4}}


# At scale 1 colour and auxiliary images come from one render, so that their noise goes together; so often they do in training.
SAME_RENDER_SHARE = 0.85
IMITATED = (0.5, 2, 4)          # sample counts over that of a render that its noise, scaled, may stand for at scale 1

SCENES_A_PROCESS = 16           # fewer are decoded sooner than a further process has started
MOST_PROCESSES = 16


class Scene:
    """One scene at one scale, half precision: colours {spp: [3, h, w]}, aux {spp, 0 converged: [A, H, W]} without the colour,
    full {spp: [3, H, W]} the full-resolution noisy colour of the same renders, for models that take it, target [3, H, W];
    base_error: mean square sRGB error of the untrained base. At scale 1 the noise of the one colour is scaled to imitate more
    counts than were `rendered`, and `aux` has every count of the colour, not those of `rendered_aux` alone.

    They are the insides of `bordered` {("colour", spp), ("aux", spp), ("full", spp), ("target",): image}, whose images have
    BORDER low-resolution pixels around them, the outermost ones again, so that a crop of any place is a plain part of one.
    What is made of them as it is asked for (merged, denoised) is kept there, too."""

    def __init__(self, decoded, config, device):
        self.scale, self.first_lights, self.bordered, self.exposures = config.scale, config.first_lights, {}, {}
        colours = {spp: image for (s, spp), image in decoded["colour"].items() if s == self.scale}
        if self.scale == 8 and not colours:     # four pixels of scale 4 are one of scale 8, but for the pixel filter
            colours = {4 * spp: pipeline.box_mean(image[None].float(), 2)[0].half() for (s, spp), image in decoded["colour"].items() if s == 4}
        full = {spp: image for (s, spp), image in decoded["colour"].items() if s == 1 and config.full and spp in decoded["aux"]}
        put = lambda kind, images: {spp: self.put((kind, spp), image.to(device)) for spp, image in images.items()}
        self.target = self.put(("target",), decoded["target"].to(device))
        self.colours, self.full = put("colour", colours), put("full", full)
        self.aux = put("aux", {spp: pipeline.own_aux(image, config) for spp, image in decoded["aux"].items()})
        self.rendered, self.rendered_aux = set(self.colours), set(self.aux)
        if self.scale == 1 and self.colours:
            self.imitate_renders()
        if self.colours:
            most = max(self.colours)
            base = pipeline.baseline(self.colours[most].float()[None], self.noisy_aux(16)[None].float(), config, self.exposure(("colour", most)))[0]
            self.base_error = (metrics.srgb(base) - metrics.srgb(self.target.float())).square().mean().item()

    def put(self, key, image):
        """Keeps an image [c, h, w] of either resolution; returns it as the inside of the bordered one."""
        self.bordered[key] = with_border(image, self.border_of(key))
        return self.inside(key)

    def border_of(self, key):
        """Pixels around the image of a key of `bordered`."""
        return BORDER * (1 if key[0] in LOW_RESOLUTION else self.scale)

    def inside(self, key):
        border = self.border_of(key)
        return self.bordered[key][:, border:-border, border:-border]

    def once(self, key, make):
        """The key; its image is made where it is not there."""
        if key not in self.bordered:
            self.put(key, make().half().to(self.target.device))
        return key

    def exposure(self, key):
        """pipeline.auto_exposure of the image of a key."""
        if key not in self.exposures:
            self.exposures[key] = pipeline.auto_exposure(self.inside(key).float())
        return self.exposures[key]

    def imitate_renders(self):
        """Adds the counts that were not rendered, each with colour and auxiliary images of the one nearest render."""
        rendered = list(self.colours)
        for spp in COLOUR_SHARES[1].keys() - set(rendered):
            have, _ = nearest_render(rendered, spp)
            if spp / have in IMITATED:
                share = (have / spp) ** 0.5
                self.colours[spp] = self.put(("colour", spp), torch.lerp(self.target.float(), self.colours[have].float(), share).clamp(min=0).half())
                self.aux[spp] = self.put(("aux", spp), torch.lerp(self.aux[0].float(), self.aux[have].float(), share).half())

    def nearest_aux(self, spp):
        """(count, share): the auxiliary images whose noise, times the share, stands for that of `spp` samples (0: converged)."""
        return (spp, 1.0) if spp == 0 or spp in self.aux else nearest_render(self.aux, spp)

    def noisy_aux(self, spp):
        """[A, H, W] float32 at `spp` samples (0: converged): the render of the nearest count, its noise scaled by sqrt(have / spp)."""
        have, share = self.nearest_aux(spp)
        return torch.lerp(self.aux[0].float(), self.aux[have].float(), share)

    def nearest_full(self, spp):
        """(count, share) as nearest_aux, of the renders that have a colour: at most twice their noise."""
        return (spp, 1.0) if spp in self.full else nearest_render(self.full, spp)

    def noisy_full(self, spp):
        """(full [3, H, W] float32, samples) of the nearest render. `samples` is the count of as much noise, more than spp where the noise would
        be more than doubled."""
        have, share = self.nearest_full(spp)
        return torch.lerp(self.target.float(), self.full[have].float(), share).clamp(min=0), have / share ** 2

    def merged(self, spp, count):
        """Key of the low-resolution colour of spp samples merged with the full-resolution one of `count`."""
        def make():
            full, samples = self.noisy_full(count)
            return pipeline.merged_colour(self.colours[spp].float(), spp, full, samples, self.scale)
        return self.once(("merged", spp, count), make)

    def denoised_colour(self, spp, count):
        """Key of the low-resolution colour of spp samples, merged where the model takes the full-resolution one, as denoise.py makes it with the
        denoised_aux() of `count` samples (0: converged), which must be the scene's own."""
        return self.once(("denoised", spp, count), lambda: denoise.denoised_low(
            self.given_colour(spp, count), self.inside(self.denoised_aux(count)).float(), self.scale))

    def denoised_full(self, spp, count):
        """The same of the full-resolution colour [3, H, W]."""
        return self.once(("denoised full", spp, count), lambda: denoise.denoised_full(
            self.full[count].float(), self.given_colour(spp, count), self.inside(self.denoised_aux(count)).float(), self.scale))

    def denoised_aux(self, count):
        """Key of the auxiliary images [A, H, W] of a render, denoised; converged ones as they are."""
        return self.once(("denoised aux", count), lambda: denoise.denoised_guides(self.aux[count], self.first_lights)) if count else ("aux", 0)

    def given_colour(self, spp, count):
        """Low-resolution colour [3, h, w] float32 of spp samples, merged with that of `count` where the model takes it."""
        return self.inside(self.merged(spp, count) if count in self.full else ("colour", spp)).float()


def with_border(image, border):
    """[c, h, w] -> [c, h + 2 border, w + 2 border]: the outermost low-resolution pixels again, blocks of border / BORDER pixels a side."""
    block = border // BORDER
    def places(extent):
        pixels = torch.arange(-BORDER, extent // block + BORDER, device=image.device).clamp(0, extent // block - 1)
        return (pixels[:, None] * block + torch.arange(block, device=image.device)).flatten()
    return image[:, places(image.shape[1])][:, :, places(image.shape[2])]


def nearest_render(counts, spp):
    """(have, share): the count, but 0, whose noise stands for that of spp samples, the next fewer one if there is one, and the factor of it."""
    fewer = [have for have in counts if 0 < have < spp]
    have = max(fewer) if fewer else min(have for have in counts if have)
    return have, min(2.0, (have / spp) ** 0.5)


def usable_cores():
    """Cores that this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()


def converted(decoded, change):
    """A decoded scene, each image of it changed."""
    return {"target": change(decoded["target"]),
            **{kind: {key: change(image) for key, image in decoded[kind].items()} for kind in ("colour", "aux")}}


def decoded_arrays(path, name):
    """A scene of a shard as numpy arrays, which another process can return (tensors would share memory, and a file descriptor each)."""
    ((_, decoded),) = shards.read_shard(path, [name])
    return converted(decoded, lambda image: image.numpy())


def decoded_scenes(paths, processes):
    """Yields ((path, scene name), decoded scene) of shards, in this order, whatever the number of processes. These decode ahead, a scene at
    a time; few scenes are decoded in this process, as they are with one."""
    origins = [(path, name) for path in paths for name in sorted(shards.scenes_in(path))]
    processes = min(processes, MOST_PROCESSES, len(origins) // SCENES_A_PROCESS)
    if processes < 2:
        for origin in origins:
            yield origin, converted(decoded_arrays(*origin), torch.from_numpy)
        return
    # A forked process would inherit the threads' locks and the device.
    with concurrent.futures.ProcessPoolExecutor(processes, multiprocessing.get_context("spawn"), torch.set_num_threads, (1,)) as pool:
        for origin, arrays in zip(origins, pool.map(decoded_arrays, *zip(*origins))):
            yield origin, converted(arrays, torch.from_numpy)


class Scenes:
    """The scenes of shard folders that have colour of the model's scale and its auxiliary images, the full-resolution colour too if the
    model takes it; refresh() adds those of new shards. Up to `processes` processes decode them, by default one a core: a script that
    makes one needs the guard of its main module (`if __name__ == "__main__"`). Each scene's `origin` is (path of its shard, name)."""

    def __init__(self, folders, config, device="cpu", processes=None):
        self.folders, self.config, self.device = [pathlib.Path(folder) for folder in folders], config, device
        self.processes = processes or usable_cores()
        self.scenes, self.read = [], set()
        self.refresh()

    def refresh(self):
        paths = [path for path in sorted(path for folder in self.folders for path in folder.glob("*.npz")) if path not in self.read]
        self.read.update(paths)
        for origin, decoded in decoded_scenes(paths, self.processes):
            if any(len(aux) < pipeline.channels_for(self.config) for aux in decoded["aux"].values()):
                continue
            scene = Scene(decoded, self.config, self.device)
            if scene.colours and (scene.full or not self.config.full):
                scene.origin = origin
                self.scenes.append(scene)

    def __len__(self):
        return len(self.scenes)
