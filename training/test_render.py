"""training/scenes/render.sh: what Blender says is in the log at once, and Blender ends with the script."""
import os
import pathlib
import signal
import subprocess
import time

import pytest

SCRIPT = pathlib.Path(__file__).resolve().parent / "scenes" / "render.sh"
BLENDER = """#!/bin/sh
echo $$ >>"$PIDS"
echo "Fra:1 Mem:2"
echo "s7 interior: built in 1 s"
exec sleep 60
"""


def until(found, seconds=20):
    end = time.monotonic() + seconds
    while time.monotonic() < end and not found():
        time.sleep(0.05)
    return found()


def running(pid):
    try:
        os.kill(pid, 0)
        return True
    except ProcessLookupError:
        return False


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_the_log_is_written_at_once_and_blender_ends_with_the_script(tmp_path, number):
    blender, pids, out = tmp_path / "blender", tmp_path / "pids", tmp_path / "out"
    blender.write_text(BLENDER)
    blender.chmod(0o755)
    environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}", "PIDS": str(pids)}
    script = subprocess.Popen([SCRIPT, out, "0", "40", "2"], env=environment, stderr=subprocess.DEVNULL)
    logs = [out / f"render.{process}.log" for process in range(2)]
    try:
        assert until(lambda: all(log.exists() and log.read_text() == "s7 interior: built in 1 s\n" for log in logs))
        started = [int(pid) for pid in pids.read_text().split()]
        assert len(started) == 2 and all(map(running, started))
        script.send_signal(number)
        assert script.wait(20) == 143
        assert not any(map(running, started)) and len(pids.read_text().split()) == 2
    finally:
        script.kill()
        for pid in pids.read_text().split():
            if running(int(pid)):
                os.kill(int(pid), signal.SIGKILL)
