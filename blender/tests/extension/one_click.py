# SPDX-License-Identifier: GPL-3.0-or-later
"""One frame, of two renders and of one."""
import os
import shutil
import unittest

import bpy
import numpy

from extension.with_blender import SINGLE_MODEL, WithBlender, before_upscaling
from properties import differences, snapshot
from xrds_render import checks, frame, jobs, layers, passes, recorder


class OneClick(WithBlender):
    def test_a_saved_frame_with_everything_as_before(self):
        for guides in ("CYCLES", "CHEAP"):
            with self.subTest(guides):
                scene = self.open("cryptomatte")
                scene.xrds.guides = guides
                before = snapshot()
                with self.kept_guides():
                    self.render()
                self.assertEqual(differences(before, snapshot()), [])
                made, guide = self.result("cryptomatte_0001_xrds.exr"), self.result("guides.exr")
                self.check_untouched(made, guide)
                colour = made.channels["ViewLayer.Combined.R"]
                self.assertEqual((colour.shape, colour.dtype), ((48, 64), numpy.float16))
                self.assertTrue(numpy.isfinite(colour).all() and colour.max() > 0)
                self.assertFalse(numpy.array_equal(colour, guide.channels["ViewLayer.Combined.R"].astype(numpy.float16)))

    def test_light_adds_up(self):
        self.open("interior").render.image_settings.file_format = "OPEN_EXR"
        bpy.context.scene.render.image_settings.color_depth = "32"
        self.render()
        made = self.result("interior_0001_xrds.exr").channels
        self.assertFalse([name for name in made if "Denoising" in name])
        self.check_sums(made)
        self.assertIn("ViewLayer.Combined_KEY.R", made)

    def test_aovs_named_as_light_and_metadata_burnt_in(self):
        scene = self.open("cryptomatte")
        scene.render.use_stamp = True
        before = snapshot()
        for name, kind in (("MaskCol", "VALUE"), ("Combined_mask", "VALUE"), ("Combined_x", "COLOR"), ("Emission", "COLOR")):
            aov = scene.view_layers[0].aovs.add()
            aov.name, aov.type = name, kind
        kept = [aov.name for aov in scene.view_layers[0].aovs]
        with self.kept_guides():
            self.render()
        self.assertEqual([one for one in differences(before, snapshot()) if "aov" not in str(one)], [])
        made, guide = self.result("cryptomatte_0001_xrds.exr"), self.result("guides.exr")
        found = [name for name in guide.channels if name.split(".")[1] in kept]
        self.assertGreaterEqual(len(found), 8)
        for name in found:
            self.assertEqual(made.channels[name].tobytes(), guide.channels[name].tobytes(), name)
        scene.render.use_stamp = False
        with self.kept_guides():
            self.render()
        self.assertEqual(self.result("guides.exr").channels["ViewLayer.Combined.R"].tobytes(), guide.channels["ViewLayer.Combined.R"].tobytes(), "the stamp is in the picture")

    def test_view_layers_motion_blur_and_a_transparent_film(self):
        scene = self.open("layers")
        before = snapshot()
        with self.kept_guides():
            self.render()
        self.assertEqual(differences(before, snapshot()), [])
        made, guide = self.result("layers_0002_xrds.exr").channels, self.result("guides.exr").channels
        self.assertIn("All of it.Depth.Z", made)
        self.assertNotIn("Front.Depth.Z", made)
        for layer in ("Front", "All of it"):
            alpha = made[f"{layer}.Combined.A"]
            self.assertEqual(alpha.tobytes(), guide[f"{layer}.Combined.A"].tobytes())
            self.assertTrue(0 == alpha.min() < alpha.max())
        self.assertLess((made["Front.Combined.A"] > 0).sum(), (made["All of it.Combined.A"] > 0).sum())
        self.assertEqual(scene.frame_current, 2)

    def test_both_renders_are_of_one_frame_wherever_the_artist_looks_meanwhile(self):
        alphas = []
        for looks in (False, True):
            job = jobs.Job(self.open("layers"))
            for step in job.steps():
                step.wait()
                if looks:
                    job.scene.frame_set(3)
            self.assertEqual(job.scene.frame_current, 2)
            alphas.append(self.result("layers_0002_xrds.exr").channels["Front.Combined.A"])
        numpy.testing.assert_array_equal(*alphas)

    def test_the_result_opens_as_layers(self):
        self.open("layers")
        self.render()
        image = next(image for image in bpy.data.images if image.name.endswith("_xrds.exr"))
        node = bpy.data.node_groups.new("Compositing", "CompositorNodeTree").nodes.new("CompositorNodeImage")
        node.image = image
        self.assertEqual((image.type, node.has_layers), ("MULTILAYER", True))
        self.assertTrue({"Combined", "Alpha"} <= {socket.name for socket in node.outputs})

    def test_view_layers_whose_names_have_dots(self):
        scene = self.open("layers")
        for layer in scene.view_layers:
            layer.name = "Front"
            layer.use_pass_diffuse_direct = layer.use_pass_diffuse_color = True
        self.assertEqual(sorted(layer.name for layer in scene.view_layers), ["Front", "Front.001"])
        self.render()
        diffuse = {"Diffuse Direct", "Diffuse Color"} if bpy.app.version >= (5, 0) else {"DiffDir", "DiffCol"}
        found = layers.layers_of(self.result("layers_0002_xrds.exr"), ["Front", "Front.001"])
        self.assertEqual([layer.passes.keys() - {"Depth"} for layer in found], [{"Combined", *diffuse}] * 2)

    def test_shadow_catchers_have_their_shadow_with_cheap_guides(self):
        for shadow_pass, channel in ((False, "Combined.A"), (True, "Shadow Catcher.G")):
            found = []
            for guides in ("CYCLES", "CHEAP"):
                scene = self.open("interior")
                scene.render.film_transparent, scene.xrds.guides = not shadow_pass, guides
                scene.view_layers[0].cycles.use_pass_shadow_catcher = shadow_pass
                self.assertEqual(passes.cheap(scene.xrds), guides == "CHEAP")
                bpy.data.objects["Floor"].is_shadow_catcher = True
                self.assertFalse(passes.cheap(scene.xrds))
                self.assertEqual("The guides are path-traced" in " ".join(checks.notes(scene)), guides == "CHEAP")
                self.render()
                found.append(self.result("interior_0001_xrds.exr").channels[f"ViewLayer.{channel}"])
            self.assertEqual(found[0].tobytes(), found[1].tobytes())
            self.assertLess(found[0].min(), 1)
            bpy.data.objects["Floor"].hide_render = True
            self.assertTrue(passes.cheap(scene.xrds))

    def test_names_as_long_as_files_keep_them(self):
        scene = self.open("interior")
        layer, aov = scene.view_layers[0], scene.view_layers[0].aovs.add()
        layer.name, aov.name, layer.lightgroups[0].name = "L" * 41, "A" * 20, "G" * 11
        self.render()
        self.assertLessEqual({f"{layer.name}.{name}" for name in ("Combined.R", f"{aov.name}.R", f"Combined_{layer.lightgroups[0].name}.R")},
                             self.result("interior_0001_xrds.exr").channels.keys())

    def test_without_the_lines_of_freestyle(self):
        scene = self.open("cryptomatte")
        scene.render.use_freestyle = True
        self.assertIn("Freestyle", " ".join(checks.notes(scene)))
        before = snapshot()
        with recorder.Recorder(scene) as made:
            passes.configure_low(scene, scene.xrds, "/nowhere", made)
            self.assertFalse(scene.render.use_freestyle)
        self.assertEqual(differences(before, snapshot()), [])

    @unittest.skipUnless(hasattr(bpy.context.scene.cycles, "use_sample_subset"), "this Blender has no subsets")
    def test_all_samples_where_the_file_asks_for_a_subset(self):
        made = []
        for asked in (False, True):
            scene = self.open("interior")
            scene.cycles.use_sample_subset, scene.cycles.sample_subset_length = asked, 1
            self.render()
            self.assertEqual(scene.cycles.use_sample_subset, asked)
            made.append(self.result("interior_0001_xrds.exr").channels["ViewLayer.Combined.R"])
        numpy.testing.assert_array_equal(*made)

    def test_animated_settings_are_noted(self):
        scene = self.open("cryptomatte")
        scene.view_settings.keyframe_insert("exposure", frame=1)
        self.assertNotIn("animated", " ".join(checks.notes(scene)))
        scene.cycles.keyframe_insert("samples", frame=1)
        self.assertIn("animated", " ".join(checks.notes(scene)))

    def test_odd_sizes_become_whole_multiples(self):
        scene = self.open("cryptomatte")
        scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 122, 96, 50
        self.assertIn("64 x 48", " ".join(checks.notes(scene)))
        self.render()
        self.assertEqual(self.result("cryptomatte_0001_xrds.exr").channels["ViewLayer.Combined.R"].shape, (48, 64))


class SingleRender(WithBlender):
    """Scale 1: one render is colour and guides."""

    def open(self, name):
        scene = super().open(name)
        scene.xrds.scale, scene.xrds.model = "1", SINGLE_MODEL
        return scene

    def orders(self):
        """Within it, the list of what the worker is asked for; the render is kept as guides.exr."""
        found = []

        def asked(step):
            found.append((step.order, sorted(os.listdir(os.path.dirname(step.order["full"])))))
            shutil.copy(step.order["full"], os.path.join(self.folder, "guides.exr"))
        return found, before_upscaling(asked)

    def test_a_saved_frame_with_everything_as_before(self):
        scene = self.open("cryptomatte")
        scene.xrds.guides = "CHEAP"  # of no matter
        before = snapshot()
        orders, listening = self.orders()
        with listening:
            self.render()
        self.assertEqual(differences(before, snapshot()), [])
        ((order, files),) = orders
        self.assertEqual(files, ["full.exr"])
        self.assertEqual(frame.Wish(*order["wish"]).samples, (2, 2))
        made, guide = self.result("cryptomatte_0001_xrds.exr"), self.result("guides.exr")
        self.check_untouched(made, guide)
        colour = made.channels["ViewLayer.Combined.R"]
        self.assertEqual(colour.shape, (48, 64))
        self.assertTrue(numpy.isfinite(colour).all() and colour.max() > 0)
        self.assertFalse(numpy.array_equal(colour, guide.channels["ViewLayer.Combined.R"].astype(numpy.float16)))

    def test_light_adds_up(self):
        scene = self.open("interior")
        scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
        self.render()
        self.check_sums(self.result("interior_0001_xrds.exr").channels)

    def test_stable_over_time(self):
        found = {}
        for steady in (True, False):
            scene = self.open("cryptomatte")
            scene.render.use_motion_blur, scene.frame_start, scene.frame_end, scene.xrds.steady, scene.cycles.use_animated_seed = False, 1, 4, steady, True
            self.render(animation=True)
            names = [f"cryptomatte_000{number}_xrds.exr" for number in range(1, 5)]
            self.assertEqual(self.exrs(), names)
            found[steady] = numpy.std([self.result(name).channels["ViewLayer.Combined.G"].astype(numpy.float32) for name in names], 0).mean()
            for name in names:
                os.remove(os.path.join(self.folder, name))
        self.assertLess(found[True], 0.8 * found[False])
