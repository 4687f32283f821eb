"""Times the engine beside ONNX Runtime, PyTorch and ncnn: the same weights and frame size, on the CPU or a CUDA GPU, in alternation.

    python3 bench/peers.py build/release/bench/xrds_bench_network [--configs compact,paper] [--size 1024] [--rounds 5]
    python3 bench/peers.py build/release/bench/xrds_bench_network --configs edsr,rcan,swinir,msspl,paper --scale 8 --rounds 1
    python3 bench/peers.py build/release/bench/xrds_bench_network --peers pytorch-cuda-fp16,pytorch-cuda-fp16-compile --precision fp16

Needs `pip install -r bench/peers-requirements.txt`. Random weights, written by the engine or (EDSR, RCAN, SwinIR, MSSPL, ...)
by training/architectures, are loaded by training/. Every peer is a process of its own with one thread a core; in each round each peer
in turn runs one frame that is not timed and one that is. Where a frame takes longer than 10 s, that before the first round is
the one that is not timed. In a single round each peer ends before the next one starts, which leaves the memory to it. Peers run the bare network on resident tensors. The engine's time includes more:
upload, exposure, radiance transform, packing, base image, learned kernels, inverse transform and download; the last
column is the ratio without the share of those that are kernels, as the engine's profile has it. On a GPU a
peer's output stays there, its fp32 is no TF32, and its memory is PyTorch's peak on the device. ncnn's time on Vulkan
includes the transfers (peers_ncnn.py has its network).
"""
import argparse
import collections
import dataclasses
import importlib
import importlib.metadata
import importlib.util
import json
import os
import pathlib
import platform
import re
import statistics
import subprocess
import sys
import tempfile
import time
import types

import numpy

CONFIGS = {
    "paper": dict(channels=64, aux_channels=32, groups=3, blocks=5, head_channels=32),
    "compact": dict(channels=32, aux_channels=16, groups=3, blocks=1, head_channels=32, kernels=5, aux_skip=True,
                    aux_kernels=5, output_side=1),
    "small": dict(channels=32, aux_channels=16, groups=1, blocks=1, head_channels=32, kernels=5, aux_skip=True,
                  aux_kernels=5, output_side=1),
    "nano": dict(channels=16, aux_channels=8, groups=1, blocks=1, head_channels=16, aux_skip=True,
                 output_side=1),
}
WARM_SECONDS = 10
# Kernels of the engine that are not the network's. box_mean is left out: most of its runs copy rows of the network.
PIPELINE = ("decode_radiance", "encode_radiance", "exposure", "filter_auxiliary", "joint_bilateral", "pack_auxiliary")
CORES = len(os.sched_getaffinity(0))
ENVIRONMENT = {**os.environ, "OMP_WAIT_POLICY": "PASSIVE", "OMP_NUM_THREADS": str(CORES), "LP_NUM_THREADS": str(CORES)}


def training(name):
    """A module of training/."""
    sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "training"))
    return importlib.import_module(name)


def network_inputs(size, config):
    """(x [1, 3, size/s, size/s], aux [1, A, size, size] if the network has any), uniform in [0, 1)."""
    random = numpy.random.default_rng(1)
    colour = random.random((1, 3, size // config.scale, size // config.scale), numpy.float32)
    return (colour, random.random((1, 3 * len(config.aux_inputs), size, size), numpy.float32)) if config.aux_inputs else (colour,)


# ---- in the process of a peer --------------------------------------------------------------------------------------

def load_network(model):
    import torch
    torch.set_num_threads(CORES)
    is_of_others = config_of(model).architecture != "xrds"
    return torch, training("architectures").load_model(model) if is_of_others else training("weights").load_model(model)[0]


def config_of(model):
    """The configuration that the file's metadata states."""
    with open(model, "rb") as file:
        fields = json.loads(file.read(int.from_bytes(file.read(8), "little")))["__metadata__"]
    names = fields.get("aux_inputs", "")
    return types.SimpleNamespace(architecture=fields.get("architecture", "xrds"), scale=int(fields["scale"]), aux_inputs=tuple(filter(None, names.split(","))))


def export_onnx(model, size):
    """Writes model.onnx for one frame size."""
    torch, network = load_network(model)
    inputs = tuple(map(torch.from_numpy, network_inputs(size, network.config)))
    with torch.inference_mode():
        torch.onnx.export(network, inputs, model + ".onnx", input_names=["x", "aux"][:len(inputs)], output_names=["raw"],
                          opset_version=20, dynamo=False)


def onnxruntime_frame(model, size):
    """A function that runs one frame and returns the raw output as an array."""
    import onnxruntime
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = CORES
    options.add_session_config_entry("session.force_spinning_stop", "1")  # idle threads must not disturb the other peers
    session = onnxruntime.InferenceSession(model + ".onnx", options, providers=["CPUExecutionProvider"])
    arrays = network_inputs(size, config_of(model))
    inputs = dict(zip(("x", "aux"), arrays))
    return lambda: session.run(None, inputs)[0]


def pytorch_frame(model, size, compiled=False, device="cpu", half=False):
    torch, network = load_network(model)
    torch.backends.cudnn.allow_tf32 = False
    place = dict(device=device, dtype=torch.float16 if half else torch.float32, memory_format=torch.channels_last)
    network = network.to(**place)
    inputs = [torch.from_numpy(x).to(**place) for x in network_inputs(size, network.config)]
    if compiled:
        import torch._inductor.config
        torch._inductor.config.freezing = True
        network = torch.compile(network, mode="max-autotune" if device == "cuda" else None)

    def frame():
        with torch.inference_mode() if not compiled else torch.no_grad():
            output = network(*inputs)
        output = output[0] if isinstance(output, tuple) else output
        if device == "cuda":
            torch.cuda.synchronize()
            return output
        return output.numpy()
    return frame


def ncnn_frame(model, size, vulkan=False):
    import peers_ncnn
    torch, network = load_network(model)
    return peers_ncnn.ncnn_frame(torch, network, model + (".vulkan" if vulkan else ".cpu"), network_inputs(size, network.config), CORES, vulkan)


def as_array(output):
    return output if isinstance(output, numpy.ndarray) else output.float().cpu().numpy()


def peak_mebibytes(peer):
    if "cuda" in peer:
        import torch
        return torch.cuda.max_memory_allocated() / 2 ** 20
    return int(re.search(r"VmHWM:\s+(\d+)", pathlib.Path("/proc/self/status").read_text())[1]) / 1024


def cuda_frame(compiled, half):
    return lambda model, size: pytorch_frame(model, size, compiled, "cuda", half)


FRAMES = {
    "onnxruntime": onnxruntime_frame,
    "pytorch": pytorch_frame,
    "pytorch-compile": lambda model, size: pytorch_frame(model, size, compiled=True),
    "ncnn": ncnn_frame,
    "ncnn-vulkan": lambda model, size: ncnn_frame(model, size, vulkan=True),
    "pytorch-cuda": cuda_frame(False, False),
    "pytorch-cuda-compile": cuda_frame(True, False),
    "pytorch-cuda-fp16": cuda_frame(False, True),
    "pytorch-cuda-fp16-compile": cuda_frame(True, True),
}


def serve(peer, model, size):
    """Loads, runs one frame into model.<peer>.npy, then times one frame for every line of standard input."""
    frame = FRAMES[peer](model, size)
    start = time.perf_counter()
    numpy.save(f"{model}.{peer}.npy", as_array(frame()))
    is_long = time.perf_counter() - start > WARM_SECONDS
    print("ready", flush=True)
    for _ in sys.stdin:
        if not is_long:
            frame()
        start = time.perf_counter()
        frame()
        seconds = time.perf_counter() - start
        print(json.dumps([seconds, peak_mebibytes(peer)]), flush=True)


# ---- in the process that alternates --------------------------------------------------------------------------------

class Peer:
    """A peer's process, asked for one timed frame at a time."""

    def __init__(self, name, model, size):
        self.name = name
        self.log = open(f"{model}.{name}.log", "w+")
        self.process = subprocess.Popen([sys.executable, __file__, "--serve", name, model, str(size)], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self.log, env=ENVIRONMENT)
        if self.process.stdout.readline() != "ready\n":
            self.close()
            self.log.seek(0)
            raise RuntimeError((self.log.read().strip().splitlines() or ["no message"])[-1])

    def frame(self):
        """(seconds, peak MiB)"""
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())

    def close(self):
        self.process.stdin.close()
        self.process.wait()


class Engine:
    """The engine's benchmark program: a process a round, its first frame not counted."""

    def __init__(self, program, model, size, precision="fp32", device=""):
        self.name, self.command = "xrds", [program, "--model", model, "--size", str(size), "--runs", "1", "--precision", precision]
        self.command += ["--device", device] if device else []

    def frame(self):
        process = subprocess.Popen(self.command, stdout=subprocess.PIPE, text=True, env=ENVIRONMENT)
        text = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            raise RuntimeError(f"{self.command[0]} exited with {process.returncode}")
        self.device = re.search(r"device (.*)", text)[1]
        kernels = re.findall(r"^(\w+) +\d+ +([\d.]+) +[\d.]+$", text, re.M)
        total = sum(float(time) for _, time in kernels)
        self.pipeline = sum(float(time) for name, time in kernels if name.startswith(PIPELINE)) / total if total else 0
        return float(re.search(r"steady median ([\d.]+)", text)[1]), usage.ru_maxrss / 1024


def write_model(program, config, scale, path):
    if config not in CONFIGS:
        architectures = training("architectures")
        return architectures.save_random(dataclasses.replace(architectures.PAPER[config], scale=scale), path)
    flags = ["--scale", str(scale)]
    for name, value in CONFIGS[config].items():
        flags += ["--" + name.replace("_", "-")] + ([] if value is True else [str(value)])
    subprocess.run([program, "--size", "64", "--runs", "1", *flags, "--write-model", path],
                   check=True, stdout=subprocess.DEVNULL, env=ENVIRONMENT)


def relative_rms(x, y):
    return float(numpy.sqrt(numpy.mean((x - y) ** 2, dtype=float) / numpy.mean(y ** 2, dtype=float)))


def start(name, model, size):
    """The peer, or None where it cannot run the network."""
    try:
        return Peer(name, model, size)
    except RuntimeError as error:
        print(f"{name}: left out, {error}", flush=True)


def run_in_rounds(engine, model, arguments, samples):
    """Adds the (seconds, peak MiB) of each round by peer; returns the names of those that ran."""
    peers = [peer for name in arguments.peers.split(",") if (peer := start(name, model, arguments.size))]
    try:
        for _ in range(arguments.rounds):
            for peer in (engine, *peers):
                samples[peer.name].append(peer.frame())
    finally:
        for peer in peers:
            peer.close()
    return [peer.name for peer in peers]


def run_in_turn(engine, model, arguments, samples):
    """The same of one round, in which one process at a time is there."""
    samples[engine.name].append(engine.frame())
    names = []
    for name in arguments.peers.split(","):
        if peer := start(name, model, arguments.size):
            try:
                samples[name].append(peer.frame())
            finally:
                peer.close()
            names.append(name)
    return names


def measure(config, arguments, folder):
    model = str(folder / f"{config}.safetensors")
    write_model(arguments.program, config, arguments.scale, model)
    if "onnxruntime" in arguments.peers:
        subprocess.run([sys.executable, __file__, "--export", model, str(arguments.size)], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=ENVIRONMENT)
    engine = Engine(arguments.program, model, arguments.size, arguments.precision, arguments.device)
    samples = collections.defaultdict(list)
    names = run_in_turn(engine, model, arguments, samples) if arguments.rounds == 1 else run_in_rounds(engine, model, arguments, samples)
    report(config, arguments, engine, samples)
    outputs = [(name, numpy.load(f"{model}.{name}.npy")) for name in names]
    for (first, x), (second, y) in zip(outputs, outputs[1:]):
        error = relative_rms(x, y)
        bound = 1e-2 if "fp16" in first + second else 1e-4
        print(f"{first} against {second}: relative RMS {error:.1e}" + ("" if error < bound else "  DIFFERENT"))


def report(config, arguments, engine, samples):
    print(f"\n{config}, {arguments.size} x {arguments.size}, scale {arguments.scale}, engine {arguments.precision}, {arguments.rounds} rounds, {CORES} cores; "
          f"{engine.device}; image pipeline {100 * engine.pipeline:.1f} % of the engine's kernel time")
    print(f"{'':25} {'median s':>9} {'least':>8} {'most':>8} {'peak MiB':>9} {'engine/peer':>12} {'network/peer':>13}")
    medians = {name: statistics.median(seconds for seconds, _ in rows) for name, rows in samples.items()}
    for name, rows in samples.items():
        seconds = [time for time, _ in rows]
        print(f"{name:25} {medians[name]:9.5f} {min(seconds):8.5f} {max(seconds):8.5f} {max(peak for _, peak in rows):9.0f} "
              f"{medians['xrds'] / medians[name]:12.2f} {medians['xrds'] * (1 - engine.pipeline) / medians[name]:13.2f}", flush=True)


def main():
    if sys.argv[1:2] == ["--export"]:
        return export_onnx(sys.argv[2], int(sys.argv[3]))
    if sys.argv[1:2] == ["--serve"]:
        return serve(sys.argv[2], sys.argv[3], int(sys.argv[4]))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", help="xrds_bench_network of a release build")
    parser.add_argument("--configs", default="paper,compact,nano", help=f"comma list of {', '.join(CONFIGS)}, and of PAPER in training/architectures: edsr, ...")
    parser.add_argument("--scale", type=int, default=4, choices=(1, 2, 4, 8, 16))
    parser.add_argument("--peers", default=",".join(name for name in FRAMES if "cuda" not in name),
                        help=f"comma list of {', '.join(FRAMES)}")
    parser.add_argument("--precision", default="fp32", choices=("fp32", "fp16"), help="of the engine")
    parser.add_argument("--device", default="", help="of the engine, as xrds --device")
    parser.add_argument("--size", type=int, default=1024, help="side of the output in pixels, a multiple of 32")
    parser.add_argument("--rounds", type=int, default=5)
    arguments = parser.parse_args()
    configs = arguments.configs.split(",")
    if unknown := [name for name in configs if name not in CONFIGS and name not in training("architectures").PAPER]:
        parser.error(f"--configs: there is no network {unknown[0]!r}; {', '.join({**CONFIGS, **training('architectures').PAPER})} are known")
    if unknown := [name for name in arguments.peers.split(",") if name not in FRAMES]:
        parser.error(f"--peers: there is no peer {unknown[0]!r}; {', '.join(FRAMES)} are known")
    print("Python " + platform.python_version() + "".join(
        f", {package} {importlib.metadata.version(package)}" for package in ("numpy", "torch", "onnx", "onnxruntime", "ncnn", "pnnx")
        if importlib.util.find_spec(package)))
    for config in configs:
        with tempfile.TemporaryDirectory() as folder:
            measure(config, arguments, pathlib.Path(folder))


if __name__ == "__main__":
    main()
