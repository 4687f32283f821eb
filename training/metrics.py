"""Image metrics between a result x and a reference y, both linear radiance [3, height, width] at the same exposure."""
import math

import torch


def srgb(x):
    """sRGB transfer function of values clamped to [0, 1]."""
    x = x.clamp(0, 1)
    return torch.where(x <= 0.0031308, 12.92 * x, 1.055 * x.clamp(min=0.0031308) ** (1 / 2.4) - 0.055)


def psnr(x, y):
    """10 log10(1 / MSE) of the clamped sRGB images, decibels."""
    return -10 * math.log10((srgb(x.double()) - srgb(y.double())).square().mean().item())


def relative_errors(x, y):
    """(x - y)^2 / (y^2 + 0.01), mean over channels: one number a pixel."""
    x, y = x.double(), y.double()
    return ((x - y).square() / (y.square() + 0.01)).mean(0).flatten()


def all_metrics(x, y):
    """{name: number}: PSNR, RelMSE, RelMSE without the worst 0.1 % of the pixels, its median and 99.9th percentile, as
    image/metrics/metrics.h defines them."""
    errors = relative_errors(x, y).sort().values
    count = errors.numel()
    kept = errors[:count - count // 1000]
    return {
        "psnr": psnr(x, y),
        "relmse": errors.mean().item(),
        "relmse_trimmed": kept.mean().item(),
        "relmse_median": (errors[(count - 1) // 2] + errors[count // 2]).item() / 2,
        "relmse_p999": kept[-1].item(),
    }


def flip(x, y):
    """Mean of NVIDIA's LDR-FLIP at 67 pixels a degree, of the clamped sRGB images; needs the package flip-evaluator."""
    import flip_evaluator
    image = lambda linear: srgb(linear.float()).permute(1, 2, 0).contiguous().numpy()
    return float(flip_evaluator.evaluate(image(y), image(x), "LDR", inputsRGB=True, applyMagma=False)[1])
