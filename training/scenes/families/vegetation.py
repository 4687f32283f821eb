"""Meadows, flowers, shrubs and trees, near and far."""
import math

from mathutils import noise

import cameras
import lights
import materials
from families import things
from shapes import blades_mesh, box, leaves_mesh, mesh, place, sheet_mesh


def flower_mesh(random, petal):
    count, reach, cup = random.randint(4, 14), random.uniform(0.025, 0.045), random.uniform(-0.2, 0.7)
    points, faces = [(0, 0, 0)], []
    for k in range(count):
        a, w = math.tau * k / count, 2.4 / count
        for t, r in ((-w / 2, 0.7), (0, 1.0), (w / 2, 0.7)):
            points.append((r * reach * math.cos(a + t), r * reach * math.sin(a + t), cup * reach * r * r))
        faces.append((0, 3 * k + 1, 3 * k + 2, 3 * k + 3))
    return mesh("flower", points, faces, petal)


def build(scene, random, folders):
    palette = materials.Palette(random)
    shift, swell = random.uniform(0, 99), random.uniform(0.1, 0.8)

    def lie(x, y):
        return swell * noise.noise((0.08 * x, 0.08 * y, shift)) + 0.06 * noise.noise((0.5 * x, 0.5 * y, shift))

    near = random.random() < 0.5
    earth = materials.stains(random, palette, 1.0, "Object") if random.random() < 0.3 else materials.plain("earth", (0.09, 0.085, 0.035), 0.95)
    place("ground", sheet_mesh("ground", 140, 140, (220, 220), lambda x, y: lie(x, y + 50), earth), (0, 50, 0))
    leaf = things.foliage(random, 0.25)
    high = random.uniform(0.12, 0.45)
    eye_high = high + random.choice((0.25, 0.6, 1.2))
    tufts = [blades_mesh("tuft", random, 130, 0.42, high, random.uniform(0.003, 0.008), leaf, random.uniform(0.3, 1.2)) for _ in range(4)]
    flowers = [flower_mesh(random, materials.plain("petal", palette.colour(0.3, 0.8), 0.5)) for _ in range(3)]
    stem = mesh("stem", [(-0.003, 0, 0), (0.003, 0, 0), (0.002, 0, 1), (-0.002, 0, 1)], [(0, 1, 2, 3)], leaf)

    def spot():
        away = 0.7 + (14 if near else 32) * random.random() ** 1.7
        return random.uniform(-0.85, 0.85) * (away + 0.5), away, random.uniform(0, 360)

    for _ in range(random.randint(700, 1500)):
        x, y, turn = spot()
        place("tuft", random.choice(tufts), (x, y, lie(x, y) - 0.02), (0, 0, turn), random.uniform(0.7, 1.2) * (1 + 0.02 * y))
    for _ in range(random.choice((0, 100, 300, 700))):
        x, y, turn = spot()
        tall = high * random.uniform(0.8, 1.5)
        place("stem", stem, (x, y, lie(x, y)), (0, 0, turn), (1, 1, tall))
        kind = int(abs(noise.noise((0.4 * x, 0.4 * y, 3.0 + shift))) * 6 + random.random()) % 3
        place("flower", flowers[kind], (x, y, lie(x, y) + tall), (random.gauss(18, 15), random.gauss(0, 15), turn), random.uniform(0.6, 1.3))
    bark = materials.timber(random)
    trees = [things.tree_meshes(random, bark, things.foliage(random, 0.3), random.uniform(3.5, 7)) for _ in range(2)]
    for _ in range(random.randint(3, 40)):
        y = random.uniform(4, 60)
        x = random.uniform(-0.7, 0.7) * y
        size, turn = random.uniform(0.6, 1.3), random.uniform(0, 360)
        for part in random.choice(trees):
            place("tree", part, (x, y, lie(x, y)), (0, 0, turn), size)
    spots = [[random.gauss(0, 0.35), random.gauss(0, 0.35), 0.4 + random.gauss(0, 0.2)] for _ in range(1500)]
    shrub = leaves_mesh("shrub", random, spots, 0.09, leaf)
    for _ in range(random.randint(0, 14)):
        y = random.uniform(2.5, 18)
        x = random.uniform(-0.7, 0.7) * y
        place("shrub", shrub, (x, y, lie(x, y)), (0, 0, random.uniform(0, 360)), random.uniform(0.5, 1.5))
    stone = materials.stains(random, palette, 0.3, "Object")
    rocks = [things.blob_mesh(random, "rock", 0.3, stone, 0.5, 3) for _ in range(3)]
    for _ in range(random.randint(0, 25)):
        y = random.uniform(1.2, 14)
        x = random.uniform(-0.7, 0.7) * y
        place("rock", random.choice(rocks), (x, y, lie(x, y)), (0, 0, random.uniform(0, 360)), random.uniform(0.3, 2))
    if random.random() < 0.4:
        fence, left = materials.timber(random), random.uniform(-3, 2)
        for k in range(14):
            x, y = left + 0.25 * k, 3 + 1.1 * k
            box("post", (0.09, 0.09, 1.2), (x, y, lie(x, y) + 0.45), fence, (random.gauss(0, 3), random.gauss(0, 3), 0), bevel=0.008)
            for z in (0.35, 0.7):
                box("rail", (0.035, 1.15, 0.08), (x + 0.12, y + 0.55, lie(x, y) + z), fence, (0, 0, -12.8), bevel=0.006)
    lights.outdoors(scene, random, folders.hdri)
    target = (random.uniform(-1, 1), 6, lie(0, 6) + random.choice((0.3, 1.0, 2.0)))
    cameras.eye(random, (0, -0.5, lie(0, -0.5) + eye_high), target, (26, 55), 0.25)
