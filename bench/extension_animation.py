"""What the extension's "Stable over Time" costs and gains: an animation of bench/temporal_scenes.py by the extension, with and without it.

    blender -b --factory-startup -noaudio -P bench/temporal_scenes.py -- --out WORK --hdri HDRI --sequences orbit
    for way in alone steady steady_denoised single single_steady; do
      XRDS_DENOISERS=NETWORKS blender -b --factory-startup -noaudio -P bench/extension_animation.py -- --out WORK --hdri HDRI --sequences orbit --way $way --package build/release/python
    done
    python3 bench/extension_animation.py --report WORK --sequences orbit

The first renders the references, the second by the extension, 16 samples of a quarter of the resolution and 4 of the guides, or as many of scale 1 alone, some denoised by the
networks that `xrds import oidn` has put into NETWORKS, and takes the processor's time. The third prints Markdown: PSNR, RelMSE and flicker as bench/temporal.py has them. Needs training/requirements.txt and OpenEXR.
"""
import argparse
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAIR = {"scale": "4", "samples": 16, "guide_samples": 4, "denoise": False}
SINGLE = {"scale": "1", "samples": 5, "denoise": True}     # as many for a pixel of the result
WAYS = {"alone": ("each frame by itself", {**PAIR, "steady": False}), "steady": ("*Stable over Time*", {**PAIR, "steady": True}),
        "steady_denoised": ("the same, denoised first", {**PAIR, "steady": True, "denoise": True}),
        "single": ("1x, denoised, each frame by itself", {**SINGLE, "steady": False}), "single_steady": ("1x, denoised, *Stable over Time*", {**SINGLE, "steady": True})}


def arguments():
    parser = argparse.ArgumentParser(prog="extension_animation.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, help="folder that has the references")
    parser.add_argument("--hdri", default="")
    parser.add_argument("--package", help="folder that has the Python package xrds")
    parser.add_argument("--report", type=pathlib.Path, help="that folder, to print its table")
    parser.add_argument("--sequences", nargs="+", default=["orbit"])
    parser.add_argument("--way", choices=WAYS, default="steady", help="one in a process: Cycles 3.4 may crash in the next scene with persistent data and Vector")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else sys.argv[1:])


def render(ask):
    sys.dont_write_bytecode = True
    sys.path[:0] = [str(ROOT / "bench"), str(ROOT / "blender"), ask.package]
    from random import Random
    from unittest import mock

    import bpy
    import extension
    import temporal_scenes
    import xrds_render
    from xrds_render import denoiser, jobs, upscaler

    xrds_render.register()
    way = ask.way
    if WAYS[way][1]["denoise"] and not denoiser.ready():
        sys.exit("The denoiser's networks are missing: xrds import oidn LIBRARY -o NETWORKS")
    for name in ask.sequences:
        family, seed, animate = temporal_scenes.SEQUENCES[name]
        frames = len(list((ask.out / name).glob("reference.*.exr")))
        fields = argparse.Namespace(width=192, height=128, size=192, lights=False, hdri=ask.hdri, models="", threads=2, frames=frames)
        scene = temporal_scenes.generator.compose(fields, seed, family)
        bpy.context.view_layer.use_pass_vector = True  # as in the references: with it Cycles 3.4 draws this scene's cloth otherwise
        scene.render.use_motion_blur = scene.camera.data.dof.use_dof = False
        animate(scene, Random(seed))
        scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = fields.width, fields.height, 100
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
        scene.frame_start, scene.frame_end, scene.cycles.use_animated_seed = 1, frames, True
        scene.render.filepath = str(ask.out / name / f"{way}_")
        for setting, value in WAYS[way][1].items():
            setattr(scene.xrds, setting, value)
        job = jobs.Job(scene, range(1, frames + 1))
        upscaler.ready()
        with mock.patch.object(upscaler, "end"):  # its time is asked for before it goes
            seconds, _ = extension.processor(lambda: jobs.run(job))
        upscaler.end()
        (ask.out / name / f"extension_{way}.json").write_text(json.dumps({"processor": seconds, **job.seconds}))


def report(ask):
    sys.path.insert(0, str(ROOT / "bench"))
    import numpy
    import temporal

    print("| sequence | way | PSNR dB | RelMSE | flicker | processor s a frame |\n|---|---|---|---|---|---|")
    for name in ask.sequences:
        sequence = temporal.Sequence(ask.report, name)
        sequence.read()
        for way, (title, _) in WAYS.items():
            results = [temporal.layers(ask.report / name / f"{way}_{frame + 1:04d}_xrds.exr", "Combined")[0] for frame in range(sequence.length)]
            seconds = json.loads((ask.report / name / f"extension_{way}.json").read_text())["processor"]
            pairs = list(zip(results, sequence.references))
            print(f"| {name} | {title} | {numpy.mean([temporal.psnr(*pair) for pair in pairs]):.2f} | {numpy.mean([temporal.relmse(*pair) for pair in pairs]):.4f} "
                  f"| {sequence.flicker(results):.4f} | {seconds / sequence.length:.1f} |")


if __name__ == "__main__":
    ask = arguments()
    report(ask) if ask.report else render(ask)
