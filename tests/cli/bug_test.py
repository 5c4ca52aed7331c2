"""./lab bug: the gallery does not give names away, every bug can be planted, and its effect shows."""

import re
import unittest
from unittest import mock

from program import PROJECT, UNOPTIMISED, ProgramTest  # first: it finds the tools
import cited_tests
import mistake
import project
from PIL import Image
from course import bug, mistakes
from project import CHAPTERS, UserError

# A chapter that stores its arguments and its shader instead of rendering.
NOTING = """#!/bin/sh
echo "$@" >'{folder}/arguments'
for word; do case $word in *.glsl=*) echo "${{word%%=*}}" >'{folder}/place'; cp "${{word#*=}}" '{folder}/shader' ;; esac; done
"""


def index_of(chapter, name):
    return 1 + [found.mistake["name"] for found in mistakes.bugs_of(chapter)].index(name)


class PlantedMistakesTest(unittest.TestCase):
    """The mistakes themselves run with --all; whether the code still has their places is seen at once."""

    def test_shaders_have_the_places_of_all_mistakes(self):
        for planted in mistake.load().values():
            mistakes.plant(
                (PROJECT / planted["file"]).read_text(encoding="utf-8"), planted["find"], planted["replace"], planted["name"]
            )


class Bugs:
    def bug(self, *arguments):
        """Standard output of ./lab bug, run in this process."""
        code, out, err = self.run_here(bug.main, *arguments)
        self.assertEqual(code, 0, err)
        return out


class BugTest(Bugs, ProgramTest):
    def test_lists_questions_and_no_name(self):
        for chapter in CHAPTERS:
            out, bugs = self.bug(chapter), mistakes.bugs_of(chapter)
            self.assertEqual(out.splitlines()[:-1], [f"{index:3}  {found.question}" for index, found in enumerate(bugs, 1)])
            for found in bugs:
                self.assertNotIn(found.mistake["name"], out)
                self.assertNotIn(found.mistake["explanation"], out)

    def test_each_bug_changes_the_chapters_shader_and_no_two_alike(self):
        for chapter in CHAPTERS:
            texts = [found.text for found in mistakes.bugs_of(chapter)]
            self.assertGreaterEqual(len(texts), 5, chapter)
            self.assertEqual(len({mistakes.own_shader(chapter).read_text(encoding="utf-8"), *texts}), 1 + len(texts))

    def test_a_place_that_is_gone_is_told(self):
        moved = {"name": "moved", "find": "no such line", "replace": ""}
        with mock.patch.object(mistakes, "read_json", return_value=[moved]), self.assertRaisesRegex(
            mistakes.Stale, "moved in chapters/03"
        ):
            mistakes.bugs_of(3)

    def test_every_answer_names_what_catches_the_bug(self):
        known, catalogue = cited_tests.written_tests(), mistakes.catalogue()
        for chapter in CHAPTERS:
            checked = {found.mistake["name"] for found in catalogue if found.chapter == chapter}
            for found in mistakes.bugs_of(chapter):
                test, command = bug.caught_by(found)
                if "sanitizer" in found.mistake:
                    self.assertEqual(
                        (test, command), (None, f"./lab bug {chapter} {index_of(chapter, found.mistake['name'])} --sanitize")
                    )
                elif test:
                    self.assertIn(re.fullmatch(r"\w+\.(?:\w+/)?(\w+)\.(\w+)(?:/\w+)?", test).groups(), known)
                    self.assertEqual(command, f"./lab test -R mistakes.{found.mistake['name']}")
                else:
                    self.assertEqual(command, f"./lab check {chapter}")
                    self.assertIn(found.mistake["name"], checked)

    def test_the_answer_shows_the_lines(self):
        code, out, err = self.run_tool("bug", 3, index_of(3, "distance-not-squared"), "--answer")
        self.assertEqual(code, 0, err)
        self.assertIn("1/r", out)
        self.assertIn("\ncaught by convergence.", out)
        self.assertRegex(out, r"\n- .*\(distance \* distance\);\n\+ .*distance;\n")

    def test_a_render_shows_right_wrong_and_difference(self):
        index = index_of(3, "wrong-measure")
        out = self.bug(3, index, "--samples", 4, "--scene", "check_room_2", "--backend", "compute")
        self.assertRegex(out, r"verdict +biased: red \+\d")
        self.assertIn(mistakes.bugs_of(3)[index - 1].question, out)
        self.assertNotIn("wrong-measure", out)
        picture = Image.open(PROJECT / f"output/bug_3_{index}.png").convert("RGB")
        self.assertGreater(picture.width, 3 * 256)
        right, wrong, difference = (picture.crop((i * 260 + 4, 40, i * 260 + 260, 270)) for i in range(3))
        light = [sum(part.convert("L").getdata()) for part in (right, wrong)]
        self.assertGreater(light[1], 1.2 * light[0])
        red, _, blue = (sum(channel.getdata()) for channel in difference.split())
        self.assertGreater(red, 1.2 * blue)  # too bright

    def test_noise_is_no_bias(self):
        with mock.patch.dict("os.environ", UNOPTIMISED):
            out = self.bug(4, index_of(4, "identical-branches"), "--samples", 4, "--scene", "textured_4", "--backend", "compute")
        self.assertRegex(out, r"verdict +noisy: \d[\d.]* times")

    def test_a_scene_without_reference_is_compared_with_the_right_picture(self):
        verdicts = {}
        for name in ("missing-cosine", "sine-forgotten", "same-number-twice"):
            out = self.bug(1, index_of(1, name), "--samples", 8, "--scene", "furnace", "--backend", "compute")
            word, red = re.search(r"verdict +(\w+).* red ([+-][\d.]+).* against the right picture", out).groups()
            verdicts[name] = word, float(red)
        # In a furnace either of the first two doubles the contribution of each bounce, and directions do not matter.
        (cosine, too_much), (sine, as_much), (directions, little) = verdicts.values()
        self.assertEqual((cosine, sine, directions), ("biased", "biased", "nothing"))
        self.assertGreater(too_much, 100)
        self.assertAlmostEqual(as_much / too_much, 1, delta=0.1)
        self.assertLess(abs(little), 5)

    def test_the_window_has_the_broken_shader(self):
        chapter = CHAPTERS[3]
        program = self.write(f"binaries/{chapter}", NOTING.format(folder=self.folder))
        program.chmod(0o755)
        with mock.patch.object(project, "BINARIES", program.parent):
            self.bug(3, 1, "--window", "--scene", "check_room_2")
        arguments = (self.folder / "arguments").read_text()
        self.assertRegex(arguments, r"check_room\.json --window --shader [^ ]+ --max-path-length 2 ")
        self.assertEqual(
            (self.folder / "place").read_text(), str(mistakes.bugs_of(3)[0].file.relative_to(PROJECT / "chapters")) + "\n"
        )
        self.assertEqual((self.folder / "shader").read_text(encoding="utf-8"), mistakes.bugs_of(3)[0].text)

    def test_what_there_is_not_is_refused(self):
        self.assert_tool_refused(["bug"], "N")
        self.assert_tool_refused(["bug", 99], "no chapter 99")
        self.assert_tool_refused(["bug", 3, 999], "bugs 1 to", "lists them")
        self.assert_tool_refused(["bug", 3, 0], "number from 1")
        self.assert_tool_refused(["bug", 3, 1, "--scene", "nothing"], "nothing: no such scene", "one of caustics, .*cornell_box")

    def test_a_chapter_without_bugs_says_so(self):
        with mock.patch.object(bug, "bugs_of", return_value=[]), self.assertRaisesRegex(UserError, "chapter 1 has no bugs"):
            self.bug(1)


class SanitizedBug_all(Bugs, ProgramTest):
    def test_what_no_picture_shows_a_sanitizer_finds(self):
        """As docs/debugging.md says."""
        if not re.search(r"native +works", self.render("--list-devices")):
            self.skipTest("no device has the backend native")
        page = (PROJECT / "docs/debugging.md").read_text(encoding="utf-8")
        chapter, index, finding = re.search(
            r"^    \./lab bug (\d+) (\d+) --sanitize\n\n```text\n(.*)\n```$", page, re.MULTILINE
        ).groups()
        self.assertEqual(int(index), index_of(int(chapter), "one-entry-too-far"))
        code, out, err = self.run_tool("bug", chapter, index, "--sanitize")
        self.assertEqual(code, 0, err)
        self.assertIn(finding, out)
        out = self.bug(chapter, index, "--samples", 4, "--scene", "microfacets_5", "--backend", "compute")
        self.assertRegex(out, r"verdict +nothing shows")
