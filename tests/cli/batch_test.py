"""Several pictures by one program, --batch, and the tool's side of it."""

import os
import re
import shlex
import signal
import subprocess
import sys
import time
from unittest import mock

from image_files import Exr
from program import BINARIES, CHAPTER, TIMEOUT_SECONDS, UNOPTIMISED, ProgramTest
from project import UserError
from report import batch as report_batch
from report.batch import Batch, quoted

SMALL = "--width 24 --height 20 --samples 3"
# A program that behaves as a command line says.
OBEYING = """#!{python}
import os, shlex, sys, time
for line in sys.stdin:
    if "crash" in line: os.kill(os.getpid(), 11)
    if "hang" in line: time.sleep(600)
    if "wait" in line: time.sleep(1.5)
    if "compute" in line: sum(range(10**10))
    if "refuse" in line: sys.exit("error: line %d of the standard input: refused" % 1)
    print(os.getpid(), file=open(shlex.split(line)[0], "w"))
    print("done", flush=True)
"""


class BatchOfPictures(ProgramTest):
    def batch(self, *lines, program=CHAPTER):
        """Exit code, standard output and standard error."""
        text = "".join(f"{line}\n" for line in lines)
        process = subprocess.run(
            [program, "--batch"],
            cwd=self.folder,
            input=text,
            capture_output=True,
            encoding="utf-8",
            timeout=TIMEOUT_SECONDS,
            env=os.environ | UNOPTIMISED,
        )
        return process.returncode, process.stdout, process.stderr

    def test_its_pictures_are_those_of_commands_of_their_own(self):
        """Whatever they share with the one before: the scene, the shaders, the device or nothing."""
        (self.folder / 'a "b').mkdir()
        for file in self.folder.glob("quad.*"):
            (self.folder / 'a "b' / file.name).write_bytes(file.read_bytes())
        scenes = [
            ("quad.json", ""),
            ("quad.json", "--seed 2"),
            ("quad.json", "--only-path-length 1"),
            (quoted('a "b/quad.json'), ""),
            ("quad.json", "--background 0,0,0"),
            ("cornell_box", ""),
            ("cornell_box", "--strategy bounces"),
            ("cornell_box", "--view normals"),
            ("torus", "--device 0"),
            ("torus", "--device 0 --exposure 1"),
        ]
        commands = [f"{scene} {SMALL} --backend compute {options}" for scene, options in scenes]
        commands += [
            f"{scene} {SMALL} --backend {backend}"
            for backend in ("query", "pipeline")
            for scene in ("quad.json", "cornell_box")
            if re.search(rf"{backend} +works", self.render("--list-devices"))
        ]
        program = BINARIES / "03_next_event_estimation"
        code, out, err = self.batch(
            *(f"{command} --quiet --output batch_{i}.exr" for i, command in enumerate(commands)), program=program
        )
        self.assertEqual((code, err), (0, ""))
        self.assertEqual(out, "".join(f"line {i + 1} is done\n" for i in range(len(commands))))
        pictures = set()
        for i, command in enumerate(commands):
            self.render(*shlex.split(command), "--quiet", "--output", f"single_{i}.exr", program=program, environment=UNOPTIMISED)
            batch, single = (Exr(self.folder / f"{kind}_{i}.exr") for kind in ("batch", "single"))
            self.assertEqual(batch.pixels(), single.pixels(), command)
            for key in ("settings", "scene_hash", "estimator_hash", "backend", "seed"):
                self.assertEqual(batch.text(key), single.text(key), command)
            pictures.add(str(single.pixels()))
        self.assertGreaterEqual(len(pictures), 8, "they differ")

    def test_a_view_is_refused_where_a_command_of_its_own_would_refuse_it(self):
        backends = [
            name for name in ("query", "pipeline", "native") if re.search(rf"{name} +works", self.render("--list-devices"))
        ]
        for backend in backends:
            code, out, err = self.batch(
                f"quad.json {SMALL} --backend {backend} --quiet --output first.exr",
                f"quad.json {SMALL} --backend {backend} --quiet --output last.exr --view bvh-steps",
            )
            self.assertEqual((code, out), (1, "line 1 is done\n"))
            self.assertRegex(err, rf"\Aerror: line 2 [^\n]*bvh-steps does not work with the backend {backend}")
        self.assertFalse((self.folder / "last.exr").exists())

    def test_an_error_names_its_line_and_what_is_before_it_is_kept(self):
        for wrong, words, code in (
            (f"quad.json --samples {2**32}", "--samples", 1),
            ("nothing.json", "nothing.json", 1),
            ("quad.json --device 99", "99", 2),
            ("--batch", "--batch goes alone", 1),
            ("quad.json --window", "--window", 1),
            ("x" * 70000, "is longer than", 1),
        ):
            with self.subTest(wrong[:50]):
                actual, out, err = self.batch(
                    f"quad.json {SMALL} --quiet --output first.exr", "", wrong, f"quad.json {SMALL} --output last.exr"
                )
                self.assertEqual((actual, out), (code, "line 1 is done\nline 2 is done\n"), err)
                self.assertRegex(err, rf"\Aerror: line 3 of the standard input: [^\n]*{words}[^\n]*\n\Z")
                self.assertFalse((self.folder / "last.exr").exists())
                (self.folder / "first.exr").unlink()

    def test_without_lines_it_ends(self):
        self.assertEqual(self.batch(), (0, "", ""))

    def test_it_goes_alone(self):
        self.assert_refused(["quad.json", "--batch"], "--batch goes alone")

    def test_ctrl_c_writes_the_picture_that_it_renders_and_ends(self):
        with subprocess.Popen(
            [CHAPTER, "--batch"],
            cwd=self.folder,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        ) as process:
            process.stdin.write(
                f"quad.json {SMALL} --quiet --output first.exr\nquad.json --quiet --samples 4000000000 --save-every 0.1 "
                "--output long.exr\nquad.json --output last.exr\n"
            )
            process.stdin.flush()
            self.wait_for(self.folder / "long.exr", process)
            process.send_signal(signal.SIGINT)
            _, err = process.communicate(timeout=TIMEOUT_SECONDS)
        self.assertEqual(process.returncode, 1)
        self.assertRegex(err, r"\Aerror: line 2 [^\n]*interrupted[^\n]*\n\Z")
        self.assertGreater(int(Exr(self.folder / "long.exr").text("samples")), 0)
        self.assertFalse((self.folder / "last.exr").exists())

    def test_a_time_limit_holds_for_its_picture_only(self):
        """Also with the backend native, which gets a signal somewhat later."""
        backend = "native" if re.search("native +works", self.render("--list-devices")) else "compute"
        code, _, err = self.batch(
            f"quad.json --backend {backend} --samples 4000000000 --time-limit 0.2 --quiet --output first.exr",
            "quad.json --backend compute --samples 4000000000 --time-limit 4 --quiet --output second.exr",
            f"quad.json {SMALL} --quiet --output third.exr",
        )
        self.assertEqual((code, err), (0, ""))
        self.assertGreater(float(Exr(self.folder / "second.exr").text("seconds")), 4)
        self.assertEqual(Exr(self.folder / "third.exr").text("samples"), "3")


class BatchTest(ProgramTest):
    """What the tools do with a program that ends, crashes or hangs."""

    def setUp(self):
        super().setUp()
        self.program = self.write("program", OBEYING.format(python=sys.executable))
        self.program.chmod(0o755)

    def run_in(self, batch, name, timeout=300):
        """The process that rendered a picture, or the exit code and the error of one that failed."""
        process = batch.run([self.program], [self.folder / name], timeout)
        return int((self.folder / name).read_text()) if process.returncode == 0 else (process.returncode, process.stderr.strip())

    def test_one_process_renders_one_picture_after_another(self):
        with Batch() as batch:
            first = self.run_in(batch, "picture")
            self.assertEqual(self.run_in(batch, 'with "quotes" and \\'), first)

    def test_a_picture_that_fails_loses_no_other(self):
        with Batch() as batch:
            self.run_in(batch, "picture")
            self.assertEqual(self.run_in(batch, "crash"), (-11, ""))
            self.assertEqual(self.run_in(batch, "refuse"), (1, "error: refused"))
            with self.assertRaises(subprocess.TimeoutExpired):
                self.run_in(batch, "hang", timeout=0.3)
            self.assertIsInstance(self.run_in(batch, "picture"), int)

    def test_a_program_that_others_keep_from_computing_is_given_more_time(self):
        """Its limit counts what it computes then; without others, it counts what passes."""
        for is_crowded, name, is_ended in ((False, "wait", True), (True, "wait", False), (True, "compute", True)):
            with self.subTest(name, is_crowded=is_crowded), Batch() as batch, mock.patch.object(
                report_batch, "is_crowded", lambda: is_crowded
            ):
                self.run_in(batch, "picture")  # it has started
                if is_ended:
                    with self.assertRaises(subprocess.TimeoutExpired):
                        self.run_in(batch, name, timeout=0.4)
                else:
                    self.assertIsInstance(self.run_in(batch, name, timeout=0.4), int)

    def test_at_the_end_nothing_goes_on(self):
        with Batch() as batch:
            found = batch.map(lambda name: self.run_in(batch, name), ["hang"] * 3)
            while len(batch.workers) < 2:
                time.sleep(0.01)
        self.assertEqual([worker.process.poll() for worker in batch.workers], [-9, -9])
        self.assertEqual(next(found), (-9, ""))
        with self.assertRaises(UserError):
            self.run_in(batch, "picture")
