"""SwiftShader, Chromium's Vulkan driver for the CPU, shares no code with Mesa's: a second opinion on every machine."""

import os
import re
import unittest

from tools_path import PROJECT  # first: it finds the others
import numpy as np
from program import BINARIES, RenderTest

PLACES = [
    os.environ.get("LAB_SWIFTSHADER", ""),
    "/usr/lib/chromium/vk_swiftshader_icd.json",
    "/usr/lib64/chromium-browser/vk_swiftshader_icd.json",
    "/opt/google/chrome/vk_swiftshader_icd.json",
]
DRIVER = next(filter(os.path.isfile, PLACES), "")
SWIFTSHADER = {"VK_DRIVER_FILES": DRIVER, "VK_ICD_FILENAMES": DRIVER}
CHAPTERS = sorted(path.name for path in (PROJECT / "chapters").glob("[0-9]*"))
MANY_LIGHTS = next(chapter for chapter in CHAPTERS if chapter.endswith("many_lights"))
SCENES = sorted(path.stem for path in (PROJECT / "assets/scenes").glob("*.json"))

# A path that goes another way nearly always differs by more than a tenth. Few may; most of them hit glass or textures. Where two lamps
# are as likely, rounding decides which one comes first in the light tree: probabilities that differ by 1e-7 turn 15 % of the paths in
# check_room, so with the tree only the means tell.
OTHER_WAY, MOST_OTHER_WAYS = 0.1, 0.005
LONGEST_PATH = 8  # rounding errors of many collisions add up
# Allowed difference of the means of all others: the error of its sines and cosines.
SINE_ERROR = 2e-4


def setUpModule():
    if not DRIVER:
        raise unittest.SkipTest("SwiftShader is missing: Debian's package chromium has it, or LAB_SWIFTSHADER names its .json")


class SwiftShader_all(RenderTest):
    def paths(self, device, chapter, scene, *options, environment=None):
        """The radiance of one path in each pixel."""
        program = BINARIES / chapter
        picture = self.picture(
            device,
            "--samples=1",
            f"--device={device}",
            f"--max-path-length={LONGEST_PATH}",
            *options,
            scene=scene,
            size=(96, 96),
            program=program,
            environment=environment,
        )
        self.assertEqual(picture.text("invalid_samples"), "0")
        return np.array(picture.pixels()).reshape(3, -1)

    def test_paths_are_those_of_mesas_driver(self):
        cases = [(chapter, "cornell_box") for chapter in CHAPTERS]
        cases += [(MANY_LIGHTS, scene, f"--light-choice={choice}") for scene in SCENES for choice in ("power", "tree")]
        for case in cases:
            with self.subTest(case):
                expected = self.paths("llvmpipe", *case)
                actual = self.paths("SwiftShader", *case, environment=SWIFTSHADER)
                differences = actual - expected
                limits = OTHER_WAY * np.maximum(expected, actual) + 1e-6 * expected.mean()
                if "--light-choice=tree" not in case:
                    self.assertLess(np.any(abs(differences) > limits, axis=0).mean(), MOST_OTHER_WAYS)
                # A path that goes another way is as likely to gain as to lose: allow five standard deviations of the sum.
                deviation = np.sqrt((differences.sum(axis=0) ** 2).sum())
                self.assertLess(abs(differences.sum()), 5 * deviation + SINE_ERROR * expected.sum())

    def test_shaders_and_hard_cases_on_it(self):
        """Only its backend's tests: others are skipped. Slow ones are left to the first driver. `native` has the CPU's own arithmetic:
        there parity would compare the drivers, as the test above does."""
        for program, least in (("shaders_tests", 100), ("parity_tests", 10), ("hard_cases_tests", 50)):
            with self.subTest(program=program):
                code, out, _ = self.run_program(
                    "--gtest_filter=-*_all:*_all/*:*/native", program=BINARIES / program, environment=SWIFTSHADER, timeout=1200
                )
                self.assertEqual(code, 0, out)
                self.assertGreater(int(re.search(r"\[  PASSED  \] (\d+) tests", out).group(1)), least)

    def test_it_has_no_ray_tracing(self):
        for backend in ("pipeline", "query"):
            arguments = ["cornell_box", "--quiet", f"--backend={backend}"]
            self.assert_refused(arguments, "lacks VK_KHR", "these work on it: compute", code=2, environment=SWIFTSHADER)
