# SPDX-License-Identifier: GPL-3.0-or-later
"""Animations, stable over time and not."""
import os
from unittest import mock

import bpy
import numpy

from extension.with_blender import WithBlender, before_upscaling
from properties import differences, snapshot
from xrds_render import checks, jobs, operators, temporal


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
