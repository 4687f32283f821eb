"""Keeps the tables of the documents equal to measurements that stand in bench/results.

    python3 bench/tables.py measure network [--xrds build/release/cli/xrds]  # times every shipped model, minutes
    python3 bench/tables.py measure skip FRAMES                       # times skipping on frames of bench/skip_scenes.py
    python3 bench/tables.py measure tiles VAL_FOLDER                  # the error of tiles on scenes
    python3 bench/tables.py gather OUT_FOLDER [single | merged]       # takes over what bench/quality.sh has measured
    python3 bench/tables.py write                                     # writes the tables into the documents
    python3 bench/tables.py check                                     # exit code 1 if a document differs
    python3 bench/tables.py origin                                    # commit and machine, for scripts that measure

A table stands between <!-- table NAME --> and <!-- end --> and is made of a file of bench/results, which carries the
commit and the machine. A table whose file is not there stays as it is.
"""
import argparse
import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import tempfile

import budget_tables
import gpu_tables
import parts_tables
import quality_tables
import temporal_tables

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "bench" / "results"
DOCUMENTS = ("README.md", "docs/performance.md", "docs/quality.md", "bench/skip.md", "bench/temporal.md", "bench/tiles.md")
BLOCK = re.compile(r"(<!-- table (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def processor():
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        fields = dict(line.split(":", 1) for line in lines if ":" in line)
        return " ".join(fields[next(key for key in fields if key.startswith("model name"))].split())
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def commit():
    git = ["git", "-C", str(ROOT)]
    name = subprocess.run([*git, "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()
    changed = subprocess.run([*git, "status", "--porcelain", "--untracked-files=no"], capture_output=True, text=True, check=True).stdout
    return name + ("+" if changed.strip() else "")


def bench(program, *arguments):
    """What `xrds bench ARGUMENTS` writes as JSON."""
    with tempfile.TemporaryDirectory() as folder:
        found = pathlib.Path(folder) / "found.json"
        subprocess.run([program, "bench", *arguments, "--json", str(found)], check=True)
        return json.loads(found.read_text())


def measure_network(program):
    """bench/results/network.json: every shipped model at 1024 x 1024, without the times of single kernels."""
    report = bench(program, "network", "--model", "all", "--size", "1024")
    for row in report["networks"]:
        row.pop("kernels", None)
    keep("network", {**origin(), "command": "xrds bench network --model all --size 1024", **report})


def measure_skip(program, frames):
    """bench/results/skip.json: the frames of bench/skip_scenes.py with one model of each scale, and nano."""
    found = [bench(program, "skip", frames, *case) for case in parts_tables.SKIP_CASES]
    keep("skip", {**origin(), "command": "xrds bench skip FRAMES --model MODEL --scale S", **parts_tables.together(found)})


def measure_tiles(program, scenes):
    """bench/results/tiles.json: two tiles cut in the middle of every scene, with halos of growing size."""
    found = [bench(program, "tiles", scenes, *case) for case in parts_tables.TILE_CASES]
    keep("tiles", {**origin(), "command": "xrds bench tiles VAL_FOLDER --model MODEL --halo 0,8,16,24", **parts_tables.together(found)})


MEASUREMENTS = {"network": measure_network, "skip": measure_skip, "tiles": measure_tiles}


def gather(folder, part=""):
    """bench/results/quality.json, or merged.json, of what quality.sh left; of its part "single" the settings alone."""
    found = quality_tables.gather(folder, part)
    if part == "single":
        found = quality_tables.with_single(json.loads((RESULTS / "quality.json").read_text()), found)
    keep("merged" if part == "merged" else "quality", found)


def origin():
    return {"commit": commit(), "machine": {"processor": processor(), "processors": os.cpu_count()}}


def keep(name, report):
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / f"{name}.json").write_text(json.dumps(report, indent=1) + "\n")


def network_table(report):
    """Markdown of network.json: seconds, memory and error of each model in both precisions."""
    rows, errors = {}, {}
    for row in report["networks"]:
        rows.setdefault(row["model"], {})[row["precision"]] = row
    for row in report["accuracies"]:
        errors.setdefault(row["model"], {})[row["precision"]] = row.get("engineError", {}).get("relativeRms")
    device = report["devices"][0]
    machine = report["machine"]
    lines = [f"`{report['command']}`, commit {report['commit']}, {machine['processors']} cores of {machine['processor']}, {device['driver']}, "
             f"{next(iter(rows.values()))['fp32']['kernelFamily']} kernels, medians of {report['runs']} frames:", "",
             "| model | G multiply-adds, run | seconds, fp32 | fp16 | MB planned, fp32 | fp16 | MB weights | start, s | engine error, fp32 | fp16 |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    for model, by_precision in sorted(rows.items(), key=lambda item: item[1]["fp32"]["wallSeconds"]["median"]):
        full, half = by_precision["fp32"], by_precision["fp16"]
        work = (full["multiplyAdds"] + full["attentionMultiplyAdds"]) / 1e9
        megabytes = lambda row, key: row["memory"][key] / 1e6
        error = lambda precision: f"{errors[model][precision]:.1e}" if errors.get(model, {}).get(precision) is not None else "-"
        lines.append(f"| `{model}` | {work:.1f} | {full['wallSeconds']['median']:.2f} | {half['wallSeconds']['median']:.2f} "
                     f"| {megabytes(full, 'plannedBytes'):.0f} | {megabytes(half, 'plannedBytes'):.0f} | {megabytes(full, 'weightBytes'):.1f} "
                     f"| {full['openSeconds'] + full['preparationSeconds']:.1f} | {error('fp32')} | {error('fp16')} |")
    return "\n".join(lines) + "\n"


# By the name of the table: the file of bench/results, and what makes Markdown of it.
TABLES = {"temporal": ("temporal", temporal_tables.sequences), "network": ("network", network_table), "network_gpu": ("gpu_network", gpu_tables.gpu_network),
          "quality_means": ("quality", quality_tables.means),
          "quality_scenes": ("quality", quality_tables.scenes), "quality_others": ("quality", quality_tables.others),
          "quality_auxiliary": ("quality", quality_tables.auxiliary), "quality_merged": ("merged", quality_tables.merged),
          "quality_ensemble": ("quality", quality_tables.ensemble),
          "quality_equal": ("quality", quality_tables.equal), "quality_single": ("quality", quality_tables.single), "skip": ("skip", parts_tables.skip_table),
          "tiles": ("tiles", parts_tables.tiles_table), "front_page": ("budgets", budget_tables.front_page)}


def updated(text, results=RESULTS):
    """The document with every table made anew."""
    def table(match):
        file, markdown = TABLES[match[2]]
        path = results / f"{file}.json"
        return match[1] + markdown(json.loads(path.read_text())) + match[3] if path.exists() else match[0]
    return BLOCK.sub(table, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("measure", "gather", "write", "check", "origin"))
    parser.add_argument("of", nargs="*", metavar="NAME | FOLDER", help="what to measure, and the folder of its scenes; the folder to gather")
    parser.add_argument("--xrds", default=str(ROOT / "build/release/cli/xrds"))
    options = parser.parse_args()
    if options.what == "measure":
        name, *folder = options.of or [""]
        if name not in MEASUREMENTS or len(folder) != (name != "network"):
            parser.error("measure takes network, skip FRAMES or tiles VAL_FOLDER")
        return MEASUREMENTS[name](options.xrds, *folder)
    if options.what == "gather":
        if len(options.of) not in (1, 2) or options.of[1:] not in ([], ["single"], ["merged"]):
            parser.error("gather takes the OUT_FOLDER of bench/quality.sh, and what it made if that is not all")
        folder, *part = options.of
        return gather(pathlib.Path(folder), *part)
    if options.what == "origin":
        return print(json.dumps(origin()))
    for name in DOCUMENTS:
        path = ROOT / name
        text = path.read_text()
        if options.what == "write":
            path.write_text(updated(text))
        elif updated(text) != text:
            sys.exit(f"The tables of {name} are not those of bench/results: run python3 bench/tables.py write.")


if __name__ == "__main__":
    main()
