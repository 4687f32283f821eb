# SPDX-License-Identifier: GPL-3.0-or-later
"""The process that upscales beside Blender, and knows nothing of it: upscaler.py starts this file by Blender's own Python.

On its standard input come pickles: the sys.path of Blender's Python, then for each frame an order, a dict of plain values; None cancels the last
order. Their end means that nobody needs this process any more. Each order names a file for answers: lines of JSON, of which the last one has "done" or "error".
The argument is the folder of these files, which is removed at the end.
"""
import contextlib
import functools
import importlib.util
import json
import os
import pickle
import queue
import shutil
import signal
import sys
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
UNHEARD = 3  # the exit code where answers cannot be written
GRACE = 10.0  # seconds for what runs when nobody needs it any more


def listen(pipe, orders):
    """Puts (order, event that is set when it is cancelled) into the queue, beside the work; None at the end."""
    cancelled = threading.Event()
    while True:
        try:
            order = pickle.load(pipe)
        except Exception:  # the end, or half an order of a Blender that was killed
            break
        if order is None:
            cancelled.set()
        else:
            cancelled = threading.Event()
            orders.put((order, cancelled))
    cancelled.set()
    orders.put(None)
    time.sleep(GRACE)
    leave(1)  # a driver does not come back


def leave(code):
    """Not through the destructors of drivers."""
    shutil.rmtree(sys.argv[1], ignore_errors=True)
    os._exit(code)


@functools.lru_cache(maxsize=None)
def extension():
    """This folder as a package, whatever its name is in Blender: (its module frame, its module temporal)."""
    spec = importlib.util.spec_from_file_location("xrds_render", os.path.join(HERE, "__init__.py"), submodule_search_locations=[HERE])
    sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    return importlib.import_module("xrds_render.frame"), importlib.import_module("xrds_render.temporal")


@functools.lru_cache(maxsize=1)
def surroundings(folder, frames, wish):
    """Kept from frame to frame of an animation."""
    return extension()[1].Surroundings(folder, frames, wish)


def upscale(order, progress):
    frame, _ = extension()
    wish, around = frame.Wish(*order["wish"]), None
    if order["around"]:
        number, folder, frames = order["around"]
        around = number, surroundings(folder, frames, wish)
    return frame.upscale(order["low"], order["full"], order["result"], wish, progress, around)


def plain(error):
    """What upscaler.raised() makes an exception of again."""
    kind = next((kind.__name__ for kind in (OSError, MemoryError) if isinstance(error, kind)), type(error).__name__)
    system = [error.errno, error.strerror, str(error.filename or "")] if kind == "OSError" else None
    text = f"The package xrds cannot be loaded by {sys.executable}: {error}." if isinstance(error, ImportError) else str(error) or kind
    return {"kind": kind, "text": text, "system": system}


def answer(order, cancelled):
    with open(order["answers"], "w") as file:
        def say(**said):
            file.write(json.dumps(said) + "\n")
            file.flush()

        def progress(stage, share):
            say(stage=stage, share=share)
            return not cancelled.is_set()

        try:
            say(done=True, found=upscale(order, progress))
        except Exception as error:
            say(error=plain(error))


def main():
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C in a terminal is meant for Blender, which cancels
    sys.path[:] = pickle.load(sys.stdin.buffer)
    orders = queue.SimpleQueue()
    threading.Thread(target=listen, args=(sys.stdin.buffer, orders), daemon=True).start()
    with contextlib.suppress(ImportError):  # the first frame tells
        extension()
        import xrds
    for order, cancelled in iter(orders.get, None):
        try:
            answer(order, cancelled)
        except OSError:
            leave(UNHEARD)
    surroundings.cache_clear()
    xrds.release()  # so that drivers keep what they compiled
    leave(0)


if __name__ == "__main__":
    main()
