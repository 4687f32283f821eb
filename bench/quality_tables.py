"""The tables of docs/quality.md, made of what bench/quality.sh leaves: `python3 bench/tables.py gather OUT_FOLDER`."""
import json
import re

METRICS = ("psnr", "relMse", "relMseTrimmed", "flip")
SCENES_OF = "x4_64_aux16"  # the setting whose scenes are kept
AUXILIARY = (("1", "x4_64_aux1"), ("4", "x4_64_aux4"), ("16", "x4_64_aux16"), ("converged", "x4_64_auxconverged"))
OTHERS = (("scale 2, 16 spp", "x2_16_aux16"), ("scale 8, 64 spp", "x8_64_aux16"), ("scale 8, 256 spp", "x8_256_aux16"))
MERGED = (("scale 4, 64 and 16 spp", "x4_64_aux16"), ("scale 4, 64 and 4 spp", "x4_64_aux4"), ("scale 4, 16 and 1 spp", "x4_16_aux1"),
          ("scale 2, 16 and 4 spp", "x2_16_aux4"), ("scale 2, 4 and 1 spp", "x2_4_aux1"))
ENSEMBLE = ((64, "x4_64_aux16"), (16, "x2_16_aux16"), (64, "x8_64_aux16"), (8, "x1_8_aux8"))
PASSES = (2, 4)
SINGLE = (1, 2, 4, 8, 16)
EQUAL = (("2", "x1_2_aux2", "x2_4_aux1", "x4_16_aux1"), ("4", "x1_4_aux4", "x2_8_aux2", "x4_32_aux2"),
         ("8", "x1_8_aux8", "x2_16_aux4", "x4_64_aux4"))


def load(path):
    return json.loads(path.read_text()) if path.exists() else {}


def gather(folder, part=""):
    """{"commit", "machine", "command", "device", "settings": {"x4_64_aux16": [methods with their means]}} of quality.sh's folder."""
    settings, device = {}, ""
    oidn = {name: load(folder / f"oidn_{kind}.lpips.json") for name, kind in (("OIDN", "plain"), ("OIDN, prefiltered", "prefiltered"))}
    for path in sorted(folder.glob("x*_aux*.json")):
        if path.name.endswith(".lpips.json"):
            continue
        report, written = json.loads(path.read_text()), load(path.with_suffix(".lpips.json"))
        device = report["device"]
        settings[path.stem] = [method(found, path.stem == SCENES_OF, {**written, **{
            file_name(name): table[f"oidn{report['colourSamples']}"] for name, table in oidn.items()
            if f"oidn{report['colourSamples']}" in table}}) for found in report["methods"]]
    if not settings:
        raise SystemExit(f"{folder} has no results of bench/quality.sh")
    return {**json.loads((folder / "origin.json").read_text()), "command": f"bench/quality.sh VAL_FOLDER OUT_FOLDER {part}".strip(), "device": device,
            "settings": settings}


def file_name(method):
    """As `xrds bench quality --write` names the images of a method."""
    return re.sub(r"[^A-Za-z0-9.-]", "_", method)


def method(found, with_scenes, distances):
    kept = {"name": found["name"], **{key: found["mean"][key] for key in METRICS}}
    if "worst" in found:
        kept |= {"toGuided": found["psnrToGuided"], "worst": found["worst"],
                 "worstToGuided": found["scenes"][found["worst"]]["psnrToGuided"]}
    if with_scenes:
        kept["scenes"] = {name: {key: scene[key] for key in ("psnr", "relMse")} for name, scene in found["scenes"].items()}
    scenes = distances.get(file_name(found["name"]))
    if scenes:
        kept["lpips"] = sum(scenes.values()) / len(scenes)
    return kept


def with_single(report, single):
    """The report of all settings with those of scale 1 from a later one, of the part `single`."""
    return {**report, "single": single["commit"], "settings": {**report["settings"], **single["settings"]}}


def caption(report, has_single):
    later = f" (scale 1: {report['single']})" if has_single and "single" in report else ""
    return (f"`{report['command']}`, commit {report['commit']}{later}, {report['device']}, {report['machine']['processors']} cores of "
            f"{report['machine']['processor']}.")


def markdown(report, header, rows, has_single=False):
    """A table under its caption; has_single: with settings of scale 1, which may be of a later run."""
    line = lambda row: "| " + " | ".join(row) + " |"
    return "\n".join([caption(report, has_single), "", line(header), "|" + "---|" * len(header), *map(line, rows)]) + "\n"


def cell(found):
    return f"{found['psnr']:.2f} / {found['relMse']:.4f}" + (f" / {found['lpips']:.4f}" if "lpips" in found else "")


def mean_row(found):
    gain = lambda key: f"{found[key]:+.2f}" if key in found else "-"
    worst = f"{found['worst']} {gain('worstToGuided')}" if "worst" in found else "-"
    lpips = f"{found['lpips']:.4f}" if "lpips" in found else "-"
    return [f"{found['psnr']:.2f}", gain("toGuided"), f"{found['relMse']:.4f}", f"{found['relMseTrimmed']:.4f}", f"{found['flip']:.4f}",
            lpips, worst]


MEANS = ["PSNR dB", "over guided", "RelMSE", "trimmed", "FLIP", "LPIPS", "worst scene, over guided"]


def means(report):
    """Scale 4 as it is usually run: every method."""
    return markdown(report, ["method", *MEANS], [[found["name"], *mean_row(found)] for found in report["settings"][SCENES_OF]])


def scenes(report):
    """The same, scene by scene."""
    methods = report["settings"][SCENES_OF]
    rows = [[name, *(f"{found['scenes'][name]['psnr']:.2f} / {found['scenes'][name]['relMse']:.4f}" for found in methods)]
            for name in methods[0]["scenes"]]
    return markdown(report, ["PSNR dB / RelMSE", *(found["name"].removeprefix("xrds-x4-") for found in methods)], rows)


def others(report):
    """The other scales."""
    rows = [[setting, found["name"], *mean_row(found)] for setting, key in OTHERS for found in report["settings"].get(key, [])
            if found["name"] in ("bicubic", "guided") or found["name"].startswith("xrds")]
    return markdown(report, ["setting", "method", *MEANS], rows)


def matrix(report, columns):
    """Methods by settings; a column is a title and keys of settings, whose methods stand below each other by scale."""
    rows = {}
    for at, (_, *keys) in enumerate(columns):
        for key in keys:
            for found in report["settings"].get(key, []):
                if found["name"] in ("bicubic", "demodulated", "input") or "ensemble" in found["name"]:
                    continue
                scale = "" if len(keys) == 1 else f", scale {key[1:].split('_')[0]}"
                name = found["name"] + (scale if found["name"] == "guided" else "")
                rows.setdefault((key.split("_")[0], name), ["-"] * len(columns))[at] = cell(found)
    return [[name, *cells] for (_, name), cells in sorted(rows.items(), key=lambda item: item[0][0])]


def single(report):
    """One render of full resolution: what the denoiser makes of it and what models of scale 1 do, as it is and denoised first."""
    rows = {}
    for at, spp in enumerate(SINGLE):
        for end, suffix in (("", ""), ("_denoised", ", denoised first")):
            for found in report["settings"].get(f"x1_{spp}_aux{spp}{end}", []):
                if found["name"].startswith(("OIDN", "xrds")):
                    rows.setdefault(found["name"] + suffix, ["-"] * len(SINGLE))[at] = cell(found)
    header = ["PSNR dB / RelMSE / LPIPS", *(f"{spp} sample{'s' * (spp > 1)}" for spp in SINGLE)]
    return markdown(report, header, [[name, *cells] for name, cells in sorted(rows.items())], True)


def auxiliary(report):
    """Scale 4 with albedo and normal of growing quality."""
    return markdown(report, ["PSNR dB / RelMSE / LPIPS", *(title for title, _ in AUXILIARY)], matrix(report, AUXILIARY))


def merged(report):
    """Colours of two renders: of the compact and the full models, denoised first or not, and the mean of eight passes."""
    rows = []
    for setting, key in MERGED:
        plain, denoised = ({found["name"]: trimmed_cell(found) for found in report["settings"].get(key + end, [])} for end in ("_merged", "_merged_denoised"))
        rows += [[setting, name, cell, denoised.get(name, "-"), denoised.get(f"{name} ensemble 8", "-")] for name, cell in plain.items() if name.startswith("xrds")]
    return markdown(report, ["samples of the two renders", "PSNR dB / trimmed RelMSE", "merged", "denoised first", "and the mean of 8 passes"], rows)


def trimmed_cell(found):
    return f"{found['psnr']:.2f} / {found['relMseTrimmed']:.4f}"


def ensemble(report):
    """One pass, and the mean of several."""
    exact = lambda found: f"{found['psnr']:.3f} / {found['relMse']:.4f}" if found else ""
    rows = []
    for samples, key in ENSEMBLE:
        several = {found["name"]: found for passes in PASSES for found in report["settings"].get(f"{key}_ensemble{passes}", [])}
        cells = lambda name: [exact(several.get(f"{name} ensemble {passes}")) for passes in PASSES]
        rows += [[f"`{found['name']}`, {samples} spp", exact(found), *cells(found["name"])]
                 for found in report["settings"].get(key, []) if any(cells(found["name"]))]
    return markdown(report, ["PSNR dB / RelMSE", "one pass", "2: also turned by half a turn", "4: mirrored both ways"], rows, True)


def equal(report):
    """Equal average samples."""
    return markdown(report, ["PSNR dB / RelMSE / LPIPS", *(f"{column[0]} average samples" for column in EQUAL)], matrix(report, EQUAL), True)
