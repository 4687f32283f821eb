"""A vase, a steel ball, a crate and a cup in a corner of an even backdrop: most of the picture needs no network."""
from shading import material, metal, plain, wood, world
from shapes import ball, box, lathe, light, look


def even(scene, colour, lit):
    """A backdrop of one colour to the camera; the scene gets `lit` of white light from all sides."""
    g = world(scene)
    seen = g.add("LightPath", output="Is Camera Ray")
    shown, shining = (g.add("Background", {"Color": c, "Strength": s}) for c, s in ((colour, 1.0), ((1, 1, 1), lit)))
    g.finish(g.add("MixShader", {0: seen, 1: shining, 2: shown}))


def wares(target=(0.15, 0, 0.55), lens=50):
    """The things themselves, close together, with their lamps and camera."""
    profile = ((0.0, 0), (0.32, 0.0), (0.45, 0.35), (0.3, 0.8), (0.16, 1.0), (0.22, 1.15), (0.18, 1.15), (0.12, 1.0))
    clay, g = material("clay")
    tone = g.noise(g.at(scale=4), 1, 9, 0.65)
    g.finish(g.surface(g.ramp(tone, (0.3, (0.25, 0.07, 0.03)), (0.7, (0.7, 0.3, 0.14))), 0.5, g.bump(tone, 0.02, 0.7)))
    lathe("vase", profile, (-0.45, 0.2, 0), clay)
    ball("ball", 0.33, (0.35, -0.25, 0.33), metal("steel", (0.8, 0.75, 0.7), 0.12))
    crate = wood("crate", (0.16, 0.09, 0.04), (0.55, 0.36, 0.18), scale=6)
    box("crate", (0.7, 0.6, 0.8), (0.75, 0.5, 0.4), crate, (0, 0, 0.4), 0.02)
    lathe("cup", ((0, 0), (0.14, 0), (0.19, 0.3), (0.17, 0.3), (0.13, 0.03), (0, 0.03)), (-0.1, -0.6, 0), plain("glaze", (0.1, 0.25, 0.5), 0.15))
    light("AREA", (-3, -3, 4), (0, 0, 0.5), 260, (1, 0.95, 0.9), 1.5)
    light("AREA", (3.5, -2, 2.5), (0, 0, 0.5), 90, (0.8, 0.9, 1), 1.0)
    look((0.1, -5.2, 1.5), target, lens)


def build(scene):
    even(scene, (0.25, 0.27, 0.3), 0.3)
    wares((1.4, 0, 1.2), 32)
