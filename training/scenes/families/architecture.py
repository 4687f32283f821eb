"""Buildings by day: facades of windows, columns, stairs, arches, courtyards."""
import math

import cameras
import lights
import materials
from families import things
from shapes import box, box_mesh, curve_through, lathe_mesh, mesh, place, sheet_mesh


def facade(random, palette, at, wide, floors, turn=0.0, glow=None):
    """A front of windows with frames, sills, cornices and perhaps balconies; faces -y before it is turned."""
    wall, trim = materials.walling(random, palette), materials.plaster("trim", palette.colour(0.35, 0.8))
    frame = materials.painted(random, palette)
    pane = materials.plain("pane", (0.02, 0.025, 0.03), 0.05, specular=0.9)
    step, high = random.uniform(1.6, 2.6), random.uniform(2.7, 3.4)
    open_wide, open_high = step * random.uniform(0.4, 0.65), high * random.uniform(0.45, 0.65)
    sill, bars = random.uniform(0.5, 0.9), random.randint(1, 3)
    balcony, shutters = random.random() < 0.35, random.random() < 0.35
    parts = [box("wall", (wide, 6, floors * high + 0.5), (0, 3, floors * high / 2), wall)]
    shared = {"frame": box_mesh("frame", (open_wide + 0.16, 0.12, open_high + 0.16), trim),
              "pane": box_mesh("pane", (open_wide, 0.04, open_high), pane),
              "lit": box_mesh("lit", (open_wide, 0.04, open_high), glow or pane), "bar": box_mesh("bar", (0.045, 0.06, open_high), frame),
              "rung": box_mesh("rung", (open_wide, 0.06, 0.045), frame), "sill": box_mesh("sill", (open_wide + 0.3, 0.22, 0.07), trim),
              "leaf": box_mesh("leaf", (open_wide / 2, 0.05, open_high), frame), "rail": box_mesh("rail", (step * 0.85, 0.03, 0.04), frame),
              "post": box_mesh("post", (0.025, 0.025, 0.9), frame), "slab": box_mesh("slab", (step * 0.85, 0.75, 0.1), trim)}
    for level in range(floors):
        parts.append(box("cornice", (wide + 0.2, 0.25, 0.16), (0, -0.05, (level + 1) * high), trim, bevel=0.03))
        for column in range(int(wide / step)):
            x, z = -wide / 2 + step * (column + 0.5) + (wide - int(wide / step) * step) / 2, level * high + sill + open_high / 2

            def put(kind, dx, dy, dz, x=x, z=z):
                parts.append(place(kind, shared[kind], (x + dx, dy, z + dz)))
            put("frame", 0, -0.02, 0)
            put("lit" if glow and random.random() < 0.45 else "pane", 0, -0.075, 0)
            for k in range(1, bars + 1):
                put("bar", open_wide * (k / (bars + 1) - 0.5), -0.1, 0)
            put("rung", 0, -0.1, random.choice((0.12, 0.2)) * open_high)
            put("sill", 0, -0.12, -open_high / 2 - 0.08)
            if shutters and level:
                for side in (-1, 1):
                    put("leaf", side * 0.78 * open_wide, -0.06, 0)
            if balcony and level and column % 2 == 0:
                put("slab", 0, -0.4, -open_high / 2 - 0.15)
                put("rail", 0, -0.75, -open_high / 2 + 0.8)
                for k in range(9):
                    put("post", step * 0.85 * (k / 8 - 0.5), -0.75, -open_high / 2 + 0.35)
    things.group(parts, at, turn)
    return floors * high


def _colonnade(random, palette):
    stone, count = materials.any_surface(random, palette, 0.4), random.randint(4, 9)
    tall, step = random.uniform(3, 5), random.uniform(1.5, 2.4)
    column = lathe_mesh("column", curve_through([(0.36, 0), (0.36, 0.12), (0.27, 0.2), (0.27, 0.5 * tall), (0.22, tall - 0.3), (0.33, tall - 0.12),
                                                 (0.36, tall)]), stone, 32)
    arched, points = random.random() < 0.6, []
    for row in (0, random.uniform(3, 5)):
        for k in range(count):
            x = step * (k - (count - 1) / 2)
            place("column", column, (x, row, 0))
            points += [(x, row, 0), (x, row, tall)]
            if arched and k:
                outer, inner, ring = step / 2 + 0.15, step / 2 - 0.2, []
                for a in (math.pi * t / 14 for t in range(15)):
                    for r in (inner, outer):
                        ring += [(r * math.cos(a), y, r * math.sin(a)) for y in (-0.25, 0.25)]
                faces = [(4 * t + a, 4 * t + b, 4 * t + 4 + b, 4 * t + 4 + a) for t in range(14) for a, b in ((0, 1), (1, 3), (3, 2), (2, 0))]
                place("arch", mesh("arch", ring, faces, stone), (x - step / 2, row, tall))
        box("beam", (step * count, 0.7, 0.5), (0, row, tall + (step / 2 + 0.3 if arched else 0.25)), stone, bevel=0.04)
    box("wall", (step * count + 4, 0.3, tall + 3), (0, row + 3, tall / 2), materials.walling(random, palette))
    for k in range(4):
        box("stair", (step * count + 1.2 * k, 0.35, 0.15), (0, -0.6 - 0.3 * k, -0.06 - 0.14 * k), stone, bevel=0.01)
    return points


def build(scene, random, folders):
    palette = materials.Palette(random)
    place("ground", sheet_mesh("ground", 160, 160, (4, 4), lambda x, y: 0.0, materials.flooring(random, palette, False)),
          (0, 0, -0.55))
    if random.random() < 0.35:
        points = _colonnade(random, palette)
        first = random.randrange(max(1, len(points) // 2 - 6))
        cameras.around(random, points[first:first + random.randint(5, 9)], (1, 16), (24, 50), (-140, -40), (0.9, 1.5), floor=0.8)
    else:
        floors, wide = random.randint(2, 6), random.uniform(10, 18)
        tall = facade(random, palette, (0, 0, -0.55), wide, floors)
        if random.random() < 0.7:
            facade(random, palette, (wide / 2 + random.uniform(2, 4), -random.uniform(4, 8), -0.55), random.uniform(8, 14), random.randint(2, 5), -90)
        if random.random() < 0.6:
            facade(random, palette, (-wide / 2 - 4, random.uniform(-1, 3), -0.55), random.uniform(6, 10), random.randint(1, 5))
        x, z = random.uniform(-0.3, 0.3) * wide, random.uniform(0.25, 0.7) * tall
        away = random.uniform(4, 15)
        cameras.eye(random, (x + random.uniform(-5, 3), -away, random.uniform(1.0, 3.5)), (x, 0, z), (24, 45), 0.08)
        for _ in range(random.randint(0, 10)):
            shape, low = things.random_mesh(random, random.uniform(0.2, 0.6), materials.any_surface(random, palette, 0.15))
            place("thing", shape, (x + random.uniform(-4, 4), -random.uniform(0.8, 0.7 * away), low - 0.55), (0, 0, random.uniform(0, 360)))
    lights.outdoors(scene, random, folders.hdri)
