"""Judges the kernels by the compilers of real GPUs, with no GPU: what Mesa's drivers make of every pipeline for GPUs of AMD on
RADV's null device, and for others, of NVIDIA, Intel, Apple and Qualcomm, on kernel interfaces that do nothing.

    bench/gpu_static_mesa.sh                                          # once: Mesa 25.0 and 26 in folders of their own
    cmake --build --preset release --target xrds_gpu_static
    python3 bench/gpu_static.py                                       # minutes; writes bench/gpu_static.md and results
    python3 bench/gpu_static.py --gpus navi31 --models xrds-x4-compact --print  # one, to look at
    python3 bench/gpu_static.py --gpus vega10 --models xrds-x4-compact --print --shape 4,4  # a shape that tuning tries

Nothing runs: these are what a compiler says and counts, not times. ACO guesses how often loops run, so its latency and
inverse throughput compare variants of one kernel under one Mesa, and nothing else.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile

import gpu_static_loops
import gpu_static_report
from gpu_static_gpus import GPUS, ROOT

FRAME = 256  # a side of the low-resolution frame
MODELS = sorted(path.stem for path in (ROOT / "models").glob("*.safetensors"))


def of_radv(raw, said):
    return {"registers": int(said["VGPRs"]), "spills": int(said["Spilled VGPRs"] + said["Spilled SGPRs"]), "scratch": int(said["Scratch size"]),
            "shared": int(said["LDS size"]), "waves": int(said["Subgroups per SIMD"]), "latency": int(said["Latency"]),
            "inverseThroughput": int(said["Inverse Throughput"]), "loop": gpu_static_loops.inner_loop(raw["assembly"])}


def of_nvk(raw, said):
    warp_schedulers = 4  # of a multiprocessor, which share its warps
    return {"registers": int(said["Number of GPRs"]), "spills": int(said["Spills to memory"] + said["Fills from memory"]), "scratch": int(said["SLM size"]),
            "shared": raw["sharedBytes"][0] if raw["sharedBytes"] else 0, "waves": int(said["Max warps/SM"]) // warp_schedulers,
            "latency": int(said["Static cycle count"]), "loop": gpu_static_loops.whole_program(raw["assembly"])}


def of_anv(raw, said):
    """A subgroup has 128 registers of its own, so how many are at work does not depend on them."""
    return {"registers": int(said["Max live registers"]), "spills": int(said["Spill Count"] + said["Fill Count"]), "scratch": int(said["Scratch Memory Size"]),
            "shared": int(said["Workgroup Memory Size"]), "latency": int(said["Cycle Count"]), "loop": gpu_static_loops.whole_gen_program(raw["assembly"])}


def of_honeykrisp(raw, said):
    subgroup, schedulers = 32, 4  # of a core
    return {"registers": (int(said["GPRs"]) + 1) // 2, "spills": int(said["Spills"] + said["Fills"]), "scratch": int(said["Scratch"]),
            "waves": int(said["Threads"]) // subgroup // schedulers, "latency": int(said["ALU"]), "loop": {"all": int(said["Instructions"])}}


def of_turnip(raw, said):
    return {"registers": 4 * int(said["Registers used"]), "spills": int(said["STP Count"] + said["LDP Count"]), "waves": int(said["Max Waves Per Core"]),
            "loop": {"all": int(said["Instruction Count"])}}


READERS = {"radeon": of_radv, "nouveau": of_nvk, "intel": of_anv, "asahi": of_honeykrisp, "freedreno": of_turnip}


def read_pipeline(raw, driver):
    """What is kept of a pipeline: 0 where the compiler does not tell. Waves are the subgroups that the registers leave beside each
    other for a SIMD or scheduler, None where they do not decide."""
    if "error" in raw:
        return {name: raw[name] for name in ("program", "specialization", "error")}
    common = {name: raw[name] for name in ("program", "specialization", "groupSize", "subgroupSize")}
    untold = {"scratch": 0, "shared": 0, "waves": None, "latency": 0, "inverseThroughput": 0, "loop": None, "codeBytes": int(raw["statistics"].get("Code size", 0))}
    return common | untold | READERS[driver](raw, raw["statistics"])


def read_network(raw, compute_units):
    """Dispatches of a network: how many, how their work fills the device, and the share of each pipeline."""
    total = sum(launch["multiplyAdds"] for launch in raw["dispatches"]) or 1
    shares, filling, small = collections.Counter(), 0, []
    for launch in raw["dispatches"]:
        groups = launch["groups"][0] * launch["groups"][1] * launch["groups"][2]
        share = launch["multiplyAdds"] / total
        shares[launch["pipeline"]] += share
        filling += share if groups >= 2 * compute_units else 0
        if share > 0.03 and groups < 2 * compute_units:
            small.append([launch["pipeline"], groups])
    return {"model": raw["model"], "precision": raw["precision"], "family": raw["family"], "arenaBytes": raw["arenaBytes"],
            "dispatches": len(raw["dispatches"]), "operators": raw["operators"], "cuts": raw["cuts"], "filling": round(filling, 3), "tooSmall": small,
            "largestGrid": max(max(launch["groups"]) for launch in raw["dispatches"]),
            "shares": {pipeline: round(share, 4) for pipeline, share in sorted(shares.items()) if pipeline >= 0}}


def others(program):
    """The names of the networks of others, which get random weights."""
    return subprocess.run([program, "--published"], check=True, capture_output=True, text=True).stdout.split()


def measure(name, program, spirv, models, *options):
    """What the program says of one GPU, read."""
    gpu = GPUS[name]
    paths = [path if (path := ROOT / "models" / f"{model}.safetensors").exists() else model for model in models]
    raw = json.loads(gpu.run(program, *paths, "--programs", spirv, "--width", FRAME, "--height", FRAME, "--memory-bytes", gpu.memory_bytes, *options))
    return {"gpu": name, "device": raw["device"], "driver": raw["driver"], "computeUnits": gpu.compute_units,
            "pipelines": [read_pipeline(each, gpu.driver) for each in raw["pipelines"]],
            "networks": [read_network(each, gpu.compute_units) for each in raw["networks"]]}


def measure_all(program, names, models, *options):
    with tempfile.TemporaryDirectory() as spirv:
        GPUS[names[0]].mesa.compile_matrix_kernels(spirv)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            return list(pool.map(lambda name: measure(name, program, spirv, models, *options), names))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build" / "release" / "bench" / "xrds_gpu_static")
    parser.add_argument("--gpus", default=",".join(GPUS))
    parser.add_argument("--models", help="all that are shipped, and the networks of others")
    parser.add_argument("--print", action="store_true", help="print the kernels of each model and write nothing")
    parser.add_argument("--shape", default="0,0", help="OUTPUTS,ROWS asked of all kernels, as tuning asks of one (KernelShape); with --print")
    options = parser.parse_args()
    if options.shape != "0,0" and not options.print:
        sys.exit("--shape goes with --print: the table is of the fixed choice.")
    names = options.gpus.split(",")
    if not options.print and names != list(GPUS):
        sys.exit("--gpus goes with --print: the table is of all.")
    for name in names:
        if name not in GPUS:
            sys.exit(f"There is no GPU '{name}': choose of {', '.join(GPUS)}.")
        if not GPUS[name].exists():
            sys.exit(f"{GPUS[name].mesa.folder} has no driver for {name}: run bench/gpu_static_mesa.sh.")
    models = options.models.split(",") if options.models else [*MODELS, *others(options.program)]
    outputs, rows = options.shape.split(",")
    gpus = measure_all(options.program, names, models, "--shape-outputs", outputs, "--shape-rows", rows)
    if options.print:
        for gpu in gpus:
            for network in gpu["networks"]:
                print("\n".join(gpu_static_report.kernel_lines(gpu, network)))
        return
    report = {"mesa": " and ".join(sorted({GPUS[name].mesa.version() for name in names})), "commit": gpu_static_report.commit(ROOT), "frame": FRAME, "gpus": gpus}
    gpu_static_report.write_json(ROOT / "bench" / "results" / "gpu_static.json", report)
    (ROOT / "bench" / "gpu_static.md").write_text(gpu_static_report.document(report))


if __name__ == "__main__":
    main()
