"""Metrics of baselines and models on a folder of scenes.

    python training/evaluate.py VAL_FOLDER --model models/xrds-x4-compact.safetensors --scale 4 --spp 64 --aux-spp 16

Prints, per image and in the mean: PSNR of the clamped sRGB image (dB), RelMSE, RelMSE without the worst 0.1 % of the
pixels, its median and its 99.9th percentile (metrics.py); FLIP with --flip. References are the *_gt.exr files; no exposure
is applied. "Average samples" is spp / scale^2 + aux spp.
"""
import argparse
import pathlib

import torch

import images
import metrics
import pipeline
import weights
from network import NetworkConfig


def cases_of(folder, scale, spp, aux_spp):
    """Yields (name, colour [3, h, w], aux [9, H, W], reference [3, H, W]) for the scenes that have the files; aux holds albedo,
    normal and relative depth, [6, H, W] where the file has no depth.

    aux_spp: samples per pixel of the auxiliary render, 0 for the converged one. Colour of scale 1 is that of the auxiliary render.
    """
    folder = pathlib.Path(folder)
    prefix = {1: "aux", 4: "lr"}.get(scale, f"x{scale}lr")
    for reference in sorted(folder.glob("*_gt.exr")):
        name = reference.name[:-len("_gt.exr")]
        colour = folder / f"{name}_{prefix}{spp}.exr"
        aux = folder / f"{name}_aux{aux_spp}.exr" if aux_spp else reference
        if colour.exists() and aux.exists():
            yield (name, images.read_exr(colour, "colour"), images.read_auxiliary(aux),
                   images.read_exr(reference, "colour"))


def methods_of(scale, model_paths):
    """{name: function(colour [1, 3, h, w], aux [1, 6 or 9, H, W]) -> radiance [1, 3, H, W]}"""
    def untrained(base):
        config = NetworkConfig(scale=scale, base=base)
        return lambda colour, aux: pipeline.baseline(colour, aux, config)

    def trained(path):
        network, _ = weights.load_model(path)
        if network.config.scale != scale:
            raise SystemExit(f"{path} has scale {network.config.scale}, --scale is {scale}")
        def run(colour, aux):
            own = pipeline.own_aux(aux, network.config) if network.config.aux_inputs else None
            return pipeline.upscale(network, colour, own)[0]
        return run

    methods = {base: untrained(base) for base in ("bicubic", "demodulated", "guided")}
    return {**methods, **{path.stem: trained(path) for path in model_paths}}


def measure(folder, scale, spp, aux_spp, methods, flip=False):
    """{method: {scene: metrics}}"""
    results = {method: {} for method in methods}
    with torch.no_grad():
        for name, colour, aux, reference in cases_of(folder, scale, spp, aux_spp):
            for method, run in methods.items():
                result = run(colour[None], aux[None])[0]
                results[method][name] = metrics.all_metrics(result, reference)
                if flip:
                    results[method][name]["flip"] = metrics.flip(result, reference)
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
    parser.add_argument("--flip", action="store_true", help="also FLIP (pip install flip-evaluator)")
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    results = measure(options.folder, options.scale, options.spp, options.aux_spp, methods_of(options.scale, options.model), options.flip)
    if not results["bicubic"]:
        raise SystemExit(f"{options.folder} has no scenes with {options.spp} spp colour and {options.aux_spp} spp aux at scale {options.scale}")
    samples = options.spp / options.scale ** 2 + options.aux_spp
    print(f"{options.spp} spp colour, {options.aux_spp or 'converged'} spp aux"
          + (f", average samples {samples:g}" if options.aux_spp else "") + "\n")
    print(tables(results))


if __name__ == "__main__":
    main()
