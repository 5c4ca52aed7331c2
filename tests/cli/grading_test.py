"""docs/grading: the autograder scripts, in a folder laid out like the autograder's."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

from program import BINARIES, PROJECT, ProgramTest  # first: it finds the tools
from check import command
from check.formats import as_gradescope
from course.handout import exercise_of, take_out
from project import CHAPTERS

GRADING = PROJECT / "docs/grading"
SUBMITTED = "direct_light.glsl"  # what chapter 3's exercise asks for
# Gradescope's documentation of results.json: names and types in a test.
TEST_KEYS = {"name": str, "score": (int, float), "max_score": (int, float), "status": str, "output": str, "visibility": str}
# The check of a chapter that is already built.
LAB = """#!/bin/sh
shift
exec '{python}' '{tools}' check "$@" --runs 5 --samples 1 --backend compute
"""


class GradingTest(ProgramTest):
    def autograde(self, shader):
        """The autograder's result for a submission, a text or Name -> text."""
        for folder in ("source/lab", "submission"):
            (self.folder / folder).mkdir(parents=True, exist_ok=True)
        script = self.folder / "source/run_autograder"
        shutil.copy(GRADING / "gradescope/run_autograder", script)
        lab = self.write("source/lab/lab", LAB.format(python=sys.executable, tools=PROJECT / "tools"))
        lab.chmod(0o755)
        for name, text in (shader if isinstance(shader, dict) else {SUBMITTED: shader}).items():
            self.write(f"submission/{name}", text)
        environment = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
        environment |= {"AUTOGRADER": str(self.folder), "LAB_BINARIES": str(BINARIES)}
        subprocess.run([script], env=environment, check=True, capture_output=True, timeout=300)
        return json.loads((self.folder / "results/results.json").read_text(encoding="utf-8"))

    def test_gradescope_gets_points_and_a_question(self):
        chapter = int(re.search(r"^chapter=(\d+)", (GRADING / "gradescope/run_autograder").read_text(), re.MULTILINE)[1])
        shader = (PROJECT / "chapters" / CHAPTERS[chapter] / SUBMITTED).read_text(encoding="utf-8")
        untouched = take_out(shader, exercise_of(chapter))[0]
        for text, points in (
            (shader, 10),
            (shader.replace("/ (distance * distance)", "/ distance"), 0),
            ("nothing", 0),
            (untouched, 0),
            (untouched.replace("TODO", ""), 0),
        ):
            result = self.autograde(text)
            self.assertAlmostEqual(result["score"], points, delta=0.001)
            self.assertAlmostEqual(sum(test["score"] for test in result["tests"]), points, delta=0.01)
            self.assertAlmostEqual(sum(test["max_score"] for test in result["tests"]), 10, delta=0.01)
            self.assertEqual(result["output"] == "", points == 10, result["output"])
            for test in result["tests"]:
                self.assertEqual(set(test), set(TEST_KEYS))
                self.assertTrue(all(isinstance(test[key], kind) for key, kind in TEST_KEYS.items()), test)
                self.assertIn(test["status"], ("passed", "failed"))

    def test_all_submitted_shaders_count(self):
        folder = PROJECT / "chapters" / CHAPTERS[3]
        shaders = {name: (folder / name).read_text(encoding="utf-8") for name in ("path_trace.glsl", SUBMITTED)}
        twice = shaders["path_trace.glsl"].replace("sample_direct_light(s, seed)", "2.0 * sample_direct_light(s, seed)")
        self.assertNotEqual(twice, shaders["path_trace.glsl"])
        self.assertEqual(self.autograde(shaders | {"path_trace.glsl": twice})["score"], 0)

    def test_a_scene_that_the_placeholder_passes_can_only_lose_points(self):
        def score(*verdicts, **options):
            scenes = [(f"scene {i}", verdict, "") for i, verdict in enumerate(verdicts)]
            result = as_gradescope(scenes, [], 12, ["scene 2"], **options)
            self.assertAlmostEqual(sum(test["max_score"] for test in result["tests"]), 12, delta=0.01)
            self.assertAlmostEqual(sum(test["score"] for test in result["tests"]), result["score"], delta=0.01)
            return result["score"]

        self.assertEqual(score("correct", "correct", "correct"), 12)
        self.assertEqual(score("correct", "noisy", "correct"), 9)
        self.assertEqual(score("biased", "biased", "correct"), 0)
        self.assertEqual(score("correct", "correct", "biased"), 8)
        self.assertEqual(score("biased", "biased", "biased"), 0)
        self.assertEqual(score("correct", "biased", "correct", is_unfinished=True), 0)

    def test_what_experiments_alone_find_costs_points(self):
        options = SimpleNamespace(form="gradescope", chapter=3, points=10)
        for verdict, of_pictures, score in (
            ("correct", "correct", 10),
            ("noisy", "correct", 7.5),
            ("noisy", "noisy", 5),
            ("biased", "noisy", 2.5),
        ):
            scene = {"scene": "lamps", "verdict": of_pictures, "noise": [2.0], "most_noise": 1.5}
            result = {"verdict": verdict, "scenes": [scene], "diagnosis": {"too_noisy": ["light", 9.0]}}
            with (
                mock.patch.multiple(command, scene_words=lambda _: [], hints_of=lambda _: []),
                mock.patch("builtins.print") as printed,
            ):
                command.report(options, result)
            self.assertEqual(json.loads(printed.call_args.args[0])["score"], score, (verdict, of_pictures))

    def test_a_check_that_cannot_run_says_so(self):
        (self.folder / "source/lab").mkdir(parents=True)
        script = Path(shutil.copy(GRADING / "gradescope/run_autograder", self.folder / "source"))
        subprocess.run([script], env=os.environ | {"AUTOGRADER": str(self.folder)}, check=True, capture_output=True, timeout=300)
        result = json.loads((self.folder / "results/results.json").read_text(encoding="utf-8"))
        self.assertEqual(result["score"], 0)
        self.assertRegex(result["output"], "teacher")

    def test_workflow_names_a_chapter_that_there_is(self):
        text = (GRADING / "github_classroom/.github/workflows/grade.yml").read_text(encoding="utf-8")
        number, shader = (re.search(rf"{name}: (\S+)", text)[1] for name in ("CHAPTER", "SHADER"))
        self.assertEqual(shader, f"chapters/{CHAPTERS[int(number)]}/{SUBMITTED}")
        self.assertTrue((PROJECT / shader).is_file())

    def test_scripts_are_valid(self):
        for script in (GRADING / "gradescope").iterdir():
            subprocess.run(["bash", "-n", script], check=True)
            self.assertTrue(os.access(script, os.X_OK), script)
