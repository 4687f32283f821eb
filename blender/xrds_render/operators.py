# SPDX-License-Identifier: GPL-3.0-or-later
"""The buttons."""
import functools

import bpy
from bpy.app.handlers import persistent

from . import checks, denoiser, jobs
from .recorder import active, restore_marked

current = None  # the job that runs
steps = None  # its steps, beside the interface
last = ""  # what became of the one before
warned = []  # what looks wrong in its frames


class XRDS_OT_render(bpy.types.Operator):
    """Render the colour at low resolution and the guides at full resolution, and upscale them"""

    bl_idname = "xrds.render"
    bl_label = "Render and Upscale"

    animation: bpy.props.BoolProperty(name="Animation", description="All frames of the scene; those that exist are skipped", options={"SKIP_SAVE"})

    @classmethod
    def poll(cls, context):
        return current is None and context.scene is not None

    def execute(self, context):
        """Waits for every step: for scripts, and for Blender without its window."""
        if not self._begin(context):
            return {"CANCELLED"}
        try:
            jobs.run(current)
        except BaseException as error:
            return self._end(context, error)
        return self._end(context, None)

    def invoke(self, context, event):
        if bpy.app.background:
            return self.execute(context)
        if bpy.app.is_job_running("RENDER"):
            self.report({"ERROR"}, "A render runs already.")
            return {"CANCELLED"}
        if not self._begin(context):
            return {"CANCELLED"}
        global steps
        show_render(context)
        steps, self._step = current.steps(), None
        self._timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            current.cancel()
        if event.type == "Z" and (event.ctrl or event.oskey):
            return {"RUNNING_MODAL"}  # undo would take the scene away under the render
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        _redraw(context)
        if steps.gi_frame is None:  # before_undo() ended it
            return self._end(context, jobs.Stopped("Cancelled."))
        if self._step and not self._step.done():
            return {"PASS_THROUGH"}
        try:
            self._step = next(steps, None)
            if self._step is None:
                return self._end(context, None)
            self._step.start()
        except Exception as error:
            steps.close()
            return self._end(context, error)
        return {"PASS_THROUGH"}

    def cancel(self, context):
        """Blender quits or loads a file: what ran ends without it."""
        stop()
        self._end(context, jobs.Stopped("Cancelled."))

    def _begin(self, context):
        global current, last
        scene = context.scene
        warned.clear()
        found = checks.problem(scene)
        if found:
            last = found
            self.report({"ERROR"}, found)
            return False
        frames = range(scene.frame_start, scene.frame_end + 1, scene.frame_step) if self.animation else None
        current, last = jobs.Job(scene, frames), ""
        return True

    def _end(self, context, error):
        global current, last, steps
        job, current, steps = current, None, None
        if getattr(self, "_timer", None):
            context.window_manager.event_timer_remove(self._timer)
        last, kind = _outcome(job, error)
        self.report({kind}, last)
        warned[:] = job.warnings()
        for sentence in warned:
            self.report({"WARNING"}, sentence)
        if job.written:
            show(context, job.written[-1])
        _redraw(context)
        if error is not None and not isinstance(error, Exception):
            raise error  # the wish to quit
        return {"FINISHED"} if error is None else {"CANCELLED"}


class XRDS_OT_cancel(bpy.types.Operator):
    """End the upscaling now; a render that runs is ended by the cross beside its progress, or Esc"""

    bl_idname = "xrds.cancel"
    bl_label = "Cancel"

    @classmethod
    def poll(cls, context):
        return current is not None

    def execute(self, context):
        current.cancel()
        return {"FINISHED"}


class XRDS_OT_get_denoiser(bpy.types.Operator):
    """Read Open Image Denoise's networks out of Blender's own copy, or out of a file"""

    bl_idname = "xrds.get_denoiser"
    bl_label = "Get Denoiser"

    filepath: bpy.props.StringProperty(name="Library", description="libOpenImageDenoise_core; empty: that of this Blender or of the system", subtype="FILE_PATH", options={"SKIP_SAVE"})

    @classmethod
    def poll(cls, context):
        return checks.package_problem() is None

    def execute(self, context):
        try:
            return self._end(context, denoiser.get(self.filepath))
        except (RuntimeError, OSError) as error:
            return self._failed(error)

    def invoke(self, context, event):
        """Asks for a file where no copy that is known has them."""
        if bpy.app.background:
            return self.execute(context)
        try:
            if library := denoiser.found():
                return self._end(context, library)
        except RuntimeError as error:
            return self._failed(error)
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def _failed(self, error):
        self.report({"ERROR"}, str(error).strip())
        return {"CANCELLED"}

    def _end(self, context, library):
        self.report({"INFO"}, f"Read the denoiser's networks out of {library}.")
        _redraw(context)
        return {"FINISHED"}


def _editors(context):
    return [area.spaces.active for window in context.window_manager.windows for area in window.screen.areas if area.type == "IMAGE_EDITOR"]


def show(context, path):
    """Loads the result, and shows it in the Image Editors that show a render, or in the first one."""
    image = bpy.data.images.load(path, check_existing=True)
    image.reload()
    editors = _editors(context)
    renders = [space for space in editors if space.image is None or space.image.type in ("RENDER_RESULT", "MULTILAYER")]
    for space in renders or editors[:1]:
        space.image = image


def show_render(context):
    """Shows the render again where a result is shown: Blender would turn one more editor into one that does."""
    found = jobs.render_result()
    for space in _editors(context):
        if found and space.image and space.image.filepath.endswith("_xrds.exr"):
            space.image = found


def _outcome(job, error):
    """(sentence, kind of report)"""
    if error is None:
        return job.summary(), "INFO"
    kept = f" {len(job.written)} frames are saved." if job.written else ""
    if isinstance(error, jobs.Stopped):
        return f"Cancelled; the settings are as before.{kept}", "WARNING"
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename or 'A file'} cannot be written or read: {error.strerror}.{kept}", "ERROR"
    if isinstance(error, ReferenceError):
        return f"The scene was deleted while it rendered.{kept}", "WARNING"
    if isinstance(error, MemoryError):
        return f"There is too little memory for this frame. Choose a smaller resolution.{kept}", "ERROR"
    return f"{str(error).strip().removeprefix('Error: ')}{kept}", "ERROR"


def _redraw(context):
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()


waiting = []  # handlers that are called


def call_waiting(_):
    waiting.pop()()
    return True


def writing(function):
    """A handler that may change settings in any case: after a render on a busy machine Blender 3.4 may take all handlers to be drawing, and refuse what
    they set. The function of a property may."""
    @persistent
    @functools.wraps(function)
    def handler(*_):
        waiting.append(function)
        bpy.context.window_manager.xrds_call  # noqa: B018

    return handler


@persistent
def after_cancel(*_):
    jobs.Render.cancelled = True


def stop():
    """Ends what runs beside the interface, and puts the settings back, at once."""
    if steps:
        current.cancel()
        steps.close()


@writing
def before_undo():
    """Undo and redo put another scene in the place of the one that is rendered."""
    stop()


@writing
def after_undo():
    """The state that is back may have been kept while settings were changed."""
    restore_marked()


@writing
def after_load():
    """So may that of a file, which Blender wrote by itself. What became of the file before is no more of interest."""
    global last
    last = ""
    warned.clear()
    restore_marked()


@writing
def before_save():
    for recorder in reversed(active):
        recorder.suspend()


@writing
def after_save():
    for recorder in active:
        recorder.resume()


HANDLERS = {"render_cancel": after_cancel, "save_pre": before_save, "save_post": after_save, "save_post_fail": after_save, "undo_pre": before_undo, "redo_pre": before_undo,
            "undo_post": after_undo, "redo_post": after_undo, "load_post": after_load}
HANDLERS = {name: function for name, function in HANDLERS.items() if hasattr(bpy.app.handlers, name)}  # save_post_fail: Blender 3.6


def register():
    bpy.types.WindowManager.xrds_call = bpy.props.BoolProperty(get=call_waiting, options={"HIDDEN", "SKIP_SAVE"})
    for name, function in HANDLERS.items():
        getattr(bpy.app.handlers, name).append(function)


def unregister():
    global current, steps
    stop()  # switched off while it runs
    current = steps = None
    for name, function in HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(function)
    del bpy.types.WindowManager.xrds_call
