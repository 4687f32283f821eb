"""The tables of bench/skip.md and bench/tiles.md, made of what `xrds bench skip` and `xrds bench tiles` write."""
SHARED = ("version", "processors", "definitions", "devices")
SKIP_CASES = tuple(("--model", f"xrds-x{scale}-{size}", "--scale", str(scale))
                   for scale, size in ((4, "compact"), (4, "nano"), (2, "compact"), (8, "compact")))
TILE_CASES = tuple(("--model", f"xrds-x4-{size}", "--halo", "0,8,16,24") for size in ("nano", "mini", "small", "compact"))
DEFAULT_HALO = 16


def together(found):
    """Reports of several cases as one: what all have in common stands once, the folder not at all."""
    rest = lambda report: {key: value for key, value in report.items() if key not in (*SHARED, "folder")}
    return {**{key: found[0][key] for key in SHARED}, "reports": [rest(report) for report in found]}


def caption(report):
    machine = report["machine"]
    return (f"`{report['command']}`, commit {report['commit']}, {machine['processors']} cores of {machine['processor']}, "
            f"{report['devices'][0]['driver']}, {report['reports'][0]['precision']}")


def lines(first, header, rows):
    line = lambda row: "| " + " | ".join(row) + " |"
    return "\n".join([first, "", line(header), "|" + "---|" * len(header), *map(line, rows)]) + "\n"


def skip_table(report):
    """Markdown of skip.json: a row for each model and frame."""
    rows = [[found["model"].removeprefix("xrds-"), scene["name"], f"{100 * scene['skipped']:.1f} %", f"{100 * scene['work']:.1f} %",
             f"{scene['medianSecondsOff']:.3f}", f"{scene['medianSeconds']:.3f}", f"**{scene['faster']:.2f}**", f"{scene['psnrOff']:.3f}",
             f"{scene['psnr'] - scene['psnrOff']:+.4f}", *(f"{scene['largestChange'][which]:.5f}" for which in ("skipped", "others"))]
            for found in report["reports"] for scene in found["scenes"]]
    return lines(f"{caption(report)}, medians of {report['reports'][0]['runs']} pairs of runs:",
                 ["model", "frame", "skipped", "work", "s off", "s skip", "faster", "PSNR off", "change dB", "skipped windows", "others"], rows)


def tiles_table(report):
    """Markdown of tiles.json: a row for each model and halo."""
    name = lambda halo: f"**{halo}**, the default" if halo == DEFAULT_HALO else str(halo)
    rows = [[found["model"].removeprefix("xrds-"), name(row["halo"]), *(f"{row[of]['relativeRms']:.2e}" for of in ("mean", "worst")),
             *(f"{row[of]['psnrChange']:+.4f}" for of in ("mean", "worst")), f"{row['worst']['step']:.2f}"]
            for found in report["reports"] for row in found["halos"]]
    return lines(caption(report) + ":", ["model", "halo", "RMS, mean", "RMS, worst", "PSNR, mean", "PSNR, worst", "largest step"], rows)
