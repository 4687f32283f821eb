"""A laid table: silver, copper, glass, glazed plates and an embroidered cloth before a dim room."""
import math
import os
from random import Random

import bpy

from shading import glass, lamp, material, metal, plain, wood, world
from shapes import ball, box, lathe, leaves_mesh, light, look, mesh, place, sheet_mesh, tube


def linen():
    """A cloth with a woven check, and a band of stitched diamonds."""
    made, g = material("linen")
    x, y, _ = g.parts(g.at("UV"))

    def stripes(c):
        return g.math("LESS_THAN", g.math("FRACT", g.math("MULTIPLY", c, 14)), 0.5)

    check = g.math("MULTIPLY", g.math("ADD", stripes(x), stripes(y)), 0.5)
    colour = g.ramp(check, (0.0, (0.72, 0.69, 0.62)), (0.5, (0.30, 0.36, 0.45)), (1.0, (0.055, 0.10, 0.22)))
    u, v = (g.math("SUBTRACT", g.math("FRACT", g.math("MULTIPLY", c, 28)), 0.5) for c in (x, y))
    diamond = g.math("ADD", g.math("ABSOLUTE", u), g.math("ABSOLUTE", v))
    stitch = g.math("MULTIPLY", g.math("COMPARE", diamond, 0.26, 0.06), g.math("COMPARE", check, 0.0, 0.1))
    colour = g.mix(stitch, colour, (0.55, 0.05, 0.04))
    warp = g.noise(g.at("UV", (900, 120, 1)), 1, 2)
    weft = g.noise(g.at("UV", (120, 900, 1)), 1, 2)
    thread = g.math("MULTIPLY", g.math("ADD", warp, weft), 0.5)
    colour = g.mix(1, colour, g.ramp(thread, (0.35, 0.7), (0.65, 1.05)), "MULTIPLY")
    g.finish(g.surface(colour, 0.9, g.bump(thread, 0.003, 0.5), sheen=0.3))
    return made


def china():
    """Glazed white with a painted rim: rings and leaves along the run of the profile."""
    made, g = material("china")
    u, run, _ = g.parts(g.at("UV"))
    ring = g.ramp(g.math("MULTIPLY", run, 4), (0, 0), (0.36, 1), (0.375, 0), (0.50, 1), (0.52, 0), (0.535, 1), (0.56, 0),
                  mode="CONSTANT")
    wave = g.math("MULTIPLY_ADD", g.math("SINE", g.math("MULTIPLY", u, math.tau * 24)), 0.012, 0.112)
    vine = g.math("COMPARE", run, wave, 0.0022)
    dots = g.math("FRACT", g.math("MULTIPLY", u, 48))
    berry = g.math("LESS_THAN", g.math("ADD", g.math("POWER", g.math("MULTIPLY", g.math("SUBTRACT", dots, 0.5), 0.014), 2),
                                       g.math("POWER", g.math("SUBTRACT", run, 0.112), 2)), 1.2e-5)
    ink = g.mix(berry, (0.02, 0.05, 0.25), (0.5, 0.03, 0.02))
    colour = g.mix(g.math("MAXIMUM", g.math("MAXIMUM", ring, vine), berry), (0.78, 0.76, 0.72), ink)
    g.finish(g.surface(colour, 0.08, clearcoat=0.5))
    return made


def peel(name, first, second, scale):
    made, g = material(name)
    at = g.at()
    pores = g.add("TexVoronoi", {"Vector": at, "Scale": scale}, "Distance")
    colour = g.mix(g.noise(at, 12, 5), first, second)
    g.finish(g.surface(colour, 0.35, g.bump(pores, 0.002, 0.35), subsurface=0.06, subsurface_color=second))
    return made


def plate(at, radius, glaze):
    s = radius / 0.14
    lathe("plate", [(0, 0.006), (0.075 * s, 0.006), (0.092 * s, 0.014), (0.14 * s, 0.024), (0.141 * s, 0.021),
                    (0.094 * s, 0.008), (0.07 * s, 0)], at, glaze, steps=96)


def teapot(at, silver, black, turn):
    root = bpy.data.objects.new("teapot", None)
    bpy.context.scene.collection.objects.link(root)
    body = [(0, 0), (0.06, 0), (0.055, 0.012), (0.075, 0.025), (0.108, 0.07), (0.105, 0.115), (0.07, 0.15), (0.05, 0.155)]
    lid = [(0.056, 0.153), (0.05, 0.165), (0.025, 0.178), (0.008, 0.182), (0.008, 0.19), (0.016, 0.198), (0.012, 0.21),
           (0, 0.213)]
    parts = [lathe("body", body, (0, 0, 0), silver, steps=96), lathe("lid", lid, (0, 0, 0), silver, steps=64),
             tube("spout", [(0.09, 0, 0.055), (0.155, 0, 0.075), (0.145, 0, 0.13), (0.2, 0, 0.165)], 0.019, silver,
                  taper=[1.35, 1, 0.75, 0.55]),
             tube("handle", [(-0.085, 0, 0.125), (-0.13, 0, 0.17), (-0.185, 0, 0.12), (-0.15, 0, 0.05), (-0.1, 0, 0.055)],
                  0.009, black)]
    for height, radius in ((0.025, 0.0765), (0.132, 0.0935)):
        parts.append(tube("bead", [(radius * math.cos(a), radius * math.sin(a), height) for a in
                                   (math.radians(d) for d in range(0, 361, 10))], 0.0026, silver))
    for part in parts:
        part.parent = root
    root.location, root.rotation_euler = at, (0, 0, math.radians(turn))


def cutlery(at, turn, silver):
    """A knife and a fork side by side."""
    blade = [(-0.011, 0), (-0.009, 0.1), (0.0, 0.118), (0.009, 0.105), (0.008, 0)]
    points = [(x, y, z) for z in (0, 0.0015) for x, y in blade]
    n = len(blade)
    faces = [tuple(range(n, 2 * n)), tuple(reversed(range(n)))] + [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    root = bpy.data.objects.new("cutlery", None)
    bpy.context.scene.collection.objects.link(root)
    parts = [place("blade", mesh("blade", points, faces, silver), (0, 0, 0.004)),
             tube("grip", [(0, 0.01, 0.005), (0, -0.05, 0.007), (0, -0.1, 0.007)], 0.006, silver, taper=[0.7, 1, 1.3])]
    parts.append(tube("grip", [(0.035, 0.03, 0.005), (0.035, -0.05, 0.006), (0.035, -0.1, 0.006)], 0.0045, silver,
                      taper=[0.7, 1, 1.5]))
    for i in range(4):
        x = 0.035 + 0.0075 * (i - 1.5)
        parts.append(tube("tine", [(0.035, 0.028, 0.005), (x, 0.045, 0.004), (x, 0.07, 0.003), (x, 0.105, 0.008)], 0.0021,
                          silver, taper=[1.6, 1.2, 1, 0.5]))
    for part in parts:
        part.parent = root
    root.location, root.rotation_euler = at, (0, 0, math.radians(turn))


def glassware(clear):
    wine, g = material("wine")
    g.finish(g.surface((0.09, 0.004, 0.01), 0.02, specular=0.7))
    goblet = [(0, 0.004), (0.036, 0.003), (0.037, 0.006), (0.008, 0.012), (0.0045, 0.03), (0.0045, 0.085), (0.02, 0.1),
              (0.041, 0.135), (0.043, 0.165), (0.036, 0.21), (0.0348, 0.21), (0.0415, 0.165), (0.0395, 0.137), (0.018, 0.103),
              (0, 0.098)]
    fill = [(0, 0.0985), (0.0175, 0.1035), (0.0388, 0.1375), (0.0403, 0.15), (0, 0.15)]
    for at, filled in (((0.235, 0.12, 0), True), ((0.335, 0.245, 0), False)):
        lathe("goblet", goblet, at, clear, steps=72)
        if filled:
            lathe("wine", fill, at, wine, smooth=False, steps=64)
    carafe = [(0, 0.003), (0.06, 0.003), (0.072, 0.03), (0.07, 0.07), (0.03, 0.15), (0.024, 0.19), (0.036, 0.24), (0.034, 0.24),
              (0.022, 0.19), (0.028, 0.15), (0.067, 0.07), (0.069, 0.03), (0.057, 0.007), (0, 0.007)]
    lathe("carafe", carafe, (-0.33, 0.3, 0), clear, steps=72)
    lathe("water", [(0, 0.0075), (0.0565, 0.0075), (0.0685, 0.03), (0.0665, 0.07), (0.05, 0.105), (0, 0.105)],
          (-0.33, 0.3, 0), glass("water", (0.9, 0.96, 0.98), 1.33), smooth=True, steps=72)


def fruit(random, leaf):
    """A copper bowl of oranges with a lemon and grapes beside it."""
    orange = peel("orange", (0.75, 0.20, 0.015), (0.85, 0.33, 0.03), 260)
    lemon = peel("lemon", (0.80, 0.58, 0.06), (0.85, 0.68, 0.12), 240)
    copper = metal("copper", (0.85, 0.42, 0.27), 0.12, 0.5, (40, 40, 500))
    lathe("bowl", [(0, 0.004), (0.05, 0.0), (0.045, 0.012), (0.09, 0.04), (0.118, 0.085), (0.123, 0.085), (0.115, 0.082),
                   (0.085, 0.043), (0.04, 0.02), (0, 0.018)], (-0.1, 0.36, 0), copper, steps=96)
    for x, y, z in ((-0.05, 0.01, 0.075), (0.035, 0.045, 0.078), (0.025, -0.045, 0.078), (0.0, 0.0, 0.132)):
        ball("orange", 0.041, (-0.1 + x, 0.36 + y, z), orange, 0.96, 48)
    spots = [(-0.1 + random.gauss(0, 0.012), 0.36 + random.gauss(0, 0.012), 0.172) for _ in range(5)]
    place("leaves", leaves_mesh("leaves", random, spots, 0.045, leaf))
    whole = lathe("lemon", [(0, -0.042), (0.008, -0.038), (0.026, -0.022), (0.031, 0), (0.026, 0.022), (0.009, 0.037),
                            (0, 0.043)], (0.085, 0.02, 0.031), lemon, (90, 0, 65))
    whole.name = "lemon"
    grape = glass("grape", (0.35, 0.08, 0.16), 1.35, 0.08)
    skin, g = material("skin")
    g.finish(g.surface(g.mix(g.noise(g.at(scale=60)), (0.08, 0.012, 0.04), (0.22, 0.05, 0.10)), 0.2, subsurface=0.2,
                       subsurface_color=(0.4, 0.05, 0.1), subsurface_radius=(0.01, 0.004, 0.004)))
    for i in range(26):
        along = random.random()
        ball("grape", random.uniform(0.0095, 0.0125),
             (0.17 + 0.11 * along + random.gauss(0, 0.006), -0.075 + random.gauss(0, 0.017) * (1.2 - 0.6 * along),
              0.011 + abs(random.gauss(0, 0.012)) * (1 - 0.6 * along)), skin if i % 3 else grape, 1.1, 20)
    tube("stalk", [(0.14, -0.07, 0.03), (0.2, -0.075, 0.03), (0.29, -0.08, 0.012)], 0.002, plain("twig", (0.12, 0.07, 0.02), 0.7))


def backdrop():
    """A dim wall of wood, and small lamps that the open lens turns into discs."""
    box("panel", (6, 0.05, 3), (0, 3.2, 0.6), wood("panel", (0.02, 0.009, 0.004), (0.12, 0.05, 0.02), (9, 9, 1)))
    random = Random(5)
    warm, amber = lamp("fairy", (1.0, 0.62, 0.3), 60, False), lamp("amber", (1.0, 0.4, 0.12), 45, False)
    for row, (left, right, sag) in enumerate(((-1.4, 1.5, 0.22), (-1.3, 1.35, 0.35))):
        for i in range(13):
            t = i / 12
            at = (left + t * (right - left), 2.3 + 0.35 * row + random.uniform(-0.1, 0.1),
                  0.30 + 0.17 * row - sag * 4 * t * (1 - t) + random.uniform(-0.03, 0.03))
            ball("fairy", 0.009, at, warm if random.random() < 0.7 else amber, steps=12).visible_diffuse = False


def build(scene):
    random = Random(3)
    silver = metal("silver", (0.88, 0.87, 0.84), 0.05)
    black = plain("ebony", (0.015, 0.012, 0.01), 0.25, clearcoat=0.6)
    oak = wood("oak", (0.05, 0.02, 0.008), (0.25, 0.115, 0.045), (2.5, 22, 22), roughness=0.25)
    box("table", (2.4, 1.4, 0.05), (0, 0.35, -0.032), oak, bevel=0.01)

    def drape(x, y):
        fold = 0.0016 * math.sin(17 * x + 5 * y) + 0.0012 * math.sin(23 * y - 8 * x)
        ridge = 0.008 * math.exp(-((x - 0.5 * y - 0.16) / 0.012) ** 2) + 0.006 * math.exp(-((y + 0.3 * x - 0.27) / 0.012) ** 2)
        return fold + ridge - 0.0035

    place("cloth", sheet_mesh("cloth", 0.92, 0.8, (230, 200), drape, linen()), (0.02, 0.14, 0), (0, 0, 24))
    glaze = china()
    plate((-0.13, 0.05, 0.002), 0.15, glaze)
    plate((-0.13, 0.05, 0.012), 0.11, glaze)
    lathe("cup", [(0, 0), (0.024, 0), (0.026, 0.006), (0.036, 0.025), (0.041, 0.058), (0.043, 0.06), (0.039, 0.056), (0.033, 0.025),
                  (0.018, 0.008), (0, 0.007)], (-0.13, 0.05, 0.024), glaze, steps=72)
    lathe("tea", [(0, 0.045), (0.0385, 0.045)], (-0.13, 0.05, 0.024), plain("tea", (0.16, 0.045, 0.008), 0.03), smooth=False)
    tube("ear", [(0.037, 0, 0.05), (0.062, 0, 0.056), (0.06, 0, 0.026), (0.034, 0, 0.02)], 0.0038, glaze, (-0.13, 0.05, 0.024),
         (0, 0, -38))
    teapot((0.1, 0.27, 0.001), silver, black, 207)
    cutlery((0.035, -0.09, 0.003), -22, silver)
    glassware(glass("clear"))
    leaf = plain("leaf", (0.03, 0.12, 0.02), 0.3)
    fruit(random, leaf)
    brass = metal("brass", (0.8, 0.55, 0.2), 0.14)
    lathe("candlestick", [(0, 0), (0.045, 0.003), (0.04, 0.012), (0.012, 0.025), (0.018, 0.05), (0.008, 0.08), (0.016, 0.13),
                          (0.02, 0.15), (0.01, 0.152), (0, 0.15)], (-0.5, 0.42, 0), brass, steps=64)
    lathe("candle", [(0.0, 0.15), (0.0105, 0.15), (0.0102, 0.29), (0, 0.292)], (-0.5, 0.42, 0),
          plain("wax", (0.75, 0.66, 0.5), 0.5), smooth=False)
    flame = lamp("flame", (1, 0.6, 0.25), 160, False)
    lathe("flame", [(0, 0.296), (0.005, 0.305), (0.003, 0.322), (0, 0.335)], (-0.5, 0.42, 0), flame).visible_diffuse = False
    backdrop()

    g = world(scene)
    folder = os.path.join(bpy.utils.system_resource("DATAFILES"), "studiolights", "world")
    picture = bpy.data.images.load(os.path.join(folder, "interior.exr"))
    room = g.add("TexEnvironment", {"Vector": g.at("Generated", turn=(0, 0, math.radians(150)))}, "Color")
    room.node.image = picture
    room = g.mix(1, g.mix(1, room, (0, 0, 0), "LIGHTEN"), (6, 6, 6), "DARKEN")
    g.finish(g.add("Background", {"Color": room, "Strength": 0.55}))
    light("AREA", (-1.1, -0.2, 1.0), (0, 0.15, 0), 14, (0.85, 0.92, 1.0), 0.55, 0.9)
    light("AREA", (1.3, 0.9, 0.9), (0, 0.2, 0.05), 9, (1.0, 0.76, 0.5), 0.4)
    look((0.14, -0.78, 0.36), (-0.03, 0.18, 0.055), 48, (0.0, 0.07, 0.05), 3.5)
