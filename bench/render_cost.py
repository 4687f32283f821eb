"""What rendering costs in Cycles: processor seconds of the inputs of xrds and of a full-resolution image, scene by scene.

    blender -b --factory-startup -noaudio -P bench/render_cost.py -- --seeds 30000:30010 [--hdri DIR] [--models DIR] [--size 256]

Builds scenes of training/scenes and renders each: the low-resolution colour at 64 samples for scale 4, the albedo and normal at 16
samples (as a full render, and with no light bounces, which leaves them nearly the same where nothing is a mirror or glass), and full-resolution colour at
two sample counts, from whose difference follow the seconds a sample and those of a start. Prints Markdown.
"""
import os
import resource
import sys

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "training", "scenes")]
import render  # noqa: E402
from families import NAMES  # noqa: E402
import passes  # noqa: E402


def seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def cost(scene, side, samples, bounces=8):
    """Processor seconds of one render; the scene has been rendered before, so that nothing is built anew."""
    scene.cycles.max_bounces = bounces
    begin = seconds()
    passes.render(scene, side, side, samples, 1)
    return seconds() - begin


def main():
    ask = render.arguments()
    first, end = (int(part) for part in ask.seeds.split(":"))
    rows = []
    for seed in range(first, end):
        name = NAMES[seed % len(NAMES)]
        try:
            scene = render.compose(ask, seed, name)
        except LookupError:
            continue
        cost(scene, ask.size, 1)
        few, many = cost(scene, ask.size, 4), cost(scene, ask.size, 36)
        sample = (many - few) / 32
        rows.append((name, cost(scene, ask.size // 4, 64), cost(scene, ask.size, 16), cost(scene, ask.size, 16, 0), few - 4 * sample, sample))
    print("| scene | 64 spp at 1/16 of the pixels | aux, 16 spp, full paths | aux, 16 spp, no bounce | start of a render | one spp at full resolution |")
    print("|---|---|---|---|---|---|")
    for name, *values in [*rows, ("mean", *(sum(row[k] for row in rows) / len(rows) for k in range(1, 6)))]:
        print(f"| {name} | " + " | ".join(f"{value:.3f}" for value in values) + " |")


if __name__ == "__main__":
    main()
