"""./lab diff: how the shaders of neighbouring chapters differ, with counts of what changed."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from program import PROJECT as ROOT, open_terminal  # first: it finds the tools
import includes
from lesson import diff as show_diff

STEPS = show_diff.BEFORE


def diff(*arguments, **streams):
    return subprocess.run([ROOT / "lab", "diff", *map(str, arguments)], text=True, **streams)


class DiffTest(unittest.TestCase):
    def lesson_of(self, chapters):
        """What ./lab diff shows of the last of these chapters, given as folder -> file -> lines: rows of each of its files."""
        with tempfile.TemporaryDirectory() as folder:
            for name, files in chapters.items():
                for file, lines in files.items():
                    path = Path(folder) / "chapters" / name / file
                    path.parent.mkdir(parents=True, exist_ok=True)
                    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
            numbers = dict(enumerate(chapters, 1))
            before = dict(zip(list(numbers)[1:], numbers))
            (Path(folder) / "shaders").mkdir()
            (Path(folder) / "shaders/replaceable.json").write_text('["points.glsl"]', encoding="utf-8")
            with mock.patch.multiple(show_diff, ROOT=Path(folder).resolve(), CHAPTERS=numbers, BEFORE=before), mock.patch.object(
                includes, "ROOT", Path(folder).resolve()
            ):
                return {
                    files[1]: show_diff.compare(*map(show_diff.shader_lines, files))[0]
                    for files in show_diff.lesson(len(chapters))
                }

    def test_nobody_needs_to_read_to_the_end(self):
        """As in ./lab diff all | head."""
        with subprocess.Popen(
            [ROOT / "lab", "diff", "all"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        ) as process:
            process.stdout.close()
            self.assertEqual(process.stderr.read(), "")

    def test_rows_are_the_two_shaders(self):
        for number in STEPS:
            for files in show_diff.lesson(number):
                before, after = map(show_diff.shader_lines, files)
                rows, _ = show_diff.compare(before, after)
                self.assertEqual([line for mark, line, _ in rows if mark != "-"], after)
                self.assertEqual([line for mark, line, _ in rows if mark != "+"], before)

    def test_a_lesson_is_all_shaders_of_a_folder(self):
        """A technique is shown in full. Of an estimator that includes another chapter's, only its own lines are new."""
        estimator = ["vec3 path_trace(Ray ray) {", "    return vec3(0.0);", "}"]
        own = ['#include "points.glsl"', '#include "../01_first/path_trace.glsl"']
        chapters = {
            "01_first": {"path_trace.glsl": estimator},
            "02_second": {"path_trace.glsl": own, "points.glsl": ["float x;"]},
        }
        shown = self.lesson_of(chapters)
        self.assertEqual(list(shown), ["chapters/02_second/path_trace.glsl", "chapters/02_second/points.glsl"])
        self.assertEqual(self.changed(shown["chapters/02_second/path_trace.glsl"]), [("+", line) for line in own])
        self.assertEqual(shown["chapters/02_second/points.glsl"], [("+", "float x;", None)])
        # A chapter that follows one which only includes is compared with the included text, even if named by its folder alone.
        chapters["03_third"] = {
            "path_trace.glsl": own[:1] + ["", *estimator],
            "points.glsl": ['#include "02_second/points.glsl"'],
        }
        shown = self.lesson_of(chapters)
        self.assertEqual(self.changed(shown["chapters/03_third/path_trace.glsl"]), [("-", own[1]), ("+", "")])
        self.assertEqual(self.changed(shown["chapters/03_third/points.glsl"]), [("+", '#include "02_second/points.glsl"')])

    def test_a_file_is_compared_with_the_one_that_the_chapter_before_gets(self):
        """However many chapters lie between, as chapter.json says."""
        says = {"chapter.json": ['{"continues": "01_first"}']}
        included = {"path_trace.glsl": ['#include "01_first/path_trace.glsl"']}
        chapters = {
            "01_first": {"path_trace.glsl": ['#include "points.glsl"'], "points.glsl": ["float x;"]},
            "02_second": says | included,
            "03_third": {"chapter.json": ['{"continues": "02_second"}'], "points.glsl": ["float x;", "float y;"]} | included,
        }
        self.assertEqual(self.changed(self.lesson_of(chapters)["chapters/03_third/points.glsl"]), [("+", "float y;")])

    def test_a_loop_in_a_file_of_its_own_is_compared_as_part_of_the_estimator(self):
        loop = ["vec3 path_trace(Ray ray) {", "    return vec3(1.0);", "}"]
        chapters = {
            "01_first": {"path_trace.glsl": loop},
            "02_second": {"path_trace.glsl": ['#include "loop.glsl"'], "loop.glsl": loop},
        }
        (rows,) = self.lesson_of(chapters).values()
        self.assertEqual(self.changed(rows), [("+", '#include "loop.glsl"')])

    def changed(self, rows):
        return [(mark, line) for mark, line, _ in rows if mark != " "]

    def test_counts(self):
        before = ["// One.", "float a = 1.0;", "", "float b = 2.0;", "float c;"]
        after = ["// Two.", "float a = 1.5;", "", "float b = 2.0;  // still", "float d;", "float e;"]
        _, counts = show_diff.compare(before, after)
        self.assertEqual(counts, {"code": 4, "comments": 1, "words": 4})  # 1.5; d and a line with float and e
        self.assertEqual(show_diff.compare(before, before)[1], {"code": 0, "comments": 0, "words": 0})

    def test_is_plain_unless_on_a_terminal(self):
        plain = diff(5, stdout=subprocess.PIPE).stdout
        self.assertNotIn("\033", plain)
        self.assertIn("+             throughput /= survival_probability;\n", plain)
        leader, follower = open_terminal()
        self.assertEqual(diff(5, stdout=follower).returncode, 0)
        os.close(follower)
        self.assertIn(b"\033[32m", os.read(leader, 1 << 16))
        os.close(leader)

    def test_all_names_every_step(self):
        lines = diff("all", stdout=subprocess.PIPE).stdout.splitlines()
        self.assertEqual([line.split(":")[0] for line in lines], [f"Chapter {m} to {n}" for n, m in STEPS.items()])

    def test_other_words_are_refused(self):
        for word in ("1", "99", "", "two", "-3"):
            result = diff(word, capture_output=True)
            self.assertEqual(result.returncode, 1)
            self.assertRegex(result.stderr, r"\Aerror: [^\n]{20,}\n\Z")
