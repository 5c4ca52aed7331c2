"""When a chapter opens a window, and that it otherwise leaves displays alone. tests/viewer looks inside the window."""

import os
import shutil
import socketserver
import struct
import subprocess
import threading
import time
import unittest

from image_files import Exr
from program import BINARIES, CHAPTER, FAULT_LAYER, PROJECT, ProgramTest, open_terminal

WITH_DISPLAY = PROJECT / "tests/support/with_display.sh"
GUARD_EXIT_CODE = 77  # of tests/faults/glfw_guard.cpp
GUARD = {"LD_PRELOAD": str(BINARIES.parent / "layers" / "libglfw_guard.so"), "ASAN_OPTIONS": "verify_asan_link_order=0"}
NO_DISPLAY = {"DISPLAY": None, "WAYLAND_DISPLAY": None}
SOME_DISPLAY = {"DISPLAY": ":4711", "WAYLAND_DISPLAY": None}
RENDER = ["quad.json", "--width=8", "--height=8", "--samples=1"]


class PoorCompositor(socketserver.BaseRequestHandler):
    """A Wayland compositor without a seat: it offers nothing at all, and only reports when it has finished saying so."""

    def handle(self):
        while header := self.request.recv(8):
            receiver, request, size = struct.unpack("=IHH", header)
            arguments = self.request.recv(size - 8)
            if (receiver, request) == (1, 0):  # wl_display.sync, to be answered by wl_callback.done
                self.request.sendall(struct.pack("=4sHHI", arguments, 0, 12, 0))


class Windows(ProgramTest):
    def run_at_terminal(self, *arguments, environment):
        """Exit code and output of a run whose standard output is a terminal, as for someone typing the command."""
        ours, theirs = open_terminal()
        variables = {**os.environ, **environment}
        process = subprocess.Popen(
            [CHAPTER, *arguments],
            cwd=self.folder,
            stdin=subprocess.DEVNULL,
            stdout=theirs,
            stderr=subprocess.PIPE,
            text=True,
            env={name: value for name, value in variables.items() if value is not None},
        )
        os.close(theirs)
        _, err = process.communicate(timeout=300)
        os.close(ours)
        return process.returncode, err

    def test_headless_never_touches_glfw(self):
        for display in (NO_DISPLAY, SOME_DISPLAY):
            code, err = self.run_at_terminal(*RENDER, "--headless", environment={**GUARD, **display})
            self.assertEqual(code, 0, err)

    def test_a_display_and_a_terminal_open_a_window(self):
        code, err = self.run_at_terminal(*RENDER, environment={**GUARD, **SOME_DISPLAY})
        self.assertEqual(code, GUARD_EXIT_CODE, err)

    def test_scripts_and_measurements_open_none(self):
        code, _, err = self.run_program(*RENDER, environment={**GUARD, **SOME_DISPLAY})
        self.assertEqual(code, 0, err)
        for option in ("--report=r.json", "--time-limit=9", "--target-error=1", "--save-every=9", "--quiet"):
            with self.subTest(option=option):
                code, err = self.run_at_terminal(*RENDER, option, environment={**GUARD, **SOME_DISPLAY})
                self.assertEqual(code, 0, err)

    def test_a_display_that_does_not_answer_is_no_obstacle(self):
        code, err = self.run_at_terminal(*RENDER, environment=SOME_DISPLAY)
        self.assertEqual(code, 0, err)
        self.assertRegex(err, r"note: no window can be opened .*--headless")
        self.assertTrue((self.folder / "output" / "01_uniform_sampling.exr").exists())

    def test_a_window_without_a_display_is_refused(self):
        self.assert_refused([*RENDER, "--window"], "display", "--headless", environment=NO_DISPLAY)
        self.assert_refused([*RENDER, "--window"], "no window", "--headless", environment=SOME_DISPLAY)

    def test_a_window_needs_wayland_to_be_there(self):
        """A session's variables persist where its compositor is out of reach."""
        for folder in (None, self.folder):
            environment = {"DISPLAY": None, "WAYLAND_DISPLAY": "nothing-0", "XDG_RUNTIME_DIR": folder}
            self.assert_refused([*RENDER, "--window"], "no display", "--headless", environment=environment)

    def test_a_compositor_without_a_seat_is_no_obstacle(self):
        """GLFW 3.4 crashes on it."""
        environment = {"DISPLAY": None, "WAYLAND_DISPLAY": "poor-0", "XDG_RUNTIME_DIR": str(self.folder)}
        server = socketserver.ThreadingUnixStreamServer(str(self.folder / "poor-0"), PoorCompositor)
        self.addCleanup(server.server_close)
        threading.Thread(target=server.serve_forever).start()
        self.addCleanup(server.shutdown)
        self.assert_refused([*RENDER, "--window"], "no window", "--headless", environment=environment)
        code, err = self.run_at_terminal(*RENDER, environment=environment)
        self.assertEqual(code, 0, err)
        self.assertRegex(err, r"\Anote: no window can be opened [^\n]*--headless\n\Z")

    @unittest.skipUnless(shutil.which("Xvfb"), "xvfb is not installed")
    def test_tests_leave_the_desktop_alone(self):
        out = self.render(
            "sh", "-c", "echo $DISPLAY $WAYLAND_DISPLAY", program=WITH_DISPLAY, environment={"WAYLAND_DISPLAY": "wayland-0"}
        )
        self.assertRegex(out, r"\A:\d+\n\Z")

    @unittest.skipUnless(shutil.which("Xvfb"), "xvfb is not installed")
    def test_a_lost_device_leaves_what_was_read_last(self):
        fault = {**FAULT_LAYER, "FAULT_LOSE_DEVICE_AFTER": "300"}
        command = [CHAPTER, "cornell_box", "--width=32", "--height=32", "--backend=compute", "--window", "--output=a.exr"]
        code, _, err = self.run_program(*command, program=WITH_DISPLAY, environment={**NO_DISPLAY, **fault})
        self.assertEqual(code, 3, err)
        self.assertRegex(err, r"\Aerror: [^\n]*the outputs hold \d+ samples a pixel; --resume continues\n\Z")
        left = Exr(self.folder / "a.exr")
        self.assertIn(left.text("samples"), err)
        # The cost of the samples so far counts when the render continues.
        self.assertGreater(float(left.text("seconds")), 0)
        self.assertGreaterEqual(int(left.text("rays")), 32 * 32 * int(left.text("samples")))

    @unittest.skipUnless(shutil.which("Xvfb"), "xvfb is not installed")
    def test_a_lost_device_and_a_folder_that_vanished(self):
        """The exit code reports what happened first."""
        folder = self.folder / "folder"
        command = [CHAPTER, "cornell_box", "--width=32", "--height=32", "--backend=compute", "--window", "--output=folder/a.exr"]
        environment = {**NO_DISPLAY, **FAULT_LAYER, "FAULT_LOSE_DEVICE_AFTER": "300"}
        with self.start(*command, program=WITH_DISPLAY, environment=environment) as process:
            self.wait_for(folder, process)
            time.sleep(0.5)  # the program still checks that it can write there
            while folder.exists():
                shutil.rmtree(folder, ignore_errors=True)
            _, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 3, err)
        self.assertRegex(err, r"\Aerror: [^\n]*Lost[^\n]*a\.exr: cannot be written[^\n]*\n\Z")

    def test_a_window_does_not_go_with_everything(self):
        for option in ("--headless", "--report=r.json", "--time-limit=9", "--target-error=1", "--save-every=9"):
            self.assert_refused([*RENDER, "--window", option], "--window", environment=NO_DISPLAY)
