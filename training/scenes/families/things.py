"""Objects that several families use: furniture, plants, turned and lumpy shapes, books, lettering."""
import math

import bmesh
import bpy
from mathutils import Vector, noise

import materials
from shapes import box, box_mesh, curve_through, lathe, lathe_mesh, leaves_mesh, mesh, place, tube


def group(parts, at, turn=0.0, size=1.0):
    """Moves parts built around the origin as one."""
    root = bpy.data.objects.new("group", None)
    bpy.context.scene.collection.objects.link(root)
    for part in parts:
        part.parent = root
    root.location, root.rotation_euler, root.scale = at, (0, 0, math.radians(turn)), (size,) * 3
    return root


def profile(random, radius, height):
    """A random turned outline: vase, bowl, bottle, column or cone."""
    knots = [(0.0, 0.0), (radius * random.uniform(0.4, 0.9), 0.0)]
    for k in range(random.randint(2, 5)):
        knots.append((radius * random.uniform(0.3, 1.0), 0))
    knots = [(r, height * (k - 1) / (len(knots) - 2) if k > 1 else 0.0) for k, (r, _) in enumerate(knots)]
    if random.random() < 0.65:  # hollow: back down inside
        wall = 0.06 * radius
        knots += [(max(0.004, r - wall), h) for r, h in reversed(knots[2:])]
        return [*knots, (0.0, 0.06 * height)]
    return [*knots, (0.0, height * 1.02)]


def blob_mesh(random, name, radius, surface, rough=0.35, detail=4):
    """A lump: a sphere moved by noise."""
    grid = bmesh.new()
    bmesh.ops.create_icosphere(grid, subdivisions=detail, radius=radius)
    offset, scale = random.uniform(0, 99), random.uniform(0.8, 2.5)
    for vertex in grid.verts:
        at = vertex.co * scale / radius + Vector((offset, 0, 0))
        vertex.co *= 1 + rough * (noise.noise(at) + 0.4 * noise.noise(at * 3.1))
    made = bpy.data.meshes.new(name)
    grid.to_mesh(made)
    grid.free()
    made.materials.append(surface)
    made.polygons.foreach_set("use_smooth", [random.random() < 0.7] * len(made.polygons))
    return made


def primitive(kind, size, surface):
    """A mesh of bmesh's: monkey, icosphere, cone, cylinder or torus around the origin, about `size` in radius."""
    if kind == "torus":
        ring, wide, thin = [], 0.72 * size, 0.26 * size
        for u in range(40):
            a = math.tau * u / 40
            ring += [((wide + thin * math.cos(b)) * math.cos(a), (wide + thin * math.cos(b)) * math.sin(a), thin * math.sin(b))
                     for b in (math.tau * v / 16 for v in range(16))]
        faces = [(u * 16 + v, (u + 1) % 40 * 16 + v, (u + 1) % 40 * 16 + (v + 1) % 16, u * 16 + (v + 1) % 16) for u in range(40) for v in range(16)]
        return mesh(kind, ring, faces, surface, smooth=True)
    grid = bmesh.new()
    if kind == "monkey":
        bmesh.ops.create_monkey(grid)
        bmesh.ops.scale(grid, vec=(0.85 * size,) * 3, verts=grid.verts)
        bmesh.ops.subdivide_edges(grid, edges=grid.edges, cuts=1, use_grid_fill=True, smooth=0.6)
    elif kind == "gem":
        bmesh.ops.create_icosphere(grid, subdivisions=1, radius=size)
    else:
        bmesh.ops.create_cone(grid, cap_ends=True, segments=48, radius1=0.75 * size, radius2=0.0 if kind == "cone" else 0.75 * size,
                              depth=1.5 * size)
    made = bpy.data.meshes.new(kind)
    grid.to_mesh(made)
    grid.free()
    made.materials.append(surface)
    made.polygons.foreach_set("use_smooth", [kind == "monkey"] * len(made.polygons))
    return made


def random_mesh(random, size, surface):
    """One of a dozen shapes about `size` in radius, and how far its lowest point lies below the origin."""
    kind = random.choice(("lathe", "lathe", "blob", "ball", "box", "monkey", "gem", "cone", "cylinder", "torus"))
    if kind == "lathe":
        height = size * random.uniform(1.2, 2.6)
        return lathe_mesh(kind, curve_through(profile(random, size * random.uniform(0.4, 0.9), height)), surface, 64), 0.0
    if kind == "blob":
        return blob_mesh(random, kind, size, surface), 0.9 * size
    if kind == "ball":
        half = [(size * math.sin(a), -size * math.cos(a)) for a in (math.pi * i / 24 for i in range(25))]
        return lathe_mesh(kind, half, surface, 48), size
    if kind == "box":
        sides = [size * random.uniform(0.5, 1.8) for _ in range(3)]
        return box_mesh(kind, sides, surface), sides[2] / 2
    return primitive(kind, size, surface), {"torus": 0.26, "monkey": 0.8, "gem": 0.85}.get(kind, 0.75) * size


def books(random, cover, at, run, depth=0.22):
    """A row of upright books along x, `run` metres long."""
    x, made = 0.0, []
    while x < run - 0.05:
        thick, tall, deep = random.uniform(0.016, 0.05), random.uniform(0.19, 0.31), random.uniform(0.7, 0.95) * depth
        if random.random() < 0.07:
            x += random.uniform(0.04, 0.15)
            continue
        made.append(box("book", (thick, deep, tall), (at[0] + x + thick / 2, at[1] - depth / 2 + deep / 2 - 0.01, at[2] + tall / 2),
                        cover, (0, random.choice((0, 0, 0, 0, random.uniform(0, 7))), 0), bevel=0.003))
        x += thick + 0.003
    return made


def book_cover(random, palette):
    """Spines: a colour for each book, bands and rows of lettering."""
    made, g = materials.material("book")
    x, _, z = g.parts(g.at("Generated"))
    dye = g.ramp(g.chance(), *((k / 9, palette.colour(0.03, 0.55)) for k in range(9)), mode="CONSTANT")
    low, high = random.uniform(0.06, 0.2), random.uniform(0.75, 0.9)
    bands = g.ramp(z, (0, 0), (low, 1), (low + 0.015, 0), (high, 1), (high + 0.02, 0), mode="CONSTANT")
    letters = g.noise(g.add("VectorMath", {0: g.at(scale=(330, 1, 120)), 1: g.math("MULTIPLY", g.chance(), 100)}, operation="ADD"), 1, 1)
    middle = g.math("MULTIPLY", g.ramp(z, (0, 0), (0.35, 1), (0.7, 0), mode="CONSTANT"),
                    g.math("LESS_THAN", g.math("ABSOLUTE", g.math("SUBTRACT", x, 0.5)), 0.33))
    ink = g.math("MAXIMUM", bands, g.math("MULTIPLY", middle, g.math("GREATER_THAN", letters, 0.52)))
    g.finish(g.surface(g.mix(ink, dye, palette.colour(0.5, 0.8)), random.uniform(0.3, 0.7)))
    return made


def table(random, top, legs, width, depth, height):
    thick = random.uniform(0.025, 0.06)
    parts = [box("top", (width, depth, thick), (0, 0, height - thick / 2), top, bevel=0.006)]
    inset, square = random.uniform(0.04, 0.12), random.random() < 0.5
    for x in (-1, 1):
        for y in (-1, 1):
            at = (x * (width / 2 - inset), y * (depth / 2 - inset), 0)
            if square:
                parts.append(box("leg", (0.055, 0.055, height - thick), (at[0], at[1], (height - thick) / 2), legs, bevel=0.005))
            else:
                parts.append(tube("pole", [at, (0.92 * at[0], 0.92 * at[1], height - thick)], 0.028, legs))
    return parts


def chair(random, frame, seat):
    parts = [box("seat", (0.44, 0.43, 0.04), (0, 0, 0.44), seat, bevel=0.012)]
    for x in (-0.19, 0.19):
        for y in (-0.18, 0.18):
            parts.append(tube("leg", [(x, y, 0.43), (1.1 * x, 1.15 * y, 0)], 0.018, frame, taper=[1, 0.7]))
        parts.append(tube("stile", [(x, -0.19, 0.43), (x, -0.22, 0.7), (x, -0.29, 0.98)], 0.016, frame))
    bars = random.randint(2, 6)
    for k in range(bars):
        if random.random() < 0.5:
            x = -0.15 + 0.3 * k / max(1, bars - 1)
            parts.append(tube("bar", [(x, -0.19, 0.45), (x, -0.22, 0.7), (x, -0.28, 0.95)], 0.008, frame))
        else:
            z = 0.55 + 0.4 * k / bars
            parts.append(box("slat", (0.38, 0.015, 0.05), (0, -0.19 - 0.2 * (z - 0.45), z), frame, bevel=0.004))
    parts.append(box("head", (0.42, 0.025, 0.08), (0, -0.285, 0.96), frame, bevel=0.008))
    return parts


def sofa(random, cloth):
    width = random.uniform(1.4, 2.1)
    parts = [box("base", (width, 0.85, 0.28), (0, 0, 0.24), cloth, bevel=0.04), box("back", (width, 0.22, 0.5), (0, -0.33, 0.6), cloth, bevel=0.08)]
    for side in (-1, 1):
        parts.append(box("arm", (0.2, 0.85, 0.55), (side * (width / 2 - 0.1), 0, 0.35), cloth, bevel=0.07))
    seats = random.randint(2, 3)
    for k in range(seats):
        wide = (width - 0.42) / seats
        parts.append(box("cushion", (wide - 0.01, 0.62, 0.16), (-width / 2 + 0.21 + wide * (k + 0.5), 0.08, 0.44), cloth, bevel=0.05))
    return parts


def plant(random, leaf, pot, tall):
    """A potted plant: stems, leaves, pot."""
    parts = [lathe("pot", [(0, 0), (0.13, 0), (0.17, 0.27), (0.185, 0.3), (0.165, 0.3), (0.15, 0.26), (0, 0.26)], (0, 0, 0), pot, smooth=False)]
    spots, spread = [], random.uniform(0.12, 0.35)
    for _ in range(random.randint(5, 12)):
        tip = (random.gauss(0, spread), random.gauss(0, spread), 0.3 + tall * random.uniform(0.5, 1))
        way = [(0, 0, 0.26), (0.25 * tip[0], 0.25 * tip[1], 0.26 + 0.6 * (tip[2] - 0.26)), tip]
        parts.append(tube("stem", way, 0.007, leaf, taper=[1, 0.8, 0.4]))
        for _ in range(22):
            t = random.uniform(0.3, 1)
            spots.append([(1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c + random.gauss(0, 0.03) for a, b, c in zip(*way)])
    parts.append(place("leaves", leaves_mesh("leaves", random, spots, random.uniform(0.06, 0.16), leaf)))
    return parts


def foliage(random, autumn=0.2):
    """Leaves of one plant: a colour by chance over its objects, light passing through."""
    made, g = materials.material("foliage")
    if random.random() < autumn:
        dark, light = (0.18, 0.05, 0.01), (0.55, 0.25, 0.03)
    else:
        shift = random.uniform(-0.02, 0.04)
        dark, light = (0.02 + abs(shift), 0.06, 0.012), (0.12 + shift, 0.22, 0.03)
    tone = g.math("MULTIPLY_ADD", g.noise(g.at(scale=2.5), 1, 4), 0.6, g.math("MULTIPLY_ADD", g.chance(), 0.5, -0.05))
    colour = g.ramp(tone, (0.1, dark), (0.9, light))
    g.finish(g.add("MixShader", {0: 0.35, 1: g.surface(colour, random.uniform(0.3, 0.6)), 2: g.add("BsdfTranslucent", {"Color": colour})}))
    return made


def tree_meshes(random, bark, leaf, tall=5.0, leaves=4000):
    """Limbs as one mesh, leaves at their ends as another."""
    points, faces, spots = [], [], []

    def rod(a, b, r0, r1):
        along = (b - a).normalized()
        side = along.orthogonal().normalized()
        other, first = along.cross(side), len(points)
        for end, r in ((a, r0), (b, r1)):
            points.extend(tuple(end + r * (math.cos(math.tau * k / 6) * side + math.sin(math.tau * k / 6) * other)) for k in range(6))
        faces.extend((first + k, first + (k + 1) % 6, first + 6 + (k + 1) % 6, first + 6 + k) for k in range(6))

    wild, droop = random.uniform(0.35, 0.65), random.uniform(-0.1, 0.25)

    def grow(base, along, length, radius, depth):
        tip = base + along * length
        rod(base, tip, radius, 0.7 * radius)
        if depth == 0:
            spots.append(tip)
            return
        for _ in range(3):
            way = (along + Vector([random.gauss(0, wild) for _ in range(3)])).normalized()
            grow(tip, Vector((way.x, way.y, 0.8 * way.z + droop)).normalized(), length * random.uniform(0.62, 0.85), 0.66 * radius, depth - 1)

    grow(Vector((0, 0, -0.2)), Vector((random.gauss(0, 0.08), random.gauss(0, 0.08), 1)), 0.27 * tall, 0.03 * tall, 4)
    scattered = [tuple(s + Vector([random.gauss(0, 0.05 * tall) for _ in range(3)])) for s in spots for _ in range(leaves // len(spots))]
    return mesh("limbs", points, faces, bark, smooth=True), leaves_mesh("leaves", random, scattered, random.uniform(0.03, 0.06) * tall, leaf)


def words(random, count=2):
    """Plausible lettering: syllables, numbers, signs."""
    syllables = ("ka", "lo", "mi", "ren", "to", "vas", "el", "nor", "qui", "sta", "bra", "fe", "zu", "hy", "pon", "gra", "wex", "di", "ju", "ost")
    out = []
    for _ in range(count):
        draw = random.random()
        word = "".join(random.choice(syllables) for _ in range(random.randint(1, 3)))
        out.append(word.upper() if draw < 0.3 else word.title() if draw < 0.6 else word if draw < 0.85 else f"{random.randint(1, 9999)}")
    return " ".join(out)


def lettering(name, body, size, surface, at=(0, 0, 0), turn=(0, 0, 0), deep=0.0, centred=True):
    """Text standing on the xy plane of its own frame; `deep` extrudes it."""
    line = bpy.data.curves.new(name, "FONT")
    line.body, line.size, line.extrude = body, size, deep
    line.align_x = "CENTER" if centred else "LEFT"
    line.resolution_u = 3
    line.materials.append(surface)
    return place(name, line, at, turn)
