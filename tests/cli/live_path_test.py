"""The path of a clicked pixel in the book's live frames: it is that of the picture's sample, listed and drawn."""

import json
import re
import unittest

from live_pages_test import LivePages  # first: it finds the others
from project import CHAPTERS, course, description
from tools_path import PROJECT

PAGE = "docs/first_steps.html"
NUMBER = r"-?\d[\d.e+-]*"


class LivePath(LivePages):
    def click_picture(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.mouse(kind, x, y)
        self.wait("frame.picture.path.path", "a path")

    def path(self, expression):
        return self.frame(f"(path => {expression})(frame.picture.path.path)")

    def next_sample(self):
        self.click(">")
        self.wait("!frame.picture.path.isRecording && frame.picture.path.path", "the next sample")

    def lines(self):
        """The listed hits: [[title, line, …]]."""
        text = "[...frame.picture.path.list.children].map(element => element.textContent.split('\\n'))"
        parts = self.frame(text)
        return [title + lines for title, lines in zip(parts[::2], parts[1::2])]

    def assert_samples_add_up(self, samples):
        """The first samples of a pixel that is lit add up to what the picture has there."""
        self.end_pictures_after(samples)
        self.wait(f"frame.film?.samples === {samples}", "a picture")
        width, lit, sums = self.frame(
            """(({width, sums}) => { const i = sums.findIndex((x, i) => x > 0 && i > sums.length / 3); const first = i - i % 3;
            return [width, first / 3, Array.from(sums.subarray(first, first + 3))]; })(frame.film)"""
        )
        self.frame(f"frame.picture.path.select([{lit % width}, {lit // width}])")
        total = [0, 0, 0]
        for sample in range(samples):
            self.wait("!frame.picture.path.isRecording && frame.picture.path.path", "a path")
            self.assertEqual(self.frame("frame.picture.path.selection.sample"), sample)
            radiance = self.path("path.radiance")
            total = [a + b for a, b in zip(total, radiance)]
            found = self.path("path.vertices.reduce((sum, vertex) => sum + vertex.radiance[1], 0)")
            if self.path("path.vertices.filter(({parent}) => parent === 0).length") == 1:  # a branch of several has a weight
                self.assertAlmostEqual(found, radiance[1], delta=1e-4 * (1 + radiance[1]))
            self.next_sample()
        for part, right in zip(total, sums):
            self.assertAlmostEqual(part, right, delta=1e-5 * (1 + right))
        self.assertGreater(max(total), 0)


class LivePathTest(LivePath, unittest.TestCase):
    def test_samples_are_those_of_the_picture(self):
        self.start(1, page=PAGE)
        self.assert_samples_add_up(8)
        self.assert_no_complaints()

    def test_the_list_has_the_numbers_of_the_furnace(self):
        """Step 6 of the first steps: each bounce has the weight 0.5 there, and each hit emits 1."""
        blocks = re.findall(r"^```glsl\n(.*?)^```$", (PROJECT / "docs/first_steps.md").read_text(encoding="utf-8"), re.M | re.S)
        self.start(1, page=PAGE)
        self.frame("(frame.controls.scene.value = frame.about.pictures.findIndex(({name}) => name === 'furnace_6'), 0)")
        self.frame(f"(frame.film = null, frame.editor.edit({json.dumps(blocks[5])}))")
        self.wait("frame.film && frame.picture.picture.name === 'furnace_6' && frame.editor.edited.length", "the furnace")
        self.click_picture(0.252, 0.752)
        hits = self.lines()
        self.assertEqual([hit[0] for hit in hits], ["x1, seen by the camera", *(f"x{i + 2}, after x{i + 1}" for i in range(6))])
        for i, (_, throughput, position, normal, radiance) in enumerate(hits):
            value = f"{0.5**i:.3g}"
            self.assertEqual(throughput, f"throughput RGB {value} {value} {value}")
            self.assertEqual(radiance, f"radiance found RGB {value} {value} {value}")
            self.assertRegex(position, rf"^position \({NUMBER}, {NUMBER}, {NUMBER}\)$")
            self.assertRegex(normal, rf"^normal \({NUMBER}, {NUMBER}, {NUMBER}\)$")
        self.assertEqual(self.frame("frame.picture.path.radiance.textContent"), "this sample's radiance RGB 1.98 1.98 1.98")
        self.assertRegex(self.frame("frame.picture.path.title.textContent"), r"^A path: sample 0 of pixel \(32, 96\)$")
        # Drawn: the first hit is where the reader has clicked.
        x, y = self.frame("['cx', 'cy'].map(name => frame.picture.root.querySelector('circle').getAttribute(name) / 400)")
        self.assertAlmostEqual(x, 32.5 / 128, delta=0.6 / 128)
        self.assertAlmostEqual(y, 96.5 / 128, delta=0.6 / 128)
        self.assertEqual(
            self.frame("frame.picture.root.querySelectorAll('text').length"),
            self.path("path.vertices.filter(({isHit}) => isHit).length"),
        )
        first = self.path("path.vertices[1].position")
        self.next_sample()
        self.assertNotEqual(self.path("path.vertices[1].position"), first)
        self.click("<")
        self.wait("!frame.picture.path.isRecording && frame.picture.path.path", "the first sample")
        self.assertEqual(self.path("path.vertices[1].position"), first)
        self.assert_no_complaints()

    def test_keys_and_what_changes_a_path(self):
        self.start(1, page=PAGE)
        self.frame("frame.picture.root.focus({ preventScroll: true })")
        self.browser.call("Input.dispatchKeyEvent", type="keyDown", key="Enter", code="Enter")
        self.wait("frame.picture.path.path", "a path")
        self.assertEqual(self.frame("frame.picture.path.selection.pixel"), [64, 64])
        self.frame("(frame.picture.path.path = undefined, frame.picture.camera.move({steps: [0, 0, 1]}), frame.picture.moved())")
        self.wait("frame.picture.path.path", "a path from elsewhere")
        camera = self.frame("frame.picture.camera.position")
        for part, right in zip(self.path("path.vertices[0].origin"), camera):
            self.assertAlmostEqual(part, right, places=5)
        self.frame("frame.picture.root.focus({ preventScroll: true })")
        self.browser.call("Input.dispatchKeyEvent", type="keyDown", key="Escape", code="Escape")
        self.wait("frame.picture.path.root.hidden", "no path")
        self.assert_no_complaints()


class LivePath_all(LivePath, unittest.TestCase):
    def test_chapters_with_branches_media_and_light_samples(self):
        for chapter, words in ((5, "light sample at|Russian roulette"), (13, "collides in the medium, at|light sample at")):
            with self.subTest(chapter=chapter):
                self.start(chapter)
                self.assert_samples_add_up(4)
                self.assertRegex(str(self.lines()), words)

    def test_every_chapter_shows_the_samples_of_its_picture(self):
        for chapter in course():
            if description(CHAPTERS[chapter]).get("light_paths"):
                continue  # other samples add to the pixel, too: live_light_paths_test.py
            with self.subTest(chapter=chapter):
                self.start(chapter)
                self.assert_samples_add_up(4)


if __name__ == "__main__":
    unittest.main()
