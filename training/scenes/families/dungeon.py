"""Imported models (glTF): a hall of modular walls and floors, its furniture and torches."""
import pathlib

import bpy
import numpy

import cameras
import lights
import materials
from families import things
from shapes import place, sheet_mesh

for _name, _kind in (("bool", bool), ("int", int), ("float", float), ("object", object), ("complex", complex), ("str", str)):
    if _name not in numpy.__dict__:  # the importer uses names that numpy 1.24 has dropped
        setattr(numpy, _name, _kind)


class Library:
    """Models of a folder by file stem; each is imported once and then instanced."""

    def __init__(self, folder):
        self.files = {p.name.split(".")[0]: p for p in sorted(pathlib.Path(folder).rglob("*.glb"))} if folder else {}
        self.loaded = {}

    def names(self, *starts):
        return [name for name in self.files if name.startswith(starts)]

    def put(self, name, at, turn=0.0, size=1.0):
        """Places a model; returns its objects, none when it cannot be read (a compressed mesh, say)."""
        if name not in self.loaded:
            before = set(bpy.data.objects)
            try:
                bpy.ops.import_scene.gltf(filepath=str(self.files[name]))
            except RuntimeError:
                pass
            added = [o for o in bpy.data.objects if o not in before]
            self.loaded[name] = [(o.data, o.matrix_world.copy()) for o in added if o.type == "MESH"]
            for made in added:
                bpy.data.objects.remove(made)
        parts = []
        for content, matrix in self.loaded[name]:
            part = bpy.data.objects.new(name, content)
            part.matrix_world = matrix
            bpy.context.scene.collection.objects.link(part)
            parts.append(part)
        if parts:
            things.group(parts, at, turn, size)
        return parts


def build(scene, random, folders):
    palette = materials.Palette(random)
    library = Library(folders.models)
    walls = [n for n in library.names("wall") if n in ("wall", "wall_arched", "wall_cracked", "wall_pillar", "wall_shelves", "wall_broken",
                                                       "wall_archedwindow_gated", "wall_archedwindow_open", "wall_window_open",
                                                       "wall_gated", "wall_scaffold")]
    floors = library.names("floor_tile_large", "floor_wood_large", "floor_dirt_large")
    if not walls or not floors:
        raise LookupError("dungeon needs the modular walls and floors of KayKit's Dungeon Remastered in --models")
    columns, rows = random.randint(2, 4), random.randint(2, 4)
    floor = random.choice(floors)
    place("below", sheet_mesh("below", 80, 80, (2, 2), lambda x, y: 0.0, materials.flooring(random, palette, False)), (0, 0, -0.12))
    for i in range(columns):
        for j in range(rows):
            library.put(floor if random.random() < 0.8 else random.choice(floors), (4 * i + 2, 4 * j + 2, 0), 90 * random.randint(0, 3))
    main = random.choice(walls)
    for i in range(columns):
        library.put(main if random.random() < 0.5 else random.choice(walls), (4 * i + 2, 4 * rows, 0), 0)
    for j in range(rows):
        library.put(main if random.random() < 0.5 else random.choice(walls), (0, 4 * j + 2, 0), 90)
        if random.random() < 0.5:
            library.put(random.choice(walls), (4 * columns, 4 * j + 2, 0), -90)
    own = [materials.any_surface(random, palette, 0.3) for _ in range(4)]
    furniture = library.names("table", "chair", "bed", "shelf", "barrel", "box", "crates", "keg", "trunk", "chest",
                              "stool", "pillar", "column", "rubble", "stairs_wood")
    small = library.names("bottle", "candle", "coin_stack", "plate", "sword", "key")
    points, spots = [], []
    for _ in range(random.randint(8, 22)):
        at = (random.uniform(1, 4 * columns - 0.8), random.uniform(1.5, 4 * rows - 1), 0.05)
        if random.random() < 0.25:
            shape, low = things.random_mesh(random, random.uniform(0.3, 0.7), random.choice(own))
            place("thing", shape, (at[0], at[1], low + 0.05), (0, 0, random.uniform(0, 360)))
        else:
            library.put(random.choice(furniture), at, random.choice((0, 90, 180, 270, random.uniform(0, 360))))
        points += [at, (at[0], at[1], 1.6)]
    for _ in range(random.randint(6, 20)):
        x, y, z = random.choice(points[::2])
        library.put(random.choice(small), (x + random.gauss(0, 1), y + random.gauss(0, 1), z), random.uniform(0, 360))
    for i in range(columns):
        if random.random() < 0.7:
            library.put(random.choice(library.names("torch_mounted", "banner")), (4 * i + 2, 4 * rows - 0.6, 2.0), 180)
            spots.append((4 * i + 2, 4 * rows - 1.2, 2.7))
    for _ in range(random.randint(0, 6)):
        x, y, _ = random.choice(points)
        spots.append((x + random.uniform(-1, 1), y, random.uniform(0.8, 2.6)))
    if random.random() < 0.5:
        lights.outdoors(scene, random, folders.hdri)
        lights.lamps(random, spots[:2], 60, 0.1)
    else:
        lights.dim(scene, (0.15, 0.2, 0.5), random.uniform(0.02, 0.3))
        lights.lamps(random, spots, 250, 0.1)
    near = sorted(points, key=lambda p: abs(p[0] - 2 * columns) + abs(p[1] - 2.5 * rows))[:random.randint(6, len(points))]
    cameras.around(random, near, (10, 40), (24, 50), (-100, -35), (0.7, 1.2), floor=0.8)
