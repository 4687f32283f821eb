"""Runs a model in PyTorch on EXR files and writes the result, to compare with the engine's.

    python training/compare.py MODEL COLOUR.exr --aux AUX.exr --output result.exr [--reference engine.exr] [--double] [--merge 64 16]

With --reference: prints PSNR and RelMSE between the two, and the maximum and RMS difference over the reference's RMS, in the
transformed domain (log(1 + x) at the frame's exposure). --merge K_LOW K_FULL: merges the colour of AUX.exr into COLOUR.exr, whose samples a
pixel these are; a model that takes the full-resolution colour needs it.
"""
import argparse
import pathlib

import torch

import images
import metrics
import pipeline
import weights


def differences(result, reference, exposure):
    """(max, RMS) of the difference over the RMS of the reference, both in the transformed domain; images [3, H, W]."""
    x, y = (pipeline.transform(image.double() * exposure, "log1p") for image in (result, reference))
    rms = y.square().mean().sqrt()
    return ((x - y).abs().max() / rms).item(), ((x - y).square().mean().sqrt() / rms).item()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("colour", type=pathlib.Path)
    parser.add_argument("--aux", type=pathlib.Path, help="EXR with albedo, normal and what else the model takes, scale times the size")
    parser.add_argument("--output", type=pathlib.Path)
    parser.add_argument("--reference", type=pathlib.Path, help="EXR to compare with")
    parser.add_argument("--merge", type=float, nargs=2, metavar=("K_LOW", "K_FULL"), help="samples of the colour and of the auxiliary render")
    parser.add_argument("--exposure", type=float, help="automatic by default")
    parser.add_argument("--double", action="store_true", help="compute in double precision")
    options = parser.parse_args()
    torch.set_num_threads(1)
    dtype = torch.float64 if options.double else torch.float32
    network, _ = weights.load_model(options.model, dtype)
    config = network.config
    if (config.aux_inputs or options.merge) and not options.aux:
        parser.error(f"the model or --merge needs --aux with {', '.join(config.aux_inputs) or 'colour'}")
    if config.full and not options.merge:
        parser.error("the model needs --merge, the samples of both colours")
    colour, aux, full = images.read_exr(options.colour, "colour")[None].to(dtype), None, None
    if config.guides:
        aux = images.read_auxiliary(options.aux, config.guides)[None].to(dtype)
    if options.merge:
        full = images.read_exr(options.aux, "colour")[None].to(dtype)
        colour = pipeline.merged_colour(colour, options.merge[0], full, options.merge[1], config.scale)
    with torch.no_grad():
        result, _, exposure = pipeline.upscale(network, colour, aux, options.exposure, full)
    print(f"exposure {exposure:.6g}")
    if options.output:
        images.write_exr(options.output, result[0])
    if options.reference:
        reference = images.read_exr(options.reference, "colour")
        if reference.shape != result[0].shape:
            raise SystemExit(f"{options.reference} is {tuple(reference.shape[1:])}, the result is {tuple(result.shape[2:])}")
        worst, rms = differences(result[0], reference, exposure)
        numbers = metrics.all_metrics(result[0], reference)
        print(f"PSNR {numbers['psnr']:.2f} dB  RelMSE {numbers['relmse']:.3e}  max {worst:.3e}  RMS {rms:.3e}")


if __name__ == "__main__":
    main()
