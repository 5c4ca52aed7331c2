"""The programs for Windows, under Wine on a virtual display, do what those for Linux do: ./lab test --all.

Wine hands Vulkan on to the driver of this machine. docs/installing.md lists what only Windows itself can show.
"""

import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import zipfile
from pathlib import Path

from image_files import Exr
from PIL import Image, ImageGrab
from program import CHAPTER, PROJECT, TOOLS, RenderTest  # first: it finds the tools
from package import windows_programs

PROGRAMS = PROJECT / "build/windows/programs/bin"
PACKAGE = PROJECT / "output/path_tracing_lab-windows.zip"
NEEDED = [windows_programs.COMPILER, "wine", "Xvfb"]
# Programs refuse bad input in the same words on both systems.
SAME_TESTS = [
    "command_line_test.Information",
    "command_line_test.WrongArguments",
    "command_line_test.MergeArguments",
    "bad_input_test",
    "rendering_test.Views",
    "rendering_test.PictureFiles",
]
BACKENDS = ["compute", "query", "pipeline"]
SMALL = ["--width=64", "--height=48", "--samples=4"]
wine = {}  # the programs' environment, once setUpModule() has prepared it


def setUpModule():
    if missing := [name for name in NEEDED if not shutil.which(name)]:
        raise unittest.SkipTest(f"{missing[0]} is missing: ./lab package windows installs it")
    for arguments in (["windows", "unit_tests"], ["package", "windows"]):
        subprocess.run([sys.executable, "-B", TOOLS, *arguments], check=True)
    folder = Path(tempfile.mkdtemp())
    unittest.addModuleCleanup(shutil.rmtree, folder, ignore_errors=True)
    for program in PROGRAMS.glob("*.exe"):
        command = folder / program.stem
        command.write_text(f'#!/bin/sh\nexec wine "{program}" "$@"\n', encoding="utf-8")
        command.chmod(0o755)
    display = subprocess.Popen(
        ["Xvfb", "-displayfd", "1", "-screen", "0", "1280x1024x24", "-nolisten", "tcp"],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    unittest.addModuleCleanup(display.communicate)
    unittest.addModuleCleanup(display.terminate)
    wine.update(
        {
            "DISPLAY": f":{display.stdout.readline().strip()}",
            "LAB_BINARIES": str(folder),
            "LC_ALL": "C.UTF-8",
            "WINEPREFIX": str(folder / "prefix"),
            "WINEDEBUG": "-all",
            "WINEDLLOVERRIDES": "mscoree,mshtml=",
        }
    )
    (folder / "prefix").mkdir()
    unittest.addModuleCleanup(subprocess.run, ["wineserver", "-k"], env=os.environ | wine)
    # Wine's own programs must not be started by one of ours: they would hold a pipe that a test reads to its end. The desktop
    # exists as long as it has a window.
    for command in (["wineserver", "-p"], ["wine", "wineboot", "-i"], ["wine", "start", "/min", "notepad"]):
        subprocess.run(command, env=os.environ | wine, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class WindowsPrograms_all(RenderTest):
    def start(self, *arguments, environment=None, program=CHAPTER, **options):
        if Path(program).parent == CHAPTER.parent:
            program = Path(wine["LAB_BINARIES"]) / Path(program).name
        return super().start(*arguments, environment=wine | (environment or {}), program=program, **options)

    def unpack(self, name):
        """The archive, unpacked into a folder of this name."""
        with zipfile.ZipFile(PACKAGE) as archive:
            archive.extractall(self.folder / name)
        return self.folder / name / "path_tracing_lab-windows"

    def test_units(self):
        result = subprocess.run(
            ["wine", PROGRAMS / "unit_tests.exe", "--gtest_brief=1"], env=os.environ | wine, capture_output=True, text=True
        )
        self.assertEqual(result.returncode, 0, result.stdout)

    def test_pictures_are_those_of_linux_to_the_bit(self):
        for scene in ("cornell_box", "torus"):
            for backend in BACKENDS:
                command = [scene, *SMALL, f"--backend={backend}", "--quiet", "--output"]
                with self.subTest(scene=scene, backend=backend):
                    self.render(*command, "windows.exr")
                    subprocess.run([CHAPTER, *command, "linux.exr"], cwd=self.folder, check=True)
                    windows, linux = (Exr(self.folder / name) for name in ("windows.exr", "linux.exr"))
                    self.assertEqual(windows.pixels(), linux.pixels())
                    self.assertGreater(min(windows.mean()), 0)

    def test_bad_input_gets_the_same_messages_and_exit_codes(self):
        result = subprocess.run(
            [sys.executable, "-B", "-m", "unittest", *SAME_TESTS],
            env=os.environ | wine,
            cwd=Path(__file__).parent,
            capture_output=True,
            text=True,
        )
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_names_of_files_in_any_language(self):
        self.write("Würfel 漢字/quad.obj", (self.folder / "quad.obj").read_text().replace("quad.mtl", "grün 🙂.mtl"))
        self.write("Würfel 漢字/grün 🙂.mtl", (self.folder / "quad.mtl").read_text())
        self.write("Würfel 漢字/szene é.json", (self.folder / "quad.json").read_text())
        text = self.render("Würfel 漢字/szene é.json", *SMALL, "--output", "Bild ß 🙂.exr")
        self.assertIn("Bild ß 🙂.exr", text)
        self.assertNotIn("?", text)
        self.assertTrue((self.folder / "Bild ß 🙂.exr").exists())

    def test_the_archive_works_in_a_folder_with_spaces_and_umlauts(self):
        folder = self.unpack("Übung 1")
        for arguments, output in (
            (("run", "1", "cornell_box", *SMALL, "--headless"), "mean radiance"),
            (("run",), "03_next_event_estimation"),
            (("help",), "check N"),
        ):
            code, out, err = self.run_program("cmd", "/c", "call", folder / "lab.cmd", *arguments, program="wine")
            self.assertEqual(code, 0, out + err)
            self.assertIn(output, out)
        self.assertTrue((self.folder / "output/01_uniform_sampling.png").exists())
        for arguments in (("run", "99"), ("paint",)):
            code, _, err = self.run_program("cmd", "/c", "call", folder / "lab.cmd", *arguments, program="wine")
            self.assertEqual(code, 1)
            self.assertRegex(err, r"\Alab: [^\n]*lab (run|help) lists them\s*\n\Z")

    def test_the_same_sources_make_the_same_archive(self):
        before = PACKAGE.read_bytes()
        subprocess.run([sys.executable, "-B", TOOLS, "package", "windows"], check=True)
        self.assertEqual(PACKAGE.read_bytes(), before)

    def test_a_program_taken_out_of_the_archive_says_what_to_do(self):
        shutil.copy(PROGRAMS / "01_uniform_sampling.exe", self.folder)
        self.assert_refused(["01_uniform_sampling.exe"], "unpack the whole archive", program="wine")

    def test_a_machine_without_vulkan(self):
        self.assert_refused(
            ["quad.json"],
            "Vulkan is missing",
            "newest driver",
            code=2,
            environment={"WINEDLLOVERRIDES": wine["WINEDLLOVERRIDES"] + ";vulkan-1="},
        )

    def test_pictures_find_a_place(self):
        """If `output` cannot be a folder, they go to the user's."""
        self.write("output", "")
        code, out, err = self.run_program("quad.json", *SMALL)
        self.assertEqual(code, 0, err)
        self.assertRegex(err, r"note: [^\n]*output[^\n]*: pictures go to [^\n]*path_tracing_lab\n")
        self.assertIn("path_tracing_lab", out)

    def test_two_at_a_time(self):
        """Both write the same files over and over."""
        command = ["quad.json", *SMALL[:2], "--samples=3000", "--save-every=0.01", "--output=a.exr"]
        processes = [self.start(*command) for _ in range(2)]
        for process in processes:
            out, err = process.communicate(timeout=120)
            self.assertEqual((process.returncode, err.count("error") + err.count("cannot be written")), (0, 0), err)
        self.assertEqual(Exr(self.folder / "a.exr").text("samples"), "3000")
        self.assertEqual(list(self.folder.glob(".*")), [])

    def test_ctrl_c_writes_what_there_is(self):
        with self.start("quad.json", "--samples=4000000000", "--save-every=0.2", "--output=a.exr") as process:
            self.wait_for(self.folder / "a.exr", process)
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=300)
        self.assertEqual(process.returncode, 0, err)
        self.assertIn("--resume", out)

    def test_points_are_those_of_linux(self):
        command = ["directions", "02_cosine_sampling", "4096", "1", "0", "2", ""]
        windows = subprocess.run(
            ["wine", PROGRAMS / "sample_points.exe", *command], env=os.environ | wine, check=True, capture_output=True
        )
        linux = subprocess.run([CHAPTER.with_name("sample_points"), *command], check=True, capture_output=True)
        self.assertEqual(windows.stdout, linux.stdout)

    def test_a_handout_has_its_chapters_and_a_todo(self):
        chapter = "chapters/03_next_event_estimation"
        exercise = json.loads((PROJECT / chapter / "chapter.json").read_text(encoding="utf-8"))["exercise"]
        subprocess.run([sys.executable, "-B", TOOLS, "handout", "3", self.folder / "lab_3", "--windows"], check=True)
        with zipfile.ZipFile(self.folder / "lab_3.zip") as archive:
            programs = {Path(name).stem for name in archive.namelist() if name.endswith(".exe")}
            shader = archive.read(f"lab_3/{chapter}/{exercise['file']}").decode()
        self.assertEqual(
            programs, {"01_uniform_sampling", "02_cosine_sampling", "03_next_event_estimation", "merge_images", "sample_points"}
        )
        self.assertIn("TODO", shader)

    def test_the_window_follows_an_edited_shader(self):
        folder = self.unpack("lab")
        shader = folder / "chapters/01_uniform_sampling/path_trace.glsl"
        text = shader.read_text(encoding="utf-8")
        program = folder / "build/bin/01_uniform_sampling.exe"
        with self.start(program, "cornell_box", "--backend=compute", "--window", program="wine") as process:
            self.addCleanup(process.kill)
            self.wait_for_colour(lambda red, green, blue: red > 1.2 * blue > 12, "the Cornell box does not show")
            begin = text.index("{", text.index("vec3 path_trace(")) + 1
            shader.write_text(text[:begin] + " if (true) return vec3(0, 0.5, 0);" + text[begin:], encoding="utf-8")
            self.wait_for_colour(lambda red, green, blue: green > 100 and red + blue == 0, "the edited shader does not show")
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=300)
        self.assertEqual((process.returncode, err), (0, ""))
        self.assertIn("01_uniform_sampling.exr", out)

    def wait_for_colour(self, is_right, message):
        """Waits until the mean colour of the part of the screen where the window shows the scene is right."""
        end = time.monotonic() + 60
        while not is_right(*(colour := self.colour_of_scene())):
            self.assertLess(time.monotonic(), end, f"{message}: {colour}")
            time.sleep(0.2)

    def colour_of_scene(self):
        scene = ImageGrab.grab(xdisplay=wine["DISPLAY"]).crop((500, 200, 800, 500))
        return scene.resize((1, 1), Image.Resampling.BOX).getpixel((0, 0))
