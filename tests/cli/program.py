"""Runs the programs under test in their own folder."""

import json
import os
import pty
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from unittest import mock

from image_files import Exr, largest_ulp_difference
from tools_path import PROJECT, TOOLS

BINARIES = Path(os.environ.get("LAB_BINARIES", PROJECT / "build" / "bin"))
CHAPTER = BINARIES / "01_uniform_sampling"
MERGE = BINARIES / "merge_images"
FAULT_LAYER = {"VK_LAYER_PATH": str(BINARIES.parent / "layers"), "VK_INSTANCE_LAYERS": "VK_LAYER_LAB_fault"}
# Mesa's driver for CPUs takes longer to optimise a shader than to render a tiny picture.
UNOPTIMISED = {"GALLIVM_PERF": "nopt"}

# A quad that faces +Z under a sky, small enough to render instantly.
QUAD_OBJ = """mtllib quad.mtl
v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
usemtl white
f 1 2 3 4
"""
QUAD_MTL = "newmtl white\nKd 0.5 0.5 0.5\n"
QUAD_JSON = """{
    "meshes": [{"file": "quad.obj"}],
    "camera": {"position": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0], "vertical_fov": 40},
    "background": {"radiance": [1, 1, 1]}
}
"""

# Allowed difference of sums in a different order.
MERGE_ULPS = 2

# Bad input must neither hang nor allocate excessively.
BAD_INPUT_SECONDS = 20  # of processor time: how long it takes says more about what else runs
TIMEOUT_SECONDS = 300
BAD_INPUT_MEMORY = 8 << 30


def open_terminal():
    """A terminal for a program: our end and the program's. Containers and chroots may not provide any."""
    try:
        return pty.openpty()
    except OSError as error:
        raise unittest.SkipTest(f"no pseudo-terminals here: {error}") from error


def copy_project(tree, *others, linked=("assets", "common"), program=None):
    """Copies what students change, and other files and folders, with links to what they do not; returns the place of a copied program."""
    for name in ("chapters", "shaders", "tools", *others):
        (shutil.copytree if (PROJECT / name).is_dir() else shutil.copy)(PROJECT / name, tree / name)
    for name in linked:
        (tree / name).symlink_to(PROJECT / name)
    if program:
        (tree / "build/bin").mkdir(parents=True)
        return shutil.copy(program, tree / "build/bin")
    return None


class Program(subprocess.Popen):
    """A running program. A test that fails does not wait for its end."""

    def __exit__(self, kind, *others):
        if kind:
            self.kill()
        super().__exit__(kind, *others)


class ProgramTest(unittest.TestCase):
    """Each test has an empty working directory that contains the scene quad.json."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.write("quad.obj", QUAD_OBJ)
        self.write("quad.mtl", QUAD_MTL)
        self.write("quad.json", QUAD_JSON)

    def write(self, name, contents):
        """Writes a file in the test's folder; returns its path."""
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(contents if isinstance(contents, bytes) else contents.encode())
        return path

    def record(self, name, value):
        """Adds a test's measurement to docs/numerics.md: a name in snake_case and a text with its unit."""
        if file := os.environ.get("LAB_TEST_RECORD"):
            with open(file, "a", encoding="utf-8") as stream:
                stream.write(json.dumps({name: value}) + "\n")

    def start(self, *arguments, environment=None, prepare=None, program=CHAPTER):
        """Starts a program; environment variables that are None are removed."""
        variables = {**os.environ, **(environment or {})}
        variables = {name: value for name, value in variables.items() if value is not None}
        return Program(
            [program, *map(str, arguments)],
            cwd=self.folder,
            env=variables,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            preexec_fn=prepare,
            text=True,
        )

    def run_program(self, *arguments, timeout=TIMEOUT_SECONDS, **options):
        """Runs a program to the end; returns exit code, standard output, standard error."""
        with self.start(*arguments, **options) as process:
            try:
                out, err = process.communicate(timeout=timeout)
            except subprocess.TimeoutExpired:
                process.kill()
                self.fail(f"still running after {timeout} s: {arguments}")
        return process.returncode, out, err

    def render(self, *arguments, **options):
        """Runs a command that must succeed; returns its standard output."""
        code, out, err = self.run_program(*arguments, **options)
        self.assertEqual(code, 0, f"{arguments}: {err}")
        return out

    def run_tool(self, *arguments, **options):
        return self.run_program("-B", TOOLS, *arguments, program=sys.executable, **options)

    def run_here(self, main, *arguments):
        """Runs a command's main() in this process; returns the same as run_program. Its exceptions reach the test."""
        out, err, code = StringIO(), StringIO(), 0
        with mock.patch("sys.argv", ["lab", *map(str, arguments)]), redirect_stdout(out), redirect_stderr(err):
            try:
                main()
            except SystemExit as end:
                code = end.code
        return code, out.getvalue(), err.getvalue()

    def assert_tool_refused(self, arguments, *words, **options):
        self.assert_refused(["-B", TOOLS, *arguments], *words, program=sys.executable, **options)

    def assert_refused(self, arguments, *words, code=1, environment=None, prepare=None, program=CHAPTER):
        """The command ends soon with this exit code and a single line that contains all the words, and writes no picture."""

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (BAD_INPUT_MEMORY, BAD_INPUT_MEMORY))
            resource.setrlimit(resource.RLIMIT_CPU, (BAD_INPUT_SECONDS, BAD_INPUT_SECONDS))
            if prepare:
                prepare()

        before = {path: path.stat().st_mtime_ns for path in self.folder.rglob("*")}
        with self.subTest(arguments=str(arguments)[:200]):
            actual, out, err = self.run_program(*arguments, environment=environment, prepare=limit, program=program)
            message = f"{arguments} printed {out!r} and the error {err!r}"
            self.assertEqual(actual, code, message)
            self.assertRegex(err, r"\A[^\n]{12,400}\n\Z", "one line, but " + message)
            for word in words:
                self.assertRegex(err, re.compile(word, re.IGNORECASE), message)
            after = {path: path.stat().st_mtime_ns for path in self.folder.rglob("*") if path.is_file()}
            for path, changed in after.items():
                self.assertEqual(before.get(path), changed, f"{path.name} was written: {message}")

    def wait_for(self, path, process, seconds=TIMEOUT_SECONDS):
        """Waits until a running program has written a file."""
        end = time.monotonic() + seconds
        while not path.exists():
            if process.poll() is not None or time.monotonic() > end:
                process.kill()
                self.fail(f"{path.name} was not written: {process.communicate()}")
            time.sleep(0.01)


class RenderTest(ProgramTest):
    """Renders small pictures of the Cornell box."""

    def picture(self, name, *arguments, scene="cornell_box", size=(24, 20), **options):
        """Renders to NAME.exr and reads it."""
        file = self.folder / f"{name}.exr"
        self.render(*self.command(*arguments, scene=scene, size=size), "--quiet", "--output", file, **options)
        return Exr(file)

    def command(self, *arguments, scene="cornell_box", size=(24, 20)):
        """The arguments for a render of this size."""
        return [scene, f"--width={size[0]}", f"--height={size[1]}", "--backend=compute", *arguments]

    def assert_close(self, first, second, ulps=MERGE_ULPS):
        self.assertLessEqual(largest_ulp_difference(first.pixels(), second.pixels()), ulps)
