"""A stone cottage in a meadow: tiled roof, trees, grass and flowers under a clouded sky."""
import math
from random import Random

import bpy
from mathutils import Vector, noise

from shading import material, plain, plaster, wood, world
from shapes import blades_mesh, box, leaves_mesh, light, look, mesh, place, sheet_mesh

HOUSE = (3.6, 9.5)


def lie(x, y):
    """Height of the ground."""
    swell = 0.5 * noise.noise((0.06 * x, 0.06 * y, 3.0)) + 0.09 * noise.noise((0.4 * x, 0.4 * y, 8.0))
    near = math.exp(-((x - HOUSE[0]) ** 2 + (y - HOUSE[1]) ** 2) / 60)
    return swell * (1 - near) - 0.08 * math.exp(-(off_path(x, y) / 0.6) ** 2)


def off_path(x, y):
    return x - (0.75 * math.sin(0.36 * y + 0.6) + 0.028 * max(0.0, y - 3) ** 2)


def ground():
    made, g = material("ground")
    x, y, _ = g.parts(g.at(offset=(0, 40, 0)))
    bend = g.math("MULTIPLY", g.math("SINE", g.math("MULTIPLY_ADD", y, 0.36, 0.6)), 0.75)
    reach = g.math("POWER", g.math("MAXIMUM", g.math("SUBTRACT", y, 3), 0), 2)
    away = g.math("ABSOLUTE", g.math("SUBTRACT", x, g.math("MULTIPLY_ADD", reach, 0.028, bend)))
    ragged = g.math("ADD", away, g.math("MULTIPLY", g.noise(g.at(scale=3), 1, 5), 0.7))
    earth = g.ramp(g.noise(g.at(scale=5), 1, 8, 0.65), (0.3, (0.16, 0.10, 0.055)), (0.7, (0.42, 0.31, 0.19)))
    stones = g.add("TexVoronoi", {"Vector": g.at(scale=16)}).node
    pebble = g.mix(g.ramp(stones.outputs["Distance"], (0.25, 1), (0.4, 0)), earth,
                   g.mix(0.25, (0.48, 0.44, 0.38), stones.outputs["Color"], "MULTIPLY"))
    turf = g.ramp(g.noise(g.at(scale=1.3), 1, 9, 0.7), (0.3, (0.035, 0.07, 0.012)), (0.55, (0.10, 0.15, 0.03)),
                  (0.75, (0.21, 0.20, 0.06)))
    colour = g.mix(g.ramp(ragged, (0.75, 0), (0.95, 1)), pebble, turf)
    g.finish(g.surface(colour, 0.95, g.bump(g.noise(g.at(scale=30), 1, 5), 0.03, 0.8)))
    return made


def leaf_colours(name, *stops, roughness=0.5, through=0.4):
    """Foliage: a colour by chance per object, varied over it, light passing through."""
    made, g = material(name)
    tone = g.math("MULTIPLY_ADD", g.noise(g.at(scale=2.5), 1, 4), 0.6, g.math("MULTIPLY_ADD", g.chance(), 0.5, -0.05))
    colour = g.ramp(tone, *stops)
    g.finish(g.add("MixShader", {0: through, 1: g.surface(colour, roughness), 2: g.add("BsdfTranslucent", {
        "Color": g.mix(0.4, colour, (0.4, 0.5, 0.06))})}))
    return made


def tree_mesh(random, name, bark, leaf, tall=6.0, leaves=7000, crown=2.2, upright=False):
    """Two meshes: limbs as square rods and the leaves at their ends."""
    points, faces, spots = [], [], []

    def rod(a, b, r0, r1):
        along = (b - a).normalized()
        side = along.orthogonal().normalized()
        other = along.cross(side)
        first = len(points)
        for end, r in ((a, r0), (b, r1)):
            for k in range(6):
                t = math.tau * k / 6
                points.append(tuple(end + r * (math.cos(t) * side + math.sin(t) * other)))
        faces.extend((first + k, first + (k + 1) % 6, first + 6 + (k + 1) % 6, first + 6 + k) for k in range(6))

    def grow(base, along, length, radius, depth):
        tip = base + along * length
        rod(base, tip, radius, 0.7 * radius)
        if depth == 0:
            spots.append(tip)
            return
        for _ in range(3 if depth < 4 else 4):
            way = (along + Vector([random.gauss(0, 0.55) for _ in range(3)])).normalized()
            way.z = 0.75 * way.z + 0.15
            grow(tip, way.normalized(), length * random.uniform(0.6, 0.82), 0.66 * radius, depth - 1)

    if upright:
        rod(Vector((0, 0, 0)), Vector((0, 0, 0.8 * tall)), 0.13, 0.03)
        for _ in range(420):
            z = tall * random.uniform(0.06, 1.0)
            r = crown * (0.35 + 0.65 * min(1, z / (0.25 * tall))) * (1 - z / tall) ** 0.6 * math.sqrt(random.random())
            a = random.uniform(0, math.tau)
            spots.append(Vector((r * math.cos(a), r * math.sin(a), z)))
    else:
        grow(Vector((0, 0, -0.2)), Vector((0, 0, 1)), 0.27 * tall, 0.035 * tall, 4)
    cloud = 0.10 * tall if not upright else 0.16
    every = max(1, leaves // len(spots))
    scattered = [tuple(s + Vector([random.gauss(0, cloud * 0.6) for _ in range(3)])) for s in spots for _ in range(every)]
    return mesh(name, points, faces, bark, smooth=True), leaves_mesh(name, random, scattered, 0.24 if not upright else 0.16, leaf)


def cottage():
    """Stone walls, a roof of single tiles, shutters, door, chimney."""
    x0, y0 = HOUSE
    stone = rubble()
    wide, deep, high, rise = 6.4, 4.6, 2.6, 1.9
    box("walls", (wide, deep, high + 0.6), (x0, y0, high / 2 - 0.3), stone)
    gable = [(-wide / 2, -deep / 2, 0), (-wide / 2, deep / 2, 0), (-wide / 2, 0, rise),
             (wide / 2, -deep / 2, 0), (wide / 2, deep / 2, 0), (wide / 2, 0, rise)]
    flat = [(p[1], p[2]) for p in gable]
    place("gable", mesh("gable", gable, [(0, 1, 2), (3, 5, 4)], stone, flat), (x0, y0, high))
    clay, g = material("roof tile")
    tone = g.ramp(g.chance(), (0, (0.26, 0.075, 0.035)), (0.5, (0.42, 0.15, 0.07)), (0.85, (0.5, 0.24, 0.12)), (1, (0.2, 0.12, 0.09)))
    moss = g.ramp(g.noise(g.at(scale=9), 1, 6, 0.7), (0.5, 0.0), (0.75, 0.6))
    g.finish(g.surface(g.mix(moss, tone, (0.12, 0.12, 0.05)), 0.8, g.bump(g.noise(g.at(scale=60), 1, 4), 0.004, 0.5)))
    arc = [(0.1 * math.cos(a), 0.075 * math.sin(a)) for a in (math.pi * k / 8 for k in range(9))]
    points = [(x * s, y, z * s + 0.01) for y, s in ((-0.23, 1.0), (0.23, 0.82)) for x, z in arc]
    tile = mesh("tile", points, [(k, k + 1, k + 10, k + 9) for k in range(8)], clay, smooth=True)
    slope = math.atan2(rise, deep / 2)
    length = math.hypot(rise, deep / 2) + 0.35
    random = Random(8)
    for side in (-1, 1):
        for row in range(int(length / 0.36) + 1):
            down = length - 0.2 - 0.36 * row
            for column in range(int((wide + 0.5) / 0.205)):
                x = x0 - wide / 2 - 0.2 + 0.205 * column
                y = y0 + side * (down - 0.02) * math.cos(slope)
                z = high + rise - down * math.sin(slope) + 0.04
                tilt = math.degrees(slope) + random.gauss(0, 1.2)
                place("tile", tile, (x + random.gauss(0, 0.006), y, z),
                      (tilt, 0, (0 if side < 0 else 180) + random.gauss(0, 1.2)))
        middle = (length - 0.02) / 2
        box("roof", (wide + 0.4, length, 0.05), (x0, y0 + side * middle * math.cos(slope), high + rise - middle * math.sin(slope)),
            plain("batten", (0.10, 0.05, 0.03), 0.8), (-side * math.degrees(slope), 0, 0))
    for column in range(int((wide + 0.4) / 0.4)):
        place("ridge", tile, (x0 - wide / 2 + 0.4 * column, y0, high + rise + 0.06), (0, 0, 90), 1.15)
    box("chimney", (0.6, 0.6, 1.5), (x0 + 1.9, y0 + 0.5, high + rise + 0.1), stone)
    box("cap", (0.75, 0.75, 0.1), (x0 + 1.9, y0 + 0.5, high + rise + 0.88), plaster("cap", (0.4, 0.37, 0.33)), bevel=0.02)
    blue = wood("shutter", (0.05, 0.12, 0.17), (0.12, 0.27, 0.34), (8, 8, 1), roughness=0.6)
    frame = plain("frame", (0.7, 0.67, 0.6), 0.5)
    pane = plain("pane", (0.02, 0.025, 0.03), 0.04, specular=0.9)
    front = y0 - deep / 2
    for x in (x0 - 2.1, x0 + 1.9):
        box("pane", (0.9, 0.04, 1.1), (x, front - 0.01, 1.45), pane)
        for dx in (-0.45, 0, 0.45):
            box("sash", (0.06, 0.07, 1.15), (x + dx, front - 0.03, 1.45), frame, bevel=0.008)
        for dz in (-0.55, 0, 0.55):
            box("sash", (0.95, 0.07, 0.05), (x, front - 0.03, 1.45 + dz), frame, bevel=0.008)
        box("lintel", (1.3, 0.1, 0.2), (x, front - 0.02, 2.14), wood("beam", (0.06, 0.035, 0.02), (0.22, 0.14, 0.08), (1, 8, 8)))
        for side in (-1, 1):
            for k in range(4):
                box("slat", (0.125, 0.035, 1.14), (x + side * (0.56 + 0.13 * k), front - 0.05, 1.45), blue, bevel=0.006)
            for dz in (-0.35, 0.35):
                box("brace", (0.5, 0.03, 0.08), (x + side * 0.755, front - 0.08, 1.45 + dz), blue, bevel=0.006)
        box("flower box", (1.1, 0.22, 0.2), (x, front - 0.16, 0.76), wood("box", (0.08, 0.04, 0.02), (0.25, 0.13, 0.06), (1, 8, 8)),
            bevel=0.01)
        spots = [(random.uniform(-0.5, 0.5), random.gauss(0, 0.08), random.uniform(0.08, 0.3)) for _ in range(240)]
        place("geranium", leaves_mesh("geranium", random, spots, 0.08, plain("green", (0.05, 0.14, 0.03), 0.5)), (x, front - 0.16, 0.76))
        place("blossom", leaves_mesh("blossom", random, spots[:110], 0.07, plain("red", (0.55, 0.03, 0.03), 0.5)), (x, front - 0.19, 0.82))
    for k in range(6):
        box("plank", (0.165, 0.06, 2.05), (x0 - 0.5 + 0.17 * k, front - 0.02, 1.0), blue, bevel=0.006)
    box("lintel", (1.4, 0.12, 0.22), (x0 - 0.08, front - 0.02, 2.14), frame, bevel=0.01)
    box("step", (1.5, 0.7, 0.16), (x0 - 0.08, front - 0.4, -0.02), plaster("step", (0.42, 0.4, 0.36)), bevel=0.02)


def rubble():
    """Field stones in mortar."""
    made, g = material("stone")
    at = g.at("UV", (2.6, 4.2, 1))
    bent = g.add("VectorMath", {0: at, 1: g.noise(g.at("UV", 4), 1, 3, output="Color")}, operation="ADD")
    cell = g.add("TexVoronoi", {"Vector": bent}).node
    seam = g.add("TexVoronoi", {"Vector": bent}, feature="DISTANCE_TO_EDGE")
    r, _, _ = g.parts(cell.outputs["Color"])
    stone = g.ramp(r, (0, (0.30, 0.26, 0.21)), (0.4, (0.48, 0.42, 0.33)), (0.75, (0.58, 0.53, 0.45)), (1, (0.40, 0.32, 0.24)))
    grit = g.noise(g.at("UV", 22), 1, 7, 0.7)
    stone = g.mix(1, stone, g.ramp(grit, (0.25, 0.55), (0.7, 1.1)), "MULTIPLY")
    joint = g.ramp(seam, (0.03, 0), (0.09, 1))
    height = g.math("ADD", g.math("MULTIPLY", grit, 0.35), joint)
    g.finish(g.surface(g.mix(joint, (0.55, 0.5, 0.42), stone), 0.9, g.bump(height, 0.04, 0.8)))
    return made


def meadow(random, eye):
    """Tufts, flowers and stones, denser towards the eye, none on the path or in the house."""
    grass = leaf_colours("grass", (0.1, (0.05, 0.11, 0.015)), (0.5, (0.13, 0.21, 0.03)), (0.9, (0.33, 0.31, 0.08)))
    tufts = [blades_mesh("tuft", random, 46, 0.17, 0.34, 0.0055, grass) for _ in range(7)]
    tall = [blades_mesh("tall", random, 22, 0.1, 0.62, 0.004, grass, 0.7) for _ in range(3)]
    petals = [plain(name, colour, 0.5) for name, colour in (("poppy", (0.62, 0.03, 0.015)), ("daisy", (0.8, 0.78, 0.74)), (
        "cornflower", (0.10, 0.13, 0.55)), ("buttercup", (0.75, 0.5, 0.02)))]
    heads = []
    for petal in petals:
        count = 11 if petal.name == "daisy" else 5
        points, faces = [(0, 0, 0.0)], []
        for k in range(count):
            a, w = math.tau * k / count, 2.6 / count
            for t, r, z in ((-w / 2, 0.03, 0.012), (0, 0.042, 0.016), (w / 2, 0.03, 0.012)):
                points.append((r * math.cos(a + t), r * math.sin(a + t), z))
            faces.append((0, 3 * k + 1, 3 * k + 2, 3 * k + 3))
        heads.append(mesh("head", points, faces, petal))
    stem = mesh("stem", [(-0.003, 0, 0), (0.003, 0, 0), (0.002, 0, 1), (-0.002, 0, 1)], [(0, 1, 2, 3)], grass)

    def free(x, y):
        inside = abs(x - HOUSE[0]) < 3.3 and abs(y - HOUSE[1]) < 2.5
        return abs(off_path(x, y)) > 0.5 + 0.12 * random.random() and not inside

    for _ in range(9000):
        away = 1.6 + 30 * random.random() ** 1.7
        side = random.uniform(-0.78, 0.78)
        x, y = eye[0] + side * away, eye[1] + away
        if not free(x, y):
            continue
        near = random.random()
        place("tuft", random.choice(tall if near < 0.07 else tufts), (x, y, lie(x, y) - 0.02), (0, 0, random.uniform(0, 360)),
              random.uniform(0.6, 1.15) * (1 + 0.02 * away))
        field = noise.noise((0.35 * x, 0.35 * y, 1.0))
        if near > 0.76 - 0.35 * max(0, field):
            kind = int(3.999 * abs(noise.noise((0.5 * x, 0.5 * y, 5.0)) * 1.7 + random.uniform(-0.3, 0.3)) % 4)
            high = random.uniform(0.22, 0.45)
            place("stem", stem, (x, y, lie(x, y)), (0, 0, random.uniform(0, 90)), (1, 1, high))
            place("flower", heads[kind], (x, y, lie(x, y) + high), (random.gauss(18, 15), random.gauss(0, 15), random.uniform(0, 360)),
                  random.uniform(0.7, 1.15))


def fence(grain, upright):
    """Weathered posts and rails at the left of the path."""
    random = Random(4)
    spots = []
    for k in range(9):
        y = -6.6 + 2.0 * k
        x = -1.75 - 0.22 * k + 0.2 * math.sin(k)
        spots.append(Vector((x, y, lie(x, y))))
        box("post", (0.11, 0.1, 1.25), (x, y, spots[-1].z + 0.45), upright, (random.gauss(0, 2.5), random.gauss(0, 2.5), 20), bevel=0.012)
    for a, b in zip(spots, spots[1:]):
        for z in (0.38, 0.72, 0.98):
            middle, way = (a + b) / 2, b - a
            made = box("rail", (way.length + 0.12, 0.035, 0.085), (middle.x + 0.07, middle.y, middle.z + z + random.gauss(0, 0.015)),
                       grain, bevel=0.008)
            made.rotation_euler = (random.gauss(0, 0.03), -math.asin(way.z / way.length), math.atan2(way.y, way.x))


def hills(random, tree):
    """Ridges, the farther the bluer, and trees on the nearest."""
    for far, high, colour in ((75, 9, (0.085, 0.12, 0.035)), (190, 30, (0.11, 0.16, 0.09)), (480, 90, (0.17, 0.24, 0.26)),
                              (1100, 210, (0.27, 0.36, 0.45))):
        made, g = material("hill")
        spots = g.ramp(g.noise(g.at(scale=9.0 / far), 4, 9, 0.7), (0.35, 0.5), (0.6, 1.25))
        g.finish(g.surface(g.mix(1, colour, spots, "MULTIPLY"), 1.0))

        def height(x, y, far=far, high=high):
            ridge = noise.noise((2.2 * x / far + far, 0.5 * y / far, 0.0)) + 0.4 * noise.noise((6 * x / far, 3 * y / far, far))
            return high * math.cos(min(1, abs(y) / (0.25 * far)) * math.pi / 2) * (0.55 + 0.5 * ridge) - 0.04 * high

        place("hill", sheet_mesh("hill", 2.6 * far, 0.5 * far, (140, 20), height, made), (0, 1.2 * far, 0))
        if far < 200:
            for _ in range(90 if far < 100 else 150):
                x, y = random.uniform(-0.8, 0.8) * far, random.uniform(-0.2, 0.1) * far
                plant_tree(random.choice(tree), (x, y + 1.2 * far, height(x, y)), random.uniform(0.7, 1.3), random.uniform(0, 360))


def plant_tree(pair, at, size, turn):
    for part in pair:
        place("tree", part, at, (0, 0, turn), size)


def sky(scene, height, turn):
    """Nishita's sky without its disc, and clouds of noise on a plane overhead."""
    g = world(scene)
    air = g.add("TexSky", {}, sky_type="NISHITA", sun_disc=False, sun_elevation=math.radians(height),
                sun_rotation=math.radians(turn), altitude=200, dust_density=1.2, air_density=1.0)
    x, y, z = g.parts(g.at("Generated"))
    over = g.math("MAXIMUM", g.math("ADD", z, 0.12), 0.05)
    flat = g.add("CombineXYZ", {0: g.math("DIVIDE", x, over), 1: g.math("DIVIDE", y, over), 2: 4.0})
    puff = g.noise(flat, 1.1, 10, 0.6, 0.25)
    cover = g.ramp(puff, (0.50, 0), (0.66, 0.95))
    low = g.math("SMOOTH_MIN", g.math("MULTIPLY", g.math("MAXIMUM", z, 0), 9), 1.0, 0.2)
    lit = g.ramp(puff, (0.5, (0.95, 0.95, 0.97)), (0.85, (0.5, 0.53, 0.6)))
    bright = g.mix(1, lit, (0.62, 0.6, 0.57), "MULTIPLY")
    g.finish(g.add("Background", {"Color": g.mix(g.math("MULTIPLY", cover, low), g.mix(1, air, (0.13, 0.13, 0.13), "MULTIPLY"),
                                                 bright), "Strength": 1.0}))


def build(scene):
    random = Random(21)
    eye = (-0.45, -7.6, 1.3)
    place("ground", sheet_mesh("ground", 120, 120, (300, 300), lambda x, y: lie(x, y + 40), ground()), (0, 40, 0))
    cottage()
    bark = wood("bark", (0.03, 0.02, 0.012), (0.16, 0.11, 0.07), (5, 5, 0.8), roughness=0.9)
    foliage = leaf_colours("foliage", (0.1, (0.025, 0.065, 0.012)), (0.5, (0.07, 0.14, 0.02)), (0.9, (0.19, 0.22, 0.04)))
    needles = leaf_colours("needles", (0.1, (0.015, 0.04, 0.012)), (0.9, (0.06, 0.10, 0.03)), through=0.2)
    broad = [tree_mesh(random, "broad", bark, foliage) for _ in range(2)]
    slim = [tree_mesh(random, "slim", bark, needles, 7.5, 9000, 0.8, upright=True) for _ in range(2)]
    for pair, x, y, size in ((broad[0], -6.3, 11, 1.15), (broad[1], -10.5, 17, 1.3), (broad[1], 10.0, 15.5, 1.25), (slim[0], -1.0, 13.5, 0.95),
                             (slim[1], 8.2, 10.5, 1.0), (slim[0], 0.2, 16, 1.1), (broad[0], -17, 26, 1.4), (broad[1], -4, 30, 1.2)):
        plant_tree(pair, (x, y, lie(x, y)), size, random.uniform(0, 360))
    hills(random, [broad[0], broad[1], slim[0]])
    meadow(random, eye)
    fence(wood("rail", (0.13, 0.11, 0.09), (0.42, 0.37, 0.31), (1.2, 16, 16), roughness=0.8),
          wood("post", (0.12, 0.10, 0.08), (0.38, 0.33, 0.28), (16, 16, 1.2), roughness=0.8))
    sky(scene, 31, 247)
    light("SUN", (-30, -13, 20), (0, 0, 0), 3.2, (1.0, 0.88, 0.7), 0.0095)
    look(eye, (1.05, 4.0, 1.82), 36)
