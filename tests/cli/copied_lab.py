"""A copy of the lab for tests that change it."""

import os
import re
import shutil
import subprocess
import sys

from program import BINARIES, PROJECT, copy_project  # first: it finds the tools
from project import CHAPTERS

SHADER = "chapters/01_uniform_sampling/path_trace.glsl"


class CopiedLab:
    """A copy of the lab with its own shaders and the program of chapter 1."""

    SIZE = ("--headless", "--width=32", "--height=32", "--samples=2")

    def setUp(self):
        super().setUp()
        program = BINARIES / CHAPTERS[1]
        devices = subprocess.run([program, "--list-devices"], capture_output=True, encoding="utf-8").stdout
        if not re.search(r"native +works", devices):
            self.skipTest("no device has the backend native")
        self.tree = self.folder / "lab"
        self.program = copy_project(self.tree, program=program)
        self.shader = self.tree / SHADER

    def plant(self, text):
        """Makes the replacements that a text of the page asks for, starting from the original shader."""
        code = (PROJECT / SHADER).read_text(encoding="utf-8")
        for old, new in re.findall(r"replace\s+`([^`]+)`\s+by\s+`([^`]+)`", text):
            self.assertEqual(code.count(old), 1, old)
            code = code.replace(old, new)
        self.shader.write_text(code, encoding="utf-8")

    def execute(self, *words):
        return subprocess.run(
            list(map(str, words)),
            cwd=self.tree,
            capture_output=True,
            encoding="utf-8",
            timeout=300,
            stdin=subprocess.DEVNULL,
            env=os.environ | {"LAB_BINARIES": str(self.tree / "build/bin")},
        )

    def debug(self, *words):
        if not shutil.which("gdb"):
            self.skipTest("gdb is not installed")
        return self.execute(sys.executable, "-B", "tools", "debug", *words).stdout

    def render(self, *arguments, backend="native", **environment):
        return subprocess.run(
            [self.program, *self.SIZE, f"--backend={backend}", "--output=picture.exr", *arguments],
            cwd=self.tree,
            capture_output=True,
            encoding="utf-8",
            timeout=120,
            env=os.environ | {"XDG_CACHE_HOME": str(self.tree / "cache")} | environment,
        )

    def compiler(self, script):
        path = self.tree / "fake/c++"
        path.parent.mkdir(exist_ok=True)
        path.write_text("#!/bin/sh\n" + script, encoding="utf-8")
        path.chmod(0o755)
        return {"PATH": f"{path.parent}:{os.environ['PATH']}"}
