"""docs/grading: the autograder scripts, in a folder laid out like the autograder's."""

import json
import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from program import BINARIES, PROJECT, ProgramTest  # first: it finds the tools
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
        """The autograder's result for a submission."""
        for folder in ("source/lab", "submission"):
            (self.folder / folder).mkdir(parents=True, exist_ok=True)
        script = self.folder / "source/run_autograder"
        shutil.copy(GRADING / "gradescope/run_autograder", script)
        lab = self.write("source/lab/lab", LAB.format(python=sys.executable, tools=PROJECT / "tools"))
        lab.chmod(0o755)
        self.write(f"submission/{SUBMITTED}", shader)
        environment = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
        environment |= {"AUTOGRADER": str(self.folder), "LAB_BINARIES": str(BINARIES)}
        subprocess.run([script], env=environment, check=True, capture_output=True, timeout=300)
        return json.loads((self.folder / "results/results.json").read_text(encoding="utf-8"))

    def test_gradescope_gets_points_and_a_question(self):
        chapter = int(re.search(r"^chapter=(\d+)", (GRADING / "gradescope/run_autograder").read_text(), re.MULTILINE)[1])
        shader = (PROJECT / "chapters" / CHAPTERS[chapter] / SUBMITTED).read_text(encoding="utf-8")
        for text, points in ((shader, 10), (shader.replace("/ (distance * distance)", "/ distance"), 10 / 3), ("nothing", 0)):
            result = self.autograde(text)
            self.assertAlmostEqual(result["score"], points, delta=0.001)
            self.assertAlmostEqual(sum(test["score"] for test in result["tests"]), points, delta=0.01)
            self.assertAlmostEqual(sum(test["max_score"] for test in result["tests"]), 10, delta=0.01)
            self.assertEqual(result["output"] == "", points == 10, result["output"])
            for test in result["tests"]:
                self.assertEqual(set(test), set(TEST_KEYS))
                self.assertTrue(all(isinstance(test[key], kind) for key, kind in TEST_KEYS.items()), test)
                self.assertIn(test["status"], ("passed", "failed"))

    def test_a_check_that_cannot_run_says_so(self):
        (self.folder / "source/lab").mkdir(parents=True)
        script = Path(shutil.copy(GRADING / "gradescope/run_autograder", self.folder / "source"))
        subprocess.run([script], env=os.environ | {"AUTOGRADER": str(self.folder)}, check=True, capture_output=True, timeout=60)
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


if __name__ == "__main__":
    unittest.main()
