# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that are changed for a while, and come back whatever happens."""
import json
from typing import Any, NamedTuple, Optional

import bpy

MARK = "xrds_before"  # a custom property of a scene while a recorder has changed it: what was there
COLOUR_SETTINGS = ("linear_colorspace_settings", "view_settings", "display_settings")  # of image settings; Blender sets them anew with Color Management: Override


class Change(NamedTuple):
    """A property, what was there, and whether its owner still is: Blender does not tell that parts of what was deleted are gone, and crashes."""
    owner: Any
    name: str
    value: Any
    block: Any  # of data, which the owner is or is a part of
    layer: Optional[int]  # the address of its view layer, if it is or is a part of one

    @staticmethod
    def of(owner, name, value):
        block = owner.id_data
        layer = next((layer for layer in getattr(block, "view_layers", ()) if owner in (layer, getattr(layer, "cycles", None))), None)
        return Change(owner, name, value, block, layer and layer.as_pointer())

    def is_there(self):
        try:
            return bool(self.block.name) and (self.layer is None or self.layer in [layer.as_pointer() for layer in self.block.view_layers])
        except ReferenceError:
            return False


class Recorder:
    """Changes properties, and puts back what was there when its `with` ends.

    In between, suspend() puts it back for a moment, as while the file is saved, and resume() changes it again. scene: gets
    a mark with what was there, for states of it that others keep meanwhile, as steps of undo: restore_marked() mends these.
    """

    def __init__(self, scene=None):
        self._scene = scene
        self._before = []
        self._suspended = []

    def mark(self):
        """Call it once all is changed."""
        places = [(_place(change.owner), change.name, change.value) for change in reversed(self._before) if change.is_there()]
        self._scene[MARK] = json.dumps([(*place, name, value) for place, name, value in places if place and isinstance(value, (bool, int, float, str))])

    def put(self, owner, name, value):
        """Sets a property; a value that is there already stays unrecorded."""
        before = getattr(owner, name)
        if before != value:
            self._before.append(Change.of(owner, name, before))
            setattr(owner, name, value)

    def keep(self, owner):
        """Records all properties of an owner, for those that change their neighbours, as a file format does."""
        for prop in owner.bl_rna.properties:
            if not prop.is_readonly and prop.type not in ("POINTER", "COLLECTION") and not getattr(prop, "is_array", False):
                self._before.append(Change.of(owner, prop.identifier, getattr(owner, prop.identifier)))

    def restore(self):
        """Puts everything back. Returns a sentence for each property that did not come back, as of a deleted object."""
        self._suspended = []
        changes, self._before = self._before, []
        self._unmark()
        return _apply(reversed(changes))

    def suspend(self):
        self._suspended = [change._replace(value=getattr(change.owner, change.name)) for change in self._before if change.is_there()]
        self._unmark()
        _apply(reversed(self._before))

    def resume(self):
        changes, self._suspended = self._suspended, []
        _apply(changes)
        if changes and self._scene:
            self.mark()

    def _unmark(self):
        try:
            if self._scene and MARK in self._scene:
                del self._scene[MARK]
        except ReferenceError:
            pass  # the scene is deleted

    def __enter__(self):
        active.append(self)
        return self

    def __exit__(self, *error):
        active.remove(self)
        self.restore()


active = []  # the recorders whose changes are in force: saving a file suspends them


def restore_marked():
    """Puts back what the marks of scenes say: of a state that was kept while a recorder had changed it. Not while one is active."""
    for scene in bpy.data.scenes:
        if not active and MARK in scene:
            marked = json.loads(scene[MARK])
            del scene[MARK]
            _apply([Change.of(owner, name, value) for kind, block, path, name, value in marked for owner in _owner(kind, block, path)])


def _place(owner):
    """(collection of bpy.data, name, path within) of what is local; None where that cannot be told."""
    block = owner.id_data
    for kind in ("scenes", "materials", "worlds", "objects"):
        if getattr(bpy.data, kind).get(block.name) == block:
            return next(((kind, block.name, path) for path in _paths(owner, block) if owner in _owner(kind, block.name, path)), None)
    return None


def _paths(owner, block):
    """Ways that may lead to an owner: Blender knows not all."""
    if owner == block:
        yield ""
    try:
        yield owner.path_from_id()
    except ValueError:
        pass
    yield from (f"render.image_settings.{name}" for name in COLOUR_SETTINGS)
    for layer in getattr(block, "view_layers", ()):
        yield f"{layer.path_from_id()}.cycles"


def _owner(kind, name, path):
    """[what is there], or nothing."""
    block = getattr(bpy.data, kind).get(name)
    try:
        return [block.path_resolve(path) if path else block] if block else []
    except ValueError:
        return []


def _apply(changes):
    """Sets properties in turn, and those that differ once more, because some change others."""
    changes = list(changes)
    for _ in range(2):
        failed = []
        for change in changes:
            try:
                if not change.is_there():
                    failed.append(f"{change.name}: its owner was deleted")
                elif getattr(change.owner, change.name) != change.value:
                    setattr(change.owner, change.name, change.value)
            except Exception as error:  # a value that fits after the others
                failed.append(f"{change.name}: {error}")
    return failed
