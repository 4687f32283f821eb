# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel in the Render properties."""
import textwrap

import bpy

from . import checks, denoiser, operators, passes


class XRDS_PT_panel(bpy.types.Panel):
    bl_label = "Render and Upscale"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"

    def draw(self, context):
        scene, job = context.scene, operators.current
        settings, layout = scene.xrds, self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.enabled = job is None
        scale = int(settings.scale)
        width, height = passes.size(scene, scale)
        column.row().prop(settings, "scale", expand=True)
        if scale > 1:
            _value(column, "Colour", f"{width} x {height}")
        column.prop(settings, "samples")
        _value(column, "Result", f"{scale * width} x {scale * height}")
        if scale > 1:
            column.prop(settings, "guides")
            column.prop(settings, "guide_samples", text="Samples")
        row = column.row(heading="Animation")
        row.active = checks.unsteady(scene) is None
        row.prop(settings, "steady")
        if checks.package_problem() is None and not denoiser.ready():
            column.operator("xrds.get_denoiser", icon="IMPORT")
        else:
            column.row(heading="Denoise").prop(settings, "denoise", text="First")
        column.prop(settings, "model")
        column.prop(settings, "device")
        if job:
            self._progress(layout, job)
        else:
            self._buttons(context, layout, scene)

    def _progress(self, layout, job):
        if hasattr(layout, "progress"):  # Blender 4
            layout.progress(factor=job.share, text=job.text)
        else:
            layout.label(text=f"{job.text}: {100 * job.share:.0f} %", icon="SORTTIME")
        layout.template_running_jobs()  # with the cross that ends a render at once
        layout.operator("xrds.cancel", icon="CANCEL", text="Cancelling" if job.cancelled else "Cancel")

    def _buttons(self, context, layout, scene):
        found = checks.problem(scene)
        if found:
            _sentence(context, layout, found, "ERROR")
        for note in checks.notes(scene):
            _sentence(context, layout, note, "INFO")
        column = layout.column(align=True)
        column.enabled = not found
        column.scale_y = 1.3
        column.operator("xrds.render", icon="RENDER_STILL", text="Render Image")
        column.operator("xrds.render", icon="RENDER_ANIMATION", text="Render Animation").animation = True
        if operators.last and operators.last != found:
            _sentence(context, layout, operators.last, "BLANK1")
        elif not found:
            _sentence(context, layout, f"To {checks.output_file(scene, scene.frame_current)}", "BLANK1")
        for sentence in operators.warned:
            _sentence(context, layout, sentence, "ERROR")


def _value(layout, name, value):
    row = layout.split(factor=0.4)
    row.alignment = "RIGHT"
    row.label(text=name)
    row.label(text=value)


def _sentence(context, layout, text, icon):
    """Text in as many lines as the panel is narrow."""
    letters = max(20, int(context.region.width / (7 * context.preferences.system.ui_scale)) - 8)
    column = layout.column(align=True)
    column.scale_y = 0.8
    for place, line in enumerate(textwrap.wrap(text, letters)):
        column.label(text=line, icon=icon if place == 0 else "BLANK1")
