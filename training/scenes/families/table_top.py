"""A table, its cloth and what stands on it, before a wall or surroundings."""
import math

import cameras
import lights
import materials
from families import things
from shapes import box, curve_through, lathe_mesh, place, sheet_mesh


def build(scene, random, folders):
    palette = materials.Palette(random)
    top = materials.timber(random, "X") if random.random() < 0.6 else materials.patterned(random, palette, 0.15)
    box("table", (2.4, 1.8, 0.06), (0, 0, -0.035), top, bevel=0.01)
    if random.random() < 0.6:
        phase, lift = random.uniform(0, 9), random.uniform(0.001, 0.003)
        place("cloth", sheet_mesh("cloth", random.uniform(0.6, 1.2), random.uniform(0.5, 0.9), (150, 120), lambda x, y: lift * (
            math.sin(21 * x + 7 * y + phase) + math.sin(26 * y - 9 * x)) - lift, materials.patterned(random, palette, 0.06, "UV")),
            (random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 0.0), (0, 0, random.uniform(0, 90)))
    walled = random.random() < 0.5
    if walled:
        box("wall", (8, 0.1, 4), (0, random.uniform(1.2, 2.5), 1.2), materials.walling(random, palette))
    surfaces = [materials.any_surface(random, palette, random.choice((0.02, 0.04, 0.07))) for _ in range(7)]
    points, taken = [], []
    for _ in range(random.randint(7, 20)):
        size = random.uniform(0.03, 0.1)
        for _ in range(20):
            x, y = random.gauss(0, 0.2), random.gauss(0, 0.15)
            if all(math.dist((x, y), t[:2]) > size + t[2] for t in taken):
                break
        else:
            continue
        taken.append((x, y, size))
        if random.random() < 0.5:
            tall = size * random.uniform(1.2, 4)
            shape, low = lathe_mesh("vessel", curve_through(things.profile(random, size, tall)), random.choice(surfaces), 72), 0.0
        else:
            shape, low = things.random_mesh(random, 0.8 * size, random.choice(surfaces))
            tall = 2 * size
        place("thing", shape, (x, y, low + 0.003), (0, 0, random.uniform(0, 360)))
        points += [(x, y, 0.0), (x, y, tall), (x - size, y, tall / 2), (x + size, y, tall / 2)]
    if random.random() < 0.35:
        cover = things.book_cover(random, palette)
        for k in range(random.randint(1, 5)):
            box("book", (0.17, 0.24, 0.03), (0.33, 0.12, 0.018 + 0.032 * k), cover, (0, 0, random.uniform(-25, 25)), bevel=0.003)
    cameras.around(random, points, (6, 42), (35, 85), (-160, -20) if walled else (0, 360))
    if random.random() < 0.5 or not lights.surroundings(scene, random, folders.hdri):
        lights.studio(scene, random, (0, 0, 0.1), 0.45)
