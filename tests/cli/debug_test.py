"""./lab debug and its page: the searches of docs/debugging.md find what they claim."""
import json
import re
import shutil
import subprocess
import sys

from program import PROJECT, ProgramTest  # first: it finds the tools
from copied_lab import SHADER, CopiedLab
from debug import command
from project import CHAPTERS
from references.images import read_rgb

PAGE = (PROJECT / "docs/debugging.md").read_text(encoding="utf-8")


class DebuggerStops_all(ProgramTest):
    """In each chapter, ./lab debug stops where a path begins."""

    def test_in_every_chapter(self):
        if not shutil.which("gdb"):
            self.skipTest("gdb is not installed")
        for number in CHAPTERS:
            with self.subTest(chapter=number):
                output = subprocess.run(
                    [
                        sys.executable,
                        "-B",
                        "tools",
                        "debug",
                        str(number),
                        "--pixel=9,9",
                        "--width=32",
                        "--height=32",
                        "--",
                        "-batch",
                        "-ex",
                        "bt 1",
                    ],
                    cwd=PROJECT,
                    capture_output=True,
                    encoding="utf-8",
                    timeout=600,
                    stdin=subprocess.DEVNULL,
                ).stdout
                self.assertRegex(output, r"(?m)^#0 .*(path_trace|extend_path) \(this=")


class DebugTest(CopiedLab, ProgramTest):
    def search(self, title):
        """A section of the page with its blocks: the command, gdb's input, and the output to expect."""
        section = re.search(rf"^## {title}.*?(?=^## )", PAGE, re.MULTILINE | re.DOTALL)[0]
        blocks = dict(re.findall(r"^```(\w+)\n(.*?)^```", section, re.MULTILINE | re.DOTALL))
        self.plant(section)
        words = re.search(r"^    \./lab (.*)$", section, re.MULTILINE)[1].split()
        self.assertEqual(words[1], "30", "the copy of chapter 1, for which chapter 1 stands here")
        return [words[0], "1", *words[2:]], blocks

    def assert_found(self, seen, blocks):
        at = 0
        for line in blocks["text"].splitlines():
            self.assertIn(line, seen[at:])
            at = seen.index(line, at) + len(line)

    def test_the_searches_of_the_page(self):
        for title in ("A breakpoint", "A watchpoint"):
            with self.subTest(title):
                words, blocks = self.search(title)
                commands = [word for line in blocks["gdb"].splitlines() for word in ("-ex", line)]
                self.assert_found(self.debug(*words[1:], "--", "-batch", *commands), blocks)
        with self.subTest("A sanitizer"):
            words, blocks = self.search("A sanitizer")
            process = self.execute(self.program, *words[2:])
            self.assert_found(process.stderr, blocks)
            self.assertEqual(process.returncode, 3)
        with self.subTest("Nothing is wrong"):
            self.plant("")
            self.assertEqual(self.execute(self.program, *words[2:], "--quiet").stderr, "")

    def test_it_stops_in_the_student_s_file_with_its_variables(self):
        seen = self.debug(
            1,
            "--pixel",
            "20,30",
            "--width",
            40,
            "--height",
            40,
            "--sample",
            3,
            "--",
            "-batch",
            "-ex",
            "info locals",
            "-ex",
            "up",
            "-ex",
            "print first",
            "-ex",
            "continue",
        )
        self.assertIn(f"{SHADER}:8", seen)
        self.assertRegex(seen, r"throughput = \(.*, .*, .*\)")
        self.assertRegex(seen, r"pixel +20,30 sample 3: ")

    def test_it_prints_what_the_picture_has_in_this_pixel(self):
        size = ["--headless", "--width=1600", "--height=1600", "--samples=1"]  # so large that freed memory is gone
        self.assertEqual(self.execute(self.program, *size, "--backend=native", "--output=picture.exr").returncode, 0)
        picture = read_rgb(self.tree / "picture.exr")
        brightest = divmod(int(picture.sum(axis=2).argmax()), 1600)
        self.assertGreater(picture[brightest].max(), 0)
        for y, x in ((0, 0), brightest):
            process = self.execute(self.program, *size, f"--debug-pixel={x},{y}")
            expected = " ".join(f"{value:g}" for value in picture[y, x])
            self.assertIn(f"\npixel          {x},{y} sample 0: {expected}\n", process.stdout, process.returncode)

    def test_visual_studio_code(self):
        process = self.execute(sys.executable, "-B", "tools", "debug", "--vscode")
        self.assertEqual(process.stdout.split(), [".vscode/launch.json", ".vscode/tasks.json"])
        launch = json.loads((self.tree / ".vscode/launch.json").read_text(encoding="utf-8"))
        [configuration] = launch["configurations"]
        inputs = {found["id"] for found in launch["inputs"]}
        self.assertEqual(set(re.findall(r"\$\{input:(\w+)\}", json.dumps(configuration))), inputs)
        # Running it again is fine, and foreign files are kept.
        self.assertEqual(self.execute(sys.executable, "-B", "tools", "debug", "--vscode").returncode, 0)
        (self.tree / ".vscode/launch.json").write_text("{}", encoding="utf-8")
        refused = self.execute(sys.executable, "-B", "tools", "debug", "--vscode")
        self.assertIn("launch.json is there already", refused.stderr)

    def test_refusals(self):
        self.assert_tool_refused(["debug"], "which chapter")
        self.assert_tool_refused(["debug", 99], "no chapter 99")
        self.assert_refused(["--debug-pixel", "64,3", "--width=64", "--height=64"], "64,3", "64x64")
        self.assert_refused(["--sanitize", "--backend=compute"], "--backend compute")

    def test_lldb_stops_at_the_same_place(self):
        self.assertEqual(
            command.command_for("lldb", "program", ["a"], []),
            ["lldb", "-o", "breakpoint set --name path_trace", "-o", "process launch", "--", "program", "a"],
        )
