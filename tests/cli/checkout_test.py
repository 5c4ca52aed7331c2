"""The command lab as a checkout has it: its line ends, and what it builds for a tool."""

import os
import shutil
import subprocess
import unittest

from program import PROJECT, ProgramTest

INSTALLED = "#!/bin/sh\nfor name; do printf '%s:installed ' \"$name\"; done\n"
NOTING = "#!/bin/sh\necho \"${{0##*/}} $@\" >>'{notes}'\n"


class LineEnds(ProgramTest):
    def test_a_checkout_of_git_for_windows_has_those_of_its_sources(self):
        prefix = ["git", "-c", "core.autocrlf=true", "checkout-index", f"--prefix={self.folder}/tree/", "--"]
        files = ["lab", "chapters/01_uniform_sampling/path_trace.glsl", "tests/fuzz/seeds/obj/bare.obj", "assets/references/plates_3.exr"]
        result = subprocess.run([*prefix, *files], cwd=PROJECT, capture_output=True, text=True)
        if "not a git repository" in result.stderr:
            self.skipTest("no repository")
        self.assertEqual(result.returncode, 0, result.stderr)
        for file in files:
            recorded = subprocess.run(["git", "cat-file", "blob", f":{file}"], cwd=PROJECT, capture_output=True, check=True).stdout
            self.assertEqual((self.folder / "tree" / file).read_bytes(), recorded, file)


class BuildForACheck(ProgramTest):
    """lab in a tree of its own, where everything is installed and nothing is built."""

    def test_the_chapter_is_built_wherever_its_number_stands(self):
        for folder in ("tree/build", "tree/bin", "tree/chapters/03_three", "tree/chapters/12_twelve"):
            (self.folder / folder).mkdir(parents=True)
        for name in ("CMakeLists.txt", "build/build.ninja"):
            (self.folder / "tree" / name).touch()
        shutil.copy(PROJECT / "lab", self.folder / "tree")
        notes = self.folder / "notes"
        for name, script in (("dpkg-query", INSTALLED), ("cmake", NOTING), ("python3", NOTING)):
            self.write(f"tree/bin/{name}", script.format(notes=notes)).chmod(0o755)
        path = f"{self.folder / 'tree/bin'}:{os.environ['PATH']}"
        for arguments in (["3", "--all", "work"], ["--all", "work", "3"], ["--teacher", "03", "mine.glsl"], ["--all", "12/work", "3"]):
            code, _, err = self.run_program("check", *arguments, program=self.folder / "tree/lab", environment={"PATH": path})
            self.assertEqual(code, 0, err)
            noted = notes.read_text()
            notes.unlink()
            self.assertRegex(noted, r"(?m)^cmake --build .* --target 03_three$", arguments)
            self.assertRegex(noted, rf"(?m)^python3 .*/tools check {' '.join(arguments)}$")


if __name__ == "__main__":
    unittest.main()
