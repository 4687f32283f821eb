# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders the colour at low resolution and its guides at full resolution, and upscales them with xrds."""
import importlib.util
import os
import shutil
import sys
import zipfile

bl_info = {  # for Blender before 4.2; later ones read blender_manifest.toml
    "name": "xrds: Render and Upscale",
    "author": "The xrds authors",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "Properties > Render > Render and Upscale",
    "description": "Renders at low resolution and upscales with the help of albedo and normals at full resolution",
    "category": "Render",
}


def _find_wheel():
    """Unpacks the wheel beside this file where Blender does not install it by itself, which is before 4.2."""
    if importlib.util.find_spec("xrds"):
        return
    from . import checks

    fitting = checks.wheels()
    if not fitting:
        return  # the panel says so
    folder = os.path.splitext(fitting[0])[0]
    if not os.path.isdir(folder):
        shutil.rmtree(f"{folder}.part", ignore_errors=True)
        zipfile.ZipFile(fitting[0]).extractall(f"{folder}.part")
        os.rename(f"{folder}.part", folder)
    sys.path.append(folder)


def register():
    import bpy

    from . import operators, panel, settings

    _find_wheel()
    for made in (settings.XRDS_Settings, operators.XRDS_OT_render, operators.XRDS_OT_cancel, operators.XRDS_OT_get_denoiser, panel.XRDS_PT_panel):
        bpy.utils.register_class(made)
    bpy.types.Scene.xrds = bpy.props.PointerProperty(type=settings.XRDS_Settings)
    operators.register()


def unregister():
    import bpy

    from . import operators, panel, settings, upscaler

    operators.unregister()
    upscaler.end()
    del bpy.types.Scene.xrds
    for made in (panel.XRDS_PT_panel, operators.XRDS_OT_get_denoiser, operators.XRDS_OT_cancel, operators.XRDS_OT_render, settings.XRDS_Settings):
        bpy.utils.unregister_class(made)
