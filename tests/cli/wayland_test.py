"""The window on a Wayland desktop, by keys and mouse as a person uses them: ./lab test --all.

The desktop is Weston. It runs on a virtual display, which xdotool sends the input to and pictures are taken of.
"""

import ctypes.util
import os
import shutil
import subprocess
import tempfile
import time
import unittest

from image_files import Exr  # first: it finds the others
import numpy as np
from PIL import ImageGrab
from program import ProgramTest

NEEDED = ["Xvfb", "weston", "xdotool"]
# The window's colours are neither as blue as the desktop nor as red as a square in the middle of the picture.
SETTINGS = "[core]\nidle-time=0\n[shell]\nbackground-color=0xff0000ff\npanel-position=none\nlocking=false\n"
RED_SQUARE = "newmtl white\nKd 0 0 0\nKe 1 0 0\n"
COMMAND = ["quad.json", "--background=0,0,0", "--width=64", "--height=64", "--backend=compute", "--window", "--output=a.exr"]
TITLE_BAR = 24  # height in the desktop's units, and width of a button in it


def setUpModule():
    if missing := [name for name in NEEDED if not shutil.which(name)]:
        raise unittest.SkipTest(f"{missing[0]} is missing: apt-get install weston xdotool")
    # Before version 3.4 GLFW is compiled for a single window system, X11 in Debian.
    if not hasattr(ctypes.CDLL(ctypes.util.find_library("glfw")), "glfwPlatformSupported"):
        raise unittest.SkipTest("this GLFW knows no Wayland")


class Wayland_all(ProgramTest):
    def setUp(self):
        super().setUp()
        self.write("quad.mtl", RED_SQUARE)
        self.write("weston.ini", SETTINGS)
        runtime = tempfile.TemporaryDirectory()
        self.addCleanup(runtime.cleanup)
        server = subprocess.Popen(
            ["Xvfb", "-displayfd", "1", "-screen", "0", "2400x1800x24", "-nolisten", "tcp", "-noreset"],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self.end_at_last(server)
        self.x11 = {"DISPLAY": f":{server.stdout.readline().strip()}", "WAYLAND_DISPLAY": None, "XDG_RUNTIME_DIR": runtime.name}
        self.wayland = self.x11 | {"DISPLAY": None, "WAYLAND_DISPLAY": "desktop"}

    def end_at_last(self, process):
        self.addCleanup(process.communicate)
        self.addCleanup(process.terminate)

    def start_desktop(self, *arguments):
        self.end_at_last(
            self.start(
                f"--config={self.folder / 'weston.ini'}", "--socket=desktop", *arguments, program="weston", environment=self.x11
            )
        )
        self.wait_until("a desktop", lambda: os.path.exists(os.path.join(self.x11["XDG_RUNTIME_DIR"], "desktop")))

    def open_window(self, environment):
        process = self.start(*COMMAND, environment=environment)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        self.wait_until("a window", lambda: process.poll() is not None or self.square() is not None)
        self.assertIsNone(process.poll())
        return process

    def wait_until(self, what, is_so):
        end = time.monotonic() + 60
        while not is_so():
            self.assertLess(time.monotonic(), end, f"still not: {what}")
            time.sleep(0.1)

    def box(self, is_shown):
        """Left, top, right and bottom of the pixels whose colours match; None if there are none."""
        pixels = np.asarray(ImageGrab.grab(xdisplay=self.x11["DISPLAY"]))
        rows, columns = np.nonzero(is_shown(*np.moveaxis(pixels, -1, 0)))
        return np.array([columns.min(), rows.min(), columns.max(), rows.max()]) if rows.size else None

    def square(self):
        return self.box(lambda red, green, blue: (red == 255) & (green == 0) & (blue == 0))

    def window(self):
        return self.box(lambda red, green, blue: (red > 0) | (green > 0))

    def size(self):
        left, top, right, bottom = self.window()
        return np.array([right - left + 1, bottom - top + 1])

    def do(self, *words):
        """Input for the window, in xdotool's language."""
        variables = {name: value for name, value in self.x11.items() if value is not None}
        subprocess.run(["xdotool", *map(str, words)], env=os.environ | variables, check=True)

    def drag(self, begin, end):
        self.do(
            "mousemove",
            *begin,
            "sleep",
            0.3,
            "mousedown",
            1,
            "sleep",
            0.3,
            "mousemove",
            *(begin + end) // 2,
            "sleep",
            0.3,
            "mousemove",
            *end,
            "sleep",
            0.3,
            "mouseup",
            1,
        )

    def drag_window(self, corner, grip, way):
        """Drags it by a grip this far from the corner at this index of window(). A slow window does not follow all the way."""
        before = self.window()[corner : corner + 2]

        def drag_once_more():
            begin = self.window()[corner : corner + 2] + grip
            self.drag(begin, begin + way)
            self.do("mousemove", *self.window()[:2] + 100)  # off the desktop, so that only the window is on it
            return ((self.window()[corner : corner + 2] - before) / way > 0.3).all()

        self.wait_until(f"dragged by {way}", drag_once_more)

    def test_keys_mouse_resizing_and_closing(self):
        self.use_window(scale=1)

    def test_a_screen_of_twice_as_many_pixels(self):
        self.use_window(scale=2)

    def use_window(self, scale):
        self.start_desktop("--backend=x11", "--width=1200", "--height=900", f"--scale={scale}")
        process = self.open_window(self.wayland)
        self.do("mousemove", 600 * scale, 450 * scale)  # off the desktop, so that only the window is on it
        self.wait_until("a window with a title", lambda: list(self.size()) == [900 * scale, (700 + TITLE_BAR) * scale])

        before = self.square()
        self.do("keydown", "s")
        self.wait_until("farther away", lambda: np.ptp(self.square()[::2]) < 0.7 * np.ptp(before[::2]))
        self.do("keyup", "s")
        before = self.square()
        centre = (before[:2] + before[2:]) // 2
        self.drag(centre, centre + 50 * scale)
        self.wait_until("turned", lambda: (np.abs(self.square() - before) > 10 * scale).all())

        size, before = self.size(), self.square()
        self.drag_window(0, np.array([200, TITLE_BAR // 2]) * scale, np.array([-60, -30]) * scale)
        self.assertEqual(list(self.size()), list(size), "moved by its title")
        self.drag_window(2, np.array([4, 4]), np.array([-200, -200]) * scale)
        self.assertTrue((self.size() < size - 50 * scale).all(), "resized by its border")
        self.wait_until("a smaller picture", lambda: np.ptp(self.square()[::2]) < 0.95 * np.ptp(before[::2]))

        def close():
            if (window := self.window()) is not None:
                button = window[[2, 1]] + np.array([-TITLE_BAR, TITLE_BAR]) * scale // 2
                self.do("mousemove", *button, "sleep", 0.3, "click", 1, "sleep", 1)
            return process.poll() is not None

        self.wait_until("closed", close)
        _, err = process.communicate(timeout=300)
        self.assertEqual((process.returncode, err), (0, ""))
        self.assertGreater(Exr(self.folder / "a.exr").mean()[0], 0)

    def test_without_a_seat(self):
        """GLFW 3.4 crashes without a seat, but X11 may be available."""
        self.start_desktop("--backend=headless")
        self.assert_refused(COMMAND, "no window", "--headless", environment=self.wayland)
        self.open_window(self.x11 | {"WAYLAND_DISPLAY": "desktop"})
