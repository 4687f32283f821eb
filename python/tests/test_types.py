"""The package is typed: mypy --strict finds nothing in it, nothing in what a user writes, and what is wrong there."""

import os
import pathlib
import subprocess
import sys

import pytest

import xrds

pytest.importorskip("mypy")
USER = pathlib.Path(__file__).parent / "user.py"


def mypy(tmp_path, *words):
    folder = pathlib.Path(xrds.__file__).parents[1]
    environment = dict(os.environ) if folder.name == "site-packages" else {**os.environ, "MYPYPATH": str(folder)}
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path.parent / "mypy"), *words]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment)
    return done.returncode, done.stdout + done.stderr


def test_package_and_user(tmp_path):
    assert (pathlib.Path(xrds.__file__).parent / "py.typed").exists()
    code, text = mypy(tmp_path, "-p", "xrds")
    assert code == 0, text
    code, text = mypy(tmp_path, str(USER))
    assert code == 0, text


def test_what_is_wrong_is_found(tmp_path):
    wrong = tmp_path / "wrong.py"
    wrong.write_text("import xrds\nxrds.upscale([1.0])\nxrds.upscale(xrds, albedoo=1)\nx: str = xrds.Model('x').scale\n")
    code, text = mypy(tmp_path, str(wrong))
    assert code == 1
    assert [number for number in "234" if f"wrong.py:{number}:" in text] == ["2", "3", "4"], text
