"""The type in which the network is trained: bfloat16 where the device is fast in it, float32 where it only emulates it.

A device says that it takes bfloat16 also where every product is made of float32 ones (CPUs without AVX-512 BF16 or AMX: six
times slower than float32), so both types are timed.
"""
import time

import torch

TYPES = {"float32": torch.float32, "bfloat16": torch.bfloat16}
ROUNDS = 3


def autocast(device, precision):
    """The context in which the network runs; its weights stay float32."""
    return torch.autocast(torch.device(device).type, TYPES[precision], enabled=precision != "float32")


def probe_seconds(device, precision):
    """Seconds of a 3 x 3 convolution and a linear layer, forward and backward, at the size of a training step of compact."""
    channels, side, batch = 32, 64, 2
    image = torch.ones(batch, channels, side, side, device=device).contiguous(memory_format=torch.channels_last)
    kernel = torch.ones(channels, channels, 3, 3, device=device, requires_grad=True)
    matrix = torch.ones(4 * channels, channels, device=device, requires_grad=True)

    def once():
        with autocast(device, precision):
            features = torch.nn.functional.conv2d(image, kernel, padding=1)
            result = torch.nn.functional.linear(features.permute(0, 2, 3, 1), matrix)
        result.float().sum().backward()
        if torch.device(device).type == "cuda":
            torch.cuda.synchronize(device)

    once()      # makes the kernels
    seconds = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        once()
        seconds.append(time.perf_counter() - begin)
    return min(seconds)


def choose(asked, device):
    """(precision, a line that says why): what was asked for, or of "auto" the faster one on the device."""
    if asked != "auto":
        return asked, f"training in {asked}, as asked"
    seconds = {precision: probe_seconds(device, precision) for precision in TYPES}
    chosen = min(seconds, key=seconds.get)
    times = ", ".join(f"{precision} {1000 * value:.1f} ms" for precision, value in seconds.items())
    return chosen, f"training in {chosen}: a probe takes {times} (--precision chooses another)"
