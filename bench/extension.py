"""What the extension for Blender costs and gains: three scenes of samples/, beside full renders of as much processor time.

    for scene in interior glossy outdoor; do
      XRDS_DENOISERS=NETWORKS blender -b --factory-startup -noaudio -P bench/extension.py -- --scene $scene --out WORK --package build/release/python
    done
    python3 bench/extension.py --report WORK --xrds build/release/cli/xrds

The first part needs Blender 3.4 or newer with the settings of samples/render.py, whose samples/*_gt.exr are the references. For each scene it renders, in
their size: by the extension, with path-traced and with cheap guides, without and with the networks that `xrds import oidn` has put into NETWORKS, and at scale 1 with them; and plainly, with as many samples as take the processor time of each, upscaling
included. Times are of the processor, of all threads, which neighbours on the machine hardly change. The second part denoises the plain renders by
Open Image Denoise, which is Blender's denoiser and needs bench/oidn-requirements.txt (albedo and normals denoised first, its time not counted), and prints Markdown.
"""
import argparse
import importlib
import json
import os
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
SIZES = {"interior": (512, 384), "glossy": (512, 384), "outdoor": (320, 240)}   # of samples/*_gt.exr
SCALE, SAMPLES, GUIDE_SAMPLES = 4, 64, 16
PAIR = {"scale": "4", "samples": SAMPLES, "guide_samples": GUIDE_SAMPLES, "model": "AUTO"}
SINGLE = {"scale": "1", "samples": GUIDE_SAMPLES, "denoise": True}
WAYS = {"cycles": {**PAIR, "guides": "CYCLES", "denoise": False}, "cycles, denoised first": {**PAIR, "guides": "CYCLES", "denoise": True},
        "cheap": {**PAIR, "guides": "CHEAP", "denoise": False}, "cheap, denoised first": {**PAIR, "guides": "CHEAP", "denoise": True},
        "1x, denoised": {**SINGLE, "model": "AUTO"}, "1x, compact, denoised first": {**SINGLE, "model": "xrds-x1-compact"}}


def arguments():
    own = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else sys.argv[1:]
    parser = argparse.ArgumentParser(prog="extension.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene", choices=SIZES, help="of samples/scenes, to render")
    parser.add_argument("--out", type=pathlib.Path, help="folder for what is rendered")
    parser.add_argument("--package", help="folder that has the Python package xrds")
    parser.add_argument("--report", type=pathlib.Path, help="that folder, to print its table")
    parser.add_argument("--xrds", default="xrds", help="the command")
    return parser.parse_args(own)


def spent():
    """Seconds of the processor, of Blender and of the process that upscales if there is one."""
    from xrds_render import upscaler

    if not upscaler.current:
        return time.process_time()
    fields = pathlib.Path(f"/proc/{upscaler.current.pid}/stat").read_text().rpartition(")")[2].split()
    return time.process_time() + (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def processor(function):
    """(seconds of the processor, result) of a call."""
    begin = spent()
    result = function()
    return spent() - begin, result


def extended(scene, choices, out):
    """Renders by the extension, with {name: value} of its settings; {step: seconds of the processor}."""
    from unittest import mock

    from xrds_render import jobs, upscaler

    seconds = {"renders": 0.0, "upscaling": 0.0}

    def timed(kind, step):
        def wait(self, wait=step.wait):
            seconds[kind] += processor(lambda: wait(self))[0]
        return mock.patch.object(step, "wait", wait)

    upscaler.ready()
    for name, value in choices.items():
        setattr(scene.xrds, name, value)
    scene.render.filepath = str(out)
    with timed("renders", jobs.Render), timed("upscaling", upscaler.Upscaling):
        seconds["all"], _ = processor(lambda: jobs.run(jobs.Job(scene)))
    return seconds


def plain(scene, samples, path):
    """Renders by Cycles alone, with the passes of its denoiser; seconds of the processor."""
    import bpy

    scene.cycles.samples = samples
    scene.view_layers[0].cycles.denoising_store_passes = True
    scene.render.filepath = str(path)
    return processor(lambda: bpy.ops.render.render(write_still=True))[0]


def render(ask):
    sys.dont_write_bytecode = True
    sys.path[:0] = [str(ROOT / "samples/scenes"), str(ROOT / "blender"), ask.package]
    import bpy
    import passes
    import xrds_render
    import xrds_render.denoiser

    ask.out.mkdir(parents=True, exist_ok=True)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    importlib.import_module(ask.scene).build(scene)
    passes.configure(scene)
    width, height = SIZES[ask.scene]
    passes.expose(scene, width // SCALE, height // SCALE)
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.seed = 7
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.image_settings.color_depth = "32"
    xrds_render.register()
    if not xrds_render.denoiser.ready():
        sys.exit("The denoiser's networks are missing: xrds import oidn LIBRARY -o NETWORKS")
    warm(scene, ask.out / "warm_")
    found = {way: extended(scene, choices, ask.out / stem_of(ask.scene, way)) for way, choices in WAYS.items()}
    first = plain(scene, GUIDE_SAMPLES, ask.out / f"{ask.scene}_plain.exr")
    for way, spent in found.items():
        samples = max(1, round(GUIDE_SAMPLES * spent["all"] / first))
        seconds = plain(scene, samples, ask.out / f"{stem_of(ask.scene, way)}plain.exr")
        spent.update(plain_samples=samples, plain_seconds=seconds)
    (ask.out / f"{ask.scene}.json").write_text(json.dumps(found, indent=1))


def stem_of(scene, way):
    return f"{scene}_{way.replace(', ', '_').replace(' ', '_')}_"


def warm(scene, out):
    """Compiles the kernels of all models, which a machine does once, and opens the device, which is kept from frame to frame."""
    for choices in WAYS.values():
        extended(scene, {**choices, "samples": 8, "guide_samples": 1}, out)


def error(ask, path, scene):
    """(PSNR in dB, RelMSE, FLIP) against the sample's reference."""
    found = ask.report / "compare.json"
    subprocess.run([ask.xrds, "compare", str(path), str(ROOT / f"samples/{scene}_gt.exr"), "--json", str(found)], check=True, capture_output=True)
    row = json.loads(found.read_text())
    row = row["metrics"] if "metrics" in row else row
    return row["psnr"], row["relMse"], row["flip"]


def denoised(path):
    """The file of a plain render, denoised."""
    import oidn

    target = path.with_name(f"{path.stem}_oidn.exr")
    with oidn.pyoidn.Device(oidn.pyoidn.OIDN_DEVICE_TYPE_CPU) as device:
        device.commit()
        oidn.check(device)
        pixels, _ = oidn.denoise(device, oidn.read_layers(path), prefilter=True)
    oidn.write_exr(target, pixels)
    return target


def report(ask):
    sys.path.insert(0, str(ROOT / "bench"))
    print("| scene, guides | way | samples | processor s | PSNR dB | RelMSE | FLIP |\n|---|---|---|---|---|---|---|")
    for path in sorted(ask.report.glob("*.json")):
        scene = path.stem
        if scene == "compare":
            continue
        for way, spent in json.loads(path.read_text()).items():
            stem = stem_of(scene, way)
            bare = ask.report / f"{stem}plain.exr"
            samples = f"{SAMPLES}-{GUIDE_SAMPLES}" if WAYS[way]["scale"] == "4" else GUIDE_SAMPLES
            rows = [("xrds", samples, spent["all"], ask.report / f"{stem}0001_xrds.exr"),
                    ("full render", spent["plain_samples"], spent["plain_seconds"], bare), ("full render, OIDN", spent["plain_samples"], spent["plain_seconds"], denoised(bare))]
            for made, samples, seconds, file in rows:
                psnr, rel_mse, flip = error(ask, file, scene)
                print(f"| {scene}, {way} | {made} | {samples} | {seconds:.1f} | {psnr:.2f} | {rel_mse:.3f} | {flip:.3f} |")


if __name__ == "__main__":
    asked = arguments()
    report(asked) if asked.report else render(asked)
