# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension in a real Blender without its window, on the files of scenes.py:

    blender -b --factory-startup -noaudio -P blender/tests/test_extension.py -- --package build/release/python

or by a Python that has the module bpy. Another folder than build/release/python may have the package xrds. Exits with 77 where it cannot be imported.
"""
import contextlib
import json
import os
import shutil
import signal
import sys
import tempfile
import time
import unittest
from unittest import mock

import bpy
import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
OWN = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else sys.argv[1:]
sys.dont_write_bytecode = True
sys.path[:0] = [HERE, os.path.dirname(HERE)] + ([os.path.abspath(OWN[1])] if OWN[:1] == ["--package"] else [])
try:
    import xrds
except ImportError as error:
    print(f"The extension is not tried: this Blender cannot import the package xrds ({error})")
    sys.stdout.flush()
    os._exit(77)

import scenes  # noqa: E402
import xrds_render  # noqa: E402
from properties import differences, snapshot  # noqa: E402
from xrds_render import checks, denoiser, exr, frame, jobs, layers, operators, passes, recorder, settings, temporal, upscaler, worker  # noqa: E402

MODEL, SINGLE_MODEL = "xrds-x4-nano", "xrds-x1-compact"
GOLDEN = os.path.join(os.path.dirname(os.path.dirname(HERE)), "tests", "golden", "unet")


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


class Animation(WithBlender):
    def test_existing_frames_are_kept(self):
        scene = self.open("layers")
        there = os.path.join(self.folder, "layers_0002_xrds.exr")
        with open(there, "w") as file:
            file.write("kept")
        before = snapshot()
        self.render(animation=True)
        self.assertEqual(differences(before, snapshot()), [])
        self.assertEqual(self.exrs(), [f"layers_000{number}_xrds.exr" for number in (1, 2, 3)])
        with open(there) as file:
            self.assertEqual(file.read(), "kept")
        first, last = (self.result(f"layers_000{number}_xrds.exr").channels["Front.Combined.A"] for number in (1, 3))
        self.assertGreater(abs(first - last).max(), 0.5)
        self.assertEqual(scene.frame_current, 2)
        self.render(animation=True)
        self.assertIn("All 3 frames are there already", operators.last)

    def test_a_stopped_one_goes_on(self):
        self.open("layers")
        self.stop_after_a_frame()
        self.assertIn("1 frame", operators.last)
        stamp = os.stat(os.path.join(self.folder, "layers_0001_xrds.exr")).st_mtime_ns
        self.render(animation=True)
        self.assertEqual(len(self.exrs()), 3)
        self.assertEqual(os.stat(os.path.join(self.folder, "layers_0001_xrds.exr")).st_mtime_ns, stamp)


class Steady(WithBlender):
    """Animations whose frames are merged with those around them."""

    def open(self, name, frames=3):
        scene = super().open(name)
        scene.render.use_motion_blur = False
        scene.frame_start, scene.frame_end = 1, frames
        self.assertTrue(checks.steady(scene))
        return scene

    def channels(self, name, frames=3):
        return [self.result(f"{name}_{number:04d}_xrds.exr").channels for number in range(1, frames + 1)]

    def check_same(self, some, others):
        for one, other in zip(some, others):
            self.assertEqual(set(one), set(other))
            for name in one:
                self.assertEqual(one[name].tobytes(), other[name].tobytes(), name)

    def test_flickers_less_with_everything_as_before(self):
        found = {}
        for steady in (True, False):
            scene = self.open("cryptomatte", 5)
            scene.xrds.steady, scene.cycles.use_animated_seed = steady, not steady
            before = snapshot()
            self.render(animation=True)
            self.assertEqual(differences(before, snapshot()), [])
            self.assertEqual(sorted(os.listdir(self.folder)), ["cryptomatte.blend", *(f"cryptomatte_000{number}_xrds.exr" for number in range(1, 6))])
            made = self.channels("cryptomatte", 5)
            self.assertEqual({name.rpartition(".")[0] for name in made[0]} & {"ViewLayer.Vector", "ViewLayer.Depth"}, set(), "nobody asked for them")
            found[steady] = numpy.std([frame["ViewLayer.Combined.G"].astype(numpy.float32) for frame in made], 0).mean()
            for name in self.exrs():
                os.remove(os.path.join(self.folder, name))
        self.assertLess(found[True], 0.7 * found[False])

    def test_a_stopped_one_goes_on_with_its_renders(self):
        self.open("layers")
        self.render(animation=True)
        whole = self.channels("layers")
        self.assertIn("All of it.Depth.Z", whole[0])
        self.assertNotIn("Front.Depth.Z", whole[0])
        for name in self.exrs():
            os.remove(os.path.join(self.folder, name))
        self.stop_after_a_frame()
        with mock.patch.object(jobs, "Render", side_effect=AssertionError("there is nothing to render")):
            self.render(animation=True)
        self.check_same(whole, self.channels("layers"))
        os.remove(os.path.join(self.folder, "layers_0002_xrds.exr"))
        self.render(animation=True)
        self.check_same(whole, self.channels("layers"))
        self.assertFalse(os.path.exists(checks.renders_folder(bpy.context.scene)))

    def test_nothing_is_left_of_one_without_results(self):
        scene = self.open("layers")
        with before_upscaling(lambda _: operators.current.cancel()), mock.patch.object(jobs, "_saved", return_value=None):
            self.assertEqual(bpy.ops.xrds.render(animation=True), {"CANCELLED"})
        self.assertFalse(os.path.exists(checks.renders_folder(scene)))

    def test_renders_of_other_settings_or_scenes_are_thrown_away(self):
        folder = os.path.join(self.folder, "renders")
        said = {"samples": [2, 1]}

        def kept(settings, state, goes_on):
            """Whether a file that the first one leaves is there for the second."""
            open(temporal.Renders(folder, said, ["a.blend", 1], False).file(1, "low"), "w").close()
            return temporal.Renders(folder, settings, state, goes_on).has(1, "low")

        self.assertTrue(kept(said, ["a.blend", 1], False))
        self.assertTrue(kept(said, ["a.blend", 2], True))
        self.assertFalse(kept(said, ["a.blend", 2], False))
        self.assertFalse(kept(said, None, False))
        self.assertFalse(kept({"samples": [4, 1]}, ["a.blend", 1], True))
        renders = temporal.Renders(folder, said, None, True)
        for number in (-1, 3, 12):
            open(renders.file(number, "full"), "w").close()
        renders.forget(12)
        self.assertEqual([renders.has(number, "full") for number in (-1, 3, 12)], [False, False, True])

    def test_files_of_others_stay_in_the_folder_of_renders(self):
        folder = os.path.join(self.folder, "renders")
        os.makedirs(folder)
        for name in ("1_low.exr", "1_low.exr.part.exr", "1_look.exr", "notes.txt"):
            open(os.path.join(folder, name), "w").close()
        renders = temporal.Renders(folder, {"samples": [2, 1]}, None, False)
        self.assertEqual(sorted(os.listdir(folder)), ["1_look.exr", "notes.txt", "settings.json"])
        renders.forget(None)
        self.assertEqual(sorted(os.listdir(folder)), ["1_look.exr", "notes.txt"])

    def test_a_damaged_render_is_made_again(self):
        scene = self.open("layers")
        self.stop_after_a_frame()
        damaged = os.path.join(checks.renders_folder(scene), "2_full.exr")
        os.truncate(damaged, os.path.getsize(damaged) // 2)
        with self.assertRaisesRegex(RuntimeError, "The render .*2_full.exr is damaged"):
            bpy.ops.xrds.render(animation=True)
        self.assertFalse(os.path.exists(damaged))
        self.render(animation=True)
        self.assertEqual(len(self.exrs()), 3)

    def test_what_is_needed(self):
        self.assertEqual(temporal.needed(range(1, 30), [1, 20]), [*range(1, 7), *range(15, 26)])
        self.assertEqual(temporal.needed(range(1, 3), [1]), [1, 2])

    def test_light_adds_up(self):
        scene = self.open("interior", 2)
        scene.render.image_settings.file_format = "OPEN_EXR"
        scene.render.image_settings.color_depth = "32"
        self.render(animation=True)
        for made in self.channels("interior", 2):
            self.check_sums(made)
            self.assertIn("ViewLayer.Vector.X", made)

    def test_cheap_guides(self):
        self.open("cryptomatte", 2).xrds.guides = "CHEAP"
        self.render(animation=True)
        self.assertTrue(all(numpy.isfinite(made["ViewLayer.Combined.R"]).all() for made in self.channels("cryptomatte", 2)))

    def test_not_with_motion_blur_or_steps(self):
        scene = self.open("layers")
        scene.render.use_motion_blur = True
        self.assertIn("Cycles has no Vector pass with Motion Blur", " ".join(checks.notes(scene)))
        self.assertFalse(checks.steady(scene))
        scene.render.use_motion_blur, scene.frame_step = False, 2
        self.assertIn("Frame Step", " ".join(checks.notes(scene)))
        scene.xrds.steady = False
        self.assertNotIn("Frame Step", " ".join(checks.notes(scene)))


class Trouble(WithBlender):
    def refused(self, sentence, **options):
        """The sentence, in the panel and as the report, and nothing lost."""
        before = snapshot()
        with self.assertRaisesRegex(RuntimeError, sentence):
            bpy.ops.xrds.render(**options)
        self.assertRegex(operators.last, sentence)
        self.assertEqual(differences(before, snapshot()), [])
        self.assertEqual(self.exrs(), [])
        self.assertIsNone(operators.current)

    def test_bad_input_is_a_sentence(self):
        def engine(scene):
            scene.render.engine = "BLENDER_WORKBENCH"

        def camera(scene):
            scene.camera = None

        def stereo(scene):
            scene.render.use_multiview = True

        def huge(scene):
            scene.render.resolution_x = scene.render.resolution_y = 60000

        def tiny(scene):
            scene.render.resolution_x = 16

        def unused(scene):
            scene.view_layers[0].use = False

        def device(scene):
            scene.xrds["device"] = 12345

        def model(scene):
            scene.xrds.scale = "2"

        def dark(scene):
            scene.xrds.model, scene.xrds.guides = "xrds-x4-full", "CHEAP"

        def folder(scene):
            scene.render.filepath = "/dev/null/frame_"

        def nowhere(scene):
            scene.render.filepath = ""

        cases = {engine: "Choose Cycles", camera: "no camera", stereo: "Stereoscopy", huge: "60000 x 60000 needs about [0-9]+ GB", tiny: "at least 8 x 8",
                 unused: "No view layer", device: "device is missing", model: "model is missing", dark: "takes the light", folder: "Nothing can be written into",
                 nowhere: "Output path is empty"}
        for spoil, sentence in cases.items():
            with self.subTest(spoil.__name__):
                spoil(self.open("cryptomatte"))
                self.assertRegex(checks.problem(bpy.context.scene), sentence)
                self.refused(sentence)

    @unittest.skipIf(bpy.app.version < (4, 5), "this Blender has no templates")
    def test_a_template(self):
        self.open("cryptomatte").render.filepath = "//{blend_name}_"
        self.refused("template in braces")

    @unittest.skipIf(bpy.app.version >= (5, 0), "this Blender keeps long names")
    def test_names_that_files_cut(self):
        def view_layer(layer):
            layer.name = "L" * 46

        def aov(layer):
            layer.aovs.add().name = "A" * 53

        def light_group(layer):
            layer.lightgroups[0].name = "\u00e9" * 22

        for lengthen, sentence in ((view_layer, "'L{46}' and its pass 'Denoising Albedo' are too long"), (aov, "'ViewLayer' and its pass 'A{53}' are too long"),
                                   (light_group, "'ViewLayer' and its pass 'Combined_\u00e9{22}' are too long")):
            with self.subTest(lengthen.__name__):
                lengthen(self.open("interior").view_layers[0])
                self.refused(sentence)
                bpy.context.scene.view_layers.new("Other")
                bpy.context.scene.view_layers[0].use = False
                self.assertIsNone(checks.problem(bpy.context.scene))

    @unittest.skipUnless(os.path.exists("/dev/full"), "this system has no file that is a full disk")
    def test_a_full_disk(self):
        scene, full = self.open("layers"), "No space left on device"
        result = os.path.join(self.folder, "layers_0002_xrds.exr")
        os.symlink("/dev/full", f"{result}.part")
        with self.assertRaisesRegex(RuntimeError, f"{result}.part cannot be written or read: {full}"):
            self.render()
        os.remove(f"{result}.part")
        said = f"Error: Error writing render result, {full} (see console)\nError: Render error ({full}) cannot save: '/there/low.exr'\n"  # by Blender 3.4 and 5.0
        render = mock.Mock(side_effect=RuntimeError(said))
        with mock.patch.object(jobs.bpy, "ops", mock.Mock(render=mock.Mock(render=render))), self.assertRaisesRegex(OSError, full) as failed:
            jobs.Render(scene, "/there/low.exr").wait()
        self.assertEqual((failed.exception.strerror, failed.exception.filename), (full, "/there/low.exr"))
        with before_upscaling(lambda step: shutil.rmtree(upscaler.ready()._folder)):
            self.refused(f"Nothing can be written into {tempfile.gettempdir()}, .* Is there room on the disk")
        note = os.path.join(self.folder, "settings.json")
        with self.assertRaises(OSError) as failed, exr.naming(note), open("/dev/full", "w") as file:
            file.write("{}")
        self.assertEqual(failed.exception.filename, note)
        self.render()

    def test_a_denoiser_that_cannot_be_stored(self):
        for sentence in ("Cannot write '/there/rt_hdr.safetensors': check.", "Cannot make the folder '/there': No space left on device."):
            with mock.patch.object(denoiser, "libraries", return_value=["one.so"]), mock.patch.object(xrds, "import_oidn", side_effect=xrds.Error(sentence)):
                with self.assertRaisesRegex(RuntimeError, sentence):
                    bpy.ops.xrds.get_denoiser()

    def test_a_path_without_a_folder(self):
        self.open("cryptomatte")
        bpy.context.scene.render.filepath = "shot_"
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        self.render()
        self.assertEqual(self.exrs(), ["shot_0001_xrds.exr"])

    def test_signs_for_the_number_within_the_name(self):
        scene = self.open("cryptomatte")
        for path, result, renders in (
            ("shot_##_beauty.png", "shot_01_beauty_xrds.exr", "shot__beauty_xrds_renders"), ("a##/b#_###", "a##/b#_001_xrds.exr", "a##/b#_xrds_renders"),
            ("####", "0001_xrds.exr", "xrds_renders"), ("a##/shot_", "a##/shot_0001_xrds.exr", "a##/shot_xrds_renders"),
        ):
            scene.render.filepath = os.path.join(self.folder, path)
            self.assertEqual((checks.output_file(scene, 1), checks.renders_folder(scene)), (os.path.join(self.folder, result), os.path.join(self.folder, renders)))
            self.assertEqual(os.path.splitext(checks.output_file(scene, 1))[0].removesuffix("_xrds"), os.path.splitext(scene.render.frame_path(frame=1))[0])

    def test_a_python_without_a_wheel(self):
        with mock.patch.dict(sys.modules, {"xrds": None}):
            self.assertRegex(checks.package_problem(), "carries no package")
            with mock.patch.object(checks, "wheels", return_value=["one.whl"]):
                self.assertRegex(checks.package_problem(), "Install the extension again")

    def test_a_machine_without_a_device(self):
        for found, sentence in (({"return_value": []}, "No Vulkan device"), ({"side_effect": xrds.Error("There is no loader.")}, "no loader")):
            settings.device_problem.cache_clear()
            self.addCleanup(settings.device_problem.cache_clear)
            self.open("cryptomatte")
            with self.subTest(sentence), mock.patch.object(xrds, "devices", **found):
                self.refused(sentence)

    def test_an_unsaved_file(self):
        scenes.cryptomatte()
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = scenes.empty()
        scene.render.filepath = "//frame_"
        self.refused("not saved yet")

    def test_what_fails_underway_is_a_sentence_too(self):
        for error, sentence in ((xrds.Error("The device went away."), "The device went away"), (MemoryError(), "too little memory"), (ValueError(), "ValueError"),
                                (ModuleNotFoundError("No module named 'numpy'"), "xrds cannot be loaded by .*: No module named 'numpy'"),
                                (OSError(28, "No space left on device", "/there/frame.exr"), "frame.exr cannot be written or read: No space left"),
                                (OSError(28, "No space left on device"), "A file cannot be written or read: No space left")):
            def failing(step, error=error):
                raise upscaler.raised(**json.loads(json.dumps(worker.plain(error))))

            self.open("layers")
            with self.subTest(sentence), mock.patch.multiple(upscaler.Upscaling, wait=lambda step: None, finish=failing):
                self.refused(sentence)

    def test_what_fails_in_the_worker_is_a_sentence_too(self):
        for spoilt, sentence in (("low", "other_low.exr cannot be written or read: No such file"), ("result", r"other_result.exr.part cannot be written or read: No such file")):
            self.open("layers")
            with self.subTest(sentence), before_upscaling(lambda step: step.order.update({spoilt: f"/nowhere/other_{spoilt}.exr"})):
                self.refused(sentence)
        self.open("layers")
        with before_upscaling(lambda step: step.order.update(wish=(*step.order["wish"][:3], "xrds-x4-none", *step.order["wish"][4:]))):
            self.refused("There is no model.*xrds-x4-none")
        self.render()

    def test_everything_is_as_before_wherever_it_ends(self):
        self.open("layers")
        bpy.context.scene.xrds.guides = "CHEAP"
        for step in range(3):
            for error in (jobs.Stopped("enough"), RuntimeError("broken"), KeyboardInterrupt()):
                with self.subTest(step=step, error=error):
                    before, job = snapshot(), jobs.Job(bpy.context.scene, [1, 3])
                    with self.assertRaises(type(error)):
                        for place, made in enumerate(job.steps()):
                            if place == step:
                                self.assertTrue(differences(before, snapshot()))
                                raise error
                            made.wait()
                    del job
                    self.assertEqual(differences(before, snapshot()), [])
                    self.assertEqual(self.exrs(), [])
                    self.assertEqual(recorder.active, [])

    @unittest.skipIf(bpy.app.binary_path == "", "Blender as a module hears no Ctrl-C: Python does")
    def test_blender_cancels_its_render(self):
        self.open("layers")
        before = snapshot()

        def interrupt(*_):
            os.kill(os.getpid(), signal.SIGINT)     # Blender without a window takes it for Esc

        bpy.app.handlers.render_pre.append(interrupt)
        try:
            self.assertEqual(bpy.ops.xrds.render(), {"CANCELLED"})
        finally:
            bpy.app.handlers.render_pre.remove(interrupt)
        self.assertIn("Cancelled", operators.last)
        self.assertEqual(differences(before, snapshot()), [])
        self.assertEqual(self.exrs(), [])


class Worker(WithBlender):
    """The process that upscales."""

    def large(self):
        """A frame whose upscaling takes a while."""
        scene = self.open("cryptomatte")
        scene.render.resolution_x, scene.render.resolution_y, scene.xrds.samples = 1024, 768, 1
        return scene

    def when_heard(self, call):
        """Within it, call(step) is called once the worker told how far a frame is."""
        def hearing(step, hear=upscaler.Upscaling._hear):
            hear(step)
            if step._read and not called:
                called.append(call(step))
        called = []
        return mock.patch.object(upscaler.Upscaling, "_hear", hearing)

    def gone(self, pid):
        """Whether a process ends within ten seconds."""
        for _ in range(200):
            try:
                with open(f"/proc/{pid}/stat") as file:
                    if file.read().rpartition(")")[2].split()[0] == "Z":
                        return True
            except FileNotFoundError:
                return True
            time.sleep(0.05)
        return False

    def test_it_is_kept_for_the_next_frame_and_goes_after_an_animation(self):
        self.open("layers")
        self.render()
        pid = upscaler.current.pid
        self.assertNotEqual(pid, os.getpid())
        self.assertTrue(bpy.app.timers.is_registered(upscaler._drop), "and when nobody wants one more frame")
        self.render()
        self.assertEqual(upscaler.current.pid, pid)
        self.render(animation=True)
        self.assertIsNone(upscaler.current)
        self.assertFalse(bpy.app.timers.is_registered(upscaler._drop))
        self.assertTrue(self.gone(pid))

    def test_it_has_the_package_of_blender_and_not_blender(self):
        self.open("layers")
        self.render()
        with open(f"/proc/{upscaler.current.pid}/maps") as file:
            mapped = {line.split()[-1] for line in file}
        self.assertIn(os.path.realpath(xrds._native.__file__), mapped)
        self.assertEqual([path for path in mapped if path == bpy.app.binary_path or "/bpy/" in path], [])

    def test_killed_in_the_middle(self):
        self.large()
        with self.when_heard(lambda step: os.kill(upscaler.current.pid, signal.SIGKILL)), \
                self.assertRaisesRegex(RuntimeError, r"ended by itself \(signal 9, SIGKILL\).*Try again"):
            bpy.ops.xrds.render()
        self.assertEqual(self.exrs(), [])
        self.render()
        self.assertEqual(self.exrs(), ["cryptomatte_0001_xrds.exr"])

    def test_killed_before_a_frame(self):
        killed = []

        def kill(step):
            killed.append(upscaler.current.pid)
            os.kill(upscaler.current.pid, signal.SIGKILL)
            upscaler.current._process.wait()

        self.open("cryptomatte")
        with before_upscaling(kill):
            self.render()
        self.assertEqual(self.exrs(), ["cryptomatte_0001_xrds.exr"])
        self.assertNotEqual(upscaler.current.pid, killed[0])

    def test_cancelled_in_the_middle(self):
        self.large()
        self.render()
        os.remove(os.path.join(self.folder, self.exrs()[0]))
        before, pid = snapshot(), upscaler.current.pid
        with self.when_heard(lambda step: operators.current.cancel()):
            self.assertEqual(bpy.ops.xrds.render(), {"CANCELLED"})
        self.assertIn("Cancelled", operators.last)
        self.assertEqual(differences(before, snapshot()), [])
        self.assertEqual(self.exrs(), [])
        self.render()
        self.assertEqual(upscaler.current.pid, pid, "it hears")

    def test_one_that_does_not_hear_is_ended_by_force(self):
        def hang(step):
            os.kill(upscaler.current.pid, signal.SIGSTOP)
            operators.current.cancel()

        self.large()
        with mock.patch.object(upscaler, "GRACE", 0.2), self.when_heard(hang):
            self.assertEqual(bpy.ops.xrds.render(), {"CANCELLED"})
        self.assertIn("Cancelled", operators.last)
        self.assertEqual(self.exrs(), [])
        self.render()

    def test_a_frame_that_nobody_waits_for(self):
        """As after undo: the next one is not kept waiting."""
        for hung in (False, True):
            job = jobs.Job(self.large())
            steps = job.steps()
            for step in steps:
                step.start() if isinstance(step, upscaler.Upscaling) else step.wait()
                if isinstance(step, upscaler.Upscaling):
                    break
            pid = upscaler.current.pid
            if hung:
                os.kill(pid, signal.SIGSTOP)
            steps.close()
            self.assertEqual(self.exrs(), [])
            self.render()
            os.remove(os.path.join(self.folder, self.exrs()[0]))
            self.assertTrue(upscaler.current.pid != pid or not hung)
            if hung:
                with contextlib.suppress(ProcessLookupError):  # ended by force already where the renders took long
                    os.kill(pid, signal.SIGCONT)
                self.assertTrue(self.gone(pid))

    def test_it_says_a_lot_and_hears_the_environment(self):
        upscaler.end()
        self.open("layers")
        with mock.patch.dict(os.environ, VK_LOADER_DEBUG="all"):
            self.render()
        with open(upscaler.current._log) as file:
            self.assertGreater(len(file.read()), 1000)
        upscaler.end()

    def test_without_a_python(self):
        for path, sentence in (("", "Python of this Blender.*is missing"), ("/nowhere/python3", "is missing in .*Install Blender again"),
                               (os.path.join(self.folder, "python3"), "cannot be started by .*python3: Permission denied"), (shutil.which("false"), r"ended by itself \(code 1\)")):
            upscaler.end()
            self.open("cryptomatte")
            open(os.path.join(self.folder, "python3"), "w").close()
            with self.subTest(path), mock.patch.object(sys, "executable", path), mock.patch.object(sys, "prefix", self.folder):
                self.assertEqual(bool(checks.problem(bpy.context.scene)), "missing" in sentence)
                with self.assertRaisesRegex(RuntimeError, sentence):
                    bpy.ops.xrds.render()
        self.render()

    def test_another_python_that_comes_first_is_not_taken(self):
        upscaler.end()
        self.open("cryptomatte")
        with mock.patch.object(sys, "executable", shutil.which("false")):
            self.render()


class Recording(WithBlender):
    def test_every_file_format_comes_back(self):
        scene = self.open("cryptomatte")
        settings = scene.render.image_settings
        for kind in ("PNG", "JPEG", "TIFF", "OPEN_EXR", "BMP"):
            settings.file_format = kind
            before = snapshot()
            with self.subTest(kind), recorder.Recorder() as made:
                passes.configure_full(scene, scene.xrds, "/nowhere", made)
                self.assertEqual(settings.file_format, "OPEN_EXR_MULTILAYER")
            self.assertEqual(differences(before, snapshot()), [])

    def test_a_file_saved_underway_has_the_settings_of_the_artist(self):
        scene = self.open("layers")
        path = os.path.join(self.folder, "saved.blend")
        with recorder.Recorder() as made:
            passes.configure_low(scene, scene.xrds, "/nowhere", made)
            bpy.ops.wm.save_as_mainfile(filepath=path, copy=True)
            self.assertEqual(scene.render.resolution_x, 16)
        with bpy.data.libraries.load(path) as (there, wanted):
            wanted.scenes = there.scenes
        self.assertEqual([wanted.scenes[0].render.resolution_x, scene.render.resolution_x], [64, 64])

    def test_undo_brings_no_changed_setting_back(self):
        """A step of undo that is kept while a render runs, as when the artist moves something, has its settings."""
        scene = self.open("layers")
        scene.xrds.guides = "CHEAP"
        bpy.ops.ed.undo_push(message="before")
        before = snapshot()
        with recorder.Recorder(scene) as made:
            passes.configure_full(scene, scene.xrds, "/nowhere", made)
            made.mark()
            changed = differences(before, snapshot())
            bpy.ops.ed.undo_push(message="underway")
        self.assertNotIn(recorder.MARK, scene)
        bpy.ops.ed.undo_push(message="after")
        bpy.ops.ed.undo()
        self.assertGreater(len(changed), 15)
        self.assertEqual([found for found in differences(before, snapshot()) if "use_extra_user" not in found], [], "which undo itself sets")
        self.assertNotIn(recorder.MARK, bpy.context.scene)

    def test_cheap_guides_hide_every_lamp(self):
        """Those of a background scene and of an instanced collection, too."""
        scene = self.open("layers")
        scene.xrds.guides = "CHEAP"
        lamps = [bpy.data.objects.new(name, bpy.data.lights.new(name, "POINT")) for name in ("Behind", "Instanced")]
        scene.background_set = bpy.data.scenes.new("Behind")
        scene.background_set.collection.objects.link(lamps[0])
        instance = bpy.data.objects.new("Instance", None)
        instance.instance_type, instance.instance_collection = "COLLECTION", bpy.data.collections.new("Lamps")
        instance.instance_collection.objects.link(lamps[1])
        scene.collection.objects.link(instance)
        with recorder.Recorder(scene) as made:
            passes.configure_full(scene, scene.xrds, "/nowhere", made)
            self.assertTrue(all(lamp.hide_render for lamp in [*lamps, bpy.data.objects["Lamp"]]))
        self.assertFalse(any(lamp.hide_render for lamp in [*lamps, bpy.data.objects["Lamp"]]))

    def test_what_is_deleted_hinders_nothing(self):
        scene = self.open("layers")
        item = bpy.data.objects["Lamp"]
        made = recorder.Recorder()
        made.put(scene.render, "resolution_x", 16)
        made.put(item, "hide_render", True)
        bpy.data.objects.remove(item)
        self.assertEqual(len(made.restore()), 1)
        self.assertEqual(scene.render.resolution_x, 64)


def main():
    xrds_render.register()
    result = unittest.main(argv=["test_extension.py", *OWN[2:]], exit=False, verbosity=1).result
    xrds_render.unregister()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0 if result.wasSuccessful() else 1)


if __name__ == "__main__":
    main()
