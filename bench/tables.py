"""Keeps the tables of the documents equal to measurements that stand in bench/results.

    python3 bench/tables.py measure [--xrds build/release/cli/xrds]   # times every shipped model, minutes
    python3 bench/tables.py write                                     # writes the tables into the documents
    python3 bench/tables.py check                                     # exit code 1 if a document differs

A table stands between <!-- table NAME --> and <!-- end --> and is made of bench/results/NAME.json, which carries the
commit and the machine.
"""
import argparse
import json
import pathlib
import platform
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "bench" / "results"
DOCUMENTS = ("docs/performance.md",)
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


def measure(program):
    """bench/results/network.json: every shipped model at 1024 x 1024, without the times of single kernels."""
    with tempfile.TemporaryDirectory() as folder:
        found = pathlib.Path(folder) / "network.json"
        subprocess.run([program, "bench", "network", "--model", "all", "--size", "1024", "--json", str(found)], check=True)
        report = json.loads(found.read_text())
    for row in report["networks"]:
        row.pop("kernels", None)
    report = {"commit": commit(), "machine": {"processor": processor(), "processors": report["processors"]},
              "command": "xrds bench network --model all --size 1024", **report}
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "network.json").write_text(json.dumps(report, indent=1) + "\n")


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


TABLES = {"network": network_table}


def updated(text, results=RESULTS):
    """The document with every table made anew."""
    def table(match):
        return match[1] + TABLES[match[2]](json.loads((results / f"{match[2]}.json").read_text())) + match[3]
    return BLOCK.sub(table, text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("measure", "write", "check"))
    parser.add_argument("--xrds", default=str(ROOT / "build/release/cli/xrds"))
    options = parser.parse_args()
    if options.what == "measure":
        return measure(options.xrds)
    for name in DOCUMENTS:
        path = ROOT / name
        text = path.read_text()
        if options.what == "write":
            path.write_text(updated(text))
        elif updated(text) != text:
            sys.exit(f"The tables of {name} are not those of bench/results: run python3 bench/tables.py write.")


if __name__ == "__main__":
    main()
