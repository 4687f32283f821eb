# SPDX-License-Identifier: GPL-3.0-or-later
"""The process that upscales."""
import contextlib
import os
import shutil
import signal
import sys
import time
from unittest import mock

import bpy
import xrds

from extension.with_blender import WithBlender, before_upscaling
from properties import differences, snapshot
from xrds_render import checks, jobs, operators, upscaler


class Worker(WithBlender):
    """The process that upscales."""

    def large(self):
        """A frame whose upscaling takes a while."""
        scene = self.open("cryptomatte")
        scene.render.resolution_x, scene.render.resolution_y, scene.xrds.samples = 1024, 768, 1
        return scene

    def when_heard(self, call):
        """Within it, call(step) is called once the worker told how far a frame is."""
        def hearing(step, hear=upscaler.Upscaling._hear):
            hear(step)
            if step._read and not called:
                called.append(call(step))
        called = []
        return mock.patch.object(upscaler.Upscaling, "_hear", hearing)

    def gone(self, pid):
        """Whether a process ends within ten seconds."""
        for _ in range(200):
            try:
                with open(f"/proc/{pid}/stat") as file:
                    if file.read().rpartition(")")[2].split()[0] == "Z":
                        return True
            except FileNotFoundError:
                return True
            time.sleep(0.05)
        return False

    def test_it_is_kept_for_the_next_frame_and_goes_after_an_animation(self):
        self.open("layers")
        self.render()
        pid = upscaler.current.pid
        self.assertNotEqual(pid, os.getpid())
        self.assertTrue(bpy.app.timers.is_registered(upscaler._drop), "and when nobody wants one more frame")
        self.render()
        self.assertEqual(upscaler.current.pid, pid)
        self.render(animation=True)
        self.assertIsNone(upscaler.current)
        self.assertFalse(bpy.app.timers.is_registered(upscaler._drop))
        self.assertTrue(self.gone(pid))

    def test_it_has_the_package_of_blender_and_not_blender(self):
        self.open("layers")
        self.render()
        with open(f"/proc/{upscaler.current.pid}/maps") as file:
            mapped = {line.split()[-1] for line in file}
        self.assertIn(os.path.realpath(xrds._native.__file__), mapped)
        self.assertEqual([path for path in mapped if path == bpy.app.binary_path or "/bpy/" in path], [])

    def test_killed_in_the_middle(self):
        self.large()
        with self.when_heard(lambda step: os.kill(upscaler.current.pid, signal.SIGKILL)), \
                self.assertRaisesRegex(RuntimeError, r"ended by itself \(signal 9, SIGKILL\).*Try again"):
            bpy.ops.xrds.render()
        self.assertEqual(self.exrs(), [])
        self.render()
        self.assertEqual(self.exrs(), ["cryptomatte_0001_xrds.exr"])

    def test_killed_before_a_frame(self):
        killed = []

        def kill(step):
            killed.append(upscaler.current.pid)
            os.kill(upscaler.current.pid, signal.SIGKILL)
            upscaler.current._process.wait()

        self.open("cryptomatte")
        with before_upscaling(kill):
            self.render()
        self.assertEqual(self.exrs(), ["cryptomatte_0001_xrds.exr"])
        self.assertNotEqual(upscaler.current.pid, killed[0])

    def test_cancelled_in_the_middle(self):
        self.large()
        self.render()
        os.remove(os.path.join(self.folder, self.exrs()[0]))
        before, pid = snapshot(), upscaler.current.pid
        with self.when_heard(lambda step: operators.current.cancel()):
            self.assertEqual(bpy.ops.xrds.render(), {"CANCELLED"})
        self.assertIn("Cancelled", operators.last)
        self.assertEqual(differences(before, snapshot()), [])
        self.assertEqual(self.exrs(), [])
        self.render()
        self.assertEqual(upscaler.current.pid, pid, "it hears")

    def test_one_that_does_not_hear_is_ended_by_force(self):
        def hang(step):
            os.kill(upscaler.current.pid, signal.SIGSTOP)
            operators.current.cancel()

        self.large()
        with mock.patch.object(upscaler, "GRACE", 0.2), self.when_heard(hang):
            self.assertEqual(bpy.ops.xrds.render(), {"CANCELLED"})
        self.assertIn("Cancelled", operators.last)
        self.assertEqual(self.exrs(), [])
        self.render()

    def test_a_frame_that_nobody_waits_for(self):
        """As after undo: the next one is not kept waiting."""
        for hung in (False, True):
            job = jobs.Job(self.large())
            steps = job.steps()
            for step in steps:
                step.start() if isinstance(step, upscaler.Upscaling) else step.wait()
                if isinstance(step, upscaler.Upscaling):
                    break
            pid = upscaler.current.pid
            if hung:
                os.kill(pid, signal.SIGSTOP)
            steps.close()
            self.assertEqual(self.exrs(), [])
            self.render()
            os.remove(os.path.join(self.folder, self.exrs()[0]))
            self.assertTrue(upscaler.current.pid != pid or not hung)
            if hung:
                with contextlib.suppress(ProcessLookupError):  # ended by force already where the renders took long
                    os.kill(pid, signal.SIGCONT)
                self.assertTrue(self.gone(pid))

    def test_it_says_a_lot_and_hears_the_environment(self):
        upscaler.end()
        self.open("layers")
        with mock.patch.dict(os.environ, VK_LOADER_DEBUG="all"):
            self.render()
        with open(upscaler.current._log) as file:
            self.assertGreater(len(file.read()), 1000)
        upscaler.end()

    def test_without_a_python(self):
        for path, sentence in (("", "Python of this Blender.*is missing"), ("/nowhere/python3", "is missing in .*Install Blender again"),
                               (os.path.join(self.folder, "python3"), "cannot be started by .*python3: Permission denied"), (shutil.which("false"), r"ended by itself \(code 1\)")):
            upscaler.end()
            self.open("cryptomatte")
            open(os.path.join(self.folder, "python3"), "w").close()
            with self.subTest(path), mock.patch.object(sys, "executable", path), mock.patch.object(sys, "prefix", self.folder):
                self.assertEqual(bool(checks.problem(bpy.context.scene)), "missing" in sentence)
                with self.assertRaisesRegex(RuntimeError, sentence):
                    bpy.ops.xrds.render()
        self.render()

    def test_another_python_that_comes_first_is_not_taken(self):
        upscaler.end()
        self.open("cryptomatte")
        with mock.patch.object(sys, "executable", shutil.which("false")):
            self.render()
