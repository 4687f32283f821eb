# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension in a real Blender without its window: the tests of extension/, on the files of scenes.py:

    blender -b --factory-startup -noaudio -P blender/tests/test_extension.py -- --package build/release/python [CLASS ...]

or by a Python that has the module bpy. Another folder than build/release/python may have the package xrds. Exits with 77 where it cannot be imported.
"""
import os
import sys
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
OWN = sys.argv[sys.argv.index("--") + 1:] if "--" in sys.argv else sys.argv[1:]
sys.dont_write_bytecode = True
sys.path[:0] = [HERE, os.path.dirname(HERE)] + ([os.path.abspath(OWN[1])] if OWN[:1] == ["--package"] else [])
try:
    import xrds  # noqa: F401
except ImportError as error:
    print(f"The extension is not tried: this Blender cannot import the package xrds ({error})")
    sys.stdout.flush()
    os._exit(77)

import xrds_render  # noqa: E402
from extension.animation import Animation, Steady  # noqa: E402, F401
from extension.denoising import Denoising  # noqa: E402, F401
from extension.findings import Findings  # noqa: E402, F401
from extension.one_click import OneClick, SingleRender  # noqa: E402, F401
from extension.process import Worker  # noqa: E402, F401
from extension.recording import Recording  # noqa: E402, F401
from extension.trouble import Trouble  # noqa: E402, F401


def main():
    xrds_render.register()
    result = unittest.main(argv=["test_extension.py", *OWN[2:]], exit=False, verbosity=1).result
    xrds_render.unregister()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0 if result.wasSuccessful() else 1)


if __name__ == "__main__":
    main()
