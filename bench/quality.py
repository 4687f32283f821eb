"""Measures a model with the engine on a folder of validation renders, beside its baselines.

    python3 bench/quality.py build/release/cli/xrds VAL_FOLDER [--model NAME|FILE] [--precision fp16] [--colour lr64] [--aux aux16]

The folder holds sNNNN_gt.exr (reference), sNNNN_<colour>.exr and sNNNN_<aux>.exr. Prints PSNR (dB) and RelMSE of every
image and their means; the metrics are those of `xrds compare --help`. Needs nothing but the built program.
"""
import argparse
import collections
import pathlib
import subprocess
import tempfile


def measure(arguments, scene):
    """{method: (psnr, relMse, trimmedRelMse, flip)} as `xrds upscale --reference` prints them."""
    files = [scene.with_name(scene.name.replace("_gt", "_" + kind)) for kind in (arguments.colour, arguments.aux)]
    with tempfile.TemporaryDirectory() as folder:
        command = [arguments.program, "upscale", *files, "-o", pathlib.Path(folder) / "out.exr", "--reference", scene,
                   "--precision", arguments.precision]
        if arguments.model:
            command += ["--model", arguments.model]
        text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    table = text[text.index("against the reference"):].splitlines()[1:]
    return {line[:22].strip(): tuple(map(float, line[22:].split())) for line in table if line.strip()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--model")
    parser.add_argument("--precision", default="fp32")
    parser.add_argument("--colour", default="lr64")
    parser.add_argument("--aux", default="aux16")
    arguments = parser.parse_args()
    sums, scenes = collections.defaultdict(lambda: [0.0] * 4), sorted(arguments.folder.glob("*_gt.exr"))
    for scene in scenes:
        row = measure(arguments, scene)
        print(f"{scene.name[:5]}  " + "  ".join(f"{method} {values[0]:.3f} / {values[1]:.5f}" for method, values in row.items()))
        for method, values in row.items():
            sums[method] = [total + value for total, value in zip(sums[method], values)]
    print(f"\nmean of {len(scenes)} images    PSNR dB     RelMSE    trimmed     FLIP")
    for method, total in sums.items():
        print(f"{method:22} " + " ".join(f"{value / len(scenes):10.4f}" for value in total))


if __name__ == "__main__":
    main()
