"""What makes a release: a single version, and workflows whose files are valid and whose commands exist."""

import json
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import yaml
from program import BINARIES, PROJECT  # first: it finds the tools
from package import make, windows_programs
from project import CHAPTERS

WORKFLOWS = sorted((PROJECT / ".github/workflows").glob("*.yml"))
# https://docs.github.com/actions/reference/workflow-syntax: the part that our files use.
STEP = {"run", "uses", "with", "env", "id", "name"}
JOB = {"runs-on", "container", "timeout-minutes", "steps", "strategy", "environment", "needs", "permissions"}
WORKFLOW = {"name", True, "jobs", "permissions", "concurrency"}  # YAML parses "on" as true


class VersionTest(unittest.TestCase):
    def test_is_that_of_the_programs_and_of_the_changes(self):
        number = make.version()
        self.assertRegex(number, r"^\d+\.\d+\.\d+$")
        said = subprocess.run([BINARIES / CHAPTERS[1], "--version"], capture_output=True, text=True).stdout
        self.assertEqual(said, f"{CHAPTERS[1]} {number}\n")
        self.assertRegex(make.changes(number), "[a-z]")
        self.assertEqual(re.findall("^## (.*)", (PROJECT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE)[0], number)

    def test_stands_in_one_place(self):
        for name in ("vcpkg.json", "CITATION.cff"):
            self.assertNotIn('"version"', (PROJECT / name).read_text(encoding="utf-8"), name)


class WorkflowsTest(unittest.TestCase):
    def steps(self):
        for file in WORKFLOWS:
            workflow = yaml.safe_load(file.read_text(encoding="utf-8"))
            self.assertLessEqual(set(workflow), WORKFLOW, file)
            for name, job in workflow["jobs"].items():
                self.assertLessEqual(set(job), JOB, f"{file}: {name}")
                self.assertLessEqual({"runs-on", "timeout-minutes", "steps"}, set(job), f"{file}: {name}")
                for step in job["steps"]:
                    self.assertLessEqual(set(step), STEP, f"{file}: {step}")
                    self.assertEqual(len({"run", "uses"} & set(step)), 1, f"{file}: {step}")
                    yield file.name, step

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
            for program in re.findall(r"(?:^|\s)(\.ci/\w+|tests/\w+)", command):
                self.assertTrue((PROJECT / program).is_file(), f"{file}: {program}")

    def test_actions_have_a_version(self):
        for file, step in self.steps():
            if "uses" in step:
                self.assertRegex(step["uses"], r"^actions/[\w-]+@v\d+$", file)

    def test_the_container_of_editors_is_that_of_students(self):
        settings = json.loads((PROJECT / ".devcontainer/devcontainer.json").read_text(encoding="utf-8"))
        place = PROJECT / ".devcontainer" / settings["build"]["dockerfile"]
        self.assertTrue(place.samefile(PROJECT / "Containerfile"))
        self.assertTrue((place.parent / settings["build"]["context"] / ".devcontainer").exists() or
                        (PROJECT / ".devcontainer" / settings["build"]["context"]).samefile(PROJECT))


class WorkflowSchema_all(unittest.TestCase):
    def test_files_follow_the_schema_of_github(self):
        program = shutil.which("check-jsonschema")
        if not program:
            folder = tempfile.TemporaryDirectory()
            self.addCleanup(folder.cleanup)
            installed = subprocess.run([sys.executable, "-m", "venv", folder.name], capture_output=True, text=True)
            program = Path(folder.name) / "bin/check-jsonschema"
            if installed.returncode == 0:
                installed = subprocess.run([program.parent / "pip", "install", "--quiet", "check-jsonschema"], capture_output=True, text=True)
            if installed.returncode != 0:
                self.skipTest(f"needs check-jsonschema from PyPI: {(installed.stderr or installed.stdout).strip().splitlines()[-1]}")
        result = subprocess.run([program, "--builtin-schema", "vendor.github-workflows", *WORKFLOWS], capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stdout)
        with tempfile.TemporaryDirectory() as folder:
            broken = Path(folder) / "broken.yml"
            broken.write_text(WORKFLOWS[0].read_text(encoding="utf-8").replace("runs-on:", "runs-at:"), encoding="utf-8")
            self.assertNotEqual(subprocess.run([program, "--builtin-schema", "vendor.github-workflows", broken], capture_output=True).returncode, 0)


class Release_all(unittest.TestCase):
    def test_has_archives_book_and_checksums(self):
        if not shutil.which(windows_programs.COMPILER):
            self.skipTest(f"{windows_programs.COMPILER} is missing: ./lab package windows installs it")
        subprocess.run([sys.executable, "-B", PROJECT / "tools", "package", "release"], check=True, stdout=subprocess.DEVNULL)
        folder, number = PROJECT / "output/release", make.version()
        names = sorted(path.name for path in folder.iterdir())
        self.assertEqual(names, ["SHA256SUMS", "notes.md", *(f"path_tracing_lab-{number}-{name}" for name in ("book.zip", "linux.tar.xz", "windows.zip"))])
        subprocess.run(["sha256sum", "--check", "--strict", "--quiet", "SHA256SUMS"], cwd=folder, check=True)
