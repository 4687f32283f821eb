"""Probes what a third auxiliary input would bring: the trainer with the same options, and --extra none, depth or deviation.

    python training/probe_inputs.py TRAIN_FOLDER --extra depth --validation VAL_FOLDER --output RUN_FOLDER --steps 700

TRAIN_FOLDER holds scenes as OpenEXR files, with depth. depth: d / (d + median of the image), noisy as the render is.
deviation: the standard deviation of albedo and of normal, of the noise that the image has (its difference from the
converged one, squared, mean of 3 x 3 pixels): more than any renderer can tell, an upper bound.
"""
import sys

import torch

import dataset
import evaluate
import images
import pipeline
import shards
import train

images.LAYERS["depth"] = ("Denoising Depth.{xyz}",)
EXTRA = sys.argv[sys.argv.index("--extra") + 1]


def depth_of(path):
    channels = images.channels_of(path)
    depth = torch.from_numpy(next(value for name, value in channels.items() if name.endswith("Depth.Z"))).clamp(0, 1e6)
    relative = depth / (depth + depth.median().clamp(min=1e-3))
    return torch.stack([relative, torch.zeros_like(depth), torch.zeros_like(depth)])


def deviation_of(aux, converged):
    """[3, H, W]: of albedo, of normal, 0."""
    square = (aux[:6].float() - converged[:6].float()).square().view(2, 3, *aux.shape[1:]).mean(1, keepdim=True)
    smooth = torch.nn.functional.avg_pool2d(torch.nn.functional.pad(square, (1, 1, 1, 1), mode="replicate"), 3, 1)[:, 0]
    return torch.cat([smooth.sqrt(), torch.zeros_like(smooth[:1])])


def aux_of(path, reference):
    """[9, H, W]: albedo, normal, the extra input."""
    aux = torch.cat(images.read_exr(path, "albedo", "normal"))
    if EXTRA == "depth":
        return torch.cat([aux, depth_of(path)])
    converged = torch.cat(images.read_exr(reference, "albedo", "normal"))
    return torch.cat([aux, deviation_of(aux, converged) if EXTRA == "deviation" else torch.zeros_like(aux[:3])])


def own_aux(image, config):
    parts = {"albedo": image[..., :3, :, :].clamp(0, pipeline.ALBEDO_MAX), "normal": image[..., 3:6, :, :], "extra": image[..., 6:, :, :]}
    return torch.cat([parts[kind] for kind in config.aux_inputs], -3)


def refresh(scenes):
    for folder in scenes.folders if not scenes.scenes else ():
        for reference in sorted(folder.glob("*_gt.exr")):
            name = reference.name.removesuffix("_gt.exr")
            kinds = shards.kinds_of(folder, name)
            decoded = {"target": images.read_exr(reference, "colour").clamp(0, 6e4).half(),
                       "aux": {0: aux_of(reference, reference).half()}, "colour": {}}
            for kind, path in kinds.items():
                if kind.startswith("aux"):
                    decoded["aux"][int(kind[3:])] = aux_of(path, reference).half()
                elif kind.startswith("lr"):
                    decoded["colour"][4, int(kind[2:])] = images.read_exr(path, "colour").clamp(0, 6e4).half()
            scenes.scenes.append(dataset.Scene(decoded, scenes.config, scenes.device))


noisy_aux = dataset.Scene.noisy_aux


def noisy_aux_and_deviation(scene, spp):
    aux = noisy_aux(scene, spp)
    if EXTRA == "deviation" and aux.shape[0] == 9:
        aux = torch.cat([aux[:6], deviation_of(aux, scene.aux[0]).half()])
    return aux


def cases_of(folder, scale, spp, aux_spp):
    for reference in sorted(folder.glob("*_gt.exr")):
        name = reference.name.removesuffix("_gt.exr")
        aux = folder / f"{name}_aux{aux_spp}.exr" if aux_spp else reference
        yield (name, images.read_exr(folder / f"{name}_lr{spp}.exr", "colour"), aux_of(aux, reference),
               images.read_exr(reference, "colour"))


pipeline.own_aux = own_aux
dataset.Scenes.refresh = refresh
dataset.Scene.noisy_aux = noisy_aux_and_deviation
evaluate.cases_of = cases_of
at = sys.argv.index("--extra")
del sys.argv[at:at + 2]
sys.argv += ["--aux", "albedo,normal" if EXTRA == "none" else "albedo,normal,extra"]
train.main()
