# SPDX-License-Identifier: GPL-3.0-or-later
"""The process that upscales, seen from Blender: started when it is needed, kept for the next frame, asked and heard without waiting.

No thread of Blender itself runs Python beside the interface: Blender 3.4 takes Python for its own while any thread has it, and crashes.
"""
import contextlib
import json
import os
import pickle
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import bpy

from .worker import UNHEARD

GRACE = 5.0  # seconds after which a cancelled frame is ended by force
IDLE = 600.0  # seconds that the process waits for one more frame, with the device open


class Stopped(Exception):
    """Cancelled by the artist, or by Blender."""


def interpreter():
    """The program of Blender's own Python, or None. sys.executable is another one's where that comes first in PATH."""
    name = f"python{sys.version_info.major}.{sys.version_info.minor}"
    own = [os.path.join(sys.prefix, *place) for place in (("bin", name), ("bin", "python.exe"), ("Scripts", "python.exe"), ("python.exe",))]
    return next((path for path in (*own, sys.executable) if path and os.path.isfile(path)), None)


def problem():
    """Why no process can be started, as a sentence, or None."""
    return None if interpreter() else f"The Python of this Blender, by which frames are upscaled, is missing in {sys.prefix}. Install Blender again."


class Worker:
    """A process that runs worker.py, until end() or Blender's own end."""

    def __init__(self):
        if missing := problem():
            raise RuntimeError(missing)
        self._folder, self._asked, self.step = tempfile.mkdtemp(prefix="xrds_worker_"), 0, None  # not in Blender's, which goes with new preferences
        self._log = os.path.join(self._folder, "log.txt")
        command = [interpreter(), "-I", "-B", "-X", "utf8", os.path.join(os.path.dirname(os.path.abspath(__file__)), "worker.py"), self._folder]
        try:
            with open(self._log, "wb") as log:
                self._process = subprocess.Popen(
                    command, bufsize=0, stdin=subprocess.PIPE, stdout=log, stderr=log, creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0))
        except OSError as error:
            self._remove()
            raise RuntimeError(f"The process that upscales cannot be started by {command[0]}: {error.strerror}.") from error
        self.pid = self._process.pid
        self._tell([os.path.abspath(path) for path in sys.path if isinstance(path, str)])

    def ask(self, step, order):
        """Returns the file for answers."""
        self._asked, self.step = self._asked + 1, step
        answers = os.path.join(self._folder, f"{self._asked}.txt")
        self._tell({**order, "answers": answers})
        return answers

    def cancel(self):
        self._tell(None)

    def _tell(self, order):
        rest = pickle.dumps(order)
        with contextlib.suppress(OSError):  # it is dead, which alive() tells
            while rest:
                rest = rest[self._process.stdin.write(rest):]

    def alive(self):
        return self._process.poll() is None

    def kill(self):
        self._process.kill()

    def end(self):
        """It cancels what it does, and goes, with its folder."""
        self._process.stdin.close()
        self.step = None
        if not self.alive():
            self._remove()

    def _remove(self):
        shutil.rmtree(self._folder, ignore_errors=True)

    def death(self):
        """What became of it, as a sentence."""
        code = self._process.returncode
        if code == UNHEARD:
            return f"Nothing can be written into {os.path.dirname(self._folder)}, where the process that upscales answers. Is there room on the disk?"
        how = f"signal {-code}, {signal.Signals(-code).name}" if -code in set(signal.Signals) else f"code {code}"
        with open(self._log, errors="replace") as file:
            said = file.read().strip().rpartition("\n")[2]
        return (f"The process that upscales ended by itself ({how}), as it does where memory is short or the driver of the device crashes. "
                f"Try again: it is started anew.{f' It said: {said}' if said else ''}")


current = None  # the Worker


def ready():
    """The worker, started if there is none."""
    global current
    if current and not current.alive():
        _drop()
    _expect(None)
    current = current or Worker()
    return current


def end():
    """Gives back the worker with all of its memory."""
    _expect(None)
    _drop()


def keep():
    """For one more frame, which may come."""
    _expect(IDLE)


def _expect(seconds):
    """The worker is ended after so long; None: it is not."""
    if bpy.app.timers.is_registered(_drop):
        bpy.app.timers.unregister(_drop)
    if current and seconds:
        bpy.app.timers.register(_drop, first_interval=seconds, persistent=True)


def _drop():
    global current
    worker, current = current, None
    if worker:
        worker.end()


class Upscaling:
    """A step: a frame made by the worker. order: what worker.upscale() takes. heard(stage, share) hears how far it is; cancelled() tells whether to end.

    found: sentences about what looks wrong in it, once it is finished.
    """

    def __init__(self, order, heard, cancelled):
        self.order, self._heard, self._cancelled = order, heard, cancelled
        self._worker = self._last = self._ending = None
        self._read, self._rest, self.found = 0, b"", []

    def start(self):
        worker = ready()
        if worker.step and not worker.step.done():  # cancelled, and still at it
            end()
            worker = ready()
        self._worker, self._answers = worker, worker.ask(self, self.order)

    def done(self):
        if self._last:
            return True
        alive = self._worker.alive()
        self._hear()
        if self._last is None and not alive:
            self._last = {"dead": True}
        elif self._last is None and self._cancelled():
            self._end()
        return self._last is not None

    def wait(self):
        self.start()
        while not self.done():
            time.sleep(0.01)

    def finish(self):
        if "dead" in self._last:
            with contextlib.suppress(OSError):
                os.remove(f"{self.order['result']}.part")
            raise Stopped("Cancelled.") if self._ending else RuntimeError(self._worker.death())
        if "error" in self._last:
            raise raised(**self._last["error"])
        self.found = self._last["found"]

    def close(self):
        """Nobody waits for it any more."""
        if self._worker and not self.done():
            self._cancelled = lambda: True
            self.done()

    def _end(self):
        if self._ending is None:
            self._ending = time.monotonic()
            self._worker.cancel()
        elif time.monotonic() - self._ending > GRACE:
            self._worker.kill()

    def _hear(self):
        with contextlib.suppress(OSError), open(self._answers, "rb") as file:
            file.seek(self._read)
            new = file.read()
            self._read += len(new)
            *lines, self._rest = (self._rest + new).split(b"\n")
            for said in map(json.loads, lines):
                if "stage" in said:
                    self._heard(**said)
                else:
                    self._last = said


def raised(kind, text, system):
    """The exception that worker.plain() told."""
    if kind == "Cancelled":
        return Stopped("Cancelled.")
    if kind == "MemoryError":
        return MemoryError(text)
    return OSError(*system[:2], system[2] or None) if system and system[1] else RuntimeError(text)
