"""Shader graphs written as expressions, and the materials of the samples."""
import bpy


def _value(socket, value):
    colour = socket.type == "RGBA" and not isinstance(value, (int, float)) and len(value) == 3
    return (*value, 1.0) if colour else value


class Graph:
    """A shader tree under construction; each method adds a node and returns one of its output sockets."""

    def __init__(self, tree):
        self.tree = tree
        tree.nodes.clear()

    def add(self, kind, inputs={}, output=0, **settings):
        node = self.tree.nodes.new("ShaderNode" + kind)
        for key, value in settings.items():
            setattr(node, key, value)
        for key, value in inputs.items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[key])
            else:
                node.inputs[key].default_value = _value(node.inputs[key], value)
        return node.outputs[output]

    def at(self, space="Object", scale=(1, 1, 1), offset=(0, 0, 0), turn=(0, 0, 0)):
        """Texture coordinates: `Object` and `UV` are metres here, `Generated` is 0..1 over the bounds."""
        scale = (scale,) * 3 if isinstance(scale, (int, float)) else scale
        place = self.add("TexCoord", output=space)
        return self.add("Mapping", {"Vector": place, "Scale": scale, "Location": offset, "Rotation": turn})

    def math(self, operation, a, b=0.0, c=0.0, clamp=False):
        return self.add("Math", {0: a, 1: b, 2: c}, operation=operation, use_clamp=clamp)

    def mix(self, factor, a, b, blend="MIX"):
        return self.add("MixRGB", {"Fac": factor, "Color1": a, "Color2": b}, blend_type=blend)

    def noise(self, at, scale=1.0, detail=6.0, roughness=0.55, distortion=0.0, output="Fac"):
        return self.add("TexNoise", {"Vector": at, "Scale": scale, "Detail": detail, "Roughness": roughness,
                                     "Distortion": distortion}, output)

    def ramp(self, factor, *stops, mode="LINEAR"):
        """A colour (or grey number) by position; stops are (position, colour)."""
        output = self.add("ValToRGB", {"Fac": factor})
        ramp = output.node.color_ramp
        ramp.interpolation = mode
        while len(ramp.elements) < len(stops):
            ramp.elements.new(1.0)
        for element, (position, colour) in zip(ramp.elements, stops):
            element.position = position
            element.color = (colour,) * 3 + (1,) if isinstance(colour, (int, float)) else (*colour, 1)
        return output

    def parts(self, vector):
        node = self.add("SeparateXYZ", {0: vector}).node
        return node.outputs["X"], node.outputs["Y"], node.outputs["Z"]

    def chance(self):
        """A number in 0..1 of its own for each object."""
        return self.add("ObjectInfo", output="Random")

    def bump(self, height, distance=0.01, strength=0.6):
        return self.add("Bump", {"Height": height, "Distance": distance, "Strength": strength}, "Normal")

    def surface(self, colour, roughness=0.5, normal=None, **more):
        inputs = {"Base Color": colour, "Roughness": roughness}
        inputs.update({key.replace("_", " ").title(): value for key, value in more.items()})
        if normal:
            inputs["Normal"] = normal
        if "Ior" in inputs:
            inputs["IOR"] = inputs.pop("Ior")
        return self.add("BsdfPrincipled", inputs)

    def finish(self, shader):
        kind = "OutputWorld" if isinstance(self.tree.id_data, bpy.types.World) else "OutputMaterial"
        self.add_output(kind, shader)

    def add_output(self, kind, shader):
        node = self.tree.nodes.new("ShaderNode" + kind)
        self.tree.links.new(shader, node.inputs["Surface"])


def material(name):
    """A new material and its empty graph."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    return made, Graph(made.node_tree)


def world(scene):
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    return Graph(scene.world.node_tree)


def plain(name, colour, roughness=0.5, **more):
    made, g = material(name)
    g.finish(g.surface(colour, roughness, **more))
    return made


def metal(name, colour, roughness=0.15, brushed=0.0, along=(1, 1, 60)):
    """Metal; `brushed` > 0 scratches it across `along`."""
    made, g = material(name)
    smear = g.noise(g.at(scale=6), 3)
    rough = g.math("ADD", g.math("MULTIPLY", smear, 0.6 * roughness), 0.7 * roughness)
    normal = g.bump(g.noise(g.at(scale=along), 8, 3), 0.002, brushed) if brushed else None
    g.finish(g.surface(colour, rough, normal, metallic=1.0))
    return made


def glass(name, colour=(1, 1, 1), ior=1.45, roughness=0.0):
    """Glass whose shadow is clear, so that it needs no caustics."""
    made, g = material(name)
    path = g.add("LightPath").node
    passing = g.math("MAXIMUM", path.outputs["Is Shadow Ray"], path.outputs["Is Diffuse Ray"])
    body = g.add("BsdfGlass", {"Color": colour, "IOR": ior, "Roughness": roughness})
    clear = g.add("BsdfTransparent", {"Color": [0.9 * c for c in colour]})
    g.finish(g.add("MixShader", {0: passing, 1: body, 2: clear}))
    return made


def lamp(name, colour, strength, sampled=True):
    """An emitting surface; with `sampled` off no shadow rays are spent on it."""
    made, g = material(name)
    made.cycles.sample_as_light = sampled
    g.finish(g.add("Emission", {"Color": colour, "Strength": strength}))
    return made


def wood(name, dark, light, grain=(1, 1, 12), scale=1.0, roughness=0.4, space="Object"):
    """Wood: rings squeezed across the grain (`grain` large across, small along) with pores."""
    made, g = material(name)
    offset = g.add("CombineXYZ", {0: g.math("MULTIPLY", g.chance(), 37), 1: g.math("MULTIPLY", g.chance(), 11)})
    place = g.add("VectorMath", {0: g.at(space, tuple(scale * c for c in grain)), 1: offset}, operation="ADD")
    warped = g.noise(place, 1.3, 4, 0.5, 1.2)
    rings = g.math("FRACT", g.math("MULTIPLY", warped, 7))
    rings = g.math("PINGPONG", rings, 0.5)
    pores = g.noise(place, 14, 4, 0.7)
    tone = g.math("ADD", g.math("MULTIPLY", rings, 0.9), g.math("MULTIPLY", pores, 0.45))
    tint = g.math("MULTIPLY_ADD", g.chance(), 0.25, -0.12)
    colour = g.ramp(g.math("ADD", tone, tint), (0.1, dark), (0.75, light))
    normal = g.bump(pores, 0.003, 0.35)
    rough = g.math("MULTIPLY_ADD", pores, 0.25, roughness - 0.1)
    g.finish(g.surface(colour, rough, normal))
    return made


def plaster(name, colour, stain=0.12, bump=0.35):
    made, g = material(name)
    at = g.at()
    broad, fine = g.noise(at, 1.2, 5), g.noise(at, 45, 5, 0.65)
    shade = g.math("MULTIPLY_ADD", broad, 2 * stain, 1 - 1.2 * stain)
    shade = g.math("MULTIPLY", shade, g.math("MULTIPLY_ADD", fine, 0.14, 0.93))
    g.finish(g.surface(g.mix(1, colour, shade, "MULTIPLY"), 0.85, g.bump(fine, 0.004, bump)))
    return made


def bricks(name, first, second, mortar, size=(0.24, 0.075), gap=0.008, space="UV", bump=0.7, shift=0.5, rough=0.8):
    """Bricks, planks or tiles in the metres of a UV map."""
    made, g = material(name)
    at = g.at(space)
    brick = g.add("TexBrick", {"Vector": at, "Color1": first, "Color2": second, "Mortar": mortar, "Scale": 1.0,
                               "Mortar Size": gap, "Mortar Smooth": 0.15, "Brick Width": size[0],
                               "Row Height": size[1]}, offset=shift).node
    wear = g.noise(at, 18, 6, 0.65)
    colour = g.mix(0.8, brick.outputs["Color"], g.ramp(wear, (0.25, 0.45), (0.7, 1.0)), "MULTIPLY")
    height = g.math("SUBTRACT", g.math("MULTIPLY", wear, 0.3), brick.outputs["Fac"])
    g.finish(g.surface(colour, g.math("MULTIPLY_ADD", wear, 0.3, rough - 0.2), g.bump(height, 0.012, bump)))
    return made
