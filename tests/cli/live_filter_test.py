"""The filters of chapter 16 on its page: they make the pictures of the program, of what a reader writes, too, and can be turned off."""

import subprocess
import tempfile
import unittest
from pathlib import Path

from live_pages_test import LivePages  # first: it finds the others
import numpy as np
from image_files import Exr
from live_light_paths_test import SAMPLES, SIZE, TINY
from program import BINARIES
from project import text_of
from tools_path import PROJECT

FILTERS = ["none", "bilateral", "a_trous", "nl_means"]
FILTER = "chapters/16_denoising/filter.glsl"
# Relative. Chromium's sine is coarser, so that one pixel of 200 has another path, and with a filter its neighbours differ a little, too.
ROUNDING, SAME, FEW = 1e-4, 1e-2, 0.02
SHARPNESS = "SHARPNESS = 0.45;"
LOOP = "for (int x = -PATCH; x <= PATCH; ++x)"


class LiveFilter_all(LivePages, unittest.TestCase):
    def start_tiny(self):
        self.start(16, before=TINY)

    def choose(self, name):
        self.frame(
            f"(frame.controls.choices[0].chosen.selectedIndex = {FILTERS.index(name)}, frame.film = null, void frame.restart())"
        )

    def assert_as_in_program(self, *options):
        self.wait(f"frame.film?.samples >= {SAMPLES}", "a picture")
        shown = np.array(self.frame("[...frame.film.sums]")) / SAMPLES
        with tempfile.TemporaryDirectory() as folder:
            image = Path(folder) / "filtered.exr"
            size = f"cornell_box --width {SIZE} --height {SIZE} --samples {SAMPLES} --max-path-length 6 --quiet --headless"
            subprocess.run(
                [BINARIES / "16_denoising", *size.split(), "--backend", "compute", *options, "--output", image], check=True
            )
            right = np.array(Exr(image).pixels()).reshape(3, -1).T.ravel()
        difference = np.abs(shown - right) / (right + 0.01)
        self.assertLess(np.median(difference), ROUNDING)
        self.assertLess((difference > SAME).mean(), FEW)
        return shown

    def test_they_make_the_pictures_of_the_program(self):
        self.start_tiny()
        for name in [*FILTERS[1:], "none"]:
            with self.subTest(filter=name):
                self.choose(name)
                self.assert_as_in_program("--filter", name)
                shows = None if name == "none" else "a filtered picture"
                self.assertEqual(self.frame("frame.controls.shownInstead ?? null"), shows)
        self.assert_no_complaints()

    def test_they_follow_the_camera_and_the_readers_text(self):
        self.start_tiny()
        self.end_pictures_after(4096)
        self.choose("nl_means")
        self.wait("frame.film?.samples >= 64", "a filtered picture")
        self.frame("(frame.picture.camera.move({ steps: [0.2, 0, 0] }), frame.film = null, frame.picture.moved())")
        self.wait("frame.film", "the picture from elsewhere, which has begun anew")
        self.frame(f"live.Picture.MOST_SAMPLES = {SAMPLES}")
        position, forward = self.frame("[frame.picture.camera.position, frame.picture.camera.forward]")
        camera = [
            f"--camera-position={','.join(map(repr, position))}",
            f"--camera-target={','.join(repr(p + f) for p, f in zip(position, forward))}",
        ]
        before = self.assert_as_in_program("--filter", "nl_means", *camera)
        self.edit(SHARPNESS, SHARPNESS.replace("0.45", "4.5"))
        with tempfile.NamedTemporaryFile("w", suffix=".glsl", encoding="utf-8") as file:
            file.write(text_of(PROJECT / FILTER).replace(SHARPNESS, SHARPNESS.replace("0.45", "4.5")))
            file.flush()
            self.frame("(frame.film = null, void frame.restart())")
            after = self.assert_as_in_program("--filter", "nl_means", *camera, "--shader", f"{Path(FILTER).name}={file.name}")
        self.assertGreater(np.abs(after - before).mean() / before.mean(), SAME)

    def test_errors_are_at_the_readers_line(self):
        self.start_tiny()
        self.choose("nl_means")
        for old, wrong, message in (
            (SHARPNESS, "SHARPNESS = vec2(0.45);", "dimension mismatch|cannot convert"),
            (SHARPNESS, "SHARPNESS = 0.45 +;", "syntax error"),
            (LOOP, LOOP.replace("++x", ""), "this loop does not end, or it takes more than 65,536 turns in a pixel"),
        ):
            text = text_of(PROJECT / FILTER)
            self.edit(old, wrong)
            line = 1 + text[: text.index(old)].count("\n")
            self.assertRegex(self.error(), rf"^{FILTER}:{line}: .*({message})")
            self.edit(wrong, old)
            self.wait("!frame.editor.error.textContent && frame.film?.samples >= 4", "the picture")
