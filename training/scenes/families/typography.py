"""Letters and fine lines: posters, pages, solid letters, nets, grilles, cables, dials."""
import math

import cameras
import lights
import materials
from families import things
from shapes import box, mesh, place, sheet_mesh, tube


def _poster(random, palette, at, turn, wide, high, ink):
    """A sheet with headings, columns of small print, rules and a chart; stands upright facing -y."""
    paper = materials.plain("paper", materials.g_mix((0.75, 0.73, 0.68), palette.colour(0.3, 0.8), random.choice((0, 0.2, 0.8))), 0.7)
    parts = [box("paper", (wide, 0.008, high), (0, 0.005, high / 2), paper)]
    z = high * 0.97
    while z > 0.08 * high:
        kind, size = random.choice(("head", "text", "text", "text", "rule", "chart", "bars")), high * random.uniform(0.05, 0.16)
        if kind == "head":
            z -= size
            parts.append(things.lettering("head", things.words(random, random.randint(1, 2)), size, random.choice(ink), (0, 0, z), (90, 0, 0)))
        elif kind == "text":
            size = high * random.choice((0.016, 0.024, 0.035))
            columns = random.randint(1, 3)
            lines = min(int((z - 0.06 * high) / (1.1 * size)), random.randint(3, 9))
            if lines < 1:
                break
            per_line = max(1, int(wide / columns / (3.1 * size)))
            for k in range(columns):
                body = "\n".join(things.words(random, per_line) for _ in range(lines))
                left = -0.46 * wide + 0.95 * wide * k / columns
                parts.append(things.lettering("text", body, size, ink[0], (left, 0, z - size), (90, 0, 0), centred=False))
            z -= 1.1 * size * lines
        elif kind == "rule":
            parts.append(box("rule", (0.92 * wide, 0.002, high * random.uniform(0.002, 0.012)), (0, -0.001, z - 0.02 * high), random.choice(ink)))
            z -= 0.03 * high
        else:
            tall = min(2.2 * size, z - 0.05 * high)
            for k in range(random.randint(8, 40) if kind == "bars" else 0):
                bar = tall * random.random()
                thin, x = wide * random.uniform(0.004, 0.015), wide * (random.random() - 0.5) * 0.9
                parts.append(box("bar", (thin, 0.002, bar), (x, -0.001, z - tall + bar / 2), random.choice(ink)))
            for _ in range(3 if kind == "chart" else 0):
                way = [(wide * (0.9 * t / 14 - 0.45), -0.002, z - tall * random.random()) for t in range(15)]
                parts.append(tube("curve", way, 0.003 * high * random.random() + 0.0006, random.choice(ink), smooth=random.random() < 0.5))
            z -= tall
        z -= 0.02 * high
    return things.group(parts, at, turn)


def _net(random, surface, at, turn, wide, high):
    """A grille, a diagonal net or a row of thin bars."""
    kind, step, thin = random.choice(("bars", "grille", "net")), random.uniform(0.03, 0.1), random.uniform(0.0012, 0.004)
    parts = []
    if kind == "net":
        for side in (-1, 1):
            x = -wide / 2 - high
            while x < wide / 2 + high:
                a, b = (x, 0), (x + side * high, high)
                parts.append(tube("wire", [(a[0], 0, a[1]), (b[0], 0, b[1])], thin, surface))
                x += 1.4 * step
    else:
        for k in range(int(wide / step) + 1):
            x = -wide / 2 + step * k
            parts.append(tube("wire", [(x, 0, 0), (x, 0, high)], thin, surface))
        for k in range(int(high / step) + 1 if kind == "grille" else 3):
            z = (step if kind == "grille" else high / 2) * k
            parts.append(tube("wire", [(-wide / 2, 0, z), (wide / 2, 0, z)], thin, surface))
    return things.group(parts, at, turn)


def build(scene, random, folders):
    palette = materials.Palette(random)
    ink = [materials.plain("ink", tint, 0.5) for tint in ((0.02, 0.02, 0.022), palette.colour(0.05, 0.5), palette.colour())]
    place("ground", sheet_mesh("ground", 10, 10, (4, 4), lambda x, y: 0.0, materials.flooring(random, palette)))
    box("wall", (10, 0.1, 5), (0, 1.0, 2.4), materials.walling(random, palette))
    points = []
    for _ in range(random.randint(2, 6)):
        wide, high = random.uniform(0.4, 0.9), random.uniform(0.5, 1.1)
        on_wall = random.random() < 0.6
        at = (random.uniform(-1.1, 1.1), 0.93 if on_wall else random.uniform(-0.2, 0.6), random.uniform(0.1, 0.9) if on_wall else 0.0)
        _poster(random, palette, at, 0 if on_wall else random.uniform(-35, 35), wide, high, ink)
        points += [(at[0] - wide / 2, at[1], at[2]), (at[0] + wide / 2, at[1], at[2] + high)]
    for _ in range(random.randint(1, 5)):
        size = random.uniform(0.12, 0.4)
        at = (random.uniform(-1, 1), random.uniform(-0.7, 0.5), 0.01)
        surface = materials.any_surface(random, palette, 0.05)
        things.lettering("letters", things.words(random, 1)[:random.randint(1, 6)], size, surface, at, (90, 0, random.uniform(-30, 30)), 0.15 * size)
        points += [(at[0] - size, at[1], 0), (at[0] + size, at[1], size)]
    metal = materials.metallic(random)
    for _ in range(random.randint(0, 3)):
        at = (random.uniform(-1, 1), random.uniform(-0.5, 0.8), random.uniform(0, 0.4))
        _net(random, random.choice((metal, ink[0], ink[1])), at, random.uniform(-40, 40), random.uniform(0.4, 1.2), random.uniform(0.4, 1.1))
    for _ in range(random.randint(0, 14)):
        ends = [(random.uniform(-2.2, 2.2), random.uniform(-0.6, 0.9), random.uniform(0.3, 2.2)) for _ in range(2)]
        sag = [(sum(c) / 2 - (0.3 if k == 2 else 0)) for k, c in enumerate(zip(*ends))]
        tube("cable", [ends[0], sag, ends[1]], random.choice((0.0015, 0.004, 0.008)), random.choice((*ink, metal)))
    if random.random() < 0.5:
        x, z, r = random.uniform(-0.8, 0.8), random.uniform(0.9, 1.5), random.uniform(0.15, 0.35)
        for k in range(60):
            a, long = math.tau * k / 60, 0.12 if k % 5 == 0 else 0.05
            way = [(x + s * r * math.sin(a), 0.93, z + s * r * math.cos(a)) for s in (1 - long, 1.0)]
            tube("tick", way, 0.004 if k % 5 == 0 else 0.002, ink[0])
            if k % 5 == 0:
                at = (x + 0.75 * r * math.sin(a), 0.93, z + 0.75 * r * math.cos(a) - 0.05 * r)
                things.lettering("hour", str(k // 5 or 12), 0.16 * r, ink[1], at, (90, 0, 0))
        for a, long in ((random.uniform(0, 6), 0.5), (random.uniform(0, 6), 0.8)):
            tube("hand", [(x, 0.92, z), (x + long * r * math.sin(a), 0.92, z + long * r * math.cos(a))], 0.005, ink[2])
        points.append((x, 0.93, z))
    cameras.around(random, points, (2, 28), (30, 70), (-125, -55), (0.9, 1.7), floor=0.1)
    if random.random() < 0.5 or not lights.surroundings(scene, random, folders.hdri):
        lights.studio(scene, random, (0, 0.3, 0.6), 1.2)
