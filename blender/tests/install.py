# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs the extension as a user does, in Blender 4.2 or newer, renders a frame by it and takes it out again:

    python3 blender/tests/install.py build/blender/xrds_render-0.1.0.zip

by a Python that has the module bpy (`pip install bpy==4.2.23`, Python 3.11). Blender's folder of the user is a new one. Says what it saw, and ends with
an error where something is not as it should be.
"""
import importlib
import os
import pathlib
import sys
import tempfile

ARCHIVE = pathlib.Path(sys.argv[1]).resolve()
HOME = tempfile.mkdtemp(prefix="xrds_blender_")
os.environ["BLENDER_USER_RESOURCES"] = HOME
sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import bpy  # noqa: E402

import scenes  # noqa: E402


def check(right, sentence):
    print(("ok: " if right else "WRONG: ") + sentence, flush=True)
    if not right:
        os._exit(1)


def main():
    file = os.path.join(HOME, "interior.blend")
    scenes.interior()    # with Blender's factory settings, so before anything is switched on
    bpy.ops.wm.save_as_mainfile(filepath=file)
    check("xrds" not in sys.modules and not hasattr(bpy.types.Scene, "xrds"), f"nothing of xrds is in Blender {bpy.app.version_string}")
    done = bpy.ops.extensions.package_install_files(filepath=str(ARCHIVE), repo="user_default", enable_on_install=True)
    check(done == {"FINISHED"} and hasattr(bpy.types.Scene, "xrds"), "installed and switched on")
    import xrds
    check(pathlib.Path(xrds.__file__).is_relative_to(HOME), "the package xrds is the one that the extension carries")

    bpy.ops.wm.open_mainfile(filepath=file)
    scene = bpy.context.scene
    scene.render.filepath = os.path.join(HOME, "shot_")
    scene.xrds.model, scene.xrds.samples, scene.xrds.guide_samples = "xrds-x4-nano", 2, 1
    check(bpy.ops.xrds.render() == {"FINISHED"}, "rendered and upscaled")
    exr = importlib.import_module("bl_ext.user_default.xrds_render.exr")
    result = exr.load(os.path.join(HOME, f"shot_{scene.frame_current:04d}_xrds.exr")).channels
    height, width = next(iter(result.values())).shape
    check((width, height) == (scene.render.resolution_x, scene.render.resolution_y), f"the frame has {width} x {height} pixels and {len(result)} channels")

    bpy.ops.extensions.package_uninstall(repo_index=repository(), pkg_id="xrds_render")
    check(not hasattr(bpy.types.Scene, "xrds"), "taken out again")
    os._exit(0)    # the module bpy may crash while Python ends


def repository():
    """The index of the user's own repository of extensions."""
    repos = bpy.context.preferences.extensions.repos
    return next(index for index, repo in enumerate(repos) if repo.module == "user_default")


main()
