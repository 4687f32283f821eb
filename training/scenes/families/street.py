"""A street at dusk or night: lit windows, lamps along the kerb, wet ground in some."""
import cameras
import lights
import materials
from families import architecture, things
from shapes import ball, box, lathe, place, sheet_mesh, tube


def build(scene, random, folders):
    palette = materials.Palette(random)
    glow = materials.glowing(random, random.uniform(1.0, 4.0))
    if random.random() < 0.5:
        road = materials.plain("wet", palette.colour(0.02, 0.08), random.choice((0.08, 0.2)))
    else:
        road = materials.flooring(random, palette, False)
    place("road", sheet_mesh("road", 120, 120, (4, 4), lambda x, y: 0.0, road))
    gap, length = random.uniform(3.0, 5.5), random.uniform(24, 36)
    for side in (-1, 1):
        y = 0.0
        while y < length:
            wide = random.uniform(6, 11)
            architecture.facade(random, palette, (side * gap, y + wide / 2, 0), wide, random.randint(2, 4), -90 * side, glow)
            y += wide + random.choice((0, 0, 1.5))
        box("kerb", (1.0, length, 0.16), (side * (gap - 0.5), length / 2, 0.07), materials.plaster("kerb", palette.colour(0.2, 0.5)), bevel=0.02)
    architecture.facade(random, palette, (0, length, 0), 4 * gap, random.randint(2, 5), 0, glow)
    iron, bulb = materials.plain("iron", (0.02, 0.02, 0.022), 0.4), materials.glowing(random, 60)
    bulb.cycles.sample_as_light = False
    spots = []
    for k in range(random.randint(3, 7)):
        at = ((-1) ** k * (gap - 0.8), 3.5 + 4.2 * k, 0)
        tube("pole", [at, (at[0], at[1], 3.2)], 0.05, iron)
        lathe("cap", [(0.02, 0.25), (0.2, 0.12), (0.24, 0.05), (0.2, 0.05)], (at[0], at[1], 3.2), iron, smooth=False)
        spots.append((at[0], at[1], 3.12))
    if random.random() < 0.5:
        y = random.uniform(4, 8)
        for row in range(random.randint(1, 3)):
            way = [(gap * (t / 7 - 1), y + 3 * row, 3.4 - 0.7 * (t / 7) * (2 - t / 7)) for t in range(15)]
            tube("wire", way, 0.01, iron)
            spots += way[1:-1:2]
    for spot in spots:
        lantern = ball("lantern", 0.09, spot, bulb, steps=16)
        lantern.visible_shadow = lantern.visible_diffuse = False
    lights.dim(scene, random.choice(((0.08, 0.13, 0.4), (0.3, 0.25, 0.5), (0.5, 0.3, 0.2))), random.uniform(0.1, 0.6))
    lights.lamps(random, spots, 120, 0.09)
    for _ in range(random.randint(4, 16)):
        shape, low = things.random_mesh(random, random.uniform(0.15, 0.5), materials.any_surface(random, palette, 0.1))
        place("thing", shape, (random.uniform(-0.8, 0.8) * gap, random.uniform(3, 14), low), (0, 0, random.uniform(0, 360)))
    cameras.eye(random, (random.uniform(-0.5, 0.5) * gap, random.uniform(-3, 0.5), random.uniform(1.2, 2.2)),
                (random.uniform(-0.5, 0.5) * gap, 12, random.uniform(1.4, 3.0)), (22, 45), 0.15)
