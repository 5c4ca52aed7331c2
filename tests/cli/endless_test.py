"""A shader with a loop that does not end: what the programs say, and that they end when asked to."""

import shutil
import signal
import subprocess
import time
import unittest

from copied_lab import SHADER, CopiedLab
from program import PROJECT, ProgramTest

WITH_DISPLAY = PROJECT / "tests/support/with_display.sh"
BODY = """vec3 path_trace(Ray ray, inout uvec2 seed) {
    vec3 radiance = vec3(0.5);
    for (;;) {
        Hit hit;
        if (trace_ray(ray, NO_LIMIT, hit)) radiance += 1.0;
        ray.direction = -ray.direction;
        if (radiance.x < 0.0) break;
    }
    return radiance;
}
"""


class Endless(CopiedLab):
    def setUp(self):
        super().setUp()
        self.shader.write_text(BODY, encoding="utf-8")


class EndlessTest(Endless, ProgramTest):
    def test_a_time_limit_ends_it_and_names_the_loop(self):
        for backend in ("compute", "pipeline", "native"):
            with self.subTest(backend=backend):
                code, _, err = self.run_program(
                    "quad.json", *self.SIZE, f"--backend={backend}", "--time-limit=1", program=self.program
                )
                self.assertEqual(code, 1)
                self.assertRegex(err, rf"\Aerror: \S+{SHADER}:3: this loop, or one around it, does not end[^\n]*\n\Z")

    def test_a_time_limit_waits_for_a_dispatch_that_takes_long(self):
        """As on a busy machine: each sample takes seconds, but its loop ends."""
        self.shader.write_text(BODY.replace("for (;;)", "for (uint i = 0u; i < 60000u; ++i)"), encoding="utf-8")
        code, out, err = self.run_program(
            "cornell_box",
            "--headless",
            "--width=128",
            "--height=128",
            "--samples=1000",
            "--backend=compute",
            "--time-limit=0.1",
            program=self.program,
        )
        self.assertEqual(code, 0, err)
        self.assertNotIn("error", err)
        self.assertRegex(out, "(?m)^samples .*stopped early")

    @unittest.skipUnless(shutil.which("Xvfb"), "xvfb is not installed")
    def test_the_window_closes_and_says_why_it_writes_nothing(self):
        command = [
            "sh",
            "-c",
            'exec "$0" quad.json --width=32 --height=32 --window --output=a.exr & echo $!; wait $!',
            self.program,
        ]
        with self.start(*command, program=WITH_DISPLAY, environment={"WAYLAND_DISPLAY": None}) as process:
            window = int(process.stdout.readline())
            time.sleep(5)  # it has met the loop
            self.assertIsNone(process.poll())
            subprocess.run(["kill", "-TERM", str(window)], check=True)
            _, err = process.communicate(timeout=300)
        self.assertRegex(err, rf"\Aerror: \S+{SHADER}:3: this loop, or one around it, does not end[^\n]*\n\Z")
        self.assertFalse((self.folder / "a.exr").exists())


class Endless_all(Endless, ProgramTest):
    def end(self, process, number):
        process.send_signal(number)
        try:
            return process.communicate(timeout=300)[1]
        except subprocess.TimeoutExpired:
            process.kill()
            self.fail(f"still running long after {number}")

    def test_a_signal_ends_a_render_whose_shader_does_not_end(self):
        for backend, number, code in (
            ("compute", signal.SIGTERM, 3),
            ("pipeline", signal.SIGINT, 3),
            ("native", signal.SIGTERM, 1),
        ):
            with self.subTest(backend=backend), self.start(
                "quad.json",
                "--width=32",
                "--height=32",
                "--samples=2",
                "--headless",
                f"--backend={backend}",
                program=self.program,
            ) as process:
                self.assertIn(f"backend {backend}", process.stdout.readline())
                note = process.stderr.readline()  # after some seconds
                self.assertRegex(
                    note, rf"\Anote: no sample for \d+ s: the device is busy, or a loop of \S+{SHADER} does not end; Ctrl-C stops"
                )
                err = self.end(process, number)
                answer = "" if backend == "native" else r"[^\n]*did not answer within 3 s: it is busy, or a loop"
                self.assertRegex(err, rf"(?m)^error: {answer}[^\n]*nothing[^\n]*\n\Z")
                self.assertEqual(process.returncode, code)
