"""python -m xrds: the command xrds, which the package brings along."""

from __future__ import annotations

import os
import pathlib
import subprocess
import sys


def main() -> None:
    """Becomes the command, with the arguments of this process."""
    name = "xrds.exe" if sys.platform == "win32" else "xrds"
    program = str(pathlib.Path(__file__).parent / "bin" / name)
    if not os.path.exists(program):
        sys.exit(f"The command is missing, expected at '{program}': install the package again.")
    if sys.platform == "win32":  # where execv() does not wait
        sys.exit(subprocess.call([program, *sys.argv[1:]]))
    os.execv(program, ["xrds", *sys.argv[1:]])


if __name__ == "__main__":
    main()
