# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes three small .blend files that the extension is tested with: blender -b --factory-startup -P blender/tests/scenes.py -- FOLDER

    interior.blend     a room lit through a window: light passes, a light group, data passes
    layers.blend       two view layers, motion blur, a transparent film, an animation of three frames
    cryptomatte.blend  many objects of few materials, all three kinds of Cryptomatte
"""
import math
import os
import sys

import bpy

WIDTH, HEIGHT = 64, 48


def empty():
    """A scene of Cycles with a camera, and nothing to see."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_denoising = 2, False
    scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = WIDTH, HEIGHT, 100
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location, camera.rotation_euler = (0, -6, 2), (math.radians(75), 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def material(name, colour, metallic=0.0):
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    surface = made.node_tree.nodes["Principled BSDF"]
    surface.inputs["Base Color"].default_value = (*colour, 1)
    surface.inputs["Metallic"].default_value = metallic
    surface.inputs["Roughness"].default_value = 0.4
    return made


def cube(name, place, size, made):
    bpy.ops.mesh.primitive_cube_add(size=1, location=place)
    item = bpy.context.object
    item.name, item.scale = name, size
    item.data.materials.append(made)
    return item


def lamp(scene, place, energy, **fields):
    light = bpy.data.lights.new("Lamp", "AREA")
    light.energy, light.size = energy, 1
    item = bpy.data.objects.new("Lamp", light)
    item.location = place
    for name, value in fields.items():
        setattr(item, name, value)
    scene.collection.objects.link(item)
    return item


def interior():
    scene = empty()
    wall = material("Wall", (0.8, 0.75, 0.7))
    for name, place, size in (("Floor", (0, 0, 0), (8, 8, 0.1)), ("Back", (0, 3, 2), (8, 0.1, 5)), ("Side", (-3, 0, 2), (0.1, 8, 5))):
        cube(name, place, size, wall)
    cube("Table", (0, 0, 0.6), (1.6, 1, 0.1), material("Wood", (0.4, 0.2, 0.1)))
    cube("Mirror", (0.9, 1.5, 1), (0.8, 0.1, 1.4), material("Metal", (0.9, 0.9, 0.9), 1.0))
    layer = scene.view_layers[0]
    layer.lightgroups.add(name="KEY")
    lamp(scene, (1, -1, 4), 300, lightgroup="KEY")
    for kind in ("diffuse", "glossy", "transmission"):
        for part in ("direct", "indirect", "color"):
            setattr(layer, f"use_pass_{kind}_{part}", True)
    for name in ("emit", "environment", "z", "normal", "vector", "object_index"):
        setattr(layer, f"use_pass_{name}", True)


def layers():
    scene = empty()
    scene.render.film_transparent = scene.render.use_motion_blur = True
    scene.frame_start, scene.frame_end, scene.frame_current = 1, 3, 2
    shown = cube("Runner", (-1, 0, 1), (1, 1, 1), material("Red", (0.8, 0.1, 0.05)))
    for frame, x in ((1, -1.5), (3, 1.5)):
        shown.location.x = x
        shown.keyframe_insert("location", frame=frame)
    behind = bpy.data.collections.new("Behind")
    scene.collection.children.link(behind)
    item = cube("Wall", (0, 2, 1), (3, 0.1, 2), material("Green", (0.1, 0.6, 0.2)))
    for collection in item.users_collection:
        collection.objects.unlink(item)
    behind.objects.link(item)
    lamp(scene, (2, -3, 4), 400)
    scene.view_layers[0].name = "Front"
    scene.view_layers[0].layer_collection.children["Behind"].exclude = True
    second = scene.view_layers.new("All of it")
    second.use_pass_z = True
    second.samples = 3


def cryptomatte():
    scene = empty()
    made = [material(f"Paint {number}", (0.2 + 0.2 * number, 0.5, 0.8 - 0.2 * number)) for number in range(3)]
    for number in range(12):
        cube(f"Brick {number}", (number % 4 - 1.5, number // 4, 0.5 + number % 3 * 0.4), (0.7, 0.7, 0.7), made[number % 3])
    lamp(scene, (0, -3, 4), 300)
    layer = scene.view_layers[0]
    layer.use_pass_cryptomatte_object = layer.use_pass_cryptomatte_material = layer.use_pass_cryptomatte_asset = True
    layer.cycles.denoising_store_passes = True


def main():
    folder = sys.argv[sys.argv.index("--") + 1]
    os.makedirs(folder, exist_ok=True)
    for build in (interior, layers, cryptomatte):
        build()
        bpy.context.scene.render.filepath = f"//{build.__name__}_"
        bpy.ops.wm.save_as_mainfile(filepath=os.path.join(os.path.abspath(folder), f"{build.__name__}.blend"))


if __name__ == "__main__":
    main()
