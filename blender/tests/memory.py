# SPDX-License-Identifier: GPL-3.0-or-later
"""Memory while many tiny frames are made: blender -b --factory-startup -noaudio -P blender/tests/memory.py -- FOLDER_OF_THE_PACKAGE [FRAMES]

Prints the resident memory of Blender and of the process that upscales after 20 %, 60 % and all of the frames; exits with 1 if that of both together grew by
more than 5 % from the first to the last of these.
"""
import os
import sys
import tempfile

import bpy

HERE = os.path.dirname(os.path.abspath(__file__))
OWN = sys.argv[sys.argv.index("--") + 1:]
sys.dont_write_bytecode = True
sys.path[:0] = [HERE, os.path.dirname(HERE), OWN[0]]
import scenes  # noqa: E402
import xrds_render  # noqa: E402
from xrds_render import jobs, upscaler  # noqa: E402


def resident(pid):
    """Bytes."""
    with open(f"/proc/{pid}/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def main():
    count, found = int(OWN[1]) if len(OWN) > 1 else 100, {}
    xrds_render.register()
    scenes.cryptomatte()
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = 32
    scene.xrds.model, scene.xrds.samples, scene.xrds.guide_samples = "xrds-x4-nano", 1, 1
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = os.path.join(folder, "frame_")
        job = jobs.Job(scene, range(1, count + 1))
        for step in job.steps():
            step.wait()
            if isinstance(step, upscaler.Upscaling) and len(job.written) + 1 in (count // 5, 3 * count // 5, count):
                found[len(job.written) + 1] = resident(os.getpid()), resident(upscaler.current.pid)
    print("memory:", {frames: " + ".join(f"{size / 1e6:.1f} MB" for size in sizes) for frames, sizes in found.items()}, flush=True)
    first, last = sum(found[min(found)]), sum(found[max(found)])
    os._exit(int(last > 1.05 * first))


main()
