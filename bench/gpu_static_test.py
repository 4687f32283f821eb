"""Asserts what compilers of real GPUs make of the kernels: python3 bench/gpu_static_test.py PROGRAM [MODEL ...]

Two models by default on all GPUs, and the networks of others on one of each maker; bench/gpu_static.py has all. Where Mesa 25.0 is not in its folder it says so and
ends with 77, which the suite takes for skipped; where only the drivers of some GPUs are not there, these are left out.
"""
import collections
import pathlib
import sys
import unittest

import gpu_static
from gpu_static_gpus import GPUS, INTEGRATED

SKIPPED = 77
LARGE = 0.03  # share of a network's work from which a kernel counts
LEAST_WAVES = 4  # a SIMD
# Not reached: four waves of vega10 have 64 registers each, and a query with its result, or 8 pixels of 4 outputs, need all.
# Where they are fewer, the compiler's estimates must say that they are enough: latency / waves <= inverse throughput.
KNOWN_WAVES = {("vega10", "window_attention_tile"): 2, ("vega10", "window_attention_plain"): 3, ("vega10", "linear_tile"): 3,
               ("vega10", "conv3x3_tile"): 2}
# Of Intel: of window attention of 8 x 8 a value or two and their loads.
KNOWN_SPILLS = {"dg2": {"window_attention_tile": 14}, "bmg": {"window_attention_tile": 8}}
# Loads from shared memory for a product of the fused layer of 96 channels: a third of the 116 for 24 products that it had.
SWIN_LOADS_A_PRODUCT = 116 / 24 / 3
MODELS = ["xrds-x4-compact", "xrds-x4-full"]
NEEDED = [name for name, gpu in GPUS.items() if gpu.driver == "radeon" and not gpu.shim]
OTHERS_ON = ["navi31", "ampere", "tgl", "m1", "a740"]  # the networks of others
SMALL = {"--shared-bytes": 16384, "--group-invocations": 128}


def stem(program):
    """linear_matrix_khr_f16 -> linear_matrix"""
    return "_".join(part for part in program.split("_") if part not in ("khr", "nv", "f16", "f32"))


def least_share(pipeline):
    """Of products in the inner loop of a matrix kernel that multiplies four fragments. Convolutions of the networks of others guard
    every read where inputs are no whole stages (SwinIR's 180), and compute more addresses where they are unshuffled (MSSPL)."""
    if pipeline["program"].startswith("conv3x3"):
        are_whole, is_unshuffled = pipeline["specialization"][11:13]
        return 0.74 if is_unshuffled else 0.8 if are_whole else 0.79
    return 0.8


class GpuStatic(unittest.TestCase):
    gpus, small = [], {}

    def kernels(self, gpu, families, least_share=0.0):
        """The pipelines of the families, each once, which have at least that share of a network's work."""
        shares = collections.Counter()
        for network in gpu["networks"]:
            if network["family"] in families:
                for index, share in network["shares"].items():
                    shares[index] = max(shares[index], share)
        return [gpu["pipelines"][index] for index, share in shares.items() if share >= least_share]

    def test_every_pipeline_compiles(self):
        for gpu in self.gpus:
            with self.subTest(gpu=gpu["gpu"]):
                self.assertEqual([pipeline for pipeline in gpu["pipelines"] if "error" in pipeline], [])
                families = {network["family"] for network in gpu["networks"]}
                self.assertEqual(families, {"plain", "tile", "matrix", "fused"} if GPUS[gpu["gpu"]].has_units else {"plain", "tile"})

    def test_nothing_is_spilled(self):
        for gpu in self.gpus:
            with self.subTest(gpu=gpu["gpu"]):
                few = KNOWN_SPILLS.get(gpu["gpu"], {})
                spilling = [p for p in gpu["pipelines"] if p["spills"] > few.get(stem(p["program"]), 0)]
                self.assertEqual([(p["program"], p["specialization"], p["spills"]) for p in spilling], [])
                # NVK leaves the loops over the pixels and tokens of `plain` as they are, and their sums in local memory.
                known = lambda p: GPUS[gpu["gpu"]].driver == "nouveau" and stem(p["program"]) in ("conv3x3_plain", "linear_plain")
                self.assertEqual([p["program"] for p in gpu["pipelines"] if p["scratch"] and not p["spills"] and not known(p)], [])

    def test_matrix_kernels_multiply_matrices(self):
        for gpu in self.gpus:
            with self.subTest(gpu=gpu["gpu"]):
                for pipeline in gpu["pipelines"]:
                    if "_matrix_" in pipeline["program"]:
                        self.assertGreater(pipeline["loop"]["products"], 0, pipeline["program"])

    def test_no_loop_gathers_halves(self):
        for gpu in self.gpus:
            with self.subTest(gpu=gpu["gpu"]):
                for pipeline in gpu["pipelines"]:
                    self.assertEqual((pipeline["loop"] or {}).get("gathers16", 0), 0, pipeline["program"])

    def test_waves_hide_latency(self):
        for gpu in self.gpus:
            with self.subTest(gpu=gpu["gpu"]):
                for pipeline in self.kernels(gpu, ("plain", "tile", "matrix", "fused"), LARGE):
                    if pipeline["waves"] is None:
                        continue
                    least = KNOWN_WAVES.get((gpu["gpu"], stem(pipeline["program"])), LEAST_WAVES)
                    self.assertGreaterEqual(pipeline["waves"], least, (pipeline["program"], pipeline["specialization"]))
                    if pipeline["waves"] < LEAST_WAVES:
                        self.assertLessEqual(pipeline["latency"], 1.01 * pipeline["waves"] * pipeline["inverseThroughput"], pipeline["program"])

    def test_large_dispatches_fill_the_gpu(self):
        for gpu in self.gpus:
            with self.subTest(gpu=gpu["gpu"]):
                for network in gpu["networks"]:
                    where = (network["model"], network["precision"], network["family"])
                    programs = [(gpu["pipelines"][pipeline]["program"], groups) for pipeline, groups in network["tooSmall"]]
                    self.assertEqual(programs, [], where)
                    self.assertGreaterEqual(network["filling"], 0.9, where)
                    # Nothing is made in bands. What is cut, for the watchdog, is cut at multiples of 16 rows.
                    usual = 250 if GPUS[gpu["gpu"]].memory_bytes == INTEGRATED else 200
                    most = max(usual, network["operators"] + 1.25 * network["cuts"] + 10)
                    self.assertLessEqual(network["dispatches"], most, where)
                    self.assertLessEqual(network["largestGrid"], 65535, where)

    def test_most_of_the_inner_loops_time_is_products(self):
        for gpu in self.gpus:
            if GPUS[gpu["gpu"]].driver != "radeon":
                continue  # there are no counts of loops
            with self.subTest(gpu=gpu["gpu"]):
                for pipeline in self.kernels(gpu, ("matrix",), LARGE):
                    four_fragments = "_matrix_" in pipeline["program"] and pipeline["specialization"][1] == 4
                    if four_fragments:  # of 16 outputs
                        self.assertGreaterEqual(pipeline["loop"]["productShare"], least_share(pipeline), (pipeline["program"], pipeline["specialization"]))

    def test_shared_memory_is_read_in_whole_texels(self):
        """A third of what it was: 136 loads for linear, 204 for convolutions of 64 outputs."""
        for gpu in self.gpus:
            if GPUS[gpu["gpu"]].driver != "radeon":
                continue  # there are no counts of loops
            with self.subTest(gpu=gpu["gpu"]):
                for pipeline in self.kernels(gpu, ("matrix", "fused")):
                    if "_matrix_" not in pipeline["program"]:
                        continue
                    loop, first = pipeline["loop"], pipeline["specialization"][1]  # channels of a layer; fragments of a map
                    if pipeline["program"].startswith("swin_layer") and first >= 96:
                        self.assertLessEqual(loop["sharedLoads"], SWIN_LOADS_A_PRODUCT * loop["products"], pipeline["specialization"])
                    elif first == 4:
                        most = 45 if pipeline["program"].startswith("linear") else 68
                        self.assertLessEqual(loop["sharedLoads"], most, (pipeline["program"], pipeline["specialization"]))

    def test_small_devices_get_small_workgroups(self):
        for pipeline in self.small["pipelines"]:
            self.assertNotIn("error", pipeline)
            x, y, z = pipeline["groupSize"]
            self.assertLessEqual(x * y * z, SMALL["--group-invocations"], pipeline["program"])
            self.assertLessEqual(pipeline["shared"], SMALL["--shared-bytes"], pipeline["program"])


def main():
    program, models = sys.argv[1], sys.argv[2:] or MODELS
    missing = [name for name, gpu in GPUS.items() if not gpu.exists()]
    if missing:
        print(f"Skipped: {', '.join(missing)}. No driver for them; bench/gpu_static_mesa.sh brings those it can.")
    if set(missing) & set(NEEDED):
        sys.exit(SKIPPED)
    if not pathlib.Path(program).exists():
        sys.exit(f"There is no {program}.")
    names = [name for name in GPUS if name not in missing]
    GpuStatic.gpus = gpu_static.measure_all(program, names, models)
    if models == MODELS:
        GpuStatic.gpus += gpu_static.measure_all(program, [name for name in OTHERS_ON if name in names], gpu_static.others(program), "--precisions", "fp16")
    small = [str(word) for option in SMALL.items() for word in option]
    GpuStatic.small = gpu_static.measure_all(program, ["navi31"], models[:1], *small)[0]
    unittest.main(argv=sys.argv[:1])


if __name__ == "__main__":
    main()
