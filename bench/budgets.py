"""What wins at which number of samples: measures every way to a picture and writes budgets.md beside this file, with its charts.

    python3 bench/budgets.py measure VAL_FOLDER LIVE_FOLDER LARGE_FOLDER [--xrds build/release/cli/xrds]
    python3 bench/budgets.py write

`measure` runs `xrds bench quality` on renders of growing samples and Open Image Denoise on full-resolution ones; it needs
bench/oidn-requirements.txt, and takes an hour of a core. It keeps the figures in bench/results/budgets.json, from which
`write` makes the document; that needs matplotlib.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import tables
from budget_tables import front, name_of, table

ROOT = pathlib.Path(__file__).resolve().parent.parent
HERE = ROOT / "bench"

# Renders whose guides are of the same paths: scale, samples of the colour, of the full-resolution render.
PATH_TRACED = ((4, 64, 16), (4, 64, 4), (4, 64, 1), (4, 16, 4), (4, 16, 1), (2, 16, 4), (2, 8, 2), (2, 4, 1))
# Renders whose guides are clean and cost nothing: scale, samples of the colour.
FREE = ((4, 1), (4, 4), (4, 16), (4, 64), (2, 1), (2, 2), (2, 4), (2, 16))
FULL_SPP = (1, 2, 4, 8, 16)      # of a full-resolution render alone, for the denoiser and for models of scale 1
FOLDERS = ("val", "live", "large")
PART_NAMES = ("path-traced", "free", "denoised")
KEPT = tables.RESULTS / "budgets.json"


def library():
    """Where pyoidn's library is."""
    import pyoidn
    return next(pathlib.Path(pyoidn.__file__).parent.rglob("libOpenImageDenoise.so.2"))


class Measurement:
    """Runs of `xrds bench quality`, each told as rows {way, model, scale, colour, aux, average, psnr, psnrs of each scene, ...}."""

    def __init__(self, program, work, asked=()):
        self.program, self.work, self.asked, self.rows = program, work, asked, []
        self.environment = {**os.environ, "XRDS_OIDN": str(library())}
        listed = subprocess.run([program, "info"], capture_output=True, text=True, check=True).stdout.split()
        self.models = {scale: [name for name in listed if name.startswith(f"xrds-x{scale}-")] for scale in (1, 2, 4)}

    def quality(self, data, folder, scale, colour, aux, way, models, *options):
        """One setting; the rows of the models and, of denoised images, of those. No row where the folder lacks the renders."""
        wanted = [name for name in (*models, *["OIDN"] * ("--also" in options)) if not self.asked or name in self.asked]
        if not wanted:
            return
        models = [model for model in models if model in wanted]
        found = self.work / "quality.json"
        command = [self.program, "bench", "quality", str(folder), "--scale", str(scale), "--samples", str(colour), "--aux", str(aux), "--json", str(found), "--quiet"]
        for model in models:
            command += ["--model", model]
        run = subprocess.run([*command, *options], env=self.environment, capture_output=True, text=True)
        if run.returncode:
            print(f"left out: {data}, {way}, x{scale} {colour}-{aux}: {run.stderr.strip().splitlines()[-1]}", file=sys.stderr)
            return
        report = json.loads(found.read_text())
        average = report["averageSamples"] or colour / scale ** 2
        for method in report["methods"]:
            if method["name"] in wanted:
                mean = method["mean"]
                self.rows.append({"data": data, "way": way, "model": method["name"], "scale": scale, "colour": colour, "aux": aux, "average": average,
                                  "psnr": mean["psnr"], "relmseTrimmed": mean["relMseTrimmed"], "scenes": len(method["scenes"]),
                                  "psnrs": {name: round(scene["psnr"], 3) for name, scene in method["scenes"].items()}})
                print(f"{data} {way} {method['name']} x{scale} {colour}-{aux}: {mean['psnr']:.2f} dB", flush=True)

    def of_scale(self, scale, *kinds):
        return [model for model in self.models[scale] if model.split("-", 2)[2] in kinds]

    def full_resolution(self, data, folder, aux_of):
        """Models of scale 1; aux_of: the guides of a render of so many samples."""
        for spp in FULL_SPP:
            here = (data, folder, 1, spp, aux_of(spp))
            self.quality(*here, "network", self.of_scale(1, "compact"))
            self.quality(*here, "denoised first", self.of_scale(1, "compact"), "--denoise-first")

    def path_traced(self, data, folder):
        self.full_resolution(data, folder, lambda spp: spp)
        for scale, colour, aux in PATH_TRACED:
            here = (data, folder, scale, colour, aux)
            self.quality(*here, "network", self.of_scale(scale, "compact"))
            self.quality(*here, "merged", self.of_scale(scale, "compact", "full"), "--merge")
            self.quality(*here, "merged, denoised first", self.of_scale(scale, "compact", "full"), "--merge", "--denoise-first")

    def free_guides(self, data, folder):
        self.full_resolution(data, folder, lambda spp: "converged")
        for scale, colour in FREE:
            here = (data, folder, scale, colour, "converged")
            self.quality(*here, "network", self.of_scale(scale, "compact", "live"))
            self.quality(*here, "denoised first", self.of_scale(scale, "compact", "live"), "--denoise-first")

    def denoised(self, data, folder):
        if self.asked and "OIDN" not in self.asked:
            return
        for free in (True,) if data == "live" else (False, True):
            for spp in FULL_SPP:
                images = self.work / f"{data}-{spp}{'-free' * free}"
                run = subprocess.run([sys.executable, HERE / "oidn.py", folder, images, "--spp", str(spp), "--prefilter", *["--free-guides"] * free], capture_output=True, text=True)
                if run.returncode == 0:
                    self.quality(data, folder, 1, spp, "converged" if free else spp, "Open Image Denoise", [], "--also", f"OIDN={images}/*_oidn{spp}.exr")


def measure(options):
    """Adds the rows of the parts, folders and models that are asked for to the others that were measured before, of the same commit or another."""
    kept = json.loads(KEPT.read_text())["rows"] if KEPT.exists() else []
    with tempfile.TemporaryDirectory() as work:
        found = Measurement(options.xrds, pathlib.Path(work), options.models)
        measures = {"path-traced": found.path_traced, "free": found.free_guides, "denoised": found.denoised}
        for part in options.parts:
            first = len(found.rows)
            for data in options.data:
                if data != "live" or part != "path-traced":      # which has no renders for it
                    measures[part](data, getattr(options, data))
            for row in found.rows[first:]:
                row.update(part=part, commit=tables.commit())
    rows = [row for row in kept if row["part"] not in options.parts or row["data"] not in options.data or options.models and row["model"] not in options.models] + found.rows
    tables.keep("budgets", {**tables.origin(), "command": "python3 bench/budgets.py measure VAL LIVE LARGE", "rows": rows})


def listed(names):
    return " and ".join(sorted(names))


def chart(rows, title, path):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "xrds"
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(10, 5), layout="constrained")
    axes.set_prop_cycle(color=plt.get_cmap("tab20").colors)      # more lines than the usual ten colours
    for name in sorted({name_of(row) for row in rows}, key=lambda name: (not name.startswith("OIDN"), name)):
        line = front([row for row in rows if name_of(row) == name])
        axes.plot([row["average"] for row in line], [row["psnr"] for row in line], marker="o", linewidth=2.5 if name.startswith("OIDN") else 1.3,
                  color="black" if name.startswith("OIDN") else None, label=name)
    axes.set_xscale("log", base=2)
    axes.set_xlabel("average samples a pixel of the output")
    axes.set_ylabel("PSNR, dB")
    axes.set_title(title)
    axes.grid(alpha=0.3)
    figure.legend(loc="outside right center", fontsize=8)
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


NUMBERS = {2: "two", 3: "three", 4: "four", 5: "five"}
PARTS = (("val", "path", "Guides of the same paths, ten scenes of 256 x 256", "budgets_val"),
         ("val", "free", "Clean guides that cost nothing, the same scenes", "budgets_val_free"),
         ("live", "free", "Clean guides that cost nothing, ten scenes of 256 x 256 for few samples", "budgets_live"),
         ("large", "path", "Guides of the same paths, {scenes} of 1024 x 1024", "budgets_large_path"),
         ("large", "free", "Clean guides that cost nothing, {scenes} of 1024 x 1024", "budgets_large"))


def write():
    report = json.loads(KEPT.read_text())
    machine, rows_of_all = report["machine"], report["rows"]
    text = ["# What wins at which number of samples", "",
            "Which render to make, and what to make of it: mean PSNR in dB against the average samples a pixel of the output, colour samples over the square of the scale plus those",
            "of the full-resolution render. Guides that cost nothing (rasterized ones, primary hits) count as none. *OIDN* is Open Image Denoise on a full-resolution render of as",
            "many samples with the same guides, which it denoises first; *merged*: the colours of both renders; *denoised first*: `--denoise-first`. In brackets the samples of the two renders. Made by",
            f"`python3 bench/budgets.py write` of `{report['command']}`, commits {listed({row['commit'] for row in rows_of_all})}, on {machine['processor']}.", ""]
    for data, kind, title, image in PARTS:
        rows = [row for row in report["rows"] if row["data"] == data and (row["aux"] == "converged") == (kind == "free")]
        if not rows:
            continue
        count = rows[0]["scenes"]
        title = title.format(scenes="one frame" if count == 1 else f"{NUMBERS.get(count, count)} frames")
        chart(rows, title, HERE / "images" / f"{image}.svg")
        text += [f"## {title}", "", f"![{title}](images/{image}.svg)", "", table(rows)]
    (HERE / "budgets.md").write_text("\n".join(text))


def command_line(description):
    """(parser, that of its verb `measure`) of a script that measures on the three folders and writes."""
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    verbs = parser.add_subparsers(dest="verb", required=True)
    measuring = verbs.add_parser("measure")
    for name in FOLDERS:
        measuring.add_argument(name, type=pathlib.Path)
    measuring.add_argument("--xrds", default=str(ROOT / "build/release/cli/xrds"))
    verbs.add_parser("write")
    return parser, measuring


def main():
    parser, measuring = command_line(__doc__)
    measuring.add_argument("--parts", nargs="+", choices=PART_NAMES, default=PART_NAMES, help="measure these alone")
    measuring.add_argument("--data", nargs="+", choices=FOLDERS, default=FOLDERS, help="of these folders alone")
    measuring.add_argument("--models", nargs="+", default=(), help="of the models, and OIDN, these alone")
    options = parser.parse_args()
    return measure(options) if options.verb == "measure" else write()


if __name__ == "__main__":
    main()
