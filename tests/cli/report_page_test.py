"""./lab report from command to page: what it writes, how it continues, what it refuses."""

import json
import re
import sys
import time
import unittest

from program import BINARIES, PROJECT, TOOLS, ProgramTest  # first: it finds the tools
from project import CHAPTERS, UserError
from report import measurement, plots

REFERENCE = PROJECT / "assets/references/cornell_box_1.exr"
# The command, with the test's own folder for references.
COMMAND = """import sys
sys.path.insert(0, sys.argv.pop(1))
from pathlib import Path
import project
from references import images
images.FOLDERS.append(Path(sys.argv.pop(1)))
from report import make
project.run_tool(make)"""
# A chapter that loses its device at seed 2 as long as the file `broken` exists.
LOSES_DEVICE = """#!/bin/sh
case " $* " in *" --seed 2 "*) if [ -e '{broken}' ]; then echo 'error: the device is gone' >&2; exit 3; fi ;; esac
exec '{program}' "$@"
"""
SMALL = ["--seconds=0.1", "--backend=compute", "--output=report"]


class Reports:
    """Helpers that make a report."""

    def start_report(self, *arguments, environment=None):
        return self.start("-B", "-c", COMMAND, TOOLS, self.folder, *arguments, program=sys.executable, environment=environment)

    def report(self, *arguments, code=0, environment=None):
        """Standard error of a run to the end."""
        with self.start_report(*arguments, environment=environment) as process:
            _, err = process.communicate(timeout=240)
        self.assertEqual(process.returncode, code, err)
        return err

    def record(self):
        return json.loads((self.folder / "report/record.json").read_text())

    def runs(self):
        return {case["case"]: case["runs"] for case in self.record()["cases"]}

    def assert_report_refused(self, arguments, *words, environment=None):
        arguments = ["-B", "-c", COMMAND, TOOLS, self.folder, *arguments]
        self.assert_refused(arguments, *words, program=sys.executable, environment=environment)


class ReportCommandTest(Reports, ProgramTest):
    def changed_reference(self, name, old, new):
        """A copy of a reference in which bytes are replaced by equally many others."""
        contents = REFERENCE.read_bytes()
        self.assertEqual(contents.count(old), 1)
        self.write(name, contents.replace(old, new))

    def test_device_loss_keeps_what_was_measured_and_the_page_is_whole(self):
        """Two chapters, the second of which loses the device halfway; then the command continues."""
        arguments = ["cornell_box_1", "1", "3", "--repetitions=2", *SMALL]
        binaries = self.folder / "binaries"
        binaries.mkdir()
        (binaries / "01_uniform_sampling").symlink_to(BINARIES / "01_uniform_sampling")
        program = self.write(
            "binaries/03_next_event_estimation",
            LOSES_DEVICE.format(broken=self.write("broken", ""), program=BINARIES / "03_next_event_estimation"),
        )
        program.chmod(0o755)
        environment = {"LAB_BINARIES": str(binaries)}

        err = self.report(*arguments, code=1, environment=environment)
        self.assertRegex(err.splitlines()[-1], "cornell_box_1, chapter 3: the device was lost: the device is gone")
        self.assertIn("Interrupted after 3 of 4 runs", (self.folder / "report/index.html").read_text())
        before = self.runs()
        self.assertEqual({case: len(runs) for case, runs in before.items()}, {"chapter 1": 2, "chapter 3": 1})

        (self.folder / "broken").unlink()
        self.assertIn("goes on after 3 runs", self.report(*arguments, environment=environment))
        after = self.runs()
        self.assertEqual(after["chapter 1"], before["chapter 1"])
        self.assertEqual(after["chapter 3"][:1], before["chapter 3"])
        self.assertEqual([run["seed"] for run in after["chapter 3"]], [1, 2])
        self.assert_page_is_whole()

    def assert_page_is_whole(self):
        page = (self.folder / "report/index.html").read_text()
        self.assertNotIn("Interrupted", page)
        for address in re.findall(r"""(?:src|href)\s*=\s*["']([^"']*)|url\(([^)]*)\)""", page):
            self.assertRegex("".join(address), r"^['\"]?(#|data:)", "refers to something outside")
        self.assertNotRegex(page, r"@import|<script|<link|<iframe")
        for word in (
            "cornell_box_1",
            "chapter 1",
            "chapter 3",
            "would have been found",
            "below 1 is better",
            "Equal time",
            "Equal error",
            "<svg",
        ):
            self.assertIn(word, page)
        self.assertEqual(page.count("<img"), 2 * (1 + 2 * 2))  # at equal time and error the reference, pictures, differences
        content = json.loads((self.folder / "report/report.json").read_text())
        self.assertEqual([case["case"] for case in content["scenes"][0]["cases"]], ["chapter 1", "chapter 3"])
        self.assertLess(content["scenes"][0]["cases"][1]["error_time"][0], 1 / 3)
        self.assertNotRegex(page, "(?i)efficien")
        self.assertIn("device", content["environment"])

    def test_scenes_that_a_chapter_refuses_are_listed(self):
        self.report("glass", "1", "6", *SMALL, "--repetitions=1")
        content = json.loads((self.folder / "report/report.json").read_text())
        self.assertEqual([case["case"] for case in content["scenes"][0]["cases"]], ["chapter 6"])
        self.assertRegex((self.folder / "report/index.html").read_text(), "chapter 1 does not render it: .* dielectric")

    def test_references_that_do_not_fit_are_refused(self):
        self.changed_reference("stale.exr", b"4102f97faa8e9116", b"4102f97faa8e9117")
        self.changed_reference("small.exr", b"width\0string\0\3\0\0\x00128", b"width\0string\0\3\0\0\x00127")
        self.changed_reference("nameless.exr", b"max_path_length\0", b"max_path_lengths\0"[1:])
        self.write("damaged.exr", REFERENCE.read_bytes()[:20000])
        self.assert_report_refused(["small", *SMALL], r"small\.exr", "128 x 128", "127 x 128")
        self.assert_report_refused(["nameless", *SMALL], r"nameless\.exr", "max_path_length", "lab reference")
        self.assert_report_refused(["damaged", *SMALL], r"damaged\.exr", "cannot be read as a reference")
        err = self.report("stale", "1", *SMALL, code=1)
        self.assertRegex(err.splitlines()[-1], r"stale\.exr: is of another version of .*cornell_box\.json: .*lab reference")

    def test_words_without_meaning_are_refused(self):
        self.assert_report_refused(["no_such_scene"], "no_such_scene", "one of .*cornell_box")
        self.assert_report_refused(["quad.json"], "quad.json", "lab reference")
        self.assert_report_refused(["missing.json"], "missing.json", "no such file")
        self.assert_report_refused(["cornell_box", "99"], "no chapter 99")
        self.assert_report_refused(["--seconds=0"], "seconds", "--help")

    def test_a_case_sets_its_variables(self):
        (case,) = measurement.report_cases([(PROJECT / "assets/scenes/cornell_box.json", REFERENCE)], [1])
        case["variables"] = ["VK_DRIVER_FILES=/nowhere", "VK_ICD_FILENAMES=/nowhere"]
        with self.assertRaisesRegex(UserError, "cornell_box_1, chapter 1: .*Vulkan"):
            measurement.run_case(case, {"backend": "compute", "device": None}, ["--samples", 1, "--seed", 1])


class LongReports_all(Reports, ProgramTest):
    def test_an_interrupted_report_goes_on_and_a_complete_one_starts_anew(self):
        arguments = ["cornell_box_1", "2", *SMALL, "--repetitions=5"]
        with self.start_report(*arguments) as process:
            self.wait_for_runs(process, 1)
            process.kill()
        first = self.runs()["chapter 2"]
        with self.start_report(*arguments) as process:
            self.wait_for_runs(process, len(first) + 1)
            process.terminate()
            _, err = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 1)
        self.assertIn("interrupted: the same command goes on", err)
        self.assertNotIn("Traceback", err)
        second = self.runs()["chapter 2"]
        self.assertEqual(second[: len(first)], first)
        self.report(*arguments)
        third = self.runs()["chapter 2"]
        self.assertEqual(third[: len(second)], second)
        self.assertEqual([run["seed"] for run in third], [1, 2, 3, 4, 5])
        self.assertEqual(len({run["rows"][-1]["samples"] for run in third}), 1)
        self.assertTrue(self.record()["is_complete"])
        self.assertNotIn("goes on after", self.report("cornell_box_1", "2", *SMALL, "--repetitions=1"))
        self.assertEqual(len(self.runs()["chapter 2"]), 1)

    def wait_for_runs(self, process, count):
        end = time.monotonic() + 60
        while not (self.folder / "report/record.json").exists() or len(self.runs()["chapter 2"]) < count:
            self.assertIsNone(process.poll(), "ended too early")
            self.assertLess(time.monotonic(), end, "took too long")
            time.sleep(0.01)

    def test_large_pictures_are_compared_with_small_references(self):
        """As far from the reference as small ones with the same total number of samples."""
        pairs, settings, found = (
            [(PROJECT / "assets/scenes/cornell_box.json", REFERENCE)],
            {"backend": "compute", "device": None},
            [],
        )
        for is_large, samples in ((False, 64), (True, 1)):
            (case,) = measurement.report_cases(pairs, [3], is_large=is_large)
            self.assertEqual((case["width"], case["scale"]), (1024, 8) if is_large else (128, 1))
            found.append(measurement.run_case(case, settings, ["--samples", samples, "--seed", 1])["rows"][-1]["rel_mse"])
        self.assertTrue(0.4 < found[1] / found[0] < 1.2, found)


class StyleTest(unittest.TestCase):
    def test_no_two_chapters_look_alike(self):
        styles = [plots.style({"is_peer": False}, index, 0) for index in range(2 * len(CHAPTERS))]
        self.assertEqual(len({(style["color"], style["marker"]) for style in styles}), len(styles))
