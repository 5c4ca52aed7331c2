"""Light paths on the page of chapter 15: their light reaches other pixels than their own, which no draw of WebGL 2 can add to."""

import subprocess
import tempfile
import unittest
from pathlib import Path

from live_pages_test import LivePages  # first: it finds the others
import numpy as np
from image_files import Exr
from live_devices_test import WRITES_AT_MOST
from program import BINARIES
from project import text_of
from tools_path import PROJECT

SIZE, SAMPLES, TILE = 40, 16, 8
# Pages and programs take the same random numbers: their pictures differ by rounding, and by which connection a fragment keeps. Their
# means are closer than those of tiles.
SAME, SAME_TILES = 0.002, 0.08
# The page's pictures as small as this test's.
TINY = f"""for (const {{ pictures }} of Object.values(live.chapters)) for (const picture of pictures) {{
    const place = new live.Layout(live.sources["shaders/interface.h"]).offsetOf("RenderParameters", "image_size");
    picture.parameters.fill({SIZE}, place, place + 2);
    delete picture.reference;
}}
live.Picture.MOST_SAMPLES = {SAMPLES}"""
LACKING = """(() => {
    const { prototype } = WebGL2RenderingContext, { getExtension } = prototype;
    prototype.getExtension = function(name) { return name === "EXT_float_blend" ? null : getExtension.call(this, name); };
})()"""
LIGHT_PATH = "chapters/15_light_paths/light_path.glsl"
POWER = "vec3 power = PI * y.emission"  # of a light path
SPLAT = "add_splat(min(pixel, parameters.image_size - 1u), radiance, sample_index);"


class LiveLightPaths_all(LivePages, unittest.TestCase):
    def start_tiny(self, before=""):
        self.start(15, before=f"{TINY}; {before}")
        return self.picture()

    def picture(self):
        self.wait(f"frame.film?.samples >= {SAMPLES}", "a picture")
        return np.array(self.frame("[...frame.film.sums]")) / SAMPLES

    def assert_as_in_program(self, picture, chapter, *options):
        with tempfile.TemporaryDirectory() as folder:
            image = Path(folder) / "glass.exr"
            size = f"glass --width {SIZE} --height {SIZE} --samples {SAMPLES} --max-path-length 8 --quiet --headless"
            subprocess.run([BINARIES / chapter, *size.split(), *options, "--output", image], check=True)
            expected = np.array(Exr(image).pixels()).reshape(3, -1).T.ravel()
        self.assertLess(abs(picture.mean() / expected.mean() - 1), SAME)
        rows = SIZE // TILE
        tiles, others = (each.reshape(rows, TILE, rows, TILE, 3).mean(axis=(1, 3, 4)) for each in (picture, expected))
        self.assertLess(np.abs(tiles / others - 1).max(), SAME_TILES)

    def test_they_bring_the_light_that_they_bring_in_the_program(self):
        self.assert_as_in_program(self.start_tiny(), "15_light_paths")
        halves = self.frame("frame.film.differences.reduce((sum, x) => sum + x) / frame.film.sums.reduce((sum, x) => sum + x)")
        self.assertLess(abs(halves), 0.02)
        self.assertEqual(self.frame("[frame.film.invalid, frame.note.textContent.includes('lacks')]"), [0, False])
        text, doubled = text_of(PROJECT / LIGHT_PATH), POWER.replace("PI", "2.0 * PI")
        self.edit(POWER, doubled)
        with tempfile.NamedTemporaryFile("w", suffix=".glsl", encoding="utf-8") as file:
            file.write(text.replace(POWER, doubled))
            file.flush()
            self.assert_as_in_program(self.picture(), "15_light_paths", "--shader", f"{Path(LIGHT_PATH).name}={file.name}")
        self.assert_no_complaints()

    def test_the_light_path_of_a_sample_is_listed_and_drawn(self):
        self.start_tiny()
        self.frame(f"frame.picture.path.select([{SIZE // 2}, {SIZE // 2}])")
        seen = drawn = 0
        for _ in range(20):
            self.wait("!frame.picture.path.isRecording && frame.picture.path.path", "a path")
            bounces, connections = self.frame(
                "(path => [path.length, path.flatMap(({lightSamples}) => lightSamples).length])(frame.picture.path.path.lightPath)"
            )
            names = self.frame("[...frame.picture.path.list.querySelectorAll('strong')].map(title => title.textContent)")
            self.assertEqual(names, [f"y{i + 1}, bounce {i + 1} of the light path" for i in range(bounces)])
            self.assertEqual(
                self.frame("frame.picture.path.list.textContent.split('seen from the camera').length - 1"), connections
            )
            drawn += self.frame("frame.picture.root.querySelectorAll('line[stroke=\"#ff8c28\"]').length")
            seen += connections
            self.click(">")
        self.assertGreater(seen, 0)
        self.assertGreater(drawn, 20)
        self.assert_no_complaints()

    def test_devices_that_write_less_at_once(self):
        self.assert_as_in_program(self.start_tiny(WRITES_AT_MOST % 2), "15_light_paths")
        self.assertEqual(self.frame("frame.picture.renderings[0].rendering.films[0].frames.length"), 2)

    def test_what_is_no_number_is_counted(self):
        self.start_tiny()
        self.edit(SPLAT, SPLAT.replace("radiance", "-radiance"))
        self.picture()
        self.assertGreater(self.frame("frame.film.invalid"), 0)
        self.assertIn("are infinite or no numbers", self.frame("frame.picture.numbers.textContent"))

    def test_a_device_that_cannot_add_them_up(self):
        picture = self.start_tiny(LACKING)
        self.assertIn("This device lacks EXT_float_blend", self.frame("frame.note.textContent"))
        self.assert_as_in_program(picture, "14_many_lights")  # camera paths find all light
        self.assert_no_complaints()
