"""Judges the kernels by the compilers of real GPUs, with no GPU: what RADV makes of every pipeline for GPUs of AMD on its null
device, and NVK for those of NVIDIA on a kernel interface that does nothing.

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
import pathlib
import subprocess
import sys
import tempfile

import gpu_static_loops
import gpu_static_report

ROOT = pathlib.Path(__file__).resolve().parent.parent
COMPUTE_UNITS = {"vega10": 64, "navi10": 40, "navi21": 80, "navi31": 96, "gfx1150": 16, "gfx1200": 32}  # of AMD, by RADV
CHIPSETS = {"turing": "164", "ampere": "174"}  # of NVIDIA, by NVK
COMPUTE_UNITS |= {"turing": 46, "ampere": 46}
MEMORY_BYTES = {"gfx1150": 4 << 30}  # an integrated GPU; 8 GiB and more of the others
FRAME = 256  # a side of the low-resolution frame
MATRIX_KERNELS = ("conv3x3", "linear", "swin_layer", "window_attention")
WARP_SCHEDULERS = 4  # of a multiprocessor of NVIDIA, which share its warps
MODELS = sorted(path.stem for path in (ROOT / "models").glob("*.safetensors"))


class Mesa:
    """A Mesa in its folder, "mesa25" or "mesa26", and how to run programs with it."""

    def __init__(self, name="mesa25"):
        cache = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache")
        self.folder = pathlib.Path(os.environ.get("XRDS_" + name.upper()) or cache / "xrds" / name)

    def exists(self):
        return (self.folder / "complete").exists()

    def version(self):
        return (self.folder / "complete").read_text().strip()

    def run(self, *command, gpu=None):
        usr = self.folder / "usr"
        libraries = usr / "lib" / "x86_64-linux-gnu"
        loader = [usr / "lib64" / "ld-linux-x86-64.so.2", "--library-path", libraries]
        environment = dict(os.environ, MESA_SHADER_CACHE_DISABLE="true", LP_NATIVE_VECTOR_WIDTH="256")
        driver = "radeon"
        if gpu in CHIPSETS:
            driver = "nouveau"
            loader += ["--preload", libraries / "libnouveau_noop_drm_shim.so"]
            environment |= {"NVK_I_WANT_A_BROKEN_VULKAN_DRIVER": "1", "NOUVEAU_CHIPSET": CHIPSETS[gpu]}
        elif gpu:
            environment["RADV_FORCE_FAMILY"] = gpu
        environment["VK_DRIVER_FILES"] = str(usr / "share" / "vulkan" / "icd.d" / f"{driver}_icd.json")
        done = subprocess.run(list(map(str, [*loader, *command])), env=environment, capture_output=True)
        if done.returncode != 0:
            raise RuntimeError(f"{command[0]} failed: {done.stdout[-2000:].decode()} {done.stderr[-2000:].decode()}")
        return done.stdout

    def compile_matrix_kernels(self, folder):
        """The kernels for VK_KHR_cooperative_matrix, which the glslang of older systems does not know, as SPIR-V."""
        for name in MATRIX_KERNELS:
            source = ROOT / "shaders" / name / f"{name}_matrix.comp"
            for stored, define in (("f16", ["-DXRDS_F16"]), ("f32", [])):
                self.run(self.folder / "usr" / "bin" / "glslangValidator", "-V", "--quiet", "--target-env", "vulkan1.2", f"-I{ROOT}",
                         "-DXRDS_MATRIX_KHR", *define, "-o", pathlib.Path(folder) / f"{name}_matrix_khr_{stored}.spv", source)


def read_pipeline(raw):
    """What is kept of a pipeline."""
    if "error" in raw:
        return {name: raw[name] for name in ("program", "specialization", "error")}
    said = raw["statistics"]
    common = {name: raw[name] for name in ("program", "specialization", "groupSize", "subgroupSize")}
    if "Number of GPRs" in said:  # NVK
        return common | {
            "registers": int(said["Number of GPRs"]), "spills": int(said["Spills to memory"] + said["Fills from memory"]),
            "scratch": int(said["SLM size"]), "shared": raw["sharedBytes"][0] if raw["sharedBytes"] else 0,
            "waves": int(said["Max warps/SM"]) // WARP_SCHEDULERS, "codeBytes": int(said["Code size"]), "latency": int(said["Static cycle count"]),
            "inverseThroughput": 0, "loop": gpu_static_loops.whole_program(raw["assembly"])}
    return common | {
        "registers": int(said["VGPRs"]), "spills": int(said["Spilled VGPRs"] + said["Spilled SGPRs"]), "scratch": int(said["Scratch size"]),
        "shared": int(said["LDS size"]), "waves": int(said["Subgroups per SIMD"]), "codeBytes": int(said["Code size"]),
        "latency": int(said["Latency"]), "inverseThroughput": int(said["Inverse Throughput"]), "loop": gpu_static_loops.inner_loop(raw["assembly"])}


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


def measure(mesa, program, spirv, gpu, models, *options):
    """What the program says of one GPU, read."""
    paths = [path if (path := ROOT / "models" / f"{model}.safetensors").exists() else model for model in models]
    raw = json.loads(mesa.run(program, *paths, "--programs", spirv, "--width", FRAME, "--height", FRAME, "--memory-bytes",
                              MEMORY_BYTES.get(gpu, 8 << 30), *options, gpu=gpu))
    return {"gpu": gpu, "device": raw["device"], "driver": raw["driver"], "computeUnits": COMPUTE_UNITS[gpu],
            "pipelines": [read_pipeline(each) for each in raw["pipelines"]],
            "networks": [read_network(each, COMPUTE_UNITS[gpu]) for each in raw["networks"]]}


def mesa_of(gpu):
    return Mesa("mesa26" if gpu in CHIPSETS else "mesa25")


def measure_all(program, gpus, models, *options):
    with tempfile.TemporaryDirectory() as spirv:
        mesa_of(gpus[0]).compile_matrix_kernels(spirv)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            return list(pool.map(lambda gpu: measure(mesa_of(gpu), program, spirv, gpu, models, *options), gpus))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=ROOT / "build" / "release" / "bench" / "xrds_gpu_static")
    parser.add_argument("--gpus", default=",".join(COMPUTE_UNITS))
    parser.add_argument("--models", help="all that are shipped, and the networks of others")
    parser.add_argument("--print", action="store_true", help="print the kernels of each model and write nothing")
    parser.add_argument("--shape", default="0,0", help="OUTPUTS,ROWS asked of all kernels, as tuning asks of one (KernelShape); with --print")
    options = parser.parse_args()
    if options.shape != "0,0" and not options.print:
        sys.exit("--shape goes with --print: the table is of the fixed choice.")
    names = options.gpus.split(",")
    for mesa in map(mesa_of, names):
        if not mesa.exists():
            sys.exit(f"{mesa.folder} has no Mesa: run bench/gpu_static_mesa.sh.")
    models = options.models.split(",") if options.models else [*MODELS, *others(options.program)]
    outputs, rows = options.shape.split(",")
    gpus = measure_all(options.program, names, models, "--shape-outputs", outputs, "--shape-rows", rows)
    if options.print:
        for gpu in gpus:
            for network in gpu["networks"]:
                print("\n".join(gpu_static_report.kernel_lines(gpu, network)))
        return
    report = {"mesa": " and ".join(sorted({mesa_of(name).version() for name in names})), "commit": gpu_static_report.commit(ROOT), "frame": FRAME, "gpus": gpus}
    gpu_static_report.write_json(ROOT / "bench" / "results" / "gpu_static.json", report)
    (ROOT / "bench" / "gpu_static.md").write_text(gpu_static_report.document(report))


if __name__ == "__main__":
    main()
