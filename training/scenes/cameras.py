"""Cameras with a reason: framed on what the scene is about."""
import math

from mathutils import Vector

from shapes import look


def _tangent(lens):
    return 18.0 / lens  # half of the 36 mm sensor, the picture being square


def depth_of_field(random, share=0.2):
    """A blur diameter as a share of the focus distance, 0 for a pinhole."""
    return random.uniform(0.012, 0.045) if random.random() < share else 0.0


def _aim(random, at, target, lens, focus, blur):
    away = (Vector(focus) - Vector(at)).length
    stop = lens / 1000 / (blur * away) if blur else 0
    return look(at, target, lens, focus, stop)


def around(random, points, rise=(8, 50), lens=(28, 85), turn=(0, 360), fill=(0.8, 1.25), floor=None):
    """Looks at `points` from a random side, as near as lets them fill the picture; `fill` > 1 crops the outermost."""
    points = [Vector(p) for p in points]
    middle = sum(points, Vector()) / len(points)
    angle, up, focal = math.radians(random.uniform(*turn)), math.radians(random.uniform(*rise)), random.uniform(*lens)
    back = Vector((math.cos(angle) * math.cos(up), math.sin(angle) * math.cos(up), math.sin(up)))
    right = Vector((-math.sin(angle), math.cos(angle), 0))
    above = back.cross(right)
    span = _tangent(focal) * random.uniform(*fill)
    need = sorted((p - middle).dot(back) + max(abs((p - middle).dot(right)), abs((p - middle).dot(above))) / span for p in points)
    away = max(need[min(len(need) - 1, int(0.95 * len(need)))], 0.05)
    at = middle + back * away
    if floor is not None:
        at.z = max(at.z, floor)
    shift = away * _tangent(focal) * 0.15
    target = middle + right * random.uniform(-shift, shift) + above * random.uniform(-shift, shift)
    return _aim(random, at, target, focal, random.choice(points), depth_of_field(random))


def inside(random, width, depth, height, lens=(18, 32)):
    """Stands near the open end (small y) of a room around x = 0 and looks down its length."""
    at = (random.uniform(-0.36, 0.36) * width, random.uniform(0.05, 0.15) * depth, random.uniform(1.0, 1.75))
    target = (random.uniform(-0.3, 0.3) * width, random.uniform(0.75, 1.0) * depth, random.uniform(0.75, 1.4))
    focus = (target[0], 0.65 * depth, target[2])
    return _aim(random, at, target, random.uniform(*lens), focus, depth_of_field(random, 0.12))


def eye(random, at, target, lens=(24, 60), blur=0.2):
    """Stands at a point and looks at another."""
    return _aim(random, at, target, random.uniform(*lens), target, depth_of_field(random, blur))
