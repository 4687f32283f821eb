"""Metrics of baselines and models on a folder of scenes.

    python training/evaluate.py VAL_FOLDER --model models/xrds-x4-compact.safetensors --scale 4 --spp 64 --aux-spp 16

Prints, per image and in the mean: PSNR of the clamped sRGB image (dB), RelMSE, RelMSE without the worst 0.1 % of the
pixels, its median and its 99.9th percentile (metrics.py); FLIP with --flip. References are the *_gt.exr files; no exposure
is applied. "Average samples" is spp / scale^2 + aux spp. Models that take the full-resolution colour get the merged one
(pipeline.merged_colour) in the place of the low-resolution one; with --merge every method does.
"""
import argparse
import dataclasses
import pathlib
import re

import torch

import denoise
import images
import metrics
import pipeline
import weights
from network import NetworkConfig


@dataclasses.dataclass
class Case:
    """One scene: low-resolution colour [3, h, w], aux [15, H, W] albedo, normal, relative depth, diffuse and glossy light, or the first of them,
    full [3, H, W] the colour of the auxiliary render and merged [3, h, w] it with the low-resolution one (None and the colour itself for
    converged auxiliary images and at scale 1), reference [3, H, W]; clean: whether the auxiliary images are converged; is_denoised: whether
    the images were denoised."""
    name: str
    colour: torch.Tensor
    aux: torch.Tensor
    full: torch.Tensor | None
    merged: torch.Tensor
    reference: torch.Tensor
    clean: bool = False
    is_denoised: bool = False

    def denoised(self, scale):
        """The case with its images denoised by denoise.py, the colours merged before, auxiliary images only where they are not clean."""
        aux = self.aux if self.clean else denoise.denoised_guides(self.aux, range(9, len(self.aux), 3))
        full = None if self.full is None else denoise.denoised_full(self.full, self.merged, aux, scale)
        merged = denoise.denoised_low(self.merged, aux, scale)
        colour = merged if full is None else denoise.denoised_low(self.colour, aux, scale)
        return dataclasses.replace(self, colour=colour, aux=aux, full=full, merged=merged, is_denoised=True)


def prefix_of(scale):
    """How the names of low-resolution colours begin behind the scene's name."""
    return {1: "aux", 4: "lr"}.get(scale, f"x{scale}lr")


def scenes_with(folder, scale, spp, aux_spp):
    """[(name, path of the colour, of the auxiliary images, of the reference)] of the scenes that have these sample counts (0: converged)."""
    folder, found = pathlib.Path(folder), []
    for reference in sorted(folder.glob("*_gt.exr")):
        name = reference.name[:-len("_gt.exr")]
        path = folder / f"{name}_{prefix_of(scale)}{spp}.exr"
        aux = folder / f"{name}_aux{aux_spp}.exr" if aux_spp else reference
        if path.exists() and aux.exists():
            found.append((name, path, aux, reference))
    return found


def lacking(folder, scale, spp, aux_spp):
    """That scenes_with() finds none, as a sentence."""
    def counts(prefix):
        names = (re.fullmatch(rf".*_{prefix}(\d+)", path.stem) for path in pathlib.Path(folder).glob("*.exr"))
        return ", ".join(map(str, sorted({int(name[1]) for name in names if name}))) or "none"
    return (f"{folder} has no scene with {spp} spp colour and {aux_spp or 'converged'} spp aux at scale {scale}; "
            f"it has colour at {counts(prefix_of(scale))} and auxiliary images at {counts('aux')}")


def cases_of(folder, scale, spp, aux_spp):
    """Yields a Case for each scene that has the files.

    aux_spp: samples per pixel of the auxiliary render, 0 for the converged one. Colour of scale 1 is that of the auxiliary render.
    """
    for name, path, aux, reference in scenes_with(folder, scale, spp, aux_spp):
        colour = merged = images.read_exr(path, "colour")
        full = images.read_exr(aux, "colour") if aux_spp and scale > 1 else None
        if full is not None:
            merged = pipeline.merged_colour(colour, spp, full, aux_spp, scale)
        yield Case(name, colour, images.read_auxiliary(aux), full, merged, images.read_exr(reference, "colour"), not aux_spp)


def result_of(network, case, merge=False, device="cpu"):
    """Radiance [3, H, W] that a model makes of a case, of the merged colour if it takes the full-resolution one, too."""
    config = network.config
    if config.full and case.full is None:
        raise SystemExit(f"the model takes the full-resolution colour, which {case.name} lacks with converged auxiliary images")
    there = lambda image: None if image is None else image[None].to(device)
    aux = pipeline.own_aux(case.aux, config) if config.aux_inputs else None
    colour = case.merged if merge or config.full else case.colour
    result = pipeline.upscale(network, there(colour), there(aux), full=there(case.full))[0]
    if case.is_denoised:
        result = pipeline.restrained(result, there(colour), config)
    return result[0].cpu()


def methods_of(scale, model_paths, merge=False):
    """{name: function(case) -> radiance [3, H, W]}; merge: all of them of the merged colour."""
    def untrained(base):
        config = NetworkConfig(scale=scale, base=base)
        return lambda case: pipeline.baseline((case.merged if merge else case.colour)[None], case.aux[None], config)[0]

    def trained(path):
        network, _ = weights.load_model(path)
        if network.config.scale != scale:
            raise SystemExit(f"{path} has scale {network.config.scale}, --scale is {scale}")
        return lambda case: result_of(network, case, merge)

    methods = {base: untrained(base) for base in ("bicubic", "demodulated", "guided")}
    return {**methods, **{path.stem: trained(path) for path in model_paths}}


def measure(folder, scale, spp, aux_spp, methods, flip=False, denoise_first=False):
    """{method: {scene: metrics}}; denoise_first: of colours that Open Image Denoise has denoised."""
    if not scenes_with(folder, scale, spp, aux_spp):
        raise SystemExit(lacking(folder, scale, spp, aux_spp))
    results = {method: {} for method in methods}
    with torch.no_grad():
        for case in cases_of(folder, scale, spp, aux_spp):
            case = case.denoised(scale) if denoise_first else case
            for method, run in methods.items():
                result = run(case)
                results[method][case.name] = metrics.all_metrics(result, case.reference)
                if flip:
                    results[method][case.name]["flip"] = metrics.flip(result, case.reference)
    return results


def mean_of(rows):
    """Mean of every metric over scenes."""
    rows = list(rows)
    return {key: sum(row[key] for row in rows) / len(rows) for key in rows[0]}


def tables(results):
    """Markdown: PSNR and RelMSE per image, then the means of all metrics."""
    methods, scenes = list(results), list(next(iter(results.values())))
    lines = [f"| PSNR dB / RelMSE | {' | '.join(methods)} |", "|---" * (len(methods) + 1) + "|"]
    for scene in scenes:
        cells = [f"{results[m][scene]['psnr']:.2f} / {results[m][scene]['relmse']:.4f}" for m in methods]
        lines.append(f"| {scene} | {' | '.join(cells)} |")
    columns = {"psnr": ("PSNR dB", ".3f"), "relmse": ("RelMSE", ".4f"), "relmse_trimmed": ("trimmed", ".4f"),
               "relmse_median": ("median", ".6f"), "relmse_p999": ("99.9th percentile", ".3f"), "flip": ("FLIP", ".4f")}
    means = {method: mean_of(rows.values()) for method, rows in results.items()}
    shown = [key for key in columns if key in means[methods[0]]]
    lines += ["", f"| mean | {' | '.join(columns[key][0] for key in shown)} |", "|---" * (len(shown) + 1) + "|"]
    for method, mean in means.items():
        lines.append(f"| {method} | {' | '.join(format(mean[key], columns[key][1]) for key in shown)} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--model", type=pathlib.Path, action="append", default=[])
    parser.add_argument("--scale", type=int, default=4)
    parser.add_argument("--spp", type=int, default=64, help="of the low-resolution colour")
    parser.add_argument("--aux-spp", type=int, default=16, help="of albedo and normal; 0: converged")
    parser.add_argument("--merge", action="store_true", help="give every method the low-resolution colour merged with that of the auxiliary render")
    parser.add_argument("--denoise-first", action="store_true", help="all images denoised by Open Image Denoise before (pyoidn)")
    parser.add_argument("--flip", action="store_true", help="also FLIP (pip install flip-evaluator)")
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    if options.merge and (options.scale == 1 or not options.aux_spp):
        parser.error("--merge needs a scale above 1 and noisy auxiliary images")
    methods = methods_of(options.scale, options.model, options.merge)
    results = measure(options.folder, options.scale, options.spp, options.aux_spp, methods, options.flip, options.denoise_first)
    samples = options.spp / options.scale ** 2 + options.aux_spp
    print(f"{options.spp} spp colour{' merged with the full-resolution one' * options.merge}{', denoised first' * options.denoise_first}, {options.aux_spp or 'converged'} spp aux"
          + (f", average samples {samples:g}" if options.aux_spp else "") + "\n")
    print(tables(results))


if __name__ == "__main__":
    main()
