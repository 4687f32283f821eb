# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Image Denoise first."""
import os
import shutil
from unittest import mock

import bpy
import numpy
import xrds

from extension.with_blender import GOLDEN, MODEL, SINGLE_MODEL, WithBlender, before_upscaling
from xrds_render import checks, denoiser, settings, upscaler


class Denoising(WithBlender):
    """With small networks of random weights in the place of Open Image Denoise's."""

    def setUp(self):
        super().setUp()
        networks = os.path.join(self.folder, "networks")
        os.mkdir(networks)
        for name, golden in (("rt_hdr_calb_cnrm_large", "hdr_albedo_normal_large"), ("rt_alb", "albedo_small"), ("rt_nrm", "normal_small")):
            shutil.copy(os.path.join(GOLDEN, f"{golden}.model.safetensors"), os.path.join(networks, f"{name}.safetensors"))
        environment = mock.patch.dict(os.environ, XRDS_DENOISERS=networks)
        environment.start()
        self.addCleanup(environment.stop)
        upscaler.end()  # which has another environment

    def test_both_renders_unless_the_artist_does_not_want_it(self):
        scene, made = self.open("cryptomatte"), []
        self.assertTrue(denoiser.ready())
        for wanted in (True, False, True):
            scene.xrds.denoise = wanted
            self.render()
            picture = self.result("cryptomatte_0001_xrds.exr")
            made.append(numpy.stack([picture.channels[f"ViewLayer.Combined.{one}"] for one in "RGB"]))
        self.assertFalse(numpy.array_equal(made[0], made[1]))
        self.assertTrue(numpy.array_equal(made[0], made[2]))
        self.assertEqual(list(checks.notes(scene)), [])

    def test_a_single_render(self):
        scene, made = self.open("cryptomatte"), []
        scene.xrds.scale = "1"
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
        for scene.xrds.denoise, scene.xrds.model in ((True, settings.AUTO), (True, SINGLE_MODEL), (False, SINGLE_MODEL)):
            with before_upscaling(lambda step: shutil.copy(step.order["full"], os.path.join(self.folder, "render.exr"))):
                self.render()
            made.append(self.result("cryptomatte_0001_xrds.exr").channels)
        for one, other in ((0, 1), (0, 2), (1, 2)):
            self.assertFalse(numpy.array_equal(*(made[place]["ViewLayer.Combined.G"] for place in (one, other))))
        render = self.result("render.exr")
        colour, albedo, normal = (numpy.stack([render.channels[f"ViewLayer.{name}.{one}"] for one in ends], -1) for name, ends in (
            ("Combined", "RGB"), ("Denoising Albedo", "RGB"), ("Denoising Normal", "XYZ")))
        alone = xrds.denoise(colour, albedo=albedo, normal=normal)
        self.assertTrue(numpy.array_equal(alone[..., 1].clip(0, 65504), made[0]["ViewLayer.Combined.G"]), "Automatic is the denoiser alone")

    def test_lights_are_denoised_and_add_up(self):
        scene = self.open("interior")
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
        for scale, model in ((scene.xrds.scale, MODEL), ("1", settings.AUTO)):
            scene.xrds.scale, scene.xrds.model, made = scale, model, []
            for scene.xrds.denoise in (True, False):
                if scale == "1" and not scene.xrds.denoise:
                    scene.xrds.model = SINGLE_MODEL
                self.render()
                made.append(self.result("interior_0001_xrds.exr").channels)
                self.check_sums(made[-1])
            self.assertTrue(any(not numpy.array_equal(*(one[name] for one in made)) for name in made[0] if name.endswith(("DiffInd.R", "Diffuse Indirect.R"))))
        self.assertEqual([note for note in checks.notes(scene) if "denoise" in note.lower()], [])

    def test_a_part_of_the_lights(self):
        scene = self.open("cryptomatte")
        scene.view_layers[0].use_pass_diffuse_direct = True
        for scene.xrds.scale in ("4", "1"):
            scene.xrds.model = settings.AUTO
            self.render()
            made = self.result("cryptomatte_0001_xrds.exr").channels
            self.assertTrue([name for name in made if name.endswith(("DiffDir.R", "Diffuse Direct.R"))])

    def test_animations(self):
        scene = self.open("cryptomatte")
        scene.frame_end = 2
        self.render(animation=True)
        self.assertTrue(os.path.exists(os.path.join(self.folder, "cryptomatte_0002_xrds.exr")))

    def test_where_the_networks_come_from(self):
        os.environ["XRDS_DENOISERS"] = os.path.join(self.folder, "none")
        self.assertFalse(denoiser.ready())
        with mock.patch.object(denoiser, "libraries", lambda: [__file__]), self.assertRaisesRegex(RuntimeError, "No Open Image Denoise was found"):
            bpy.ops.xrds.get_denoiser()
        with self.assertRaisesRegex(RuntimeError, "is no library of Open Image Denoise"):
            bpy.ops.xrds.get_denoiser(filepath=__file__)
        with mock.patch.object(denoiser, "libraries", lambda: ["one", "two"]), mock.patch.object(xrds, "import_oidn") as reads, mock.patch.object(
                denoiser, "ready", lambda: reads.call_count == 2):
            self.assertEqual(bpy.ops.xrds.get_denoiser(), {"FINISHED"})
        self.assertTrue(all(isinstance(path, str) for path in denoiser.libraries()))
