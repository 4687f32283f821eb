# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings that are changed for a while, and come back whatever happens."""


class Recorder:
    """Changes properties, and puts back what was there when its `with` ends.

    In between, suspend() puts it back for a moment, as while the file is saved, and resume() changes it again.
    """

    def __init__(self):
        self._before = []
        self._suspended = []

    def put(self, owner, name, value):
        """Sets a property; a value that is there already stays unrecorded."""
        before = getattr(owner, name)
        if before != value:
            self._before.append((owner, name, before))
            setattr(owner, name, value)

    def keep(self, owner):
        """Records all properties of an owner, for those that change their neighbours, as a file format does."""
        for prop in owner.bl_rna.properties:
            if not prop.is_readonly and prop.type not in ("POINTER", "COLLECTION") and not getattr(prop, "is_array", False):
                self._before.append((owner, prop.identifier, getattr(owner, prop.identifier)))

    def restore(self):
        """Puts everything back. Returns a sentence for each property that did not come back, as of a deleted object."""
        self._suspended = []
        changes, self._before = self._before, []
        return _apply(reversed(changes))

    def suspend(self):
        self._suspended = [(owner, name, getattr(owner, name)) for owner, name, _ in self._before]
        _apply(reversed(self._before))

    def resume(self):
        changes, self._suspended = self._suspended, []
        _apply(changes)

    def __enter__(self):
        active.append(self)
        return self

    def __exit__(self, *error):
        active.remove(self)
        self.restore()


active = []  # the recorders whose changes are in force: saving a file suspends them


def _apply(changes):
    """Sets properties in turn, and those that differ once more, because some change others."""
    changes = list(changes)
    for _ in range(2):
        failed = []
        for owner, name, value in changes:
            try:
                if getattr(owner, name) != value:
                    setattr(owner, name, value)
            except Exception as error:  # a deleted owner, a value that fits after the others
                failed.append(f"{name}: {error}")
    return failed
