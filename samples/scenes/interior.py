"""A study: sun through a window, lamps, books, tiles, wood, a rug."""
import math
from random import Random

import bpy

from shading import bricks, glass, lamp, material, metal, plain, plaster, wood, world
from shapes import ball, box, lathe, leaves_mesh, light, look, place, sheet_mesh, tube

WARM = (1.0, 0.72, 0.42)


def tiles():
    """Blue and white glazed tiles, 0.15 m, each with a flower of arcs."""
    made, g = material("tiles")
    at = g.at("UV", 1 / 0.15)
    x, y, _ = g.parts(g.add("VectorMath", {0: at}, operation="FRACTION"))
    u, v = (g.math("SUBTRACT", c, 0.5) for c in (x, y))
    radius = g.math("SQRT", g.math("ADD", g.math("MULTIPLY", u, u), g.math("MULTIPLY", v, v)))
    angle = g.math("ARCTAN2", u, v)
    petal = g.math("MULTIPLY_ADD", g.math("COSINE", g.math("MULTIPLY", angle, 8)), 0.09, 0.27)
    flower = g.math("LESS_THAN", g.math("ABSOLUTE", g.math("SUBTRACT", radius, petal)), 0.035)
    heart = g.math("LESS_THAN", radius, 0.09)
    corner = g.math("LESS_THAN", g.math("ABSOLUTE", g.math("SUBTRACT", g.math("ADD", g.math(
        "ABSOLUTE", u), g.math("ABSOLUTE", v)), 0.78)), 0.05)
    ink = g.math("MAXIMUM", g.math("MAXIMUM", flower, heart), corner)
    edge = g.math("MAXIMUM", g.math("ABSOLUTE", u), g.math("ABSOLUTE", v))
    seam = g.math("GREATER_THAN", edge, 0.485)
    wash = g.noise(g.at("UV", 30), 1, 4)
    blue = g.mix(wash, (0.015, 0.06, 0.25), (0.06, 0.16, 0.42))
    colour = g.mix(seam, g.mix(ink, g.mix(wash, (0.62, 0.63, 0.6), (0.78, 0.77, 0.72)), blue), (0.35, 0.33, 0.3))
    rough = g.math("MULTIPLY_ADD", seam, 0.6, 0.18)
    g.finish(g.surface(colour, rough, g.bump(g.math("SUBTRACT", 1, seam), 0.002, 0.5)))
    return made


def rug_weave():
    """A woven rug: medallion, borders and thread."""
    made, g = material("rug")
    x, y, _ = g.parts(g.at("UV"))
    ax, ay = g.math("ABSOLUTE", x), g.math("ABSOLUTE", y)
    border = g.math("MAXIMUM", g.math("DIVIDE", ax, 1.1), g.math("DIVIDE", ay, 0.8))
    bands = g.ramp(border, (0, (0.30, 0.03, 0.025)), (0.70, (0.03, 0.05, 0.12)), (0.74, (0.55, 0.42, 0.24)),
                   (0.77, (0.30, 0.03, 0.025)), (0.88, (0.55, 0.42, 0.24)), (0.91, (0.03, 0.05, 0.12)), mode="CONSTANT")
    lattice = g.add("VectorMath", {0: g.at("UV", 9), 1: (0.5, 0.5, 0)}, operation="ADD")
    px, py, _ = g.parts(g.add("VectorMath", {0: lattice}, operation="FRACTION"))
    diamond = g.math("ADD", g.math("ABSOLUTE", g.math("SUBTRACT", px, 0.5)),
                     g.math("ABSOLUTE", g.math("SUBTRACT", py, 0.5)))
    motif = g.math("COMPARE", diamond, 0.3, 0.08)
    pattern = g.mix(motif, bands, (0.58, 0.46, 0.28))
    medal = g.math("PINGPONG", g.math("MULTIPLY", g.math("ADD", g.math("DIVIDE", ax, 0.6), g.math(
        "DIVIDE", ay, 0.4)), 4), 1.0)
    inside = g.math("LESS_THAN", g.math("ADD", g.math("DIVIDE", ax, 0.6), g.math("DIVIDE", ay, 0.4)), 1.0)
    pattern = g.mix(inside, pattern, g.ramp(medal, (0, (0.03, 0.06, 0.14)), (0.4, (0.55, 0.4, 0.2)),
                                            (0.65, (0.34, 0.05, 0.03)), mode="CONSTANT"))
    thread = g.add("TexNoise", {"Vector": g.at("UV", (300, 60, 1)), "Scale": 1.0, "Detail": 2.0})
    pattern = g.mix(1, pattern, g.ramp(thread, (0.3, 0.55), (0.7, 1.0)), "MULTIPLY")
    g.finish(g.surface(pattern, 0.95, g.bump(thread, 0.006, 0.6), sheen=0.4))
    return made


def book_cover():
    """A spine: a colour of its own, gilt bands and rows of lettering."""
    made, g = material("book")
    x, _, z = g.parts(g.at("Generated"))
    dyes = ((0.28, 0.03, 0.02), (0.03, 0.10, 0.06), (0.02, 0.04, 0.14), (0.42, 0.30, 0.12), (0.10, 0.04, 0.02),
            (0.55, 0.50, 0.40), (0.30, 0.12, 0.04), (0.05, 0.15, 0.18), (0.45, 0.10, 0.05), (0.04, 0.04, 0.045))
    dye = g.ramp(g.chance(), *((i / len(dyes), c) for i, c in enumerate(dyes)), mode="CONSTANT")
    grain = g.noise(g.at(scale=90), 1, 3)
    cover = g.mix(1, dye, g.ramp(grain, (0.3, 0.6), (0.7, 1.05)), "MULTIPLY")
    bands = g.ramp(z, (0, 0), (0.07, 1), (0.085, 0), (0.12, 1), (0.13, 0), (0.80, 1), (0.815, 0), (0.9, 1),
                   (0.92, 0), mode="CONSTANT")
    row = g.math("GREATER_THAN", g.math("FRACT", g.math("MULTIPLY", z, 26)), 0.45)
    seed = g.math("MULTIPLY", g.chance(), 100)
    ink = g.math("GREATER_THAN", g.noise(g.add("VectorMath", {0: g.at(scale=(330, 1, 120)), 1: seed},
                                               operation="ADD"), 1, 1), 0.52)
    middle = g.math("MULTIPLY", g.ramp(z, (0, 0), (0.42, 1), (0.72, 0), mode="CONSTANT"),
                    g.math("LESS_THAN", g.math("ABSOLUTE", g.math("SUBTRACT", x, 0.5)), 0.32))
    gilt = g.math("MAXIMUM", bands, g.math("MULTIPLY", middle, g.math("MULTIPLY", row, ink)))
    g.finish(g.surface(g.mix(gilt, cover, (0.75, 0.52, 0.2)), g.math("MULTIPLY_ADD", gilt, -0.2, 0.5),
                       g.bump(grain, 0.001, 0.4), metallic=g.math("MULTIPLY", gilt, 0.8)))
    return made


def painting(seed):
    """A small landscape: sky, hills, lake."""
    made, g = material("painting")
    x, y, z = g.parts(g.at("Generated"))
    ridge = g.noise(g.at("Generated", (3, 1, 0.2), (seed, 0, 0)), 2, 7, 0.6)
    brush = g.noise(g.at("Generated", (12, 1, 50), (seed, 0, 0)), 1, 4)
    line = g.math("ADD", g.math("SUBTRACT", z, g.math("MULTIPLY", ridge, 0.55)), g.math("MULTIPLY", brush, 0.12))
    colour = g.ramp(line, (0, (0.05, 0.09, 0.10)), (0.1, (0.10, 0.13, 0.05)), (0.2, (0.32, 0.25, 0.08)),
                    (0.28, (0.13, 0.20, 0.28)), (0.36, (0.75, 0.50, 0.30)), (0.6, (0.35, 0.48, 0.62)))
    g.finish(g.surface(g.mix(0.35, colour, g.ramp(brush, (0.3, 0.2), (0.7, 0.9)), "OVERLAY"), 0.4,
                       g.bump(brush, 0.003, 0.5)))
    return made


def shell(oak):
    """Walls, floor, ceiling, the tiled dado, and the window's frame at the left."""
    wall = plaster("wall", (0.62, 0.52, 0.38))
    floor = bricks("floor", (0.30, 0.15, 0.065), (0.16, 0.075, 0.03), (0.03, 0.015, 0.008), (1.1, 0.11), 0.003,
                   bump=0.4, shift=0.37, rough=0.42)
    box("floor", (5.4, 6.4, 0.1), (0, 2.4, -0.05), floor)
    box("ceiling", (5.4, 6.4, 0.1), (0, 2.4, 2.85), plaster("ceiling", (0.75, 0.72, 0.66)))
    box("back", (5.4, 0.1, 2.9), (0, 5.05, 1.4), wall)
    box("front", (5.4, 0.1, 2.9), (0, -0.75, 1.4), wall)
    box("right", (0.1, 6.4, 2.9), (2.65, 2.4, 1.4), wall)
    for size, at in (((0.2, 6.4, 0.85), (-2.6, 2.4, 0.425)), ((0.2, 6.4, 0.45), (-2.6, 2.4, 2.6)),
                     ((0.2, 3.0, 1.55), (-2.6, 0.7, 1.6)), ((0.2, 0.9, 1.55), (-2.6, 4.55, 1.6))):
        box("left", size, at, wall)
    glaze = tiles()
    box("dado", (5.2, 0.02, 1.05), (0, 4.99, 0.525), glaze)
    box("dado", (0.02, 5.4, 0.75), (-2.49, 2.4, 0.375), glaze)
    for at, size in (((0, 4.97, 1.07), (5.2, 0.06, 0.05)), ((0, 4.97, 0.06), (5.2, 0.04, 0.12))):
        box("rail", size, at, oak, bevel=0.008)
    for y in (0.9, 2.5, 4.1):
        box("beam", (5.2, 0.2, 0.2), (0, y, 2.7), oak, bevel=0.015)
    white = plain("white", (0.7, 0.68, 0.62), 0.35)
    for y in (2.2, 2.84, 3.46, 4.1):
        box("mullion", (0.07, 0.05, 1.55), (-2.6, y, 1.62), white, bevel=0.006)
    for z in (0.86, 1.36, 1.87, 2.38):
        box("mullion", (0.07, 1.95, 0.045), (-2.6, 3.15, z), white, bevel=0.006)
    box("sill", (0.34, 2.1, 0.05), (-2.47, 3.15, 0.84), white, bevel=0.01)


def curtain(y):
    made, g = material("curtain")
    stripe = g.math("GREATER_THAN", g.math("FRACT", g.math("MULTIPLY", g.parts(g.at("UV"))[0], 14)), 0.7)
    cloth = g.mix(stripe, (0.62, 0.56, 0.44), (0.42, 0.10, 0.06))
    weave = g.noise(g.at("UV", 240), 1, 2)
    g.finish(g.add("MixShader", {0: 0.35, 1: g.surface(cloth, 0.9, g.bump(weave, 0.002, 0.4)),
                                 2: g.add("BsdfTranslucent", {"Color": cloth})}))
    fold = sheet_mesh("curtain", 0.5, 2.05, (90, 4), lambda x, y: 0.04 * math.sin(x * 75) + 0.015 * math.sin(x * 31), made)
    place("curtain", fold, (-2.36, y, 1.5), (90, 0, 90))


def bookcase(random, oak, at, width, shelves, depth=0.3, step=0.36):
    """A case of shelves at `at` (left, back, floor), its open side to -y, filled with books."""
    x, y, _ = at
    cover, high = book_cover(), shelves * step + 0.1
    box("case", (width, 0.02, high), (x + width / 2, y, high / 2), oak)
    for side in (0, width):
        box("case", (0.035, depth, high), (x + side, y - depth / 2, high / 2), oak, bevel=0.004)
    box("crown", (width + 0.12, depth + 0.05, 0.05), (x + width / 2, y - depth / 2, high + 0.02), oak, bevel=0.012)
    for shelf in range(shelves):
        z = 0.08 + shelf * step
        box("shelf", (width, depth, 0.028), (x + width / 2, y - depth / 2, z), oak, bevel=0.004)
        run = 0.03
        while run < width - 0.09:
            thick, tall = random.uniform(0.018, 0.05), random.uniform(0.21, 0.31)
            deep = random.uniform(0.16, 0.22)
            if random.random() < 0.06:
                run += random.uniform(0.06, 0.16)
                continue
            lean = random.choice((0, 0, 0, 0, 0, random.uniform(3, 10)))
            shift = 0.5 * tall * math.sin(math.radians(lean))
            box("book", (thick, deep, tall), (x + run + thick / 2 + shift, y - depth + deep / 2 + random.uniform(0.02, 0.05),
                                              z + 0.014 + tall / 2), cover, (0, lean, 0), bevel=0.004)
            run += thick + 0.003 + 2 * shift
    return cover


def desk(random, oak, cover):
    """A writing desk at the back wall with a lamp, an open book, a globe and a mug."""
    brass = metal("brass", (0.75, 0.5, 0.2), 0.2)
    box("top", (1.7, 0.75, 0.045), (-0.95, 4.5, 0.76), oak, bevel=0.008)
    for x in (-1.6, -0.3):
        box("pedestal", (0.36, 0.62, 0.64), (x, 4.53, 0.42), oak, bevel=0.006)
        for z in (0.2, 0.42, 0.62):
            box("drawer", (0.31, 0.02, 0.185), (x, 4.215, z), oak, bevel=0.008)
            ball("knob", 0.017, (x, 4.19, z), brass, steps=16)
    shade, g = material("shade")
    pleat = g.math("PINGPONG", g.math("MULTIPLY", g.parts(g.at("UV"))[0], 60), 1)
    paper = g.mix(pleat, (0.75, 0.5, 0.25), (0.85, 0.66, 0.4))
    g.finish(g.add("MixShader", {0: 0.55, 1: g.surface(paper, 0.8), 2: g.add("BsdfTranslucent", {"Color": paper})}))
    spot = (-1.5, 4.62, 0.78)
    lathe("lamp foot", [(0, 0), (0.09, 0.005), (0.08, 0.025), (0.02, 0.05), (0.016, 0.12), (0.045, 0.18), (0.02, 0.25),
                        (0.012, 0.32), (0.012, 0.42)], spot, brass)
    lathe("lamp shade", [(0.18, 0.33), (0.165, 0.39), (0.12, 0.53)], spot, shade, smooth=False, steps=64)
    ball("bulb", 0.035, (-1.5, 4.62, 1.16), lamp("bulb", WARM, 200))
    globe, g = material("globe")
    land = g.ramp(g.noise(g.at(scale=9), 1, 8, 0.6), (0.47, (0.10, 0.22, 0.30)), (0.5, (0.55, 0.45, 0.25)),
                  (0.62, (0.30, 0.32, 0.12)))
    g.finish(g.surface(land, 0.25, clearcoat=0.6))
    ball("globe", 0.15, (-0.45, 4.62, 1.02), globe, steps=48)
    lathe("stand", [(0.1, 0), (0.09, 0.02), (0.02, 0.04), (0.015, 0.1)], (-0.45, 4.62, 0.78), brass)
    tube("meridian", [(0.165 * math.cos(a), 0, 0.165 * math.sin(a)) for a in (math.radians(d) for d in range(-90, 91, 15))],
         0.006, brass, (-0.45, 4.62, 1.02), (0, 0, 30))
    page, g = material("page")
    x, y, _ = g.parts(g.at("UV"))
    line = g.math("LESS_THAN", g.math("FRACT", g.math("MULTIPLY", y, 75)), 0.4)
    words = g.math("GREATER_THAN", g.noise(g.at("UV", (150, 75, 1)), 1, 1), 0.47)
    block = g.math("LESS_THAN", g.math("ABSOLUTE", g.math("SUBTRACT", g.math("ABSOLUTE", x), 0.085)), 0.06)
    block = g.math("MULTIPLY", block, g.math("LESS_THAN", g.math("ABSOLUTE", y), 0.1))
    g.finish(g.surface(g.mix(g.math("MULTIPLY", block, g.math("MULTIPLY", line, words)), (0.78, 0.72, 0.58),
                             (0.08, 0.06, 0.05)), 0.8))
    place("open book", sheet_mesh("open book", 0.34, 0.25, (40, 2), lambda x, y: 0.035 * math.sqrt(abs(x) / 0.17) * (
        1.3 - abs(x) / 0.17), page), (-1.0, 4.33, 0.79), (0, 0, 8))
    for i in range(4):
        box("book", (0.2 + 0.02 * random.random(), 0.27, 0.035), (-0.78, 4.68, 0.803 + 0.036 * i), cover,
            (0, 0, random.uniform(-15, 15)), bevel=0.003)
    lathe("mug", [(0, 0), (0.038, 0), (0.042, 0.02), (0.042, 0.1), (0.037, 0.1), (0.036, 0.02), (0, 0.015)],
          (-0.62, 4.3, 0.785), plain("mug", (0.05, 0.18, 0.2), 0.12, clearcoat=0.5), smooth=False)


def chair(oak, at, turn):
    """A wooden chair with a spindle back."""
    root = bpy.data.objects.new("chair", None)
    bpy.context.scene.collection.objects.link(root)
    cushion = plain("cushion", (0.30, 0.05, 0.04), 0.9, sheen=0.5)
    parts = [box("seat", (0.44, 0.42, 0.035), (0, 0, 0.44), oak, bevel=0.012),
             box("cushion", (0.40, 0.38, 0.05), (0, 0, 0.475), cushion, bevel=0.022)]
    for x in (-0.18, 0.18):
        parts.append(tube("leg", [(x, -0.17, 0.43), (1.15 * x, -0.2, 0)], 0.019, oak, taper=[1, 0.65]))
        parts.append(tube("leg", [(x, 0.17, 0.43), (1.15 * x, 0.22, 0)], 0.019, oak, taper=[1, 0.65]))
        parts.append(tube("stile", [(x, -0.19, 0.44), (1.05 * x, -0.24, 0.72), (1.1 * x, -0.3, 1.0)], 0.018, oak))
        parts.append(tube("rung", [(1.07 * x, -0.19, 0.2), (1.07 * x, 0.19, 0.2)], 0.011, oak))
    for i in range(5):
        x = -0.12 + 0.06 * i
        parts.append(tube("spindle", [(x, -0.19, 0.45), (x, -0.24, 0.7), (1.1 * x, -0.3, 0.95)], 0.009, oak))
    parts.append(box("head", (0.46, 0.025, 0.1), (0, -0.3, 0.98), oak, (-10, 0, 0), bevel=0.01))
    for part in parts:
        part.parent = root
    root.location, root.rotation_euler = at, (0, 0, math.radians(turn))


def plant(random, at, pot, leaf, tall=0.9, count=170, size=0.12):
    lathe("pot", [(0, 0), (0.13, 0), (0.17, 0.26), (0.185, 0.27), (0.185, 0.31), (0.165, 0.31), (0.16, 0.27), (0, 0.26)],
          at, pot, smooth=False)
    spots = []
    for _ in range(9):
        tip = (random.gauss(0, 0.28), random.gauss(0, 0.28), 0.3 + tall * random.uniform(0.5, 1))
        way = [(0, 0, 0.26), (0.25 * tip[0], 0.25 * tip[1], 0.26 + 0.6 * (tip[2] - 0.26)), tip]
        tube("stem", way, 0.007, leaf, at, taper=[1, 0.8, 0.4])
        for _ in range(count // 9):
            t = random.uniform(0.35, 1)
            spots.append([(1 - t) ** 2 * a + 2 * t * (1 - t) * b + t * t * c + random.gauss(0, 0.03)
                          for a, b, c in zip(*way)])
    place("leaves", leaves_mesh("leaves", random, spots, size, leaf), at)


def pictures(oak):
    gold = metal("gilt", (0.7, 0.46, 0.17), 0.3, 0.4)
    for i, (x, z, wide, tall) in enumerate(((-1.75, 1.85, 0.5, 0.62), (-1.0, 1.78, 0.72, 0.5), (-0.32, 1.9, 0.36, 0.46))):
        box("canvas", (wide, 0.02, tall), (x, 4.985, z), painting(7.3 * i + 2))
        for dx, dz, w, h in ((0, tall / 2, wide + 0.09, 0.05), (0, -tall / 2, wide + 0.09, 0.05),
                             (wide / 2, 0, 0.05, tall), (-wide / 2, 0, 0.05, tall)):
            box("frame", (w, 0.05, h), (x + dx, 4.975, z + dz), gold if i != 1 else oak, bevel=0.012)


def pendants(black):
    glow = lamp("filament", WARM, 170)
    for x, y, z in ((0.25, 3.3, 1.98), (0.85, 3.3, 2.12), (1.45, 3.3, 1.98)):
        tube("cord", [(x, y, z + 0.1), (x, y, 2.8)], 0.005, black)
        lathe("hood", [(0.03, 0.12), (0.05, 0.1), (0.12, 0.03), (0.16, -0.03), (0.155, -0.03), (0.11, 0.03), (0.03, 0.1)],
              (x, y, z), metal("copper", (0.85, 0.42, 0.25), 0.2), steps=40)
        ball("filament", 0.04, (x, y, z - 0.01), glow, steps=20)


def view(scene):
    """The garden behind the window: hills and sky."""
    g = world(scene)
    x, y, z = g.parts(g.at("Generated"))
    ridge = g.noise(g.at("Generated", 9), 1, 6)
    rise = g.math("SUBTRACT", z, g.math("MULTIPLY_ADD", ridge, 0.3, -0.22))
    shade = g.ramp(g.noise(g.at("Generated", 40), 1, 5), (0.35, (0.03, 0.07, 0.02)), (0.65, (0.22, 0.3, 0.08)))
    sky = g.ramp(z, (0.0, (0.8, 0.85, 0.9)), (0.4, (0.3, 0.52, 0.85)))
    colour = g.mix(g.math("GREATER_THAN", rise, 0.0), shade, sky)
    g.finish(g.add("Background", {"Color": colour, "Strength": 1.6}))
    scene.world.cycles.sampling_method = "NONE"  # only looked at: the window's area light does the lighting
    scene.world.cycles_visibility.diffuse = False


def build(scene):
    random = Random(11)
    oak = wood("oak", (0.055, 0.022, 0.009), (0.27, 0.13, 0.055), (14, 1.2, 14))
    upright = wood("walnut", (0.045, 0.018, 0.008), (0.2, 0.095, 0.04), (14, 14, 1.2))
    shell(oak)
    curtain(1.95)
    curtain(4.36)
    cover = bookcase(random, upright, (0.35, 4.95, 0), 1.9, 6)
    desk(random, oak, cover)
    chair(upright, (-0.75, 3.75, 0), 14)
    pictures(oak)
    pendants(plain("black", (0.02, 0.02, 0.02), 0.4))
    place("rug", sheet_mesh("rug", 2.2, 1.6, (40, 30), lambda x, y: 0.004 * math.sin(9 * x + 4 * y), rug_weave()),
          (0.1, 2.75, 0.012), (0, 0, -6))
    leaf, g = material("leaf")
    g.finish(g.surface(g.ramp(g.noise(g.at(scale=20)), (0.3, (0.02, 0.07, 0.015)), (0.7, (0.08, 0.2, 0.03))), 0.35))
    clay = plaster("clay", (0.42, 0.17, 0.08))
    plant(random, (-2.05, 4.3, 0), clay, leaf, 1.25, 190, 0.14)
    for y in (2.5, 3.2, 3.75):
        lathe("flowerpot", [(0, 0), (0.05, 0), (0.07, 0.11), (0, 0.1)], (-2.4, y, 0.865), clay, smooth=False)
        spots = [(random.gauss(0, 0.06), random.gauss(0, 0.06), random.uniform(0.1, 0.28)) for _ in range(60)]
        place("herbs", leaves_mesh("herbs", random, spots, 0.06, leaf), (-2.4, y, 0.865))
    table = lathe("table", [(0.0, 0.5), (0.3, 0.5), (0.3, 0.47), (0.04, 0.46), (0.03, 0.1), (0.2, 0.02), (0.2, 0)],
                  (1.48, 3.35, 0), oak, smooth=False)
    table.data.polygons.foreach_set("use_smooth", [False] * len(table.data.polygons))
    lathe("vase", [(0, 0), (0.05, 0), (0.085, 0.08), (0.06, 0.18), (0.03, 0.24), (0.045, 0.27)], (1.43, 3.42, 0.5),
          plain("celadon", (0.25, 0.42, 0.36), 0.1, clearcoat=0.7))
    box("book", (0.16, 0.22, 0.03), (1.6, 3.2, 0.517), cover, (0, 0, 40), bevel=0.003)
    lathe("glass", [(0, 0.004), (0.03, 0.004), (0.036, 0.11), (0.033, 0.11), (0.028, 0.01), (0, 0.01)], (1.3, 3.2, 0.5),
          glass("tumbler"), smooth=False)

    view(scene)
    light("SUN", (-5, 2, 4), (-1.0, 3.4, 0.9), 9.0, (1.0, 0.86, 0.66), 0.012)
    light("AREA", (-2.75, 3.15, 1.62), (0, 3.15, 1.2), 60, (0.75, 0.87, 1.0), 1.9, 1.5).visible_camera = False
    look((0.95, 0.75, 1.42), (-0.32, 4.3, 1.12), 25)
