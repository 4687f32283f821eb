# SPDX-License-Identifier: GPL-3.0-or-later
"""A render of one or more frames, as a row of steps: the interface runs between them, or waits for each where there is none."""
import contextlib
import errno
import functools
import os
import re
import tempfile
import time

import bpy

from . import checks, denoiser, frame, passes, temporal, upscaler
from .recorder import Recorder
from .settings import AUTO
from .upscaler import Stopped


def render_result():
    """The image that Blender renders into; None before the first render."""
    return next((image for image in bpy.data.images if image.type == "RENDER_RESULT"), None)


class Render:
    """A step: Blender's own render into a file, with its progress and its ways to cancel it."""

    cancelled = False  # told by a handler of Blender: the last one that ran beside the interface

    def __init__(self, scene, path):
        self._scene, self._path = scene, path
        self._slot = None

    def start(self):
        Render.cancelled = False
        bpy.ops.render.render("INVOKE_DEFAULT", scene=self._scene.name)
        self._slot = self._slots().active_index

    def done(self):
        return not bpy.app.is_job_running("RENDER")

    def wait(self):
        with self._writing():
            bpy.ops.render.render(write_still=True, scene=self._scene.name)

    def finish(self):
        if self._slot is not None and not Render.cancelled:
            self._save()
        if not os.path.exists(self._path):  # Blender writes it unless it was cancelled
            raise Stopped("The render was cancelled.")

    def _save(self):
        """Here, not by the render: Blender 3.4 crashes where one that writes is ended by undo or another file."""
        slots = self._slots()
        shown, slots.active_index = slots.active_index, self._slot
        try:
            with self._writing():
                render_result().save_render(self._path, scene=self._scene)
        finally:
            slots.active_index = shown

    @contextlib.contextmanager
    def _writing(self):
        """Within it, Blender's lines about a file that it cannot write become the system's reason."""
        try:
            yield
        except RuntimeError as error:
            if reason := re.search(r"Error writing render result, (.*?)(?: \(see console\))?$", str(error), re.MULTILINE):
                raise OSError(errno.EIO, reason[1], self._path) from error
            raise

    @staticmethod
    def _slots():
        return render_result().render_slots


class Job:
    """Renders and upscales frames of a scene. steps() changes the scene only while a render runs.

    frames: None: the current one, written anew; else those of an animation, of which existing ones are skipped.
    """

    def __init__(self, scene, frames=None):
        self.scene = scene
        self.frames = frames
        self.text, self.share = "", 0.0
        self.cancelled = False
        self.written, self.skipped = [], 0
        self._found = {}  # {sentence without its numbers: {frame: sentence}}
        self.seconds = {"renders": 0.0, "upscaling": 0.0, "all": 0.0}

    @property
    def settings(self):
        return self.scene.xrds  # not kept, as it goes with the scene

    def steps(self):
        begin, scene = time.monotonic(), self.scene
        before = self._shown()
        try:
            if self.frames and checks.steady(scene):
                yield from self._steady()
            else:
                yield from self._each()
        finally:
            with contextlib.suppress(ReferenceError):  # the scene was deleted
                self._show(*before)
            (upscaler.end if self.frames else upscaler.keep)()
            self.seconds["all"] = time.monotonic() - begin

    def _shown(self):
        return self.scene.frame_current, self.scene.frame_subframe

    def _show(self, number, subframe):
        if self._shown() != (number, subframe):
            self.scene.frame_set(number, subframe=subframe)

    def _each(self):
        """Every frame by itself."""
        for place, number in enumerate(self.frames or [self.scene.frame_current]):
            if self.frames and os.path.exists(checks.output_file(self.scene, number)):
                self.skipped += 1
                continue
            if self.frames:
                self.scene.frame_set(number)
            yield from self._frame(number, place, len(self.frames or [0]))

    def _steady(self):
        """Every frame merged with those around it, as soon as these are rendered."""
        missing = [number for number in self.frames if not os.path.exists(checks.output_file(self.scene, number))]
        self.skipped = len(self.frames) - len(missing)
        if not missing:
            return
        wish, needed = self._wish(steady=True), temporal.needed(self.frames, missing)
        renders = temporal.Renders(checks.renders_folder(self.scene), self._said(wish), _saved(), goes_on=self.skipped > 0)
        try:
            yield from self._row(renders, wish, missing, needed)
        finally:
            if not (self.written or self.skipped or renders.state):
                renders.forget(None)

    def _row(self, renders, wish, missing, needed):
        kinds, step = passes.renders(self.settings), 0
        steps = len(kinds) * len(needed) + len(missing)
        for number in needed:
            for kind, configure, text in kinds:
                if not renders.has(number, kind):
                    self.scene.frame_set(number)
                    yield from self._kept(functools.partial(configure, merges=True), renders.file(number, kind), f"{text} of frame {number}", step / steps)
                step += 1
            while missing and number >= min(missing[0] + temporal.RADIUS, needed[-1]):
                yield from self._merged(renders, missing[0], wish, step, steps)
                del missing[0]
                step += 1
                renders.forget(missing[0] - temporal.RADIUS if missing else None)

    def _kept(self, configure, path, text, share):
        """A render whose file is there whole or not at all, if Blender is ended while it writes."""
        part = f"{path}.part.exr"
        yield from self._render(configure, part, text, share)
        os.replace(part, path)

    def _merged(self, renders, number, wish, step, steps):
        low, full = (renders.file(number, kind) for kind in ("low", "full"))
        yield from self._upscale(low, full, checks.output_file(self.scene, number), wish, f"Upscaling of frame {number}", (step / steps, (step + 1) / steps), number, renders)

    def _said(self, wish):
        """What renders depend on, of what is chosen here: those of other choices are of no use."""
        scene, settings = self.scene, self.settings
        return {"size": list(passes.size(scene, int(settings.scale))), "scale": int(settings.scale), "samples": list(wish.samples), "light": wish.has_light,
                "passes": [[layer.name, layer.use, [[aov.name, aov.type] for aov in layer.aovs], [group.name for group in getattr(layer, "lightgroups", ())],
                            *(name for owner, name in passes.flags(layer) if getattr(owner, name))] for layer in scene.view_layers]}

    def cancel(self):
        """Ends an upscaling soon, a render when it is done: Blender's own button beside its progress ends that at once."""
        self.cancelled = True

    def summary(self):
        if not self.written:
            return f"All {self.skipped} frames are there already: nothing was rendered."
        what = self.written[-1] if len(self.written) == 1 else f"{len(self.written)} frames, the last one {self.written[-1]}"
        skipped = f" {self.skipped} were there already." if self.skipped else ""
        return f"Saved {what} in {self.seconds['all']:.1f} s, of which {self.seconds['renders']:.1f} s for renders, {self.seconds['upscaling']:.1f} s for upscaling.{skipped}"

    def warnings(self):
        """What looks wrong in the frames, as sentences: each once, whatever its numbers are."""
        for sentences in self._found.values():
            first, sentence = next(iter(sentences.items()))
            others = f" The same in {len(sentences) - 1} more." if len(sentences) > 1 else ""
            yield f"Frame {first}: {sentence}{others}" if self.frames else sentence

    def _frame(self, number, place, count):
        result = checks.output_file(self.scene, number)
        os.makedirs(os.path.dirname(result), exist_ok=True)
        of = f" of frame {number}" if count > 1 else ""
        wish, shown = self._wish(), self._shown()
        with tempfile.TemporaryDirectory(dir=bpy.app.tempdir or None, prefix="xrds_") as folder:
            low, full = (os.path.join(folder, f"{name}.exr") for name in ("low", "full"))
            kinds = passes.renders(self.settings)
            for done, (kind, configure, text) in enumerate(kinds):
                self._show(*shown)  # the artist may look at another frame meanwhile
                yield from self._render(configure, os.path.join(folder, f"{kind}.exr"), f"{text}{of}", (place + done / (len(kinds) + 1)) / count)
            yield from self._upscale(low, full, result, wish, f"Upscaling{of}", ((place + len(kinds) / (len(kinds) + 1)) / count, (place + 1) / count), number)

    def _wish(self, steady=False):
        settings, layers = self.settings, self.scene.view_layers
        drops = {(layer.name, name) for layer in layers for name, flag in passes.MOTION_FLAGS.items() if not getattr(layer, flag)} if steady else ()
        output = self.scene.render.image_settings
        return frame.Wish(
            layers=tuple(layer.name for layer in layers), keeps_guides=frozenset(layer.name for layer in layers if layer.cycles.denoising_store_passes),
            samples=passes.samples(settings), model=None if settings.model == AUTO else settings.model,
            device=None if settings.device == AUTO else settings.device, has_light=passes.has_light(settings),
            denoise=settings.denoise and denoiser.ready(), half=not (output.file_format.startswith("OPEN_EXR") and output.color_depth == "32"), drops=frozenset(drops),
            single=passes.single(settings), aovs=frozenset((layer.name, aov.name) for layer in layers for aov in layer.aovs))

    def _upscale(self, low, full, result, wish, text, shares, number, renders=None):
        """shares: of the whole job, at the begin and at the end. renders: where it is merged with those around it."""
        def heard(stage, share):
            self.text, self.share = text if stage == "upscaling" else "Preparing the device", shares[0] + share * (shares[1] - shares[0])

        around = (number, renders.folder, tuple(self.frames)) if renders else None
        order = {"low": low, "full": full, "result": result, "wish": tuple(wish), "around": around}
        step = upscaler.Upscaling(order, heard, lambda: self.cancelled)
        try:
            yield from self._timed("upscaling", step, text, shares[0])
        finally:
            step.close()
        self.written.append(result)
        for sentence in step.found:
            self._found.setdefault(re.sub(r"\d+", "", sentence), {})[number] = sentence

    def _render(self, configure, path, text, share):
        upscaler.ready()  # it starts while Blender renders
        with Recorder(self.scene) as recorder:
            configure(self.scene, self.settings, path, recorder)
            recorder.mark()
            yield from self._timed("renders", Render(self.scene, path), text, share)

    def _timed(self, kind, step, text, share):
        if self.cancelled:
            raise Stopped("Cancelled.")
        self.text, self.share = text, share
        begin = time.monotonic()
        yield step
        step.finish()
        self.seconds[kind] += time.monotonic() - begin


def _saved():
    """[path, time] of the .blend file if the scene is as it says; else None."""
    path = bpy.data.filepath
    return [path, os.stat(path).st_mtime_ns] if path and not bpy.data.is_dirty and os.path.exists(path) else None


def run(job):
    """Without an interface: every step is waited for."""
    for step in job.steps():
        step.wait()
