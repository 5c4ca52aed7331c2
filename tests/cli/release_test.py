"""What makes a release: a single version, and workflows whose files are valid and whose commands exist."""

import json
import re
import shutil
import subprocess
import sys
import unittest

from program import BINARIES, PROJECT  # first: it finds the tools
import yaml
from package import make, windows_programs
from project import CHAPTERS

WORKFLOWS = sorted((PROJECT / ".github/workflows").glob("*.yml"))


class VersionTest(unittest.TestCase):
    def test_is_that_of_the_programs_and_of_the_changes(self):
        number = make.version()
        self.assertRegex(number, r"^\d+\.\d+\.\d+$")
        said = subprocess.run([BINARIES / CHAPTERS[1], "--version"], capture_output=True, text=True).stdout
        self.assertEqual(said, f"{CHAPTERS[1]} {number}\n")
        self.assertRegex(make.changes(number), "[a-z]")
        self.assertEqual(re.findall("^## (.*)", (PROJECT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)[0], number)

    def test_stands_in_one_place(self):
        self.assertNotIn("version:", (PROJECT / "CITATION.cff").read_text(encoding="utf-8").replace("cff-version:", ""))


class WorkflowsTest(unittest.TestCase):
    def steps(self):
        for file in WORKFLOWS:
            for job in yaml.safe_load(file.read_text(encoding="utf-8"))["jobs"].values():
                yield from ((file.name, step) for step in job["steps"])

    def test_commands_are_valid_and_exist(self):
        lab = (PROJECT / "lab").read_text(encoding="utf-8")
        commands = [(file, step["run"]) for file, step in self.steps() if "run" in step]
        self.assertGreaterEqual(len(commands), 10)
        for file, command in commands:
            plain = re.sub(r"\$\{\{.*?\}\}", "1", command)
            result = subprocess.run(["bash", "-n"], input=plain, capture_output=True, text=True)
            self.assertEqual(result.stderr, "", f"{file}: {command}")
            for name in re.findall(r"\./lab (\w+)", command):
                self.assertIn(f"\ncommand_{name}()", lab, file)
            for program in re.findall(r"(?:^|\s)(\.ci/\w+|tests/[\w/.]+)", command):
                self.assertTrue((PROJECT / program).is_file(), f"{file}: {program}")

    def test_actions_have_a_version(self):
        for file, step in self.steps():
            if "uses" in step:
                self.assertRegex(step["uses"], r"^actions/[\w-]+@v\d+$", file)

    def test_the_container_of_editors_is_that_of_students(self):
        settings = json.loads((PROJECT / ".devcontainer/devcontainer.json").read_text(encoding="utf-8"))
        place = PROJECT / ".devcontainer" / settings["build"]["dockerfile"]
        self.assertTrue(place.samefile(PROJECT / "Containerfile"))
        self.assertTrue(
            (place.parent / settings["build"]["context"] / ".devcontainer").exists()
            or (PROJECT / ".devcontainer" / settings["build"]["context"]).samefile(PROJECT)
        )


class Release_all(unittest.TestCase):
    def test_has_archives_book_and_checksums(self):
        if not shutil.which(windows_programs.COMPILER):
            self.skipTest(f"{windows_programs.COMPILER} is missing: ./lab package windows installs it")
        subprocess.run([sys.executable, "-B", PROJECT / "tools", "package", "release"], check=True, stdout=subprocess.DEVNULL)
        folder, number = PROJECT / "output/release", make.version()
        names = sorted(path.name for path in folder.iterdir())
        self.assertEqual(
            names,
            [
                "SHA256SUMS",
                "notes.md",
                *(f"path_tracing_lab-{number}-{name}" for name in ("book.zip", "linux.tar.xz", "windows.zip")),
            ],
        )
        subprocess.run(["sha256sum", "--check", "--strict", "--quiet", "SHA256SUMS"], cwd=folder, check=True)
