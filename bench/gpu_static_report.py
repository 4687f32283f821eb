"""Writes what bench/gpu_static.py has found: a JSON of a line a pipeline, and tables."""
import collections
import json
import subprocess

SHOWN_MODEL = "xrds-x4-compact"
HEAD = """# The kernels under the compilers of GPUs

Made by `python3 bench/gpu_static.py` with Mesa {mesa}, commit {commit}. Mesa's drivers compiled every pipeline of every shipped model,
and of the networks of others (docs/networks.md) in their published sizes with random weights, for GPUs that were not there. Nothing ran, so these are counts and a
compiler's estimates, not times. `bench/results/gpu_static.json` has every pipeline. Frames of {frame} x {frame} low-resolution pixels.

| GPUs | driver | on | latency | waves | counts of instructions |
|---|---|---|---|---|---|
| vega10, navi10, navi21, navi31, gfx1150; gfx1201 | RADV of AMD | its null device; a shim | ACO's estimate | of a SIMD | of the inner loop |
| turing (chip 164), ampere (174) | NVK of NVIDIA | a shim | NAK's cycles | warps of a scheduler | of the program |
| tgl (Xe of 2020), dg2 (Arc A770M), bmg (Arc B580) | ANV of Intel | a shim | its cycles | registers do not decide | of the program |
| m1 | Honeykrisp of Apple | a shim | arithmetic alone | of a scheduler | |
| a740 | Turnip of Qualcomm (Adreno) | a shim | | of a core | of the program |

A shim is a kernel interface that does nothing: Debian's `mesa-drm-shim`, for Intel made of Mesa's source. ACO and ANV guess how often a loop runs: their estimates compare
variants of one kernel with the same loops, and nothing else. Of Ada (chip 192) the shim knows too little. Apple's own compiler, which MoltenVK uses, is not Honeykrisp's, and
that of Intel on Windows not ANV's: they share the hardware, its registers above all.

*Products* is the share of the inner loop's vector time that multiply-adds take, of which a product of matrix units counts as 16 vector instructions.
*Filling* is the share of a frame's work in dispatches of at least two workgroups for each compute unit. *16-bit* are loads of single halves.

Short of the aim of four waves a SIMD, on vega10 alone: window attention (2; plain 3), `linear_tile` (3) and `conv3x3_tile` (2), whose four waves would have 64
registers each. Registers are what limits them, not shared memory. By the compiler's estimates two waves are enough: latency divided by the waves is at
most the inverse throughput. So the fixed choice stays as it is, and smaller ones are left to `xrds tune`: four pixels an invocation of `conv3x3_tile`
(`--shape 4,0`) have 3 or 4 waves, and an inverse throughput 7 to 12 % higher for the same work; four tokens of `linear_tile` (`--shape 0,4`) 4 waves and 8 to 12 %.
Window attention that takes four keys together in place of eight has 3 waves where windows are not shifted, else 2, and 16 to 25 % more: not kept.

NVK leaves the loops of `conv3x3_plain` and `linear_plain` over their pixels and tokens as they are: their sums, 64 to 80 bytes, lie in local memory. No other
family has any.

GPUs differ in their registers, and Vulkan does not tell how many they have. On Intel's an invocation has 128 of 32 bits in the smallest subgroups, and fewer in larger ones.
`conv3x3_tile` with eight pixels an invocation spilled 32 to 59 of them in every shape, and the matrix kernels, in the subgroups of 32 that the driver prefers, 9 to 848.
So GPUs of makers with few registers (`registersOf()`) get four pixels, the smallest subgroups for matrices with at most two fragments of outputs a workgroup in `conv3x3`, and
runs of two pixels in the joint bilateral filter, which spilled on Apple's and Qualcomm's, too. The matrix kernels spilled 12 to 226 even so on Alchemist (dg2), whose subgroups
of 8 have 4 KiB: it takes the tile kernels. Window attention reads a row of scores twice in subgroups of 16, where it spilled 34. What is left on Intel are one or two values of it in `tile`.

Sums of few products in halves, two an instruction, were tried in `linear_tile` and `conv3x3_tile` (commits 09b2a0e and 96e33ac: 8 and 12 products, four at a time, then a sum in fp32).
By ACO's inverse throughput they take 0.70 to 0.80 of the time on RDNA 1 and 2 and 0.78 to 0.85 on vega10; NAK counts 0.72 to 0.85 of the cycles on Turing, 0.63 to 0.67 on Ampere.
RDNA 3 and 4, which take two floats an instruction, too, need 1.14 to 1.23 of it (`bench/results/gpu_static.json` of aaa7167); on Intel's GPUs 79 registers were spilled. The PSNR of
four scenes changed by at most 0.001 dB, but the error of a convolution of the golden model `s2_guided` was 1.2e-3, its budget is 8e-4, and sums beyond 65504 were lost: in
`xrds bench stress` 34864 pixels of `xrds-x2-live` were not finite. Not kept. Window attention with values added up so took 0.94 on RDNA and 1.28 on vega10.

Loads from shared memory in the fused layer of 96 channels once were 116 beside 24 products in the loop of a map. A head's loop, into which the map's is now
unrolled, has 64 beside 57: 1.1 a product in place of 4.8; the map alone 24 beside 39.
"""


def commit(root):
    git = ["git", "-C", str(root)]
    name = subprocess.run([*git, "rev-parse", "--short", "HEAD"], capture_output=True, text=True, check=True).stdout.strip()
    changed = subprocess.run([*git, "status", "--porcelain", "--untracked-files=no"], capture_output=True, text=True, check=True).stdout
    return name + ("+" if changed.strip() else "")


def write_json(path, report):
    """A line for each pipeline and network."""
    lines = lambda rows: "[\n" + ",\n".join(json.dumps(row, separators=(",", ":")) for row in rows) + "]"
    gpus = []
    for gpu in report["gpus"]:
        head = json.dumps({name: gpu[name] for name in ("gpu", "device", "driver", "computeUnits")})
        gpus.append(head[:-1] + ',\n"networks": ' + lines(gpu["networks"]) + ',\n"pipelines": ' + lines(gpu["pipelines"]) + "}")
    head = json.dumps({name: report[name] for name in ("mesa", "commit", "frame")})
    path.write_text(head[:-1] + ', "gpus": [\n' + ",\n".join(gpus) + "]}\n")


def used_by(gpu, family, precision=None):
    """The pipelines of a family, each with its largest share of a model's work."""
    shares = collections.Counter()
    for network in gpu["networks"]:
        if network["family"] == family and precision in (None, network["precision"]):
            for pipeline, share in network["shares"].items():
                shares[int(pipeline)] = max(shares[int(pipeline)], share)
    return [(gpu["pipelines"][pipeline], share) for pipeline, share in sorted(shares.items())]


def families(gpu):
    return list(dict.fromkeys(network["family"] for network in gpu["networks"]))


def overview(report):
    rows = ["| GPU | family | pipelines | refused | spills | scratch | fewest waves, of kernels with 3 % of the work |", "|---|---|--:|--:|--:|--:|--:|"]
    for gpu in report["gpus"]:
        for family in families(gpu):
            used = used_by(gpu, family)
            good = [(pipeline, share) for pipeline, share in used if "error" not in pipeline]
            waves = [pipeline["waves"] for pipeline, share in good if share > 0.03 and pipeline["waves"]]
            rows.append(f"| {gpu['gpu']} | `{family}` | {len(used)} | {len(used) - len(good)} | {sum(p['spills'] for p, _ in good)} | "
                        f"{sum(p['scratch'] for p, _ in good)} | {min(waves, default='')} |")
    return rows


def kernel_lines(gpu, network):
    """The kernels with at least a hundredth of the network's work."""
    rows = [f"`{network['model']}` on {gpu['gpu']}, `{network['family']}`, {network['precision']}: {network['dispatches']} dispatches, filling "
            f"{100 * network['filling']:.0f} %, arena {network['arenaBytes'] / 1e6:.0f} MB", "",
            "| kernel | work % | subgroup | registers | shared KiB | waves | latency | inverse throughput | products % | products | shared loads | loads | "
            "16-bit | vector | waits | all |", "|---|" + "--:|" * 15]
    for index, share in sorted(network["shares"].items(), key=lambda item: -item[1]):
        pipeline = gpu["pipelines"][int(index)]
        if share < 0.01 or "error" in pipeline:
            continue
        loop = pipeline["loop"] or {}
        count = lambda *names: sum(loop.get(name, 0) for name in names)
        constants = ",".join(map(str, pipeline["specialization"][:5]))
        rows.append(f"| `{pipeline['program']}` {constants} | {100 * share:.1f} | {pipeline['subgroupSize']} | {pipeline['registers']} | "
                    f"{pipeline['shared'] / 1024:.1f} | {pipeline['waves'] or ''} | {pipeline['latency'] or ''} | {pipeline['inverseThroughput'] or ''} | "
                    f"{100 * loop.get('productShare', 0):.0f} | {count('products', 'multiplyAdds')} | {count('sharedLoads')} | {count('loads')} | "
                    f"{count('gathers16')} | {count('vector')} | {count('waits')} | {count('all')} |")
    return rows


def dispatch_lines(report):
    gpu = next(gpu for gpu in report["gpus"] if "matrix" in families(gpu))
    rows = [f"On {gpu['gpu']}, fp16:", "", "| model | family | dispatches | filling % | arena MB |", "|---|---|--:|--:|--:|"]
    for network in gpu["networks"]:
        if network["precision"] == "fp16" and network["family"] != "plain":
            rows.append(f"| `{network['model']}` | `{network['family']}` | {network['dispatches']} | {100 * network['filling']:.0f} | {network['arenaBytes'] / 1e6:.0f} |")
    return rows


def kernel_tables(report, name, wanted, models):
    """Of the models on that GPU, in fp16."""
    rows = []
    for gpu in report["gpus"]:
        for network in gpu["networks"]:
            if gpu["gpu"] == name and network["family"] in wanted and network["model"] in models and network["precision"] == "fp16":
                rows += [*kernel_lines(gpu, network), ""]
    return rows


def document(report):
    parts = [HEAD.format(**report), "## All pipelines", "", *overview(report), "", "## Dispatches of a frame", "", *dispatch_lines(report), "",
             f"## Kernels of `{SHOWN_MODEL}`", "", "Those with at least 1 % of the work; counts are of the inner loop on GPUs of AMD, else of the whole program.", ""]
    shown = (("navi31", ("matrix", "fused", "tile")), ("navi21", ("tile",)), ("vega10", ("tile",)), ("ampere", ("matrix", "fused", "tile")),
             ("bmg", ("matrix", "tile")), ("tgl", ("tile",)), ("m1", ("tile",)), ("a740", ("tile",)))
    for name, wanted in shown:
        parts += kernel_tables(report, name, wanted, [SHOWN_MODEL])
    others = {network["model"] for gpu in report["gpus"] for network in gpu["networks"] if not network["model"].startswith("xrds-")}
    parts += ["## Kernels of networks of others", "", *kernel_tables(report, "navi31", ("matrix",), others)]
    return "\n".join(parts).rstrip() + "\n"
