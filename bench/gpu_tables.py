"""The table of docs/performance.md that is made of bench/results/gpu_network.json, a report of `xrds bench network` on a GPU."""


def gpu_network(report):
    """Markdown: milliseconds of a frame with its transfers and of the device alone, memory and start, by model."""
    device, machine = report["devices"][0], report["machine"]
    kernels = " and ".join(sorted({row["kernelFamily"] for row in report["networks"]}))
    lines = [f"`{report['command']}`, commit {report['commit']}, {device['name']}, driver {device['driver']}, {machine['processors']} cores of an "
             f"{machine['processor']}, {kernels} kernels, medians of {report['runs']} frames:", "",
             "| model | ms a frame, with transfers | of which the device computes | images a second of the device | MB of device memory | start, s |",
             "|---|--:|--:|--:|--:|--:|"]
    for row in sorted(report["networks"], key=lambda row: row["deviceSeconds"]["median"]):
        frame, computed = (1e3 * row[key]["median"] for key in ("wallSeconds", "deviceSeconds"))
        lines.append(f"| `{row['model']}` | {frame:.1f} | {computed:.1f} | {1e3 / computed:.0f} | {row['memory']['deviceBytes'] / 1e6:.0f} "
                     f"| {row['openSeconds'] + row['preparationSeconds']:.2f} |")
    return "\n".join(lines) + "\n"
