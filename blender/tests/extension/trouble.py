# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands in the way, and what fails underway."""
import json
import os
import shutil
import signal
import sys
import tempfile
import unittest
from unittest import mock

import bpy
import xrds

import scenes
from extension.with_blender import WithBlender, before_upscaling
from properties import differences, snapshot
from xrds_render import checks, denoiser, exr, jobs, operators, recorder, settings, upscaler, worker


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

    def test_a_view_layer_that_is_renamed_or_deleted_underway(self):
        def rename(scene):
            scene.view_layers["Front"].name = "Other"

        def delete(scene):
            scene.view_layers.remove(scene.view_layers["Front"])

        for change in (rename, delete):
            for blurred in (True, False):  # each frame by itself, and merged with those around it
                job = jobs.Job(self.open("layers"), [1, 2])
                job.scene.render.use_motion_blur = blurred
                with self.subTest(f"{change.__name__} {blurred}"), self.assertRaisesRegex(RuntimeError, "^The view layer 'Front' was renamed or deleted"):
                    for place, step in enumerate(job.steps()):
                        step.wait()
                        if place == 0:
                            change(job.scene)
                self.assertEqual(self.exrs(), [])
                shutil.rmtree(checks.renders_folder(job.scene), ignore_errors=True)

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

    def test_a_scene_that_is_deleted_underway(self):
        for place in range(3):
            other = self.open("layers").copy()
            before, job = snapshot(), jobs.Job(other, [1, 2])
            with self.subTest(place), self.assertRaises(ReferenceError) as failed:
                for done, step in enumerate(job.steps()):
                    step.wait()
                    if done == place:
                        bpy.data.scenes.remove(other)
            self.assertEqual(operators._outcome(job, failed.exception)[0].partition(".")[0], "The scene was deleted while it rendered")
            self.assertEqual([found for found in differences(before, snapshot()) if not found.startswith("scenes[Scene.001]") and "users" not in found], [])
            self.assertEqual(recorder.active, [])
            for name in self.exrs():
                os.remove(os.path.join(self.folder, name))

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
