"""Rooms by day or by night: windows, furniture, shelves, pictures, many small lights."""
import math

import cameras
import lights
import materials
from families import things
from shapes import ball, box, lathe, light, place, sheet_mesh, tube


def build(scene, random, folders):
    palette = materials.Palette(random)
    width, depth, height = random.uniform(3.2, 6.5), random.uniform(4.5, 8), random.uniform(2.4, 3.4)
    by_day = random.random() < 0.55
    frame = materials.timber(random) if random.random() < 0.5 else materials.painted(random, palette)
    _shell(random, palette, width, depth, height, frame, by_day)
    top, cloth = materials.timber(random, "X"), materials.weave(random, palette, 0.2, "Object")
    _furnish(random, palette, width, depth, height, frame, top, cloth)
    spots = _fittings(random, palette, width, depth, height)
    if by_day:
        _daylight(scene, random, folders, width, depth, height)
        lights.lamps(random, spots[:random.randint(0, 3)], 12)
    else:
        lights.dim(scene, (0.2, 0.3, 0.6), 0.05)
        lights.lamps(random, spots, 30)
    cameras.inside(random, width, depth, height)


def _shell(random, palette, width, depth, height, frame, by_day):
    """Floor, ceiling, three whole walls and one with a row of windows at the left."""
    wall = materials.walling(random, palette)
    other = materials.walling(random, palette) if random.random() < 0.5 else wall
    box("floor", (width, depth, 0.1), (0, depth / 2, -0.05), materials.flooring(random, palette))
    box("ceiling", (width + 0.4, depth + 0.4, 0.1), (0, depth / 2, height + 0.05), materials.plaster("ceiling", palette.colour(0.5, 0.8)))
    box("back", (width + 0.4, 0.1, height), (0, depth + 0.05, height / 2), other)
    box("front", (width + 0.4, 0.1, height), (0, -0.25, height / 2), wall)
    box("right", (0.1, depth + 0.6, height), (width / 2 + 0.05, depth / 2, height / 2), wall)
    low, high = random.choice((0.15, 0.85)), height - random.uniform(0.25, 0.6)
    count, x = random.randint(1, 3), -width / 2 - 0.1
    pier = 0.35
    wide = (depth - 1.5 - pier * count) / count
    box("left", (0.2, depth + 0.4, low), (x, depth / 2, low / 2), wall)
    box("left", (0.2, depth + 0.4, height - high), (x, depth / 2, (height + high) / 2), wall)
    y = 1.5
    box("left", (0.2, y + 0.2, high - low), (x, (y - 0.2) / 2, (low + high) / 2), wall)
    for _ in range(count):
        bars = random.randint(2, 4) if by_day else 3
        for k in range(bars + 1):
            box("bar", (0.06, 0.045, high - low), (x, y + wide * k / bars, (low + high) / 2), frame, bevel=0.005)
        for k in range(3):
            box("bar", (0.06, wide, 0.045), (x, y + wide / 2, low + (high - low) * k / 2), frame, bevel=0.005)
        box("left", (0.2, pier, high - low), (x, y + wide + pier / 2, (low + high) / 2), wall)
        if random.random() < 0.4:
            cloth = materials.stripes(random, palette, 0.2, "UV")
            fold = sheet_mesh("curtain", 0.5, high - low + 0.2, (60, 3), lambda u, v: 0.04 * math.sin(70 * u), cloth)
            for end in (y + 0.1, y + wide - 0.1):
                place("curtain", fold, (x + 0.2, end, (low + high) / 2), (90, 0, 90))
        y += wide + pier
    if random.random() < 0.5:
        for k in range(random.randint(2, 5)):
            box("beam", (width, 0.16, 0.18), (0, depth * (0.25 + 0.18 * k), height - 0.08), frame, bevel=0.012)
    skirting = 0.1
    box("skirting", (width, 0.03, skirting), (0, depth - 0.015, skirting / 2), frame)
    box("skirting", (0.03, depth, skirting), (width / 2 - 0.015, depth / 2, skirting / 2), frame)


def _furnish(random, palette, width, depth, height, frame, top, cloth):
    leaf, pot = things.foliage(random, 0), materials.any_surface(random, palette, 0.06)
    if random.random() < 0.8:
        wide, deep = random.uniform(1.4, 2.2), random.uniform(0.9, 1.4)
        place("rug", sheet_mesh("rug", 1.6 * wide, 1.5 * deep, (20, 20), lambda u, v: 0.003 * math.sin(9 * u + 4 * v),
                                       materials.patterned(random, palette, 0.25, "UV")), (random.uniform(-0.4, 0.4), 0.55 * depth, 0.01),
                     (0, 0, random.uniform(-12, 12)))
    x, y = random.uniform(-0.15, 0.2) * width, random.uniform(0.45, 0.7) * depth
    high = random.choice((0.42, 0.74, 0.74))
    wide, deep = random.uniform(1.0, 1.8), random.uniform(0.6, 0.9)
    turn = random.uniform(-25, 25)
    things.group(things.table(random, top, frame, wide, deep, high), (x, y, 0), turn)
    for _ in range(random.randint(3, 9)):
        shape, low = things.random_mesh(random, random.uniform(0.04, 0.1), materials.any_surface(random, palette, 0.05))
        place("thing", shape, (x + random.uniform(-0.4, 0.4) * wide, y + random.uniform(-0.35, 0.35) * deep, high + low),
              (0, 0, random.uniform(0, 360)))
    if high > 0.5:
        for k in range(random.randint(1, 4)):
            side = 90 * k + turn
            away = (0.5 if k % 2 else 0.62) * (deep if k % 2 == 0 else wide)
            angle = math.radians(side - 90)
            at = (x - away * math.cos(angle), y - away * math.sin(angle), 0)
            things.group(things.chair(random, frame, cloth), at, side + random.gauss(180, 15))
    if random.random() < 0.6:
        things.group(things.sofa(random, cloth), (random.uniform(-0.25, 0.25) * width, depth - 0.55, 0), 180)
    else:
        _shelves(random, palette, frame, random.uniform(-0.3, 0) * width, depth - 0.02, random.uniform(1.0, 1.9), min(height - 0.4, 2.3))
    if random.random() < 0.5:
        cabinet = box("cabinet", (0.45, 1.2, 0.85), (width / 2 - 0.24, 0.6 * depth, 0.43), top, bevel=0.008)
        for k in range(3):
            box("door", (0.02, 0.36, 0.74), (cabinet.location.x - 0.23, 0.6 * depth - 0.39 + 0.39 * k, 0.43), frame, bevel=0.006)
    for _ in range(random.randint(0, 3)):
        at = (random.choice((-1, 1)) * (width / 2 - 0.4), random.uniform(0.4, 0.95) * depth, 0)
        things.group(things.plant(random, leaf, pot, random.uniform(0.5, 1.4)), at, random.uniform(0, 360))
    gilt = materials.metallic(random)
    for _ in range(random.randint(1, 5)):
        w, h = random.uniform(0.25, 0.8), random.uniform(0.25, 0.7)
        at = (random.uniform(-0.42, 0.42) * width, depth - 0.02, random.uniform(1.5, height - 0.5))
        box("frame", (w + 0.08, 0.04, h + 0.08), at, gilt if random.random() < 0.5 else frame, bevel=0.01)
        box("canvas", (w, 0.05, h), at, materials.patterned(random, palette, 0.5))


def _shelves(random, palette, frame, left, back, wide, high):
    cover, rows = things.book_cover(random, palette), max(3, int(high / 0.37))
    box("case", (wide, 0.02, high), (left + wide / 2, back, high / 2), frame)
    for side in (0, wide):
        box("case", (0.03, 0.3, high), (left + side, back - 0.15, high / 2), frame, bevel=0.003)
    for k in range(rows + 1):
        z = 0.06 + k * (high - 0.08) / rows
        box("shelf", (wide, 0.3, 0.025), (left + wide / 2, back - 0.15, z), frame, bevel=0.003)
        if k < rows and random.random() < 0.85:
            things.books(random, cover, (left + 0.03, back - 0.17, z + 0.013), wide * random.uniform(0.5, 0.96))


def _fittings(random, palette, width, depth, height):
    """Pendants, sconces or strings of bulbs; returns where their light comes from."""
    spots, hood, glow = [], materials.metallic(random), materials.glowing(random, 40)
    glow.cycles.sample_as_light = False
    kind = random.choice(("pendants", "sconces", "string", "panels"))
    if kind == "pendants":
        for k in range(random.randint(1, 5)):
            at = (random.uniform(-0.35, 0.35) * width, random.uniform(0.35, 0.9) * depth, height - random.uniform(0.4, 1.0))
            tube("cord", [at, (at[0], at[1], height)], 0.006, hood)
            lathe("hood", [(0.03, 0.16), (0.06, 0.13), (0.15, 0.02), (0.2, -0.03), (0.145, 0.02), (0.05, 0.13)], at, hood)
            spots.append((at[0], at[1], at[2] - 0.06))
    elif kind == "sconces":
        for k in range(random.randint(3, 8)):
            side = random.choice((-1, 1))
            spots.append((side * (width / 2 - 0.15), depth * (0.2 + 0.1 * k), random.uniform(1.6, 2.0)))
    elif kind == "string":
        for row in range(random.randint(1, 3)):
            y, sag = random.uniform(0.4, 0.95) * depth, random.uniform(0.1, 0.4)
            way = [(width * (t / 12 - 0.5), y, height - 0.15 - sag * 4 * t / 12 * (1 - t / 12)) for t in range(13)]
            tube("wire", way, 0.004, materials.painted(random, palette))
            spots += [(a, b, c - 0.05) for a, b, c in way[1:-1]]
    else:
        for k in range(random.randint(2, 6)):
            spots.append((width * (0.4 * (k % 2) - 0.2), depth * (0.25 + 0.13 * k), height - 0.08))
    for spot in spots:
        bulb = ball("bulb", 0.03, spot, glow, steps=12)
        bulb.visible_shadow = bulb.visible_diffuse = False
    return spots


def _daylight(scene, random, folders, width, depth, height):
    """Surroundings behind the windows, an area light in them, and the sun in most scenes."""
    if not lights.surroundings(scene, random, folders.hdri, 1.5):
        lights.dim(scene, (0.6, 0.8, 1.0), 1.5)
    scene.world.cycles.sampling_method = "NONE"
    scene.world.cycles_visibility.diffuse = False
    x = -width / 2 - 0.25
    light("AREA", (x, depth / 2 + 0.6, 1.5), (0, depth / 2 + 0.6, 1.2), 90, (0.8, 0.9, 1.0), depth - 1.5, height - 1).visible_camera = False
    if random.random() < 0.7:
        at = (-5, random.uniform(-2, 3), random.uniform(2, 5))
        light("SUN", at, (0, 0.5, 0), random.uniform(6, 14), (1, 0.85, 0.65), random.uniform(0.006, 0.03))
