# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Image Denoise's networks, which take the noise out of both renders before they are upscaled: whether they are there, and where they come from."""
import glob
import os

import bpy


def ready():
    """Whether the networks are there."""
    import xrds

    return xrds.can_denoise()


def libraries():
    """Files that may hold the networks: of this Blender first, then of the system."""
    places = [os.path.join(os.path.dirname(bpy.app.binary_path), "lib"), "/usr/lib/*", "/usr/lib64", "/usr/local/lib"]
    return [path for place in places for path in sorted(glob.glob(os.path.join(place, "libOpenImageDenoise*.so*")))]


def found():
    """The first of them out of which the networks can be read, which is done; None: there is none. Raises RuntimeError where they cannot be stored."""
    import xrds

    for library in libraries():
        try:
            xrds.import_oidn(library)
        except xrds.Error as error:
            if str(error).startswith(("Cannot make the folder", "Cannot write")):
                raise
        if ready():
            return library
    return None


def get(path=""):
    """Reads the networks out of a library, or out of one that is known. Returns it. Raises RuntimeError, a sentence."""
    import xrds

    if path:
        xrds.import_oidn(path)
    library = path or found()
    if not library or not ready():
        raise RuntimeError("No Open Image Denoise was found that has the networks. Choose its file libOpenImageDenoise_core, as that of pip install pyoidn.")
    return library
