# SPDX-License-Identifier: GPL-3.0-or-later
"""Every property of the data of a file, to compare one state with another."""
import bpy

COLLECTIONS = ("scenes", "objects", "materials", "worlds", "lights", "cameras", "collections")
# What Blender counts by itself: nobody set it.
OWN_BUSINESS = frozenset({"rna_type", "bl_rna", "is_evaluated", "original", "id_data", "users", "tag", "session_uid", "is_updated", "depsgraph",
                          "uv_sculpt"})  # whose brush points nowhere in the module bpy 4.2 after a second file is opened


def snapshot():
    """{path: value} of scenes, objects, materials and the like, and of the preferences of the view."""
    found = {}
    for kind in COLLECTIONS:
        for item in getattr(bpy.data, kind):
            _walk(item, f"{kind}[{item.name}]", found, set())
    _walk(bpy.context.preferences.view, "preferences.view", found, set())
    return found


def differences(before, after):
    """Sentences; none where the two are the same."""
    paths = [path for path in sorted({*before, *after}) if before.get(path) != after.get(path) and not _filled_in(path, before)]
    return [f"{path}: {before.get(path)!r} became {after.get(path)!r}" for path in paths]


def _filled_in(path, before):
    """A colour space that nobody chose yet: Blender 5 chooses one with the file format, and lets nobody empty it again."""
    return path.endswith("linear_colorspace_settings.name") and before.get(path) == ""


def _walk(struct, path, found, seen):
    """Each struct is walked through once: the parts of a tree of nodes point at each other. The first part of a struct has its address."""
    key = struct.as_pointer(), struct.bl_rna.identifier
    if key in seen:
        return
    seen.add(key)
    for prop in struct.bl_rna.properties:
        name = prop.identifier
        if name in OWN_BUSINESS:
            continue
        try:
            value = getattr(struct, name)
        except Exception as error:  # a property that this Blender does not compute now
            value = type(error).__name__
        _take(prop, value, f"{path}.{name}", found, seen)


def _take(prop, value, path, found, seen):
    if prop.type == "POINTER":
        _pointed(value, path, found, seen)
    elif prop.type == "COLLECTION":
        for place, item in enumerate(value):
            _pointed(item, f"{path}[{place}]", found, seen)
    elif getattr(prop, "is_array", False) and not isinstance(value, str):
        found[path] = tuple(tuple(row) if hasattr(row, "__iter__") else row for row in value)
    else:
        found[path] = value


def _pointed(value, path, found, seen):
    """A part of its owner is walked through, another block of data is a name."""
    if isinstance(value, bpy.types.ID) and not isinstance(value, bpy.types.NodeTree):
        found[path] = value.name_full
    elif value is None or path.count(".") > 6:
        found[path] = value is None
    else:
        _walk(value, path, found, seen)
