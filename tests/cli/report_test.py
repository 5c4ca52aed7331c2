"""The report: error against samples and seconds, as JSON and CSV."""

import csv
import json
import math
import os
import re
import resource
import statistics

from image_files import Exr, relative_mse
from program import BINARIES, PROJECT, QUAD_JSON, RenderTest

FIELDS = ["samples", "seconds", "device_seconds", "cpu_seconds", "rays", "mse", "rel_mse", "rel_rmse", "mean"]


class Report(RenderTest):
    def report(self, *arguments, **options):
        self.image = self.picture("image", "--report=report.json", *arguments, **options)
        return json.loads((self.folder / "report.json").read_text())

    def test_fields(self):
        report = self.report("--samples=16", "--seed=5")
        expected = {"chapter": "01_uniform_sampling", "width": 24, "height": 20, "backend": "compute", "seed": 5}
        expected |= {"invalid_samples": 0, "scene": "cornell_box.json", "device": self.image.text("device")}
        self.assertEqual({name: report[name] for name in expected}, expected)
        for row in report["rows"]:
            for name in FIELDS:
                self.assertIn(name, row)

    def test_the_name_of_a_scene_need_not_be_utf_8(self):
        name = os.fsdecode(b"b\xfcro.json")
        (self.folder / name).write_text(QUAD_JSON)
        self.picture("image", "--samples=1", "--report=report.json", scene=name)
        self.assertEqual(json.loads((self.folder / "report.json").read_text(encoding="utf-8"))["scene"], "b\ufffdro.json")

    def test_rows_at_powers_of_two(self):
        report = self.report("--samples=24")
        self.assertEqual([row["samples"] for row in report["rows"]], [1, 2, 4, 8, 16, 24])
        for name in ("seconds", "device_seconds", "cpu_seconds", "rays"):
            numbers = [row[name] for row in report["rows"]]
            self.assertEqual(numbers, sorted(numbers))
            self.assertGreater(numbers[0], 0)
        # At least one ray per path, and at most one more than the default maximal path length 8.
        paths = 24 * 20 * 24
        self.assertTrue(paths <= report["rows"][-1]["rays"] <= 9 * paths)

    def test_seconds_do_not_contain_the_work_of_measuring(self):
        """There is little to render and much to measure, especially on a device that renders fast."""
        arguments, size = ["--samples=4", "--max-path-length=0"], (1000, 1000)
        plain = float(self.picture("plain", *arguments, size=size).text("seconds"))
        measured = float(self.picture("measured", *arguments, "--report=report.json", size=size).text("seconds"))
        row = json.loads((self.folder / "report.json").read_text())["rows"][-1]
        self.assertEqual(row["seconds"], measured)
        self.assertTrue(1 / 3 < measured / plain < 3, f"{measured} against {plain}")

    def test_cpu_seconds_are_those_of_all_threads(self):
        """As many as more samples take, by the system's account of the program."""

        def seconds(samples):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            row = self.report(f"--samples={samples}", size=(256, 256))["rows"][-1]
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            return row["cpu_seconds"], after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

        seconds(1)  # fills the caches of compiled shaders
        told, used = (many - few for many, few in zip(seconds(33), seconds(1)))
        if self.image.text("device").startswith("llvmpipe"):  # others hardly need the CPU
            self.assertTrue(0.7 < told / used < 1.4, f"{told} against {used}")

    def test_mean_is_that_of_the_image(self):
        row = self.report("--samples=8")["rows"][-1]
        for a, b in zip(row["mean"], self.image.mean()):
            self.assertAlmostEqual(a, b, delta=1e-5 * b)

    def test_errors_against_a_reference(self):
        self.picture("reference", "--samples=4096", "--seed=77")
        reference = Exr(self.folder / "reference.exr")
        report = self.report("--samples=64", "--reference=reference.exr")
        x, r = self.image.pixels(), reference.pixels()
        mse = sum((a - b) ** 2 for a, b in zip(x, r)) / len(r)
        row = report["rows"][-1]
        self.assertAlmostEqual(row["mse"] / mse, 1, delta=1e-4)
        self.assertAlmostEqual(row["rel_mse"] / relative_mse(self.image, reference), 1, delta=1e-4)
        self.assertAlmostEqual(row["rel_rmse"] / math.sqrt(relative_mse(self.image, reference)), 1, delta=1e-4)
        self.assertGreater(report["rows"][0]["mse"], 8 * row["mse"])

    def test_errors_without_a_reference_are_estimated(self):
        """The estimate from the image's own halves agrees with the error against a good reference."""
        self.picture("reference", "--samples=8192", "--seed=77")
        estimated = self.report("--samples=1024")["rows"][-1]["mse"]
        measured = self.report("--samples=1024", "--reference=reference.exr")["rows"][-1]["mse"]
        self.assertTrue(0.5 < estimated / measured < 2, f"{estimated} against {measured}")

    def test_the_program_prints_the_errors_of_the_report(self):
        out = self.render(*self.command("--samples=32"), "--output=a.exr", "--report=a.json")
        row = json.loads((self.folder / "a.json").read_text())["rows"][-1]
        self.assertEqual(f"{100 * row['rel_rmse']:.3g}", re.search(r"^noise +([\d.]+) %", out, re.MULTILINE)[1])
        deviation = float(re.search(r"^mean radiance .* ± ([\d.e-]+) ", out, re.MULTILINE)[1])
        self.assertAlmostEqual(deviation / math.sqrt(row["mse"] / (24 * 20)), 1, delta=0.01)
        # The same without a report; and neither slows down users who do not ask for it.
        again = self.render(*self.command("--samples=32"), "--output=b.exr")
        lines = [line for line in out.splitlines() if line.startswith(("mean", "noise"))]
        self.assertEqual([line for line in again.splitlines() if line.startswith(("mean", "noise"))], lines)
        # An error against a reference includes bias, so it is not a standard error.
        again = self.render(*self.command("--samples=32"), "--output=b.exr", "--reference=a.exr")
        self.assertNotRegex(again, "±")

    def test_every_picture_tells_its_error(self):
        """With any number of samples, from any first sample, when resumed, and with points that are not independent."""
        for chapter in ("05_russian_roulette", "09_low_discrepancy_points"):
            program = BINARIES / chapter
            for name, arguments in (
                ("a", ["--samples=100"]),
                ("b", ["--samples=201", "--resume=a.exr"]),
                ("c", ["--samples=7", "--first-sample=3"]),
            ):
                out = self.render(*self.command(*arguments), f"--output={name}.exr", program=program)
                self.assertRegex(out, "(?m)^noise .*estimated", f"{chapter}, {arguments}")
                if "--samples=100" in arguments:  # for an even number the file contains the standard errors
                    deviation = float(re.search(r"± ([\d.e-]+) ", out)[1])
                    channels = Exr(self.folder / "a.exr").channels
                    squares = [x * x for name in "RGB" for x in channels[f"difference.{name}"]]
                    self.assertAlmostEqual(math.sqrt(statistics.mean(squares) / (24 * 20)) / deviation, 1, delta=0.06)

    def test_the_mean_is_as_exact_as_its_error_says(self):
        """Over many renders with different seeds, each with the ± that it prints."""
        means, variances = [], []
        for seed in range(24):
            out = self.render(*self.command("--samples=16", f"--seed={seed}"), "--output=a.exr")
            *mean, deviation = map(float, re.search(r"^mean radiance +(\S+) (\S+) (\S+) ± (\S+)", out, re.MULTILINE).groups())
            means.append(mean)
            variances.append(deviation**2)
        spread = sum(statistics.variance(channel) for channel in zip(*means)) / 3  # all channels together: their root mean square
        self.assertTrue(0.5 < spread / statistics.mean(variances) < 2, f"{spread}, {statistics.mean(variances)}")

    def test_a_reference_of_another_size_is_refused(self):
        self.picture("small", "--samples=1", size=(8, 20))
        arguments = self.command("--samples=4000000000", "--reference=small.exr")
        self.assert_refused(arguments, r"small\.exr", "8x20", "24x20")

    def test_a_reference_of_something_else_is_noted(self):
        reference = PROJECT / "assets/references/cornell_box_6.exr"
        for scene, length, note in (
            ("cornell_box", 6, None),
            ("cornell_box", 7, "--max-path-length 6"),
            ("torus", 6, "another scene"),
        ):
            with self.subTest(scene=scene, length=length):
                arguments = "--samples=1", f"--max-path-length={length}", f"--reference={reference}"
                command = self.command(*arguments, scene=scene, size=(128, 128))
                code, _, error = self.run_program(*command, "--output=noted.exr")
                self.assertEqual(code, 0, error)
                self.assertRegex(error, rf"\Anote: \S*cornell_box_6.exr: .*{note}.*\n\Z" if note else r"\A\Z")

    def test_csv_has_the_same_rows(self):
        self.picture("image", "--samples=4", "--report=report.csv")
        with open(self.folder / "report.csv", newline="") as stream:
            rows = list(csv.DictReader(stream))
        self.assertEqual([row["samples"] for row in rows], ["1", "2", "4"])
        for row in rows:
            self.assertTrue({"seconds", "rays", "mse", "rel_mse", "rel_rmse"} <= row.keys())
            self.assertNotIn(None, row)
            self.assertGreater(float(row["seconds"]), 0)
