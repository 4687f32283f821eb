# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension in Blender's own window, under Xvfb, as an artist meets it:

    python3 blender/tests/window.py build/blender/xrds_render-0.1.0.zip [--pictures docs/images] [--blender blender]

Installs the file for a new user, renders the scene that Blender starts with, cancels while it renders and while it upscales, takes a step
back by undo and opens another file meanwhile, keeps steps of undo at any moment, stops an animation and goes on with it, kills the process that
upscales, and compares every setting after each. Says what it saw, and ends with an error where something is not as it should be. --pictures: where
the pictures of docs/blender.md are written to; they are of Blender 3.4. Needs xvfb and xdotool, and Blender before 5.0.
"""
import argparse
import os
import pathlib
import signal
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent


def start():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("archive", type=pathlib.Path)
    parser.add_argument("--pictures", type=pathlib.Path)
    parser.add_argument("--blender", default="blender")
    ask = parser.parse_args()
    with tempfile.TemporaryDirectory() as home:
        pictures = ask.pictures.resolve() if ask.pictures else home
        environment = {**os.environ, "BLENDER_USER_SCRIPTS": f"{home}/scripts", "BLENDER_USER_CONFIG": f"{home}/config", "BLENDER_USER_EXTENSIONS": f"{home}/extensions"}
        command = ["xvfb-run", "-a", "-s", "-screen 0 1600x900x24", ask.blender, "--factory-startup", "-noaudio", "-p", "0", "0", "1600", "900",
                   "-P", str(pathlib.Path(__file__).resolve()), "--", str(ask.archive.resolve()), str(pictures), home]
        sys.exit(subprocess.run(command, env=environment, timeout=900).returncode)


if "bpy" not in sys.modules:
    start()

import bpy  # noqa: E402
import numpy  # noqa: E402

ARCHIVE, PICTURES, HOME = sys.argv[sys.argv.index("--") + 1:]
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE))
from properties import differences, snapshot  # noqa: E402


MODULE = "xrds_render" if bpy.app.version < (4, 2) else "bl_ext.user_default.xrds_render"
bpy.context.preferences.view.show_splash = False


def check(right, sentence):
    print(("ok: " if right else "WRONG: ") + sentence, flush=True)
    if not right:
        os._exit(1)


def area_of(kind, window=None):
    return next(area for area in (window or bpy.context.window_manager.windows[0]).screen.areas if area.type == kind)


def picture(name, area, window=None, part=(0.0, 0.0, 1.0, 1.0)):
    """A picture of an area after it is drawn anew, or a part of it: left, bottom, right, top."""
    window, file = window or bpy.context.window_manager.windows[0], os.path.join(PICTURES, f"blender_{name}.png")
    with bpy.context.temp_override(window=window, area=area):
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
    yield 0.01  # after drawing, go_on() lets it set everything again
    if PICTURES == HOME:
        return  # nobody asked for it
    with bpy.context.temp_override(window=window, area=area):
        bpy.ops.screen.screenshot(filepath=file)
    whole = bpy.data.images.load(file)
    width, height = whole.size
    left, bottom, right, top = (round(share * side) for share, side in zip(part, 2 * (area.width, area.height)))
    pixels = numpy.array(whole.pixels[:], numpy.float32).reshape(height, width, 4)[area.y + bottom:area.y + top, area.x + left:area.x + right]
    cut = bpy.data.images.new(name, pixels.shape[1], pixels.shape[0])
    cut.pixels = pixels.ravel()
    cut.filepath_raw, cut.file_format = file, "PNG"
    cut.save()
    for image in (whole, cut):
        bpy.data.images.remove(image)


def invoke(**options):
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, area=area_of("PROPERTIES")):
        return bpy.ops.xrds.render("INVOKE_DEFAULT", **options)


def started(**options):
    """A click, as soon as Blender takes it."""
    yield from until(lambda: invoke(**options) == {"RUNNING_MODAL"})


def job():
    return sys.modules[f"{MODULE}.operators"].current


def until(right, seconds=120.0):
    """Lets Blender go on until it is so."""
    for _ in range(int(20 * seconds)):
        if right():
            return
        yield 0.05
    check(False, f"nothing happened in {seconds} s: {job().text if job() else sys.modules[f'{MODULE}.operators'].last}")


def results():
    return sorted(name for name in os.listdir(HOME) if name.endswith(".exr"))


def install():
    if MODULE == "xrds_render":
        bpy.ops.preferences.addon_install(filepath=ARCHIVE)
        bpy.ops.preferences.addon_enable(module=MODULE)
    else:
        bpy.ops.extensions.package_install_files(filepath=ARCHIVE, repo="user_default", enable_on_install=True)
    import xrds

    check(os.path.realpath(xrds.__file__).startswith(os.path.realpath(HOME)), f"installed in Blender {bpy.app.version_string}, with the package that it carries")
    bpy.ops.screen.userpref_show("INVOKE_DEFAULT")
    bpy.context.preferences.active_section = "ADDONS"
    bpy.context.window_manager.addon_search = "xrds"
    yield 1.0
    window = bpy.context.window_manager.windows[-1]
    yield from picture("install", area_of("PREFERENCES", window), window)
    with bpy.context.temp_override(window=window):
        bpy.ops.wm.window_close()
    yield 0.5


def only(*names):
    """The Properties show these panels and the extension's: all fit into a picture."""
    for panel in [one for one in bpy.types.Panel.__subclasses__() if getattr(one, "bl_space_type", "") == "PROPERTIES" and getattr(one, "bl_context", "") in ("render", "output")]:
        if panel.__name__ not in (*names, "XRDS_PT_panel") and hasattr(bpy.types, panel.__name__):
            bpy.utils.unregister_class(panel)


def prepare():
    scene, properties = bpy.context.scene, area_of("PROPERTIES")
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = 640, 480
    scene.render.filepath = os.path.join(HOME, "shot_")
    scene.xrds.model, scene.xrds.guide_samples = "xrds-x4-nano", 16
    bpy.ops.wm.save_as_mainfile(filepath=os.path.join(HOME, "shot.blend"))
    only("RENDER_PT_context", "RENDER_PT_output")
    scene.xrds.model = "AUTO"
    scene.render.filepath = "//shot_"
    for context in ("OUTPUT", "RENDER"):
        properties.spaces.active.context = context
        yield 0.5
        yield from picture({"OUTPUT": "output", "RENDER": "panel"}[context], properties)
    scene.xrds.model, scene.render.filepath = "xrds-x4-nano", os.path.join(HOME, "shot_")
    bpy.context.preferences.view.render_display_type = "AREA"
    yield 0.2


def one_click():
    layer = bpy.context.view_layer
    layer.use_pass_diffuse_direct = layer.use_pass_diffuse_indirect = layer.use_pass_diffuse_color = layer.use_pass_cryptomatte_object = True
    bpy.context.scene.xrds.model = "AUTO" if PICTURES != HOME else "xrds-x4-nano"
    before = snapshot()
    check(invoke() == {"RUNNING_MODAL"}, "it runs beside the interface")
    yield from until(lambda: job() and job().text.startswith("Guides"))
    yield 0.3
    check(len(differences(before, snapshot())) > 5, "settings are changed while it renders")
    yield from picture("progress", area_of("PROPERTIES"))
    yield from until(lambda: job() is None, 500)
    check(results() == ["shot_0001_xrds.exr"], "the frame is saved")
    check(same(before), "every setting is as before")
    yield 0.5
    editor = area_of("IMAGE_EDITOR")
    check(editor.spaces.active.image.name == "shot_0001_xrds.exr", "the Image Editor shows it")
    yield from picture("result", editor, part=(0.2, 0.1, 0.8, 1.0))


def compositor():
    scene, area = bpy.context.scene, area_of("IMAGE_EDITOR")
    area.ui_type = "CompositorNodeTree"
    scene.use_nodes = True
    nodes, links = scene.node_tree.nodes, scene.node_tree.links
    for node in [node for node in nodes if node.type != "COMPOSITE"]:
        nodes.remove(node)
    image = nodes.new("CompositorNodeImage")
    image.image, image.location = bpy.data.images["shot_0001_xrds.exr"], (-40, 350)
    links.new(image.outputs["Combined"], nodes["Composite"].inputs[0])
    yield 0.5
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=area.regions[-1]):
        bpy.ops.node.view_all()
    yield 1.0
    yield from picture("compositor", area, part=(0.0, 0.05, 0.6, 1.0))
    scene.use_nodes = False
    area.ui_type = "VIEW_3D"


def again():
    """Blender turns an editor into one for the render where none shows it: not one more for each click."""
    scene, kinds = bpy.context.scene, []
    size, scene.render.resolution_x = scene.render.resolution_x, 64
    scene.xrds.model, scene.xrds.samples = "xrds-x4-nano", 1
    for _ in range(3):
        yield from started()
        yield from until(lambda: job() is None)
        yield 0.3
        kinds.append([area.type for area in bpy.context.window_manager.windows[0].screen.areas])
    scene.render.resolution_x = size
    check(kinds[0] == kinds[2], "three clicks take no other editor")


def push(message):
    """Keeps a step of undo in the context of the Properties; whether Blender did."""
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area_of("PROPERTIES")):
        return bpy.ops.ed.undo_push(message=message) == {"FINISHED"}


def under_way(stage):
    return stage in job().text or stage == "Upscaling" and "Preparing" in job().text


def pushed():
    """Steps of undo are kept in another context at every moment of an upscaling, which goes on: such an operator takes Python for its own if a
    thread of Blender runs it meanwhile, and crashes."""
    scene, count = bpy.context.scene, 0
    scene.xrds.model, scene.xrds.samples = "xrds-x4-nano", 1
    for _ in range(5):
        yield from started()
        yield from until(lambda: job() is None or under_way("Upscaling"))
        while job():
            count += sum(push("under way") for _ in range(20))
            yield 0.002
    check(count > 200 and results() == ["shot_0001_xrds.exr"], f"{count} steps of undo were kept while it upscaled")


def cancelled():
    """While it renders, and while it upscales."""
    bpy.context.scene.xrds.model = "xrds-x4-nano"
    for way, stage, delay in [(way, stage, delay) for way in ("escape", "undo", "cancel") for stage, delay in (("Colour", 0), ("Upscaling", 0), ("Upscaling", 0.1))]:
        for name in results():
            os.remove(os.path.join(HOME, name))
        scene = bpy.context.scene
        scene.xrds.samples = 2000 if stage == "Colour" else 1
        scene.xrds.guide_samples = 1
        scene.render.resolution_x, scene.render.resolution_y = (640, 480) if stage == "Colour" else (1920, 1440)  # so that it takes a while
        bpy.ops.ed.undo_push(message="before")
        bpy.ops.ed.undo_push(message="once more")
        before = snapshot()
        yield from started()
        yield from until(lambda: job() is None or under_way(stage))
        yield delay
        yield from until(lambda: push("under way"))
        check(job() is not None, f"{stage} is under way")
        with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area_of("PROPERTIES")):
            if way == "undo":
                bpy.ops.ed.undo()
            elif way == "cancel":
                bpy.ops.xrds.cancel()
            else:
                subprocess.run(["xdotool", "mousemove", "400", "400", "key", "Escape"], check=True)
        if way == "cancel" and stage == "Colour":
            check(bool(differences(before, snapshot())), "a render that is cancelled goes on until it is done")
        yield from until(lambda: job() is None, 10 if way != "cancel" else 120)
        yield 0.3
        check(same(before), f"every setting is as before: {way} in {stage}")
        check(results() == [], "no file is left")
    bpy.context.scene.render.resolution_x, bpy.context.scene.render.resolution_y = 640, 480


BLENDER_ITSELF = ("use_extra_user", "preview.icon_id", "particle_edit.object", "].enabled", "].is_unavailable", ".dimensions", "is_runtime_data")  # by undo and by drawing nodes


def same(before):
    found = [one for one in differences(before, snapshot()) if not any(part in one for part in BLENDER_ITSELF)]
    print(*found, sep="\n")
    return not found


def animation():
    """Stopped after its first frame, it goes on; with a window of its own for renders, as Blender does it by itself."""
    bpy.context.preferences.view.render_display_type = "WINDOW"
    scene, cube = bpy.context.scene, bpy.data.objects["Cube"]
    scene.frame_start, scene.frame_end = 1, 8
    scene.render.resolution_x, scene.render.resolution_y, scene.xrds.samples, scene.xrds.guide_samples = 64, 48, 4, 1
    for frame, turn in ((1, 0.0), (8, 1.0)):
        cube.rotation_euler.z = turn
        cube.keyframe_insert("rotation_euler", frame=frame)
    scene.frame_set(3)
    yield 0.5
    before = snapshot()
    yield from started(animation=True)
    yield from until(lambda: results())
    bpy.ops.xrds.cancel()
    yield from until(lambda: job() is None)
    stopped = results()
    check(0 < len(stopped) < 8 and same(before), f"an animation was stopped after {len(stopped)} frames, every setting is as before")
    yield from started(animation=True)
    yield from until(lambda: job() is None)
    check(len(results()) == 8 and same(before), "it went on to its end, every setting is as before")
    check(sorted(name for name in os.listdir(HOME) if name.startswith("shot_")) == results(), "nothing else is left beside the frames")


def killed():
    """The process that upscales dies: Blender does not, and the next click starts another."""
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 1920, 1440
    before = snapshot()
    yield from started()
    yield from until(lambda: job() is None or under_way("Upscaling"))
    os.kill(sys.modules[f"{MODULE}.upscaler"].current.pid, signal.SIGKILL)
    yield from until(lambda: job() is None, 10)
    said = sys.modules[f"{MODULE}.operators"].last
    check("ended by itself (signal 9, SIGKILL)" in said and same(before), f"a worker was killed: {said}")
    yield from started()
    yield from until(lambda: job() is None)
    check("Saved" in sys.modules[f"{MODULE}.operators"].last, "the next click starts another")


def loaded():
    for stage, samples in (("Colour", 2000), ("Upscaling", 1)):
        scene = bpy.context.scene
        scene.render.resolution_x, scene.render.resolution_y = 1920, 1440
        scene.xrds.model, scene.xrds.samples, scene.xrds.guide_samples = "xrds-x4-nano", samples, 1
        yield from started()
        yield from until(lambda stage=stage: job() and under_way(stage))
        bpy.ops.wm.open_mainfile(filepath=os.path.join(HOME, "shot.blend"))
        yield 0.5
        check(job() is None and bpy.context.scene.render.resolution_x == 640, f"another file was opened while it rendered: {stage}")


def all_steps():
    for part in (install, prepare, one_click, compositor, again, pushed, cancelled, animation, killed, loaded):
        yield from part()
    os._exit(0)


STEPS = all_steps()


def next_step(_):
    try:
        return next(STEPS)
    except BaseException as error:
        import traceback

        traceback.print_exc()
        check(False, str(error))


def go_on():
    """Not as it is: after a render on a busy machine Blender 3.4 may take all timers to be drawing, and refuse what they set and call, unlike what an artist
    clicks. The function of a property may do both in any case."""
    return bpy.context.window_manager.next_step


bpy.types.WindowManager.next_step = bpy.props.FloatProperty(get=next_step)
bpy.app.timers.register(go_on, first_interval=2.0, persistent=True)
