"""What cheap albedo and normals cost, and what they do to the result: the recipes of scripts/blender_guides.py.

    python3 bench/guides.py DATA_FOLDER WORK_FOLDER 41000:41010 --hdri DIR --models DIR [--samples 16] [--blender blender]

DATA_FOLDER holds the renders sNNNNN_lr64.exr and sNNNNN_gt.exr of the seeds (training/scenes). Each scene is composed anew, saved, rendered
by every recipe in turn, --rounds times, and upscaled by the default model of scale 4. Prints Markdown. EEVEE draws on a display of its own
(xvfb-run), in software, so that its time says nothing of a GPU's. Run it with the Python that Blender finds, the
system's: a Blender of the system looks for its modules beside the first python3 of the PATH.
"""
import argparse
import json
import pathlib
import re
import statistics
import subprocess

import tables

ROOT = pathlib.Path(__file__).resolve().parent.parent
RECIPES = ("full", "direct", "mirrors", "flat", "eevee")
LAYERS = {"eevee": ["--albedo", "ViewLayer.DiffCol", "--normal", "ViewLayer.Normal"]}      # the others' names are known


def blender(options, *arguments, display=False):
    """What a run of Blender prints; with a display where it asks for one."""
    return subprocess.run([*["xvfb-run", "-a"] * display, options.blender, "-b", *map(str, arguments)], capture_output=True, text=True, check=True).stdout


def composed(options, seed):
    path = options.work / f"s{seed}.blend"
    if not path.exists():
        said = blender(options, "--factory-startup", "-noaudio", "-P", ROOT / "training/scenes/render.py", "--", "--seeds", f"{seed}:{seed + 1}", "--out",
                       options.work, "--blend", "--hdri", options.hdri, "--models", options.models)
        if not path.exists():
            raise SystemExit(f"no scene of seed {seed}:\n{said}")
    return path


def rendered(options, scene, recipe):
    """(seconds of the processor, file) of the guides."""
    path = scene.with_name(f"{scene.stem}_{recipe}.exr")
    said = blender(options, scene, "-noaudio", "-t", 1, "-P", ROOT / "scripts/blender_guides.py", "--", path, "--samples", options.samples, "--recipe", recipe, display=recipe == "eevee")
    return float(re.search(r"blender_guides: .* ([\d.]+) s of processors,", said)[1]), path


def quality(options, seed, guides, layers=()):
    """(PSNR, RelMSE) of the upscaled colour."""
    found, data = options.work / "run.json", options.data / f"s{seed}"
    subprocess.run([options.xrds, "upscale", f"{data}_lr64.exr", str(guides), "--aux-colour", "never", "-o", str(options.work / "out.exr"), "--reference",
                    f"{data}_gt.exr", "--json", str(found), "--quiet", *layers], check=True, capture_output=True)
    measured = next(row for row in json.loads(found.read_text())["methods"] if row["name"] == "xrds")
    return measured["psnr"], measured["relMse"]


def measure(options):
    """{recipe: [(seconds over those of the full path, dB, RelMSE) a scene]}"""
    rows = {recipe: [] for recipe in (*RECIPES, "converged")}
    for seed in range(*(int(part) for part in options.seeds.split(":"))):
        scene = composed(options, seed)
        rounds = [{recipe: rendered(options, scene, recipe) for recipe in RECIPES} for _ in range(options.rounds)]
        seconds = {recipe: statistics.median(turn[recipe][0] for turn in rounds) for recipe in RECIPES}
        for recipe in RECIPES:
            rows[recipe].append((seconds[recipe] / seconds["full"], *quality(options, seed, rounds[0][recipe][1], LAYERS.get(recipe, ()))))
        rows["converged"].append((float("nan"), *quality(options, seed, options.data / f"s{seed}_gt.exr")))
    return rows


def markdown(rows, origin, options):
    machine = origin["machine"]
    lines = ["# What cheap guides cost", "",
             f"Albedo and normal of {options.samples} samples by the recipes of `scripts/blender_guides.py`, which says what each leaves out of a path: processor time of the render, of 256 x 256 pixels, over that of the full "
             f"path (median, and the extremes of the scenes), and PSNR and RelMSE of `xrds-x4-compact` with them, colour at 64 samples; means of {len(rows['full'])} scenes of "
             f"`training/scenes`. `python3 bench/guides.py`, commit {origin['commit']}, one core of {machine['processor']}.", "",
             "| guides | time | least | most | PSNR dB | RelMSE |", "|---|---|---|---|---|---|"]
    mean = lambda found, place: statistics.mean(row[place] for row in found)
    for recipe, found in rows.items():
        shares = [row[0] for row in found]
        time = "| - | - | - " if recipe in ("converged", "eevee") else f"| {statistics.median(shares):.2f} | {min(shares):.2f} | {max(shares):.2f} "
        lines.append(f"| {recipe} {time}| {mean(found, 1):.2f} | {mean(found, 2):.4f} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("work", type=pathlib.Path)
    parser.add_argument("seeds", metavar="FIRST:END")
    parser.add_argument("--hdri", default="")
    parser.add_argument("--models", default="")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--blender", default="blender")
    parser.add_argument("--xrds", default=str(ROOT / "build/release/cli/xrds"))
    options = parser.parse_args()
    options.work = options.work.resolve()
    options.work.mkdir(parents=True, exist_ok=True)
    print(markdown(measure(options), tables.origin(), options), end="")


if __name__ == "__main__":
    main()
