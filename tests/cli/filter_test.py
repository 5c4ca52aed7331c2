"""Filters of the finished picture: what a filtered file says, and what must not be done with it."""

import json

from image_files import Exr
from program import BINARIES, MERGE, RenderTest
from tools_path import PROJECT

CHAPTER = BINARIES / "16_denoising"


class FilterTest(RenderTest):
    def filtered(self, name, *arguments):
        return self.picture(name, *arguments, program=CHAPTER)

    def refused(self, words, *arguments):
        self.assert_refused(self.command(*arguments), words, program=CHAPTER)

    def test_filtered_files_say_so_and_stand_alone(self):
        for name in ("bilateral", "a_trous", "nl_means"):
            self.assertEqual(self.filtered(name, "--samples=8", f"--filter={name}").text("filter"), name)
        file = self.folder / "nl_means.exr"
        self.refused("cannot be continued or merged", "--samples=16", f"--resume={file}")
        self.refused("cannot serve as a reference", "--samples=4", f"--reference={file}")
        self.assert_refused([file, "-o", self.folder / "merged.exr"], "cannot be continued or merged", program=MERGE)

    def test_a_render_can_be_continued_with_a_filter(self):
        self.filtered("first", "--samples=8")
        continued = self.filtered("continued", "--samples=16", f"--resume={self.folder / 'first.exr'}", "--filter=nl_means")
        whole = self.filtered("whole", "--samples=16", "--filter=nl_means")
        for one, other in zip(continued.pixels(), whole.pixels()):
            self.assertAlmostEqual(one, other, delta=1e-5)

    def test_too_few_samples_are_not_filtered(self):
        text = self.render(
            *self.command("--samples=3", "--filter=nl_means"), "--output", self.folder / "few.exr", program=CHAPTER
        )
        self.assertIn("needs four samples", text)
        self.assertNotIn("filter", Exr(self.folder / "few.exr").attributes)

    def test_a_filter_needs_new_samples(self):
        self.filtered("first", "--samples=8")
        options = self.command("--samples=8", f"--resume={self.folder / 'first.exr'}", "--filter=nl_means")
        text = self.render(*options, "--output", self.folder / "same.exr", program=CHAPTER)
        self.assertIn("needs two new samples a pixel", text)
        attributes = Exr(self.folder / "same.exr").attributes
        self.assertFalse({"filter", "shows"} & set(attributes))

    def test_pixels_that_a_filter_divides_by_0_are_counted(self):
        text = (PROJECT / "chapters/16_denoising/filter.glsl").read_text(encoding="utf-8")
        file = self.write("filter.glsl", text.replace("= sum / weights;", "= sum * (1.0 / (weights * 0.0));"))
        options = self.command("--samples=8", "--filter=bilateral", f"--shader=filter.glsl={file}")
        out = self.render(*options, "--output", self.folder / "infinite.exr", program=CHAPTER)
        self.assertRegex(out, r"invalid +\d+ of \S+( \w)? samples infinite or not a number")

    def test_a_bias_has_no_target(self):
        self.refused("leave one of them out", "--filter=nl_means", "--target-error=0.1")

    def test_reports_split_the_error(self):
        report = self.folder / "report.json"
        self.filtered("picture", "--samples=16", "--filter=bilateral", f"--report={report}")
        for row in json.loads(report.read_text())["rows"]:
            if row["samples"] < 4:
                self.assertNotIn("variance", row)
                continue
            self.assertAlmostEqual(row["squared_bias"], max(row["rel_mse"] - row["variance"], 0))
            self.assertLess(row["variance"], row["rel_mse_unfiltered"])
