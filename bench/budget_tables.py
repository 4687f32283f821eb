"""Tables of the map, bench/results/budgets.json: what wins at which number of samples."""


def name_of(row):
    """How a line of the chart and a column of the table is called."""
    if row["model"] == "OIDN":
        return "OIDN, full resolution"
    return f"{row['model'].removeprefix('xrds-')}, {row['way']}" if row["way"] != "network" else row["model"].removeprefix("xrds-")


def front(rows):
    """The best row of each number of average samples, as far as more samples give more."""
    best, most = [], float("-inf")
    for average in sorted({row["average"] for row in rows}):
        row = max((row for row in rows if row["average"] == average), key=lambda row: row["psnr"])
        if row["psnr"] > most:
            best.append(row)
            most = row["psnr"]
    return best


def table(rows):
    """Markdown: a row an average, the best of each way, the best of all in bold."""
    names = sorted({name_of(row) for row in rows}, key=lambda name: (not name.startswith("OIDN"), name))
    lines = ["| average | " + " | ".join(names) + " |", "|---" * (len(names) + 1) + "|"]
    for average in sorted({row["average"] for row in rows}):
        here = [row for row in rows if row["average"] == average]
        top = max(here, key=lambda row: row["psnr"])
        cells = []
        for name in names:
            own = max((row for row in here if name_of(row) == name), key=lambda row: row["psnr"], default=None)
            text = "" if own is None else f"{own['psnr']:.2f}" + ("" if own["scale"] == 1 else f" ({own['colour']}-{own['aux']})".replace("-converged", ""))
            cells.append(f"**{text}**" if own is top else text)
        lines.append(f"| {average:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


# Of the front page: scenes and guides that a pair of columns is about, and the averages at which they have renders for both sides.
FRONT = (("live", True, "free guides", (1 / 16, 1 / 4, 1 / 2, 1)), ("val", False, "path-traced guides", (2, 4, 8)))
FRACTIONS = {1 / 16: "1/16", 1 / 4: "1/4", 1 / 2: "1/2"}


def front_page(report):
    """Markdown: the denoiser at full resolution beside the best that is made of two renders, for each number of average samples; "+ OIDN": denoised
    first."""
    lines = ["| average samples | " + " | ".join(f"{title}: OIDN | xrds" for _, _, title, _ in FRONT) + " |", "|---" * (1 + 2 * len(FRONT)) + "|"]
    for average in sorted(average for *_, averages in FRONT for average in averages):
        cells = []
        for data, free, _, averages in FRONT:
            rows = [row for row in report["rows"] if row["data"] == data and (row["aux"] == "converged") == free and row["average"] == average in averages]
            pair = [max((row for row in rows if (row["model"] == "OIDN") == rival), key=lambda row: row["psnr"], default=None) for rival in (True, False)]
            top = max((row["psnr"] for row in pair if row), default=None)
            for row in pair:
                text = "" if row is None else f"**{row['psnr']:.2f}**" if row["psnr"] == top else f"{row['psnr']:.2f}"
                cells.append(text if row is None or row["model"] == "OIDN" else f"{text} {row['model'].removeprefix('xrds-')}{' + OIDN' * ('denoised' in row['way'])}")
        lines.append(f"| {FRACTIONS.get(average, f'{average:g}')} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"
