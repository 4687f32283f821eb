"""Random materials: a palette for the scene, then surfaces that suit a role."""
import colorsys

from shading import bricks, glass, lamp, material, metal, plain, plaster, wood

WOODS = (((0.055, 0.022, 0.009), (0.27, 0.13, 0.055)), ((0.2, 0.12, 0.06), (0.5, 0.36, 0.2)), ((0.03, 0.012, 0.007), (0.12, 0.05, 0.025)),
         ((0.12, 0.10, 0.08), (0.4, 0.36, 0.3)), ((0.14, 0.04, 0.015), (0.36, 0.13, 0.05)), ((0.34, 0.26, 0.17), (0.62, 0.52, 0.38)))
METALS = ((0.9, 0.88, 0.85), (0.75, 0.5, 0.2), (0.85, 0.42, 0.26), (0.55, 0.55, 0.57), (0.3, 0.3, 0.32), (0.9, 0.7, 0.32), (0.35, 0.25, 0.2))


class Palette:
    """Colours that go together: a few hues, strong and faded, and neutrals."""

    def __init__(self, random):
        self.random = random
        first = random.random()
        spread = random.choice((0.04, 0.08, 0.5, 0.33))
        self.hues = [first, (first + spread) % 1, (first - spread) % 1, random.random()]
        self.strength = random.choice((0.35, 0.6, 0.8))

    def colour(self, low=0.04, high=0.75):
        r = self.random
        if r.random() < 0.35:
            grey, warm = r.uniform(low, high), r.uniform(-0.12, 0.18)
            return grey * (1 + 0.5 * warm), grey, grey * (1 - warm)
        saturation = min(0.97, self.strength * r.uniform(0.4, 1.25))
        red, green, blue = colorsys.hsv_to_rgb((r.choice(self.hues) + r.gauss(0, 0.02)) % 1, saturation, 1)
        value = r.uniform(low, high) if r.random() < 0.5 else high * r.uniform(0.6, 1)
        return red * value, green * value, blue * value

    def pair(self):
        """A dark and a light colour."""
        return self.colour(0.02, 0.3), self.colour(0.4, 0.8)


def _graph(name, random, palette, size, space):
    made, g = material(name)
    turn = (0, 0, random.choice((0, 0, 0.785, random.uniform(0, 3.1))))
    return made, g, g.at(space, 1 / size, turn=turn if space == "UV" else (0, 0, 0))


def _finish(made, g, random, colour, height=None, distance=0.004):
    rough = random.choice((0.12, 0.3, 0.5, 0.8, 0.95))
    if random.random() < 0.4:
        rough = g.math("MULTIPLY_ADD", g.noise(g.at(scale=8), 1, 5), 0.5, 0.6 * rough)
    more = {"clearcoat": 0.6} if random.random() < 0.15 else {}
    normal = g.bump(height, distance, random.uniform(0.2, 0.9)) if height else None
    g.finish(g.surface(colour, rough, normal, **more))
    return made


def checks(random, palette, size, space):
    made, g, at = _graph("checks", random, palette, size, space)
    first, second = palette.pair()
    colour = g.add("TexChecker", {"Vector": at, "Color1": first, "Color2": second, "Scale": 1.0})
    wear = g.noise(g.at(space, 6 / size), 1, 6)
    return _finish(made, g, random, g.mix(0.5, colour, g.ramp(wear, (0.3, 0.5), (0.7, 1.0)), "MULTIPLY"), wear)


def stripes(random, palette, size, space):
    made, g, at = _graph("stripes", random, palette, size, space)
    part = g.math("FRACT", g.parts(at)[random.choice((0, 1))])
    stops, place = [], 0.0
    while place < 0.95:
        stops.append((place, palette.colour()))
        place += random.uniform(0.05, 0.4)
    weave = g.noise(g.at(space, 25 / size), 1, 3)
    colour = g.mix(1, g.ramp(part, *stops, mode="CONSTANT"), g.ramp(weave, (0.3, 0.7), (0.7, 1.05)), "MULTIPLY")
    return _finish(made, g, random, colour, weave, 0.002)


def dots(random, palette, size, space):
    made, g, at = _graph("dots", random, palette, size, space)
    cell = g.add("TexVoronoi", {"Vector": at, "Scale": 1.0, "Randomness": random.choice((0.0, 0.0, 1.0))}, "Distance")
    first, second = palette.pair()
    edge = random.uniform(0.2, 0.42)
    inside = g.ramp(cell, (edge, 1), (edge + 0.03, 0))
    return _finish(made, g, random, g.mix(inside, first, second), inside if random.random() < 0.4 else None, 0.003)


def terrazzo(random, palette, size, space):
    made, g, at = _graph("terrazzo", random, palette, size, space)
    bent = g.add("VectorMath", {0: at, 1: g.noise(at, 3, 2, output="Color")}, operation="ADD")
    cell = g.add("TexVoronoi", {"Vector": bent, "Scale": 1.6}).node
    edge = g.add("TexVoronoi", {"Vector": bent, "Scale": 1.6}, feature="DISTANCE_TO_EDGE")
    chip = g.parts(cell.outputs["Color"])[0]
    colours = g.ramp(chip, *((k / 6, palette.colour(0.1, 0.8)) for k in range(6)), mode="CONSTANT")
    joint = g.ramp(edge, (0.06, 0), (0.09, 1))
    return _finish(made, g, random, g.mix(joint, palette.colour(0.3, 0.7), colours), joint, 0.001)


def marble(random, palette, size, space):
    made, g, at = _graph("marble", random, palette, size, space)
    first, second = palette.pair()
    vein = g.noise(at, 1.1, 12, 0.62, 1.8)
    vein = g.math("ABSOLUTE", g.math("SUBTRACT", vein, 0.5))
    colour = g.ramp(vein, (0, first), (0.04, g_mix(first, second)), (0.16, second), (0.5, palette.colour(0.5, 0.8)))
    return _finish(made, g, random, colour)


def g_mix(a, b, t=0.5):
    return tuple((1 - t) * x + t * y for x, y in zip(a, b))


def stains(random, palette, size, space):
    """Layers of noise: rust, stone, worn paint."""
    made, g, at = _graph("stains", random, palette, size, space)
    broad, fine = g.noise(at, 0.8, 9, 0.65, 0.4), g.noise(at, 9, 8, 0.7)
    stops = [(k / 4 + random.uniform(0.0, 0.12), palette.colour(0.03, 0.65)) for k in range(4)]
    colour = g.mix(1, g.ramp(broad, *[(0.2 + 0.6 * p, c) for p, c in stops]), g.ramp(fine, (0.3, 0.5), (0.7, 1.05)), "MULTIPLY")
    return _finish(made, g, random, colour, g.math("ADD", broad, g.math("MULTIPLY", fine, 0.4)), 0.02 * size)


def weave(random, palette, size, space):
    made, g, _ = _graph("weave", random, palette, size, space)
    first, second = palette.pair()
    fine = 14 / size
    a, b = g.noise(g.at(space, (fine, 6 * fine, fine)), 1, 2), g.noise(g.at(space, (6 * fine, fine, 6 * fine)), 1, 2)
    x, y, z = g.parts(g.at(space, fine))
    knot = g.math("MULTIPLY", g.math("SINE", g.math("MULTIPLY", g.math("ADD", x, z), 6.283)), g.math("SINE", g.math("MULTIPLY", y, 6.283)))
    height = g.math("ADD", g.math("MULTIPLY", g.math("ADD", a, b), 0.5), g.math("MULTIPLY", knot, 0.35))
    colour = g.mix(g.ramp(height, (0.2, 0), (0.75, 1)), first, second)
    g.finish(g.surface(colour, 0.95, g.bump(height, 0.004, 0.7), sheen=0.4))
    return made


def waves(random, palette, size, space):
    made, g, at = _graph("waves", random, palette, size, space)
    wave = g.add("TexWave", {"Vector": at, "Scale": random.uniform(0.4, 1.2), "Distortion": random.uniform(0, 9), "Detail": 3.0},
                 wave_type=random.choice(("BANDS", "RINGS")), wave_profile=random.choice(("SIN", "SAW", "TRI")))
    first, second = palette.pair()
    sharp = random.choice((0.02, 0.1, 0.45))
    return _finish(made, g, random, g.mix(g.ramp(wave, (0.5 - sharp, 0), (0.5 + sharp, 1)), first, second), wave, 0.006)


def grid(random, palette, size, space):
    """Thin lines on a ground, as on graph paper."""
    made, g, at = _graph("grid", random, palette, size, space)
    parts = g.parts(g.add("VectorMath", {0: at}, operation="FRACTION"))
    thin = random.choice((0.04, 0.08, 0.15))
    line = g.math("MAXIMUM", *(g.math("LESS_THAN", c, thin) for c in random.sample(parts, 2)))
    first, second = palette.pair()
    return _finish(made, g, random, g.mix(line, second, first) if random.random() < 0.6 else g.mix(line, first, second), line, 0.002)


def leather(random, palette, size, space):
    made, g, at = _graph("leather", random, palette, size, space)
    cell = g.add("TexVoronoi", {"Vector": at, "Scale": 14.0}, feature="DISTANCE_TO_EDGE")
    base = palette.colour(0.03, 0.45)
    colour = g.mix(g.ramp(cell, (0, 0), (0.15, 1)), tuple(0.45 * c for c in base), base)
    g.finish(g.surface(colour, random.uniform(0.3, 0.6), g.bump(cell, 0.003, 0.5)))
    return made


PATTERNS = (checks, stripes, dots, terrazzo, marble, stains, weave, waves, grid, leather)


def patterned(random, palette, size=0.1, space="Object"):
    """A textured surface whose pattern repeats about every `size` metres."""
    return random.choice(PATTERNS)(random, palette, size * random.uniform(0.5, 1.6), space)


def metallic(random):
    tint = random.choice(METALS)
    brushed = random.choice((0, 0, 0.5, 1.0))
    return metal("metal", tint, random.choice((0.03, 0.1, 0.2, 0.35)), brushed, random.choice(((1, 1, 120), (90, 90, 90), (2, 160, 2))))


def clear(random, palette):
    tint = (1, 1, 1) if random.random() < 0.5 else g_mix((1, 1, 1), palette.colour(0.3, 0.9), random.uniform(0.2, 0.8))
    return glass("glass", tint, random.uniform(1.3, 1.6), random.choice((0, 0, 0, 0.08, 0.2)))


def painted(random, palette):
    more = {"clearcoat": 0.8} if random.random() < 0.3 else {}
    return plain("paint", palette.colour(), random.choice((0.08, 0.25, 0.5, 0.9)), **more)


def timber(random, grain="Z"):
    """Wood whose grain runs along the object's axis `grain`."""
    dark, light = random.choice(WOODS)
    along = {"X": (1.2, 14, 14), "Y": (14, 1.2, 14), "Z": (14, 14, 1.2)}[grain]
    return wood("wood", dark, light, along, random.uniform(0.7, 1.5), random.choice((0.25, 0.45, 0.7)))


def any_surface(random, palette, size=0.1):
    """For an object of any kind: a third plain, a third patterned, the rest wood, metal, glass."""
    draw = random.random()
    if draw < 0.28:
        return painted(random, palette)
    if draw < 0.66:
        return patterned(random, palette, size)
    if draw < 0.78:
        return timber(random, random.choice("XYZ"))
    return metallic(random) if draw < 0.92 else clear(random, palette)


def flooring(random, palette, indoors=True):
    """For a surface with a UV map in metres."""
    draw = random.random()
    if draw < 0.3:
        dark, light = random.choice(WOODS)
        return bricks("planks", light, dark, tuple(0.3 * c for c in dark), (random.uniform(0.6, 1.4), random.uniform(0.06, 0.2)), 0.003,
                      bump=0.4, shift=random.uniform(0.2, 0.5), rough=random.choice((0.35, 0.6)))
    if draw < 0.55:
        first, second = palette.pair()
        side = random.choice((0.1, 0.2, 0.3, 0.6))
        return bricks("tiles", g_mix(first, second, 0.4), second, palette.colour(0.1, 0.5), (side * random.choice((1, 1, 2)), side), 0.006,
                      bump=0.5, shift=random.choice((0, 0.5)), rough=random.choice((0.3, 0.5, 0.8)))
    if draw < 0.9 or not indoors:
        return patterned(random, palette, random.choice((0.12, 0.3, 0.6)), "UV")
    return plain("floor", palette.colour(0.1, 0.6), random.choice((0.15, 0.4, 0.8)))


def walling(random, palette):
    """For walls with a UV map in metres."""
    draw = random.random()
    if draw < 0.45:
        return plaster("plaster", palette.colour(0.25, 0.75))
    if draw < 0.65:
        red = g_mix((0.35, 0.13, 0.08), palette.colour(0.1, 0.6), random.random() * 0.7)
        return bricks("bricks", red, tuple(0.7 * c for c in red), palette.colour(0.3, 0.6))
    if draw < 0.85:
        return patterned(random, palette, random.choice((0.06, 0.12, 0.25)), "UV")
    return plain("wall", palette.colour(0.3, 0.75), 0.8)


def glowing(random, strength=30.0):
    """An emitter between candle and daylight."""
    warm = random.random()
    tint = (1.0, 0.55 + 0.4 * warm, 0.22 + 0.7 * warm) if random.random() < 0.85 else colorsys.hsv_to_rgb(random.random(), 0.7, 1)
    return lamp("glow", tint, strength * random.uniform(0.6, 1.6))
