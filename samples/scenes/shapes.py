"""Meshes from numbers: boxes, turned profiles, tubes, sheets, and cameras and lights beside them. Metres, Z up."""
import math

import bpy
from mathutils import Euler, Matrix, Vector


def place(name, content, at=(0, 0, 0), turn=(0, 0, 0), size=1.0):
    """Links an object showing `content` (a mesh, curve or light) into the scene; `turn` in degrees."""
    made = bpy.data.objects.new(name, content)
    made.location = at
    made.rotation_euler = Euler([math.radians(angle) for angle in turn])
    made.scale = (size,) * 3 if isinstance(size, (int, float)) else size
    bpy.context.scene.collection.objects.link(made)
    return made


def mesh(name, points, faces, material=None, uvs=None, smooth=False):
    """A mesh; `uvs` gives each point's (u, v)."""
    made = bpy.data.meshes.new(name)
    made.from_pydata(points, [], faces)
    if uvs:
        layer = made.uv_layers.new().data
        for loop in made.loops:
            layer[loop.index].uv = uvs[loop.vertex_index]
    if material:
        made.materials.append(material)
    made.polygons.foreach_set("use_smooth", [smooth] * len(made.polygons))
    made.update()
    return made


def box_mesh(name, size, material=None):
    """A box around the origin whose UV map is in metres on every face."""
    x, y, z = (c / 2 for c in size)
    points, faces, uvs = [], [], []
    for axis in range(3):
        for side in (-1, 1):
            u, v = ((1, 2), (0, 2), (0, 1))[axis]
            corner = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
            if side * (-1 if axis == 1 else 1) < 0:
                corner.reverse()
            first = len(points)
            for a, b in corner:
                p = [0, 0, 0]
                p[axis], p[u], p[v] = side, a, b
                points.append((p[0] * x, p[1] * y, p[2] * z))
                uvs.append((points[-1][u], points[-1][v]))
            faces.append(tuple(range(first, first + 4)))
    return mesh(name, points, faces, material, uvs)


def box(name, size, at, material, turn=(0, 0, 0), bevel=0.0):
    """A box centred at `at`; a `bevel` rounds its edges."""
    made = place(name, box_mesh(name, size, material), at, turn)
    if bevel:
        weld = made.modifiers.new("weld", "WELD")
        weld.merge_threshold = 1e-5
        round_off = made.modifiers.new("bevel", "BEVEL")
        round_off.width, round_off.segments = bevel, 2
        round_off.limit_method = "NONE"
    return made


def lathe_mesh(name, profile, material, steps=48):
    """Turns (radius, height) pairs around Z; runs along u, heights along v, in metres of the outline."""
    points, uvs, run = [], [], 0.0
    for row, (radius, height) in enumerate(profile):
        if row:
            run += math.dist(profile[row - 1], (radius, height))
        for step in range(steps + 1):
            angle = 2 * math.pi * step / steps
            points.append((radius * math.cos(angle), radius * math.sin(angle), height))
            uvs.append((step / steps, run))
    faces = [(r * (steps + 1) + s, r * (steps + 1) + s + 1, (r + 1) * (steps + 1) + s + 1, (r + 1) * (steps + 1) + s)
             for r in range(len(profile) - 1) for s in range(steps)]
    return mesh(name, points, faces, material, uvs, smooth=True)


def curve_through(profile, steps=6):
    """A smooth outline through (radius, height) pairs: Catmull-Rom."""
    closed = [profile[0], *profile, profile[-1]]
    out = []
    for i in range(1, len(closed) - 2):
        p0, p1, p2, p3 = (Vector(p) for p in closed[i - 1:i + 3])
        for s in range(steps):
            t = s / steps
            q = 0.5 * (2 * p1 + (p2 - p0) * t + (2 * p0 - 5 * p1 + 4 * p2 - p3) * t ** 2
                       + (3 * p1 - p0 - 3 * p2 + p3) * t ** 3)
            out.append((max(q.x, 0.0), q.y))
    return [*out, profile[-1]]


def lathe(name, profile, at, material, turn=(0, 0, 0), steps=48, smooth=True):
    return place(name, lathe_mesh(name, curve_through(profile) if smooth else profile, material, steps), at, turn)


def ball(name, radius, at, material, squash=1.0, steps=32):
    half = [(radius * math.sin(a), -radius * squash * math.cos(a)) for a in
            (math.pi * i / (steps // 2) for i in range(steps // 2 + 1))]
    return place(name, lathe_mesh(name, half, material, steps), at)


def tube(name, points, radius, material, at=(0, 0, 0), turn=(0, 0, 0), smooth=True, taper=None):
    """A round tube through points; `taper` gives each point's share of the radius."""
    line = bpy.data.curves.new(name, "CURVE")
    line.dimensions = "3D"
    line.bevel_depth, line.bevel_resolution, line.resolution_u = radius, 3, 8
    line.use_fill_caps = True
    spline = line.splines.new("NURBS" if smooth and len(points) > 2 else "POLY")
    spline.points.add(len(points) - 1)
    for i, (knot, point) in enumerate(zip(spline.points, points)):
        knot.co = (*point, 1)
        knot.radius = taper[i] if taper else 1
    if spline.type == "NURBS":
        spline.use_endpoint_u, spline.order_u = True, 3
    line.materials.append(material)
    return place(name, line, at, turn)


def sheet_mesh(name, width, depth, counts, height, material, smooth=True):
    """A grid over width x depth around the origin, raised by `height(x, y)`; UV in metres."""
    columns, rows = counts
    points, uvs = [], []
    for row in range(rows + 1):
        for column in range(columns + 1):
            x, y = width * (column / columns - 0.5), depth * (row / rows - 0.5)
            points.append((x, y, height(x, y)))
            uvs.append((x, y))
    faces = [(r * (columns + 1) + c, r * (columns + 1) + c + 1, (r + 1) * (columns + 1) + c + 1,
              (r + 1) * (columns + 1) + c) for r in range(rows) for c in range(columns)]
    return mesh(name, points, faces, material, uvs, smooth)


def blades_mesh(name, random, count, spread, height, width, material, bend=0.5):
    """A tuft of grass: `count` bent, pointed blades within `spread` of the origin."""
    points, faces = [], []
    for _ in range(count):
        angle, away = random.uniform(0, math.tau), spread * math.sqrt(random.random())
        base = Vector((away * math.cos(angle), away * math.sin(angle), 0))
        lean = Vector((random.gauss(0, 1), random.gauss(0, 1), 0)) * bend * 0.5
        tall = height * random.uniform(0.45, 1.0)
        across = Vector((math.cos(angle + 1.3), math.sin(angle + 1.3), 0)) * width
        first = len(points)
        for t, wide in ((0, 1), (0.45, 0.8), (0.8, 0.45)):
            middle = base + tall * (Vector((0, 0, t)) + lean * t * t)
            points += [tuple(middle - across * wide), tuple(middle + across * wide)]
        points.append(tuple(base + tall * (Vector((0, 0, 1)) + lean)))
        faces += [(first, first + 1, first + 3, first + 2), (first + 2, first + 3, first + 5, first + 4),
                  (first + 4, first + 5, first + 6)]
    return mesh(name, points, faces, material)


def leaves_mesh(name, random, spots, size, material):
    """A diamond-shaped leaf, folded along its rib, at every spot."""
    points, faces = [], []
    for spot in spots:
        turn = Euler([random.uniform(0, math.tau) for _ in range(3)]).to_matrix()
        length = size * random.uniform(0.6, 1.3)
        shape = ((0, 0, 0), (0.3, 0.45, 0.1), (0, 1, 0), (-0.3, 0.45, 0.1))
        first = len(points)
        points += [tuple(Vector(spot) + turn @ Vector(p) * length) for p in shape]
        faces += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return mesh(name, points, faces, material)


def look(at, target, lens=35.0, focus=None, aperture=0.0):
    """The scene's camera; `aperture` is an f-number, 0 for a pinhole."""
    lens_of = bpy.data.cameras.new("camera")
    lens_of.lens = lens
    lens_of.clip_end = 5000
    made = place("camera", lens_of, at)
    made.rotation_euler = (Vector(target) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
    if aperture:
        lens_of.dof.use_dof = True
        lens_of.dof.aperture_fstop = aperture
        lens_of.dof.focus_distance = (Vector(focus or target) - Vector(at)).length
    bpy.context.scene.camera = made
    return made


def light(kind, at, target=None, energy=10.0, colour=(1, 1, 1), size=0.1, height=None):
    """A lamp; `size` is its side, radius or (for SUN) angle in radians."""
    glow = bpy.data.lights.new(kind.lower(), kind)
    glow.energy, glow.color = energy, colour
    if kind == "AREA":
        glow.shape, glow.size, glow.size_y = "RECTANGLE", size, height or size
    elif kind == "SUN":
        glow.angle = size
    else:
        glow.shadow_soft_size = size
    made = place(kind.lower(), glow, at)
    if target:
        made.rotation_euler = (Vector(target) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
    return made
