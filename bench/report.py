"""Makes one page of the measurements: run time against error, operators against the roofline, memory, scaling.

    xrds bench network --model all --json network.json
    xrds_bench_operators --benchmark_out=operators.json
    python3 bench/report.py network.json --operators operators.json -o report.html

The page holds everything it shows: no other file, no script, light or dark as the browser asks. Needs Python alone.
"""
import argparse
import html
import json
import math
import sys

from report_charts import LogAxis, Plot, SERIES, STYLE, bars, legend, number, stacked, table

PRECISIONS = ("fp32", "fp16")


def seconds_text(value):
    for unit, factor in (("s", 1), ("ms", 1e3), ("µs", 1e6)):
        if value * factor >= 1:
            return f"{number(value * factor)} {unit}"
    return f"{number(value * 1e6)} µs"


def bytes_text(value):
    return f"{number(value / 1e9)} GB" if value >= 1e9 else f"{number(value / 1e6)} MB"


def power_text(value):
    """1e-06 as a power of ten, other numbers in two digits."""
    exponent = round(math.log10(value))
    if math.isclose(value, 10.0 ** exponent, rel_tol=1e-6) and abs(exponent) > 2:
        return "10" + str(exponent).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return number(value) if 1e-2 <= value < 1e4 else f"{value:.1e}"


def seconds_of(network):
    """Median wall clock of a steady frame; None of a refused one."""
    return network["wallSeconds"]["median"] if "refused" not in network else None


def short(model):
    return model.removeprefix("xrds-")


class Device:
    """One device's rows, and the colours of its models."""

    def __init__(self, description, data):
        self.name, self.description = description["name"], description
        self.networks = [row for row in data["networks"] if row["device"] == description["uuid"]]
        self.accuracies = {(row["model"], row["precision"]): row for row in data["accuracies"]
                           if row["device"] == description["uuid"]}
        self.models = list(dict.fromkeys(row["model"] for row in self.networks))
        self.sizes = sorted({row["width"] for row in self.networks})

    def series(self, model):
        return self.models.index(model) % SERIES

    def ran(self, size):
        return [row for row in self.networks if row["width"] == size and "refused" not in row]

    def size_to_compare(self):
        """The largest size that most networks ran at."""
        return max(self.sizes, key=lambda size: (len(self.ran(size)), size))

    def legend(self, rows):
        models = [model for model in self.models if any(row["model"] == model for row in rows)]
        used = [precision for precision in PRECISIONS if any(row["precision"] == precision for row in rows)]
        return legend([(self.series(model), short(model)) for model in models],
                      [("filled" if precision == "fp32" else "hollow", precision) for precision in used])


# ---- run time against error ----------------------------------------------------------------------------------------

def pareto_front(points):
    """Those points (x, y, ...) that no other beats in both, from the left."""
    front = []
    for point in sorted(points, key=lambda p: p[:2]):
        if not front or point[1] < front[-1][1]:
            front.append(point)
    return front


def pareto_chart(device, rows, error_of, y_title, front_of=lambda row: None):
    """Points of the same front_of() compete with each other."""
    points = []
    for row in rows:
        error = error_of(device.accuracies.get((row["model"], row["precision"]), {}))
        if error is not None and error > 0 and math.isfinite(error):
            points.append((seconds_of(row), error, row))
    if not points:
        return None
    plot = Plot(LogAxis([p[0] for p in points], "time of a frame", seconds_text),
                LogAxis([p[1] for p in points], y_title, power_text))
    fronts = [pareto_front([point for point in points if front_of(point[2]) == key])
              for key in dict.fromkeys(front_of(row) for _, _, row in points)]
    for front in fronts:
        plot.steps([(x, y) for x, y, _ in front])
    for x, y, row in points:
        plot.marker(x, y, device.series(row["model"]), row["precision"] == "fp16",
                    f"{row['model']} {row['precision']}: {seconds_text(x)}, {y:.3g}")
    best = [point for front in fronts for point in front]
    for x, y, row in best + [point for point in points if point not in best]:
        plot.label(x, y, f"{short(row['model'])} {row['precision']}", device.series(row["model"]))
    return plot.svg() + device.legend([row for _, _, row in points])


def pareto_section(device):
    size = device.size_to_compare()
    rows = device.ran(size)
    engine = pareto_chart(device, rows, lambda row: row.get("engineError", {}).get("relativeRms"), "engine error")
    image = pareto_chart(device, rows, lambda row: row.get("imageError", {}).get("relMse"), "image error (RelMSE)",
                         lambda row: row["scale"])
    parts = [figure(f"Run time against engine error, {size} × {size}", engine,
                    "Relative RMS of the output against the reference in double precision, 16 × 16 pixels of colour. "
                    "Down and left is better; the line joins what nothing else beats."),
             figure(f"Run time against image error, {size} × {size}", image,
                    "Mean RelMSE over the scenes against their references. The lines join what nothing else of "
                    "the same scale beats: models of other scales upscale other renders.")]
    return [part for part in parts if part]


# ---- memory, scaling, kernels --------------------------------------------------------------------------------------

def memory_section(device):
    size = device.size_to_compare()
    rows = [row for row in device.networks if row["width"] == size]
    entries = []
    for row in rows:
        memory = row["memory"]
        held = [("arena", memory["plannedBytes"], memory["lowerBoundBytes"])]
        if "peakProcessBytes" in memory and "refused" not in row:
            held.append(("process", memory["peakProcessBytes"], None))
        entries.append((f"{short(row['model'])} {row['precision']}", device.series(row["model"]), held))
    return figure(f"Memory, {size} × {size}", bars(entries, bytes_text),
                  "Thick: the planned arena; the tick is its lower bound, the largest set of values alive at once. "
                  "Thin: the largest resident memory of the process, which on a CPU device holds the arena too.")


def scaling_section(device):
    ran = [row for row in device.networks if "refused" not in row]
    if len(device.sizes) < 2 or not ran:
        return ""
    plot = Plot(LogAxis([size * size for size in device.sizes], "pixels of the output",
                        lambda pixels: f"{math.isqrt(round(pixels))}²", [size * size for size in device.sizes]),
                LogAxis([seconds_of(row) for row in ran], "time of a frame", seconds_text))
    for model in device.models:
        for precision in PRECISIONS:
            line = sorted((row["width"] ** 2, seconds_of(row)) for row in ran
                          if (row["model"], row["precision"]) == (model, precision))
            plot.line(line, device.series(model), dashed=precision == "fp16")
            for x, y in line:
                plot.marker(x, y, device.series(model), precision == "fp16",
                            f"{model} {precision}: {math.isqrt(x)}², {seconds_text(y)}")
    refused = [row for row in device.networks if "refused" in row]
    for row in refused:
        plot.refusal(row["width"] ** 2, device.series(row["model"]), f"{row['model']} {row['precision']}: {row['refused']}")
    note = "A straight line of slope one is time in proportion to pixels."
    if refused:
        note += " Crosses at the top: refused by the device, reasons in the table."
    return figure("Scaling", plot.svg() + device.legend(device.networks), note)


def operator_of(program):
    return "_".join(program.split("_")[:-2])


def kernel_section(device):
    size = device.size_to_compare()
    rows = [row for row in device.ran(size) if row.get("kernels")]
    totals = {}
    for row in rows:
        for kernel in row["kernels"]:
            name = operator_of(kernel["program"])
            totals[name] = totals.get(name, 0) + kernel["seconds"]
    if not totals:
        return ""
    largest = sorted(totals, key=totals.get, reverse=True)[:SERIES - 1]
    entries = []
    for row in rows:
        shares = dict.fromkeys([*largest, "others"], 0.0)
        for kernel in row["kernels"]:
            name = operator_of(kernel["program"])
            shares[name if name in shares else "others"] += kernel["seconds"]
        entries.append((f"{short(row['model'])} {row['precision']}", list(shares.values())))
    names = [*largest, "others"] if len(totals) > len(largest) else largest
    return figure(f"Where a frame's device time goes, {size} × {size}",
                  stacked(entries, seconds_text) + legend(list(enumerate(names)), []), "By operator, of the last frame.")


# ---- operators -----------------------------------------------------------------------------------------------------

class Operators:
    """What xrds_bench_operators wrote."""

    def __init__(self, data):
        self.context = data["context"]
        self.peak_flops = float(self.context["peakFlops"])
        self.peak_bytes = float(self.context["peakBytesPerSecond"])
        self.rows = [row for row in data["benchmarks"] if row.get("run_type", "iteration") == "iteration"]
        for row in self.rows:
            row["operator"], row["network"], row["precision"], row["node"] = (
                row["name"].removesuffix("/manual_time").split("/", 3))
        self.timed = [row for row in self.rows if not row.get("error_occurred")]
        self.failed = [row for row in self.rows if row.get("error_occurred")]


def roofline_section(operators):
    rows = [row for row in operators.timed if row.get("GFLOP/s")]
    if not rows:
        return ""
    names = list(dict.fromkeys(row["operator"] for row in rows))
    intensities = [row["GFLOP/s"] / row["GB/s"] for row in rows]
    ridge = operators.peak_flops / operators.peak_bytes
    x_axis = LogAxis([*intensities, ridge, 2 * max(intensities)], "FLOP a byte", power_text)
    y_axis = LogAxis([*(row["GFLOP/s"] for row in rows), operators.peak_flops / 1e9], "GFLOP/s", power_text)
    plot = Plot(x_axis, y_axis)
    knee = y_axis.low * 1e9 / operators.peak_bytes
    start = (max(knee, x_axis.low), max(y_axis.low, x_axis.low * operators.peak_bytes / 1e9))
    plot.roof([start, (ridge, operators.peak_flops / 1e9), (x_axis.high, operators.peak_flops / 1e9)])
    for row, intensity in zip(rows, intensities):
        plot.marker(intensity, row["GFLOP/s"], names.index(row["operator"]) % SERIES, row["precision"] == "fp16",
                    f"{row['name'].removesuffix('/manual_time')}: {number(row['GFLOP/s'])} GFLOP/s, {row['label']}", 2.6)
    keys = legend([(i % SERIES, name) for i, name in enumerate(names)], [("filled", "fp32"), ("hollow", "fp16")])
    return figure("Operators under the roofline", plot.svg() + keys,
                  f"Line: the measured peaks, {number(operators.peak_flops / 1e9)} GFLOP/s of multiply-adds in registers "
                  f"and {number(operators.peak_bytes / 1e9)} GB/s of copying. Tensors that stay in a cache lie above it. "
                  "Bytes are those of inputs, outputs and weights, each once.")


def bandwidth_section(operators):
    moved = {}  # by operator and precision: GB and seconds in all frames
    for row in operators.timed:
        if not row.get("GFLOP/s"):
            key, seconds = (row["operator"], row["precision"]), 1e-3 * row["real_time"] * row["perFrame"]
            gigabytes, before = moved.get(key, (0, 0))
            moved[key] = gigabytes + row["GB/s"] * seconds, before + seconds
    names = list(dict.fromkeys(name for name, _ in moved))
    entries = [(f"{name} {precision}", names.index(name) % SERIES,
                [("", gigabytes / seconds, operators.peak_bytes / 1e9)])
               for (name, precision), (gigabytes, seconds) in moved.items()]
    return figure("Operators that only move data", bars(entries, lambda v: f"{number(v)} GB/s"),
                  "Inputs and outputs a second, mean over the networks' frames; the tick is the measured copy.")


def operator_table(operators):
    rows = sorted(operators.timed, key=lambda row: -row["real_time"] * row["perFrame"])
    cells = [[row["operator"], row["network"], row["precision"], row["node"], row["label"].split(", ")[-1],
              number(row["real_time"]), f"{row['perFrame']:.0f}", number(row["real_time"] * row["perFrame"]),
              number(row["GFLOP/s"]) if row.get("GFLOP/s") else "–", number(row["GB/s"]), f"{100 * row['ofRoofline']:.0f} %",
              f"{row['rmsError']:.1e}", f"{row['maxError']:.1e}"] for row in rows]
    text = table(["operator", "network", "precision", "first node", "kernel", "ms", "× a frame", "ms a frame", "GFLOP/s",
                  "GB/s", "of roofline", "RMS error", "largest error"], cells, 5)
    failures = "".join(f"<p class=bad>{html.escape(row['name'].removesuffix('/manual_time'))}: "
                       f"{html.escape(row['error_message'])}</p>" for row in operators.failed)
    return f"<h2>Operators</h2>{failures}{text}"


# ---- the page ------------------------------------------------------------------------------------------------------

def figure(title, content, note):
    if not content:
        return ""
    return f"<figure><h3>{html.escape(title)}</h3>{content}<figcaption>{html.escape(note)}</figcaption></figure>"


def network_table(device):
    cells = []
    for row in device.networks:
        memory = row["memory"]
        peak = bytes_text(memory["peakProcessBytes"]) if "peakProcessBytes" in memory else "–"
        times = ([(row["refused"], 7)] if "refused" in row else
                 [seconds_text(row[key]) for key in ("openSeconds", "preparationSeconds", "firstSeconds")]
                 + [seconds_text(row["wallSeconds"][key]) for key in ("median", "least", "most")])
        if "refused" not in row:
            times.append(seconds_text(row["deviceSeconds"]["median"]) if "deviceSeconds" in row else "–")
        cells.append([short(row["model"]), row["precision"], f"{row['width']}²", *times, bytes_text(memory["plannedBytes"]),
                      bytes_text(memory["lowerBoundBytes"]), bytes_text(memory["unaliasedBytes"]), peak])
    return table(["model", "precision", "output", "open", "prepare", "first", "median", "least", "most", "on device",
                  "arena", "lower bound", "unaliased", "process"], cells, 3)


def accuracy_table(device):
    cells = []
    for (model, precision), row in device.accuracies.items():
        engine, image = row.get("engineError"), row.get("imageError")
        to_fp32 = engine.get("relativeMaxToFp32") if engine else None
        metrics = ["–"] * 4
        if image:
            metrics = [f"{image['psnr']:.2f}", f"{image['relMse']:.4f}", f"{image['flip']:.4f}", str(image["scenes"])]
        elif "imageErrorMissing" in row:
            metrics = [(row["imageErrorMissing"], 4)]
        cells.append([short(model), precision, f"{engine['relativeRms']:.1e}" if engine else "–",
                      f"{engine['worstRelativeRms']:.1e} ({engine['worstOperator']})" if engine else "–",
                      f"{to_fp32:.1e}" if to_fp32 is not None else "–",
                      *metrics])
    return table(["model", "precision", "engine error", "of its worst operator", "largest to fp32", "PSNR dB", "RelMSE",
                  "FLIP", "scenes"], cells, 2) if cells else ""


def device_part(device, runs):
    description = device.description
    charts = [*pareto_section(device), scaling_section(device), memory_section(device), kernel_section(device)]
    return (f"<h2>{html.escape(device.name)}</h2><p class=note>{html.escape(description['driver'])}, Vulkan "
            f"{html.escape(description['apiVersion'])}; median of {runs} frames after the first.</p>"
            f"<div class=charts>{''.join(charts)}</div>{network_table(device)}{accuracy_table(device)}")


def page(data, operators):
    parts = [device_part(Device(description, data), data["runs"]) for description in data["devices"]]
    if operators:
        parts.append(f"<h2>Operators on {html.escape(operators.context['device'])}</h2><div class=charts>"
                     f"{roofline_section(operators)}{bandwidth_section(operators)}</div>{operator_table(operators)}")
    definitions = "".join(f"<dt>{html.escape(name)}</dt><dd>{html.escape(text)}</dd>"
                          for name, text in data["definitions"].items())
    return (f"<!doctype html>\n<html lang=en><head><meta charset=utf-8>"
            f"<meta name=viewport content=\"width=device-width, initial-scale=1\"><title>xrds: speed, memory, error</title>"
            f"<style>{STYLE}</style></head><body><h1>xrds {html.escape(data['version'])}: speed, memory, error</h1>"
            f"{''.join(parts)}<details><summary>What the numbers mean</summary><dl>{definitions}</dl></details>"
            f"</body></html>\n")


def read(path):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError) as error:
        sys.exit(f"report.py: Cannot read '{path}': {error}.")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("network", help="what xrds bench network --json wrote")
    parser.add_argument("--operators", help="what xrds_bench_operators --benchmark_out= wrote")
    parser.add_argument("-o", "--output", default="report.html")
    arguments = parser.parse_args()
    data = read(arguments.network)
    if "networks" not in data:
        sys.exit(f"report.py: '{arguments.network}' was not written by xrds bench network --json.")
    operators = read(arguments.operators) if arguments.operators else None
    if operators is not None and "peakFlops" not in operators.get("context", {}):
        sys.exit(f"report.py: '{arguments.operators}' was not written by xrds_bench_operators.")
    text = page(data, Operators(operators) if operators else None)
    try:
        with open(arguments.output, "w", encoding="utf-8") as file:
            file.write(text)
    except OSError as error:
        sys.exit(f"report.py: Cannot write '{arguments.output}': {error}.")


if __name__ == "__main__":
    main()
