# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the extension begin with: files of scenes.py, and checks of results."""
import os
import shutil
import tempfile
import unittest
from unittest import mock

import bpy
import numpy

import scenes
from properties import differences, snapshot
from xrds_render import exr, operators, upscaler

MODEL, SINGLE_MODEL = "xrds-x4-nano", "xrds-x1-compact"
GOLDEN = os.path.join(os.path.dirname(os.path.abspath(__file__)), *[os.pardir] * 3, "tests", "golden", "unet")


def before_upscaling(call):
    """Within it, call(step) is called before each frame is given to the worker."""
    def calling(step, start=upscaler.Upscaling.start):
        call(step)
        start(step)
    return mock.patch.object(upscaler.Upscaling, "start", calling)


class WithBlender(unittest.TestCase):
    """Each test begins with a file of scenes.py, in a folder of its own."""

    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        os.environ["XRDS_DENOISERS"] = os.path.join(cls.made.name, "denoisers")  # where there are none
        for build in (scenes.interior, scenes.layers, scenes.cryptomatte):
            build()
            bpy.context.scene.render.filepath = f"//{build.__name__}_"
            bpy.ops.wm.save_as_mainfile(filepath=os.path.join(cls.made.name, f"{build.__name__}.blend"))

    @classmethod
    def tearDownClass(cls):
        cls.made.cleanup()

    def setUp(self):
        self._folder = tempfile.TemporaryDirectory()
        self.folder = self._folder.name
        self.addCleanup(self._folder.cleanup)

    def open(self, name):
        path = shutil.copy(os.path.join(self.made.name, f"{name}.blend"), self.folder)
        bpy.ops.wm.open_mainfile(filepath=path)
        scene = bpy.context.scene
        scene.xrds.model, scene.xrds.samples, scene.xrds.guide_samples = MODEL, 2, 1
        return scene

    def render(self, **options):
        self.assertEqual(bpy.ops.xrds.render(**options), {"FINISHED"})

    def result(self, name):
        return exr.load(os.path.join(self.folder, name))

    def stop_after_a_frame(self):
        """An animation of "layers" that is cancelled in its second frame leaves the first one and the settings."""
        count = []

        def stopping(_):
            count.append(1)
            if len(count) == 2:
                operators.current.cancel()

        before = snapshot()
        with before_upscaling(stopping):
            self.assertEqual(bpy.ops.xrds.render(animation=True), {"CANCELLED"})
        self.assertEqual(differences(before, snapshot()), [])
        self.assertEqual(self.exrs(), ["layers_0001_xrds.exr"])

    def exrs(self):
        return sorted(name for name in os.listdir(self.folder) if ".exr" in name)

    def check_sums(self, made):
        """The lights of scenes.interior() add up to the colour."""
        long = "ViewLayer.Diffuse Direct.R" in made
        names = ("Diffuse {}", "Glossy {}", "Transmission {}", "Direct", "Indirect", "Color", "Emission", "Environment") if long else (
            "Diff{}", "Gloss{}", "Trans{}", "Dir", "Ind", "Col", "Emit", "Env")
        for component in "RGB":
            def of(name, component=component):
                return made[f"ViewLayer.{name}.{component}"].astype(numpy.float64)
            total = sum((of(kind.format(names[3])) + of(kind.format(names[4]))) * of(kind.format(names[5])) for kind in names[:3]) + of(names[6]) + of(names[7])
            beauty = of("Combined")
            self.assertLess(numpy.abs(total - beauty).max(), 1e-3 * beauty.max())
            self.assertGreater(beauty.max(), 0)

    def check_untouched(self, made, guide):
        self.assertEqual(made.attributes, guide.attributes)
        self.assertEqual(sum(name.startswith("cryptomatte/") for name in made.attributes), 12)
        data = [name for name in guide.channels if not name.startswith("ViewLayer.Combined.") or name.endswith(".A")]
        self.assertTrue(any("CryptoObject00" in name for name in data))
        self.assertTrue(any("Denoising Albedo" in name for name in data), "the file asked for them")
        for name in data:
            self.assertEqual(made.channels[name].tobytes(), guide.channels[name].tobytes(), name)

    def kept_guides(self):
        """Within it, the guides' file is copied to guides.exr before it goes."""
        return before_upscaling(lambda step: shutil.copy(step.order["full"], os.path.join(self.folder, "guides.exr")))
