"""Displaced terrain: ridges, terraces, dunes and craters, with water, rocks and trees."""
import math

from mathutils import noise

import cameras
import lights
import materials
from families import things
from shapes import place, sheet_mesh


def _cover(random, palette, high):
    """Colour by height and slope: sand, grass, rock, snow, or the palette's."""
    made, g = materials.material("terrain")
    z = g.parts(g.at())[2]
    steep = g.parts(g.add("NewGeometry", output="Normal"))[2]
    rough = g.noise(g.at(scale=1.5), 1, 9, 0.7)
    if random.random() < 0.6:
        layers = [(0.30, 0.24, 0.14), (0.08, 0.13, 0.03), (0.13, 0.15, 0.05), (0.25, 0.22, 0.18), (0.75, 0.77, 0.8)]
    else:
        layers = [palette.colour(0.08, 0.6) for _ in range(5)]
    level = g.math("ADD", g.math("MULTIPLY_ADD", z, 0.6 / high, 0.3), g.math("MULTIPLY_ADD", rough, 0.5, -0.25))
    colour = g.ramp(level, *((0.1 + 0.2 * k, c) for k, c in enumerate(layers)))
    cliff = g.ramp(g.math("MULTIPLY_ADD", rough, 0.25, steep), (0.72, 1), (0.9, 0))
    strata = g.noise(g.at(scale=(0.4, 0.4, 7)), 1, 5)
    rock = g.ramp(strata, (0.3, (0.07, 0.06, 0.05)), (0.7, materials.g_mix((0.34, 0.3, 0.26), palette.colour(), 0.3)))
    colour = g.mix(cliff, colour, rock)
    fine = g.noise(g.at(scale=12), 1, 8, 0.7)
    colour = g.mix(1, colour, g.ramp(fine, (0.3, 0.6), (0.7, 1.1)), "MULTIPLY")
    g.finish(g.surface(colour, 0.95, g.bump(g.math("ADD", fine, strata), 0.05, 0.7)))
    return made


def build(scene, random, folders):
    palette = materials.Palette(random)
    high, kind, shift = random.uniform(2.5, 7), random.choice(("ridges", "ridges", "terraces", "dunes", "craters")), random.uniform(0, 99)
    holes = [(random.uniform(-20, 20), random.uniform(-4, 36), random.uniform(1, 6)) for _ in range(30)]

    def lie(x, y):
        at = (0.055 * x, 0.055 * y, shift)
        if kind == "ridges":
            value = noise.ridged_multi_fractal(at, 1.0, 2.1, 7, 1.0, 2.0) - 1.0
        elif kind == "dunes":
            value = abs(math.sin(3 * noise.noise(at) + 0.3 * x + 0.15 * y)) * 0.4 + 0.02 * math.sin(9 * x + 3 * math.sin(y))
        elif kind == "craters":
            value = 0.5 * noise.fractal(at, 1.0, 2.0, 6)
            for a, b, r in holes:
                away = math.hypot(x - a, y - b) / r
                value += (0.3 * away * away - 0.25 if away < 1 else 0.05 * math.exp(-6 * (away - 1))) * r / 5
        else:
            value = 1.2 * noise.fractal(at, 0.9, 2.0, 5)
            value = (math.floor(5 * value) + min(1, 4 * (5 * value % 1))) / 5
        near = math.exp(-(x * x + (y + 6) ** 2) / 30)
        return high * value * (1 - 0.85 * near)

    land = sheet_mesh("terrain", 90, 90, (420, 420), lambda x, y: lie(x, y + 32), _cover(random, palette, high), kind != "terraces")
    place("terrain", land, (0, 32, 0))
    if random.random() < 0.5:
        water, g = materials.material("water")
        ripple = g.noise(g.at(scale=(3, 1.2, 1)), 1, 4)
        g.finish(g.surface(palette.colour(0.01, 0.08), 0.03, g.bump(ripple, 0.02, 0.3), specular=0.6))
        place("water", sheet_mesh("water", 90, 90, (2, 2), lambda x, y: 0, water), (0, 32, random.uniform(-0.35, 0.0) * high))
    stone = materials.stains(random, palette, 0.4, "Object")
    rocks = [things.blob_mesh(random, "rock", 0.35, stone, 0.5, 3) for _ in range(3)]
    for _ in range(random.randint(20, 250)):
        y = -3 + 30 * random.random() ** 1.6
        x = random.uniform(-0.8, 0.8) * (y + 6)
        place("rock", random.choice(rocks), (x, y, lie(x, y)), [random.uniform(0, 360) for _ in range(3)], random.uniform(0.2, 1.6) ** 2)
    if random.random() < 0.55:
        trees = [things.tree_meshes(random, materials.timber(random), things.foliage(random), 3, 1800) for _ in range(2)]
        for _ in range(random.randint(10, 160)):
            y = 40 * random.random()
            x = random.uniform(-0.8, 0.8) * (y + 6)
            if noise.noise((0.2 * x, 0.2 * y, shift)) > -0.1:
                turn, size = random.uniform(0, 360), random.uniform(0.4, 0.9)
                for part in random.choice(trees):
                    place("tree", part, (x, y, lie(x, y)), (0, 0, turn), size)
    lights.outdoors(scene, random, folders.hdri)
    at = (0, -7, max(lie(0, -7), lie(0, -5), 0) + random.uniform(1.2, 5))
    cameras.eye(random, at, (random.uniform(-4, 4), 16, lie(0, 16) * 0.5 + random.uniform(-1, 1.5)), (24, 50), 0.05)
