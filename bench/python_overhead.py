"""What a frame costs in Python over the C++ API: pairs in alternation.

    PYTHONPATH=build/release/python .venv/bin/python bench/python_overhead.py build/release/bench/xrds_frame_seconds

Options: --model xrds-x4-nano --size 256 (low-resolution pixels to a side) --pairs 40. Prints the medians, the median of
the ratios with the quartiles of it, and the seconds of Python alone: the same call with the frame itself left out.
"""
import argparse
import statistics
import subprocess
import time

import numpy

import xrds


def arguments():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--model", default="xrds-x4-nano")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--pairs", type=int, default=40)
    return parser.parse_args()


def seconds(action):
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


class Nothing:
    """In the place of the native upscaler: takes what it takes."""

    def run(self, colour, auxiliary, output, progress):
        pass


def main():
    options = arguments()
    size = options.size
    model = xrds.Model(options.model)
    upscaler = xrds.Upscaler(size, size, model, tune="never")
    random = numpy.random.default_rng(1)
    colour = random.random((size, size, 3), numpy.float32)
    full = random.random((size * model.scale, size * model.scale, 3), numpy.float32)
    images = {name: full for name in model.inputs}
    command = [options.program, options.model, str(size), str(size)]
    pairs = []
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1) as program:
        for pair in range(options.pairs + 2):
            def native():
                program.stdin.write("\n")
                return float(program.stdout.readline())

            first = native() if pair % 2 else None
            python = seconds(lambda: upscaler(colour, **images))
            pairs.append((first or native(), python))
        program.stdin.close()
    pairs = pairs[2:]
    ratios = sorted(python / native for native, python in pairs)
    quartiles = statistics.quantiles(ratios, n=4)
    upscaler._native = Nothing()
    alone = statistics.median(seconds(lambda: upscaler(colour, **images)) for _ in range(200))
    native, python = (statistics.median(times) for times in zip(*pairs))
    side = size * model.scale
    print(f"{options.model}, {side} x {side}, {len(pairs)} pairs: C++ {1000 * native:.1f} ms, Python {1000 * python:.1f} ms, "
          f"ratio {quartiles[1]:.4f} (quartiles {quartiles[0]:.4f} and {quartiles[2]:.4f}); "
          f"Python alone {1e6 * alone:.0f} us, {100 * alone / native:.3f} % of the frame")


if __name__ == "__main__":
    main()
