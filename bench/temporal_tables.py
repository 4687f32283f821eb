"""The tables of bench/temporal.md."""
import statistics

WAYS = ("xrds", "median", "temporal", "oidn", "rdg")
SHOWN = {"xrds": "xrds", "median": "median of 3", "temporal": "`--temporal`", "oidn": "OIDN", "rdg": "RDG"}


def sequences(kept):
    lines = ["| sequence | frames | way | PSNR dB | least over xrds, dB | RelMSE | flicker | of xrds | ColorVideoVDP |", "|---|---|---|---|---|---|---|---|---|"]
    for name, row in kept["sequences"].items():
        alone = row["ways"]["xrds"]
        for way in filter(row["ways"].__contains__, WAYS):
            found = row["ways"][way]
            least = min(a - b for a, b in zip(found["psnr"], alone["psnr"]))
            video = "" if found["video"] is None else f"{found['video']:.2f}"
            lines.append(f"| {name} | {row['frames']} | {SHOWN[way]} | {statistics.mean(found['psnr']):.2f} | {'' if way == 'xrds' else f'{least:+.2f}'} | "
                         f"{found['relmse']:.4f} | {found['flicker']:.4f} | {100 * found['flicker'] / alone['flicker']:.0f} % | {video} |")
    return "\n".join(lines) + "\n"
