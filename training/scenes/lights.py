"""Light for a scene: pictures of surroundings, sky and sun, studio areas, many small lamps."""
import math
import pathlib

import bpy

from shading import world
from shapes import light


def surroundings(scene, random, folder, strength=1.0):
    """An HDRI of the folder, turned at random, its radiance clamped to 0..60; False when there is none."""
    pictures = sorted(p for p in pathlib.Path(folder).glob("*") if p.suffix in (".exr", ".hdr")) if folder else []
    if not pictures:
        return False
    g = world(scene)
    picture = g.add("TexEnvironment", {"Vector": g.at("Generated", turn=(0, 0, random.uniform(0, math.tau)))}, "Color")
    picture.node.image = bpy.data.images.load(str(random.choice(pictures).resolve()))
    radiance = g.mix(1, g.mix(1, picture, (0, 0, 0), "LIGHTEN"), (60, 60, 60), "DARKEN")
    g.finish(g.add("Background", {"Color": radiance, "Strength": strength}))
    return True


def sky(scene, random, clouds=0.5):
    """Nishita's sky with clouds in a share of scenes, and a sun lamp to match; low suns are warm."""
    height, turn = math.radians(random.choice((random.uniform(4, 15), random.uniform(15, 65)))), random.uniform(0, math.tau)
    g = world(scene)
    air = g.add("TexSky", {}, sky_type="NISHITA", sun_disc=False, sun_elevation=height, sun_rotation=turn,
                dust_density=random.uniform(0.3, 4), air_density=random.uniform(0.7, 2))
    colour = g.mix(1, air, (0.14, 0.14, 0.14), "MULTIPLY")
    overcast = random.random() < 0.25
    if overcast or random.random() < clouds:
        x, y, z = g.parts(g.at("Generated"))
        over = g.math("MAXIMUM", g.math("ADD", z, 0.12), 0.05)
        flat = g.add("CombineXYZ", {0: g.math("DIVIDE", x, over), 1: g.math("DIVIDE", y, over), 2: random.uniform(0, 50)})
        puff = g.noise(flat, random.uniform(0.6, 1.6), 9, 0.6, 0.3)
        start = 0.3 if overcast else random.uniform(0.45, 0.58)
        bright = (0.7, 0.68, 0.66) if height > 0.25 else (0.6, 0.4, 0.3)
        low = g.math("MINIMUM", g.math("MULTIPLY", g.math("MAXIMUM", z, 0), 9), 1.0)
        grey = g.mix(1, g.ramp(puff, (start, 1.0), (0.85, 0.5)), bright, "MULTIPLY")
        colour = g.mix(g.math("MULTIPLY", g.ramp(puff, (start, 0), (start + 0.16, 0.95)), low), colour, grey)
    g.finish(g.add("Background", {"Color": colour, "Strength": 1.0}))
    if not overcast:
        warm = min(1.0, height / 0.6)
        away = (-40 * math.cos(height) * math.sin(-turn), 40 * math.cos(height) * math.cos(-turn), 40 * math.sin(height))
        light("SUN", away, (0, 0, 0), random.uniform(2.0, 5.0), (1.0, 0.62 + 0.32 * warm, 0.35 + 0.53 * warm), random.uniform(0.005, 0.03))


def outdoors(scene, random, folder):
    if random.random() < 0.62 or not surroundings(scene, random, folder):
        sky(scene, random)


def dim(scene, colour=(0.5, 0.6, 0.8), strength=0.03):
    g = world(scene)
    g.finish(g.add("Background", {"Color": colour, "Strength": strength}))


def studio(scene, random, around=(0, 0, 0), reach=1.0):
    """Two to four soft boxes of different sizes and tints about a point; `reach` is the subject's radius."""
    dim(scene, (0.6, 0.6, 0.65), random.uniform(0.02, 0.2))
    start = random.uniform(0, math.tau)
    for k in range(random.randint(2, 4)):
        turn, rise, away = start + k * random.uniform(1.3, 2.3), random.uniform(0.25, 1.3), reach * random.uniform(2.2, 4)
        at = (around[0] + away * math.cos(turn) * math.cos(rise), around[1] + away * math.sin(turn) * math.cos(rise),
              around[2] + away * math.sin(rise))
        warm = random.random()
        side = reach * random.uniform(0.25, 1.8)
        made = light("AREA", at, around, 30 * away * away * random.choice((1, 0.5, 0.2)), (1, 0.72 + 0.25 * warm, 0.45 + 0.55 * warm),
                     side, side * random.uniform(0.4, 1.6))
        made.visible_camera = random.random() < 0.15


def lamps(random, spots, watts=30.0, radius=0.03):
    """A small warm or coloured lamp at every spot."""
    for spot in spots:
        warm = random.random()
        tint = (1.0, 0.5 + 0.4 * warm, 0.2 + 0.65 * warm) if random.random() < 0.85 else tuple(random.uniform(0.1, 1) for _ in range(3))
        light("POINT", spot, None, watts * random.uniform(0.3, 1.6), tint, radius)
