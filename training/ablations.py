"""Trains small variants of the compact model with equal budgets and tabulates them: the paper's ablations.

    python training/ablations.py SHARD_FOLDER... --validation VAL_FOLDER --output FOLDER [--steps 1500] [--seeds 2] [--parallel 2] [--only NAME ...]

Every run is a folder of its own that train.py resumes; finished ones are not run again. Afterwards a Markdown table is printed:
mean PSNR and RelMSE on the validation folder (64 spp colour, 16 spp aux, averaged weights), one column a seed, the
multiply-accumulates for 1024 x 1024, and the spread. --table prints it without training.
"""
import argparse
import concurrent.futures
import pathlib
import re
import statistics
import subprocess
import sys

import torch

import arguments
from arguments import number
from cost import multiply_accumulates

# Of the full-resolution render, alike for both of table 6.
LAYERS = ["--aux-kernels", "5", "--aux-shares", "1:0.35,2:0.15,4:0.25,8:0.1,16:0.15"]
# name: (what it belongs to, flags of train.py beside the compact defaults)
VARIANTS = {
    "compact": ("all", []),
    "none": ("table 5, auxiliary inputs", ["--aux", "", "--base", "bicubic", "--kernels", "0", "--aux-skip", "0"]),
    "normal": ("table 5", ["--aux", "normal", "--base", "bicubic", "--kernels", "0"]),
    "albedo": ("table 5", ["--aux", "albedo"]),
    "plain-both": ("table 5, the paper's form", ["--kernels", "0", "--aux-skip", "0", "--base", "none"]),
    "plain-albedo": ("table 5, the paper's form", ["--aux", "albedo", "--kernels", "0", "--aux-skip", "0", "--base", "none"]),
    "plain-normal": ("table 5, the paper's form", ["--aux", "normal", "--kernels", "0", "--aux-skip", "0", "--base", "none"]),
    "plain-none": ("table 5, the paper's form", ["--aux", "", "--kernels", "0", "--aux-skip", "0", "--base", "none"]),
    "fast": ("table 6, layers of the full-resolution render", LAYERS),
    "full": ("table 6, its colour, too", ["--aux", "albedo,normal,colour", "--colour-kernels", "5", *LAYERS]),
    "rdb": ("table 8, blocks", ["--block", "rdb", "--cross", "concat"]),
    "rstb": ("table 8", ["--block", "rstb", "--cross", "concat"]),
    "rdst": ("table 8", ["--cross", "concat"]),
    "blocks-2": ("table 9, RDST a group", ["--blocks", "2"]),
    "blocks-3": ("table 9", ["--blocks", "3"]),
    "groups-1": ("table 10, XDG", ["--groups", "1"]),
    "groups-2": ("table 10", ["--groups", "2"]),
    "smape-alone": ("table of losses", ["--smape", "--tone", "0", "--ratio", "0"]),
    "robust-alone": ("table of losses", ["--tone", "0", "--ratio", "0"]),
    "residual-alone": ("our fields", ["--kernels", "0"]),
    "no-skip": ("our fields", ["--aux-skip", "0"]),
    "aux-kernels": ("our fields", ["--aux-kernels", "5"]),
    "output-1": ("our fields", ["--groups", "1", "--output-side", "1"]),
    "wide-crops": ("our fields", ["--crop", "48", "--batch", "2"]),
}


def arguments_of_command_line():
    parser = arguments.Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("train", nargs="+")
    parser.add_argument("--validation", type=arguments.folder, required=True)
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--steps", type=number(int, 1), default=1500)
    parser.add_argument("--seeds", type=number(int, 1), default=2)
    parser.add_argument("--parallel", type=number(int, 1), default=2, help="runs at a time, a thread each")
    parser.add_argument("--only", nargs="*", choices=VARIANTS, default=list(VARIANTS))
    parser.add_argument("--table", action="store_true", help="only print the table")
    return parser.parse_args()


def folder_of(options, name, seed):
    return options.output / f"{name}-{seed}"


def result_of(folder):
    """(PSNR, RelMSE) of the last validation of a finished run, or None."""
    log = folder / "log.txt"
    lines = log.read_text().splitlines() if log.exists() else []
    found = re.search(r"validation  PSNR ([\d.]+)  RelMSE ([\d.]+)", lines[-1]) if lines and (folder / "finished").exists() else None
    return found and (float(found[1]), float(found[2]))


def run(options, name, seed):
    folder = folder_of(options, name, seed)
    if result_of(folder):
        return
    command = [sys.executable, str(pathlib.Path(__file__).with_name("train.py")), *options.train, "--validation", str(options.validation),
               "--output", str(folder), "--steps", str(options.steps), "--seed", str(seed), "--evaluate-every", "1000", "--warm-up", "100", *VARIANTS[name][1]]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    (folder / "finished").touch()
    print(f"{name}, seed {seed}: PSNR {result_of(folder)[0]:.3f}", flush=True)


def table(options):
    """Markdown rows of what is finished."""
    lines = ["| variant | belongs to | G MACs | PSNR dB by seed | mean | spread | RelMSE |", "|---|---|---|---|---|---|---|"]
    for name in options.only:
        folders = [folder for seed in range(1, options.seeds + 1) if result_of(folder := folder_of(options, name, seed))]
        if not folders:
            continue
        psnr, relmse = zip(*(result_of(folder) for folder in folders))
        config = torch.load(folders[0] / "checkpoint.pt", map_location="cpu", weights_only=False)["config"]
        giga = multiply_accumulates(config, 1024, 1024) / 1e9
        lines.append(f"| {name} | {VARIANTS[name][0]} | {giga:.1f} | {', '.join(f'{value:.3f}' for value in psnr)} | {statistics.mean(psnr):.3f} | "
                     f"{max(psnr) - min(psnr):.3f} | {statistics.mean(relmse):.4f} |")
    return "\n".join(lines)


def main():
    options = arguments_of_command_line()
    if not options.table:
        with concurrent.futures.ThreadPoolExecutor(options.parallel) as pool:
            runs = [pool.submit(run, options, name, seed) for seed in range(1, options.seeds + 1) for name in options.only]
            try:
                for finished in concurrent.futures.as_completed(runs):
                    finished.result()
            except subprocess.CalledProcessError as error:      # train.py has said why
                pool.shutdown(cancel_futures=True)
                sys.exit(f"ablations.py: a training ended with code {error.returncode}")
    print(table(options))


if __name__ == "__main__":
    main()
