"""An infinite or NaN sample: the program counts, displays and reports it."""

import json

from image_files import Exr, read_png
from program import CHAPTER, MERGE, RenderTest, copy_project


class Poison(RenderTest):
    """A copy of the program's shaders in which one sample of one pixel is NaN."""

    width, height, samples = 24, 20, 9
    pixel, sample = 7 * 24 + 11, 4

    def setUp(self):
        super().setUp()
        tree = self.folder / "poisoned"
        self.poisoned = copy_project(tree, program=CHAPTER)  # which looks for the shaders in parent folders
        shader = tree / "shaders/engine/sample_loop.glsl"
        text = shader.read_text(encoding="utf-8")
        call = "finish_sample(path_trace(ray, seed));"
        self.assertEqual(text.count(call), 1)
        poisoned = f"""bool is_poisoned = position.y * parameters.image_size.x + position.x == {self.pixel}u &&
                            parameters.first_sample + i == {self.sample}u;
        vec3 radiance = path_trace(ray, seed);
        finish_sample(is_poisoned ? vec3(0.5, uintBitsToFloat(0x7fc00000u), 0.5) : radiance);"""
        shader.write_text(text.replace(call, poisoned), encoding="utf-8")

    def render_to(self, name, *arguments, program=CHAPTER, samples=samples):
        """Renders to NAME.exr and more; returns that file and all that the program printed."""
        command = self.command(f"--samples={samples}", *arguments, scene="quad.json", size=(self.width, self.height))
        code, out, err = self.run_program(*command, f"--output={name}.exr", program=program)
        self.assertEqual(code, 0, err)
        return Exr(self.folder / f"{name}.exr"), out + err

    def test_an_invalid_sample_is_counted_shown_and_reported(self):
        clean, text = self.render_to("clean")
        self.assertNotIn("invalid", text)
        outputs = ("--output=poisoned.png", "--report=poisoned.json")
        poisoned, text = self.render_to("poisoned_picture", *outputs, program=self.poisoned)
        self.assertRegex(text, r"(?m)^invalid +1 of .* samples infinite or not a number")
        _, text = self.render_to("quiet", "--quiet", program=self.poisoned)
        self.assertRegex(text, r"\Anote: 1 of [^\n]*not a number[^\n]*\n\Z")
        self.assertEqual(poisoned.text("invalid_samples"), "1")
        report = json.loads((self.folder / "poisoned.json").read_text(encoding="utf-8"))
        self.assertEqual(report["invalid_samples"], 1)

        _, _, pixels = read_png(self.folder / "poisoned.png")
        magenta = [i for i, pixel in enumerate(pixels) if pixel[:3] == (255, 0, 255)]
        self.assertEqual(magenta, [self.pixel])
        for channel in "RGB":
            pairs = zip(clean.channels[channel], poisoned.channels[channel])
            self.assertEqual([i for i, (a, b) in enumerate(pairs) if a != b], [self.pixel], channel)
        self.record("other_pixels_that_change", f"0 of {self.width * self.height - 1}")

    def test_resuming_and_merging_keep_the_count(self):
        self.render_to("part", program=self.poisoned, samples=6)
        resumed, text = self.render_to("resumed", "--resume=part.exr", program=self.poisoned)
        self.assertEqual(resumed.text("invalid_samples"), "1")
        self.assertRegex(text, r"(?m)^invalid +1 of")
        self.render_to("rest", "--first-sample=6", program=self.poisoned, samples=3)
        self.render("part.exr", "rest.exr", "-o", "merged.exr", program=MERGE)
        merged = Exr(self.folder / "merged.exr")
        self.assertEqual((merged.text("invalid_samples"), merged.text("samples")), ("1", "9"))
