"""Glass and metal in a studio or under an HDRI."""
import math

import cameras
import lights
import materials
from families import things
from shapes import ball, box, place, sheet_mesh, tube


def build(scene, random, folders):
    palette = materials.Palette(random)
    floor = random.choice((materials.painted, lambda r, p: materials.flooring(r, p, False), lambda r, p: materials.timber(r, "X")))(random, palette)

    def sweep(x, y):  # a studio's cove: the ground rises behind
        return 0.0 if y < 1.2 else min(3.0, 2.2 * (y - 1.2) ** 2)

    cove = random.random() < 0.5
    place("ground", sheet_mesh("ground", 12, 9, (40, 220), sweep if cove else lambda x, y: 0.0, floor))
    surfaces = [materials.metallic(random) for _ in range(3)] + [materials.clear(random, palette) for _ in range(3)] + [
        materials.any_surface(random, palette, 0.05), materials.patterned(random, palette, 0.08)]
    points, taken = [], []
    for _ in range(random.randint(6, 16)):
        size = random.uniform(0.08, 0.28)
        for _ in range(30):
            x, y = random.gauss(0, 0.5), random.gauss(0, 0.4)
            if y < 0.9 and all(math.dist((x, y), t[:2]) > size + t[2] for t in taken):
                break
        else:
            continue
        taken.append((x, y, size))
        surface = random.choice(surfaces)
        if random.random() < 0.12:
            turns, knots = random.randint(2, 5), []
            for k in range(turns * 12):
                a = math.tau * k / 12
                knots.append((0.7 * size * math.cos(a), 0.7 * size * math.sin(a), 0.08 * size + 1.6 * size * k / (turns * 12)))
            tube("spring", knots, 0.07 * size, surface, (x, y, 0.02))
        else:
            shape, low = things.random_mesh(random, size * 0.85, surface)
            place("thing", shape, (x, y, low + 0.002), (0, 0, random.uniform(0, 360)))
        points += [(x - size, y, size), (x + size, y, size), (x, y, 0), (x, y, 2 * size)]
    for _ in range(random.randint(0, 25)):
        r = random.uniform(0.012, 0.04)
        ball("bead", r, (random.gauss(0, 0.6), random.gauss(-0.2, 0.4), r), random.choice(surfaces), steps=24)
    if random.random() < 0.3:
        for k in range(random.randint(2, 6)):
            box("pane", (0.5, 0.015, 0.7), (random.uniform(-1, 1), 0.9 - 0.1 * k, 0.36), surfaces[3], (0, 0, random.uniform(-40, 40)))
    cameras.around(random, points, (4, 40), (35, 85), (-150, -30) if cove else (0, 360))
    if random.random() < 0.4 or not lights.surroundings(scene, random, folders.hdri):
        lights.studio(scene, random, (0, 0, 0.3), 1.2)
