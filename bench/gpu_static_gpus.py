"""The GPUs that bench/gpu_static.py asks about, and how programs run with the driver of one on a device that is not there."""
import dataclasses
import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
MATRIX_KERNELS = ("conv3x3", "linear", "swin_layer", "window_attention")


class Mesa:
    """A Mesa in its folder, "mesa25" or "mesa26", which bench/gpu_static_mesa.sh brings."""

    def __init__(self, name):
        cache = pathlib.Path(os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache")
        self.folder = pathlib.Path(os.environ.get("XRDS_" + name.upper()) or cache / "xrds" / name)
        self.libraries = self.folder / "usr" / "lib" / "x86_64-linux-gnu"

    def exists(self):
        return (self.folder / "complete").exists()

    def version(self):
        return (self.folder / "complete").read_text().strip()

    def run(self, *command, driver="radeon", shim=None, environment=None):
        """What the command prints with that Vulkan driver, on the shim's kernel interface."""
        usr = self.folder / "usr"
        loader = [usr / "lib64" / "ld-linux-x86-64.so.2", "--library-path", self.libraries]
        if shim:
            loader += ["--preload", self.libraries / shim]
        everything = dict(os.environ, MESA_SHADER_CACHE_DISABLE="true", LP_NATIVE_VECTOR_WIDTH="256", **(environment or {}),
                          VK_DRIVER_FILES=str(usr / "share" / "vulkan" / "icd.d" / f"{driver}_icd.json"))
        done = subprocess.run(list(map(str, [*loader, *command])), env=everything, capture_output=True)
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


@dataclasses.dataclass
class Gpu:
    """How to have a program meet that GPU."""
    compute_units: int  # of AMD; multiprocessors, cores or what else shares shared memory
    driver: str
    environment: dict
    mesa: Mesa = dataclasses.field(default_factory=lambda: Mesa("mesa26"))
    shim: str = None
    memory_bytes: int = 8 << 30
    has_units: bool = False  # for matrices

    def exists(self):
        return self.mesa.exists() and (not self.shim or (self.mesa.libraries / self.shim).exists())

    def run(self, *command):
        return self.mesa.run(*command, driver=self.driver, shim=self.shim, environment=self.environment)


def _radv(name, compute_units, **rest):
    return Gpu(compute_units, "radeon", {"RADV_FORCE_FAMILY": name}, Mesa("mesa25"), **rest)


def _nvk(chipset, compute_units):
    environment = {"NVK_I_WANT_A_BROKEN_VULKAN_DRIVER": "1", "NOUVEAU_CHIPSET": chipset}
    return Gpu(compute_units, "nouveau", environment, shim="libnouveau_noop_drm_shim.so", has_units=True)


def _anv(platform, compute_units, **rest):
    return Gpu(compute_units, "intel", {"INTEL_STUB_GPU_PLATFORM": platform}, Mesa("mesa25"), "libintel_noop_drm_shim.so", **rest)


INTEGRATED = 4 << 30  # bytes of memory; 8 GiB and more of the others
GPUS = {
    "vega10": _radv("vega10", 64),
    "navi10": _radv("navi10", 40),
    "navi21": _radv("navi21", 80),
    "navi31": _radv("navi31", 96, has_units=True),
    "gfx1150": _radv("gfx1150", 16, memory_bytes=INTEGRATED, has_units=True),
    "gfx1201": Gpu(64, "radeon", {"AMDGPU_GPU_ID": "gfx1201"}, shim="libamdgpu_noop_drm_shim.so", has_units=True),
    "turing": _nvk("164", 46),
    "ampere": _nvk("174", 46),
    "tgl": _anv("tgl", 6, memory_bytes=INTEGRATED),  # Xe of 2020
    "dg2": _anv("dg2", 32),  # Arc A770M, whose matrix units are not used: see holdsFragments()
    "bmg": _anv("bmg", 20, has_units=True),  # Arc B580
    "m1": Gpu(8, "asahi", {}, shim="libasahi_noop_drm_shim.so", memory_bytes=INTEGRATED),
    "a740": Gpu(6, "freedreno", {"FD_GPU_ID": "740"}, shim="libfreedreno_noop_drm_shim.so", memory_bytes=INTEGRATED),
}
