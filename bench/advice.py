"""Fits what `xrds advise` predicts to the map of budgets.py, checks it on scenes that the fit has not seen, and writes models/ways.json and advice.md.

    python3 bench/advice.py measure VAL_FOLDER LIVE_FOLDER LARGE_FOLDER [--xrds build/release/cli/xrds]
    python3 bench/advice.py write

`measure` asks `xrds advise --scene-only` what two cheap renders say of each scene and keeps it in bench/results/scenes.json; `write` needs that, the map
(bench/results/budgets.json) and numpy.
"""
import json
import pathlib
import statistics
import subprocess
import tempfile

import numpy as np

import budget_tables
import budgets
import tables

ROOT = pathlib.Path(__file__).resolve().parent.parent
FEATURES = ("noise", "detail", "guideNoise")
CHEAP = {"val": 16, "live": 4, "large": 16}     # samples of the low-resolution render, of scale 4; the other render has one
SHARED_RIDGE, OWN_RIDGE = 1.0, 20.0             # of standardised features, in rows: of what all ways have in common, and of what one has of its own
KEPT = tables.RESULTS / "scenes.json"


def measure(options):
    scenes = {}
    for data, spp in CHEAP.items():
        folder = getattr(options, data)
        for reference in sorted(folder.glob("*_gt.exr")):
            name = reference.name[:-len("_gt.exr")]
            with tempfile.NamedTemporaryFile(suffix=".json") as found:
                subprocess.run([options.xrds, "advise", folder / f"{name}_lr{spp}.exr", folder / f"{name}_aux1.exr", "--samples", f"{spp},1", "--scene-only",
                                "--quiet", "--json", found.name], check=True, capture_output=True)
                scenes[name] = {"data": data, **json.loads(pathlib.Path(found.name).read_text())["scene"]}
    tables.keep("scenes", {**tables.origin(), "command": "python3 bench/advice.py measure VAL LIVE LARGE", "scenes": scenes})


def way_of(row):
    """What the rows of one way have in common, as a key and as the way itself; Open Image Denoise at full resolution has no model."""
    alone, free = row["model"] == "OIDN", row["aux"] == "converged"
    way = {"name": budget_tables.name_of(row) + ", free guides" * free, "model": "" if alone else row["model"], "scale": row["scale"], "guides": "free" if free else "rendered",
           "merges": "merged" in row["way"], "denoisesFirst": "denoised first" in row["way"], "takesFullColour": row["model"].endswith("-full")}
    return way["name"], way


def features_of(row, way, scene):
    """[FEATURES] of one render of a scene: advice/ways.h says the same in C++."""
    free = way["guides"] == "free"
    count = row["colour"] + (way["scale"] ** 2 * row["aux"] if way["merges"] else 0)
    return [scene["noise"] - np.log2(count), scene["detail"], 0 if free else scene["guideNoise"] - np.log2(row["aux"])]


def slopes_of(features, values, ridge):
    """Slopes [f] of the ridge regression of centred features [n, f] and values [n]."""
    spread = features.std(0)
    spread[spread < 1e-9] = 1
    standard = features / spread
    return np.linalg.solve(standard.T @ standard + ridge * np.eye(features.shape[1]), standard.T @ values) / spread


def fitted(points):
    """{way: [constant, slopes]} of points of ways whose guides are of one kind. A scene that is hard for one way is hard for all: the slopes are those of all
    ways together, corrected for each way as far as its own points ask for it."""
    ways = {}
    for point in points:
        ways.setdefault(point["way"], []).append((point["features"], point["psnr"]))
    centres, centred = {}, {}
    for name, rows in ways.items():
        features, values = np.array([row[0] for row in rows]), np.array([row[1] for row in rows])
        centres[name] = features.mean(0), values.mean()
        centred[name] = features - features.mean(0), values - values.mean()
    shared = slopes_of(*(np.concatenate(parts) for parts in zip(*centred.values())), SHARED_RIDGE)
    found = {}
    for name, (features, values) in centred.items():
        slopes = shared + slopes_of(features, values - features @ shared, OWN_RIDGE)
        found[name] = np.array([centres[name][1] - slopes @ centres[name][0], *slopes])
    return found


class Map:
    """The rows of budgets.json taken apart: a render of a scene each, {way, scene, data, average, psnr, features}."""

    def __init__(self, rows, scenes):
        self.ways, self.points = {}, []
        for row in rows:
            name, way = way_of(row)
            way = self.ways.setdefault(name, {**way, "ratios": []})
            if way["guides"] == "rendered" and way["scale"] > 1 and row["colour"] / row["aux"] not in way["ratios"]:
                way["ratios"].append(row["colour"] / row["aux"])
            for scene, psnr in row["psnrs"].items():
                self.points.append({"way": name, "scene": scene, "data": row["data"], "average": row["average"], "psnr": psnr,
                                    "features": features_of(row, way, scenes[scene])})

    def fit(self, without=None):
        """{way: coefficients} of the scenes but for one."""
        found = {}
        for guides in ("rendered", "free"):
            points = [point for point in self.points if point["scene"] != without and self.ways[point["way"]]["guides"] == guides]
            found.update(fitted(points) if points else {})
        return found

    def predict_left_out(self):
        """Sets `predicted` of every point, from a fit that has not seen its scene; the points of a way that only that scene has go."""
        for scene in {point["scene"] for point in self.points}:
            fits = self.fit(without=scene)
            for point in self.points:
                if point["scene"] == scene and point["way"] in fits:
                    point["predicted"] = float(fits[point["way"]] @ np.array([1, *point["features"]]))
        self.points = [point for point in self.points if "predicted" in point]

    def regrets(self):
        """[{scene, data, guides, budget, regret, advised, best}]: for each scene, kind of guides and number of average samples the best plan's PSNR
        less the advised one's."""
        found, groups = [], {}
        for point in self.points:
            groups.setdefault((point["data"], point["scene"], self.ways[point["way"]]["guides"]), []).append(point)
        for (data, scene, guides), points in sorted(groups.items()):
            for budget in sorted({point["average"] for point in points}):
                here = [point for point in points if point["average"] <= budget]
                best, advised = (max(here, key=lambda point: point[key]) for key in ("psnr", "predicted"))
                found.append({"scene": scene, "data": data, "guides": guides, "budget": budget, "regret": best["psnr"] - advised["psnr"],
                              "advised": advised["way"], "best": best["way"]})
        return found


def ways_json(whole):
    ways = []
    for name, values in whole.fit().items():
        way, points = whole.ways[name], [point for point in whole.points if point["way"] == name]
        noise = [point["features"][0] for point in points]
        errors = [point["predicted"] - point["psnr"] for point in points]
        ways.append({**way, "ratios": sorted(way["ratios"]), "noise": [round(min(noise), 3), round(max(noise), 3)], "spread": round(float(np.sqrt(np.mean(np.square(errors)))), 2),
                     "coefficients": {key: round(float(value), 4) for key, value in zip(("constant", *FEATURES), values)}})
    return ways


def write():
    report, scenes = json.loads(budgets.KEPT.read_text()), json.loads(KEPT.read_text())["scenes"]
    whole = Map(report["rows"], scenes)
    whole.predict_left_out()
    ways, regrets = ways_json(whole), whole.regrets()
    (ROOT / "models" / "ways.json").write_text(json.dumps({"about": "What the error of each way from samples to a picture depends on, for xrds advise: bench/advice.md", "ways": ways}, indent=1) + "\n")
    (ROOT / "bench" / "advice.md").write_text(document(ways, regrets, report["machine"]))


def document(ways, regrets, machine):
    lines = ["# How well `xrds advise` predicts", "",
             "`xrds advise` reads two cheap renders and predicts the PSNR of each way from samples to a picture, of the noise that is left, the detail and the noise of the guides",
             "([docs/advice.md](../docs/advice.md)). The coefficients are fitted to the map of [budgets.md](budgets.md). Here every scene is predicted by coefficients that have not",
             "seen it; which features there are, and how strongly the fit is held back, was chosen by the same figures. Made by `python3 bench/advice.py write` of figures measured",
             f"on {machine['processor']}.", "",
             "## The advised plan against the best one", "",
             "For each scene and each number of average samples at which the map has a plan: the PSNR of the best plan of at most so many samples, less that of the advised one.",
             "Plans with guides of the same paths and plans with free ones are told apart, as a user can make one or the other.", "",
             "| scenes, guides | cases | median, dB | 90 % below | worst | within 0.3 dB | worst case |", "|---|---|---|---|---|---|---|"]
    for data, guides in (("val", "rendered"), ("val", "free"), ("live", "free"), ("large", "rendered"), ("large", "free"), ("all", "")):
        here = [case for case in regrets if data in (case["data"], "all") and guides in (case["guides"], "")]
        if not here:
            continue
        values, worst = sorted(case["regret"] for case in here), max(here, key=lambda case: case["regret"])
        lines.append(f"| {data} {guides} | {len(here)} | {statistics.median(values):.2f} | {values[int(0.9 * (len(values) - 1))]:.2f} | {values[-1]:.2f} | {sum(value <= 0.3 for value in values) / len(values):.0%} "
                     f"| {worst['scene']} at {worst['budget']:g}: {worst['advised']} for {worst['best']} |")
    lines += ["", "## The predicted PSNR", "", "Root mean square of the errors for scenes that were left out, dB, and the coefficients of the fit to all.", "",
              "| way | error | constant | " + " | ".join(FEATURES) + " |", "|---" * (3 + len(FEATURES)) + "|"]
    for way in ways:
        lines.append(f"| {way['name']} | {way['spread']:.2f} | " + " | ".join(f"{value:.2f}" for value in way["coefficients"].values()) + " |")
    return "\n".join(lines) + "\n"


def main():
    options = budgets.command_line(__doc__)[0].parse_args()
    return measure(options) if options.verb == "measure" else write()


if __name__ == "__main__":
    main()
