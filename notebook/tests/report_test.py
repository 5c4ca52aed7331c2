"""./lab notebook report: records of chapters, and comparisons with Mitsuba."""

import json
import sys

import paths  # noqa: F401  (first: it finds the others)
from program import BINARIES, PROJECT, ProgramTest
from tables.chapter_tables import chapter_tables
from tables.cpu_table import cpu_table

PATHS = f"{PROJECT / 'notebook'}:{PROJECT / 'tools'}"
# --record with only the last two cases, which have no reference; with --peer with one scene.
RECORD = """import sys
sys.path[:0] = sys.argv.pop(1).split(":")
import project
from peers import cases, report
report.study_cases = lambda: [case for case in cases.study_cases() if case["case"].startswith("splitting factor") and case["scene"] == "cornell_box_6"]
cases.CPU_SCENES = ["cornell_box_1"]
project.run_tool(report)"""
# Replaces Mitsuba on a CPU: takes its arguments, and renders by chapter 3.
MITSUBA = """#!{python}
import subprocess, sys
variant, scene, arguments = sys.argv[4], sys.argv[5], sys.argv[6:]
if variant == "cuda_ad_rgb":
    sys.exit("error: no such device")
if "--sampler" in arguments:
    place = arguments.index("--sampler")
    del arguments[place : place + 2]
if "--samples" not in arguments:
    arguments += ["--samples", "1000000"]
sys.exit(subprocess.call(["{program}", "--quiet", scene, *arguments]))
"""
SMALL = ["--seconds=0.1", "--backend=compute", "--output=report"]


class ReportTest(ProgramTest):
    def report(self, *arguments, code=0, environment=None):
        """Standard error of a run to the end."""
        result, _, err = self.run_program(
            "-B", PROJECT / "notebook", "report", *arguments, program=sys.executable, environment=environment
        )
        self.assertEqual(result, code, err)
        return err

    def test_what_does_not_go_together_is_refused(self):
        for arguments, words in (
            (["--record=record.json", "torus"], "no scenes"),
            (["--record=record.json", "--peer=mitsuba", "torus"], "no scenes"),
            (["torus", "--peer-sampler=multijitter"], "--peer mitsuba"),
        ):
            self.assertIn(words, self.report(*arguments, code=1))

    def test_without_mitsuba_it_says_how_to_get_it(self):
        (self.folder / "bin").mkdir()
        self.write("bin/python3", f'#!/bin/sh\nexec "{sys.executable}" -S "$@"\n').chmod(0o755)
        environment = {"PATH": f"{self.folder / 'bin'}:/usr/bin:/bin"}
        self.assertRegex(
            self.report("cornell_box", "--peer=mitsuba", code=1, environment=environment), "Mitsuba 3.*pip install mitsuba"
        )

    def test_a_record_can_be_shown_in_the_results(self):
        arguments = ["--record=record.json", "--backend=compute", "--seconds=0.2", "--repetitions=2"]
        self.render("-B", "-c", RECORD, PATHS, *arguments, program=sys.executable)
        record = json.loads((self.folder / "record.json").read_text())
        self.assertTrue(record["is_complete"])
        self.assertNotIn(str(PROJECT), json.dumps(record))
        self.assertIn("renderer", record["measured"])
        self.assertRegex(
            chapter_tables(record),
            r"\| splitting factor 2 \| `--samples \d+ --splitting-factor 2` \|[^|]*\|[^|]*\|[^|]*\| [\d.]+ \(",
        )

    def with_mitsuba(self):
        """An environment in which chapter 3 replaces Mitsuba."""
        (self.folder / "bin").mkdir()
        fake = MITSUBA.format(python=sys.executable, program=BINARIES / "03_next_event_estimation")
        self.write("bin/python3", fake).chmod(0o755)
        return {"PATH": f"{self.folder / 'bin'}:/usr/bin:/bin"}

    def test_a_peer_is_compared_with_as_each_sampler(self):
        arguments = ["cornell_box_1", "1", "4", "--peer=mitsuba", "--peer-sampler=multijitter", "--repetitions=2", *SMALL]
        self.report(*arguments, environment=self.with_mitsuba())
        scene, *others = json.loads((self.folder / "report/report.json").read_text())["scenes"]
        self.assertEqual(
            len(others),
            0 if "CPU" in json.loads((self.folder / "report/record.json").read_text())["environment"]["driver"] else 1,
        )  # large pictures
        cases = {case["case"]: case for case in scene["cases"]}
        self.assertEqual(
            {name: case["options"] for name, case in cases.items()},
            {
                "chapter 1": "",
                "chapter 4": "",
                "Mitsuba scalar": "--sampler independent",
                "Mitsuba LLVM": "--sampler independent",
                "Mitsuba LLVM, multijitter": "--sampler multijitter",
            },
        )
        self.assertEqual([case["paths_per_sample"] for case in cases.values()], [1, 4, 1, 1, 1])
        gains = {(gain["case"], gain["peer"]): gain["gain"] for gain in scene["gains"]}
        self.assertEqual(len(gains), 5 * 3 - 3)
        self.assertLess(gains["chapter 1", "Mitsuba LLVM"][0], 0.5)
        page = (self.folder / "report/index.html").read_text()
        for text in ("Mitsuba LLVM, multijitter", "What differs", "docs/results.md"):
            self.assertIn(text, page)
        self.assertEqual(len(list((self.folder / "report/pictures").iterdir())), 2 * 5)

    def test_a_record_of_the_backends_of_a_cpu(self):
        path = self.with_mitsuba()
        arguments = ["--record=record.json", "--peer=mitsuba", "--device=llvmpipe", "--seconds=0.2", "--repetitions=2"]
        self.render("-B", "-c", RECORD, PATHS, *arguments, program=sys.executable, environment=path)
        record = json.loads((self.folder / "record.json").read_text())
        self.assertTrue(record["is_complete"])
        cases = {case["case"]: case for case in record["cases"]}
        self.assertEqual(
            {name: case["backend"] for name, case in cases.items() if not case["is_peer"]},
            {"compute": "compute", "native, one by one": "native", "native, lanes": "native"},
        )
        self.assertEqual(
            [name for name, case in cases.items() if case["is_peer"]],
            ["Mitsuba scalar", "Mitsuba LLVM", "Mitsuba LLVM, multijitter"],
        )
        rows = cpu_table(record).splitlines()
        self.assertRegex(rows[0], r", \d+ cores, llvmpipe.*, and ")
        self.assertEqual(len(rows), 4 + len(cases))
