# SPDX-License-Identifier: GPL-3.0-or-later
"""What looks wrong in a frame, and is told."""
import ctypes
import math
import os
import re
import tempfile
import warnings

import bpy

from extension.with_blender import WithBlender, before_upscaling
from xrds_render import exr, findings, operators, settings


class Findings(WithBlender):
    def told(self, **options):
        """What a render warns of: in the panel, and as reports, which Blender prints."""
        with tempfile.TemporaryFile() as printed:
            shown = os.dup(1)
            os.dup2(printed.fileno(), 1)
            try:
                self.render(**options)
            finally:
                ctypes.CDLL(None).fflush(None)
                os.dup2(shown, 1)
                os.close(shown)
            printed.seek(0)
            lines = printed.read().decode().splitlines()
        reports = [line for line in lines if re.match("Info: Saved [^\"]|Warning: ", line)]
        self.assertEqual(reports, [f"Info: {operators.last}", *(f"Warning: {sentence}" for sentence in operators.warned)])
        return list(operators.warned)

    def test_negative_light(self):
        self.open("interior")
        self.assertEqual(self.told(), [])
        bpy.data.lights["Lamp"].energy = -300
        (sentence,) = self.told()
        self.assertRegex(sentence, "^Pixels are negative, as by lamps of negative strength, and count as 0: [0-9]+ in Combined, .*[0-9]+ in Combined_KEY")
        self.assertRegex(sentence, "in (DiffDir|Diffuse Direct),")
        bpy.data.lights["Lamp"].energy = 300
        self.assertEqual(self.told(), [])

    def test_another_file_tells_nothing_of_the_one_before(self):
        self.open("interior")
        bpy.data.lights["Lamp"].energy = -300
        self.assertEqual(len(self.told()), 1)
        self.assertIn("Saved", operators.last)
        self.open("cryptomatte")
        self.assertEqual((operators.last, operators.warned), ("", []))

    def test_what_is_not_finite(self):
        def spoil(step):
            for key, names in {"low": ("Combined.R", "Combined.G"), "full": ("Denoising Normal.X",)}.items():
                if not os.path.exists(step.order[key]):
                    continue  # of a single render
                picture = exr.load(step.order[key])
                for name in names:
                    plane = picture.channels[f"ViewLayer.{name}"].copy()
                    plane[3, 2:5] = math.nan, math.inf, 1
                    picture.channels[f"ViewLayer.{name}"] = plane
                exr.save(step.order[key], picture)

        scene = self.open("cryptomatte")
        with before_upscaling(spoil):
            self.assertEqual(self.told(), ["Pixels are not finite, and count as their neighbours: 2 in Combined, 2 in Denoising Normal."])
            scene.xrds.scale, scene.xrds.model = "1", "xrds-x1-compact"
            self.assertEqual(self.told(), ["Pixels are not finite, and count as their neighbours: 2 in Denoising Normal."])

    def test_a_view_layer_that_shows_nothing(self):
        scene = self.open("layers")
        for child in scene.view_layers["Front"].layer_collection.children:
            child.exclude = True
        for item in scene.collection.objects:
            if item.type == "MESH":
                item.hide_render = True
        empty = "View layer 'Front': The albedo is the same everywhere"
        self.assertEqual(self.told(), [f"{empty}, and tells the model nothing: Automatic takes one that does without."])
        scene.xrds.model = settings.AUTO
        self.assertEqual(self.told(), [f"{empty}; taking model xrds-x4-compact-plain."])

    def test_frames_of_an_animation_are_told_once(self):
        scene = self.open("layers")
        bpy.data.lights["Lamp"].energy = -300
        for blurred in (True, False):  # each by itself, and merged with those around it
            scene.render.use_motion_blur, scene.frame_end = blurred, 3 if blurred else 5
            first, second = self.told(animation=True)
            start = 1 if blurred else 4
            self.assertRegex(first, f"^Frame {start}: View layer 'Front': Pixels are negative.*: [0-9]+ in Combined. The same in {scene.frame_end - start} more.$")
            self.assertRegex(second, f"^Frame {start}: View layer 'All of it': ")

    def test_what_the_package_warns_of(self):
        found = ["Before."]
        with findings.of_package(found):
            for _ in range(2):
                warnings.warn("The layers add up to 130 % of the colour.")
            warnings.warn("overflow encountered in cast", RuntimeWarning)
        self.assertEqual(found, ["Before.", *["The layers add up to 130 % of the colour."] * 2])
