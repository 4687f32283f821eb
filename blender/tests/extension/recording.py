# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that are changed for a while."""
import os
import unittest

import bpy

from extension.with_blender import WithBlender
from properties import differences, snapshot
from xrds_render import operators, passes, recorder


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

    def test_colour_management_of_files_comes_back(self):
        scene = self.open("cryptomatte")
        settings = scene.render.image_settings
        settings.file_format, settings.color_management = "PNG", "OVERRIDE"
        settings.view_settings.view_transform, settings.view_settings.exposure, settings.view_settings.gamma = "Standard", 1.5, 0.5
        bpy.ops.ed.undo_push(message="before")
        before = snapshot()
        with recorder.Recorder(scene) as made:
            passes.configure_low(scene, scene.xrds, "/nowhere", made)
            made.mark()
            self.assertEqual(settings.color_management, "FOLLOW_SCENE")
            bpy.ops.ed.undo_push(message="underway")
        self.assertEqual(differences(before, snapshot()), [])
        bpy.ops.ed.undo_push(message="after")
        bpy.ops.ed.undo()
        self.assertEqual([found for found in differences(before, snapshot()) if "image_settings" in found], [])

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

    @unittest.skipIf(bpy.app.version >= (5, 0), "whose functions of properties may not write either, so that none leaves it so")
    def test_where_blender_refuses_to_write(self):
        """As Blender 3.4 may refuse it to handlers after a render; here as to the poll of operators."""
        scene, sizes = self.open("layers"), []

        class Refusing(bpy.types.Operator):
            bl_idname, bl_label = "xrds.refusing", "Refusing"

            @classmethod
            def poll(cls, context):
                with self.assertRaisesRegex(AttributeError, "not allowed"):
                    scene.render.resolution_x = 7
                for handler in (operators.before_save, operators.after_save):
                    handler()
                    sizes.append((scene.render.resolution_x, recorder.MARK in scene))
                return False

        bpy.utils.register_class(Refusing)
        self.addCleanup(bpy.utils.unregister_class, Refusing)
        with recorder.Recorder(scene) as made:
            made.put(scene.render, "resolution_x", 16)
            made.mark()
            self.assertFalse(bpy.ops.xrds.refusing.poll())
        self.assertEqual(sizes, [(64, False), (16, True)])

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

    def test_deleted_scenes_and_view_layers_hinder_nothing(self):
        """Their parts look as if they were there, and Blender crashes where they are written to."""
        scene = self.open("layers")
        before, made = snapshot(), recorder.Recorder(scene)
        other = scene.copy()
        for owner in (scene, other):
            made.put(owner.render, "resolution_x", 16)
            made.put(owner.view_layers[1], "use_pass_z", not owner.view_layers[1].use_pass_z)
            made.put(owner.view_layers[1].cycles, "denoising_store_passes", True)
        bpy.data.scenes.remove(other)
        scene.view_layers.remove(scene.view_layers[1])
        made.mark()
        made.suspend()
        made.resume()
        self.assertEqual(scene.render.resolution_x, 16)
        self.assertEqual(len(made.restore()), 5)
        self.assertEqual([found for found in differences(before, snapshot()) if "view_layers" not in found], [])
