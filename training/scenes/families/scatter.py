"""Many instances of a few things: strewn over a ground, heaped, or floating."""
import math

import cameras
import lights
import materials
from families import things
from shapes import place, sheet_mesh


def build(scene, random, folders):
    palette = materials.Palette(random)
    meshes = []
    for _ in range(random.randint(3, 7)):
        size = random.uniform(0.05, 0.16)
        meshes.append((*things.random_mesh(random, size, materials.any_surface(random, palette, random.choice((0.03, 0.06)))), size))
    mode = random.choice(("strewn", "strewn", "rows", "floating", "heap"))
    points = []

    def put(x, y, z, tumble):
        shape, low, size = random.choice(meshes)
        grow = random.uniform(0.7, 1.4)
        turn = [random.uniform(0, 360) for _ in range(3)] if tumble else (0, 0, random.uniform(0, 360))
        place("thing", shape, (x, y, z + (size if tumble else low) * grow), turn, grow)
        points.append((x, y, z))

    ground = materials.flooring(random, palette, indoors=False)
    swell = random.choice((0, 0, 0.06))
    if mode != "floating":
        place("ground", sheet_mesh("ground", 60, 60, (200, 200), lambda x, y: swell * math.sin(0.9 * x) * math.cos(0.7 * y), ground), (0, 0, 0))
    if mode == "strewn":
        for _ in range(random.randint(150, 700)):
            away, angle = 3.5 * math.sqrt(random.random()), random.uniform(0, math.tau)
            put(away * math.cos(angle), away * math.sin(angle), 0, random.random() < 0.5)
    elif mode == "rows":
        step, twist = random.uniform(0.3, 0.5), random.random() < 0.5
        for i in range(-7, 8):
            for j in range(-7, 8):
                put(step * i + (0.5 * step * (j % 2) if twist else 0), step * j, 0, False)
    elif mode == "heap":
        for _ in range(random.randint(250, 600)):
            away, angle = abs(random.gauss(0, 0.75)), random.uniform(0, math.tau)
            put(away * math.cos(angle), away * math.sin(angle), random.random() * 0.9 * math.exp(-1.5 * away * away), True)
    else:
        for _ in range(random.randint(120, 400)):
            put(*(random.gauss(0, 0.9) for _ in range(3)), True)
    near = sorted(points, key=lambda p: math.hypot(*p))[:max(30, len(points) // random.choice((2, 3, 6)))]
    cameras.around(random, near, (5, 65) if mode != "floating" else (-20, 30), (24, 70))
    lights.outdoors(scene, random, folders.hdri) if random.random() < 0.75 else lights.studio(scene, random, (0, 0, 0.2), 2.0)
