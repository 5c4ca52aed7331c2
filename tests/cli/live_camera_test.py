"""What readers of the book do to a picture: they move its camera, change its background, and choose its scene. The programs show the same."""

import subprocess
import tempfile
import unittest
from pathlib import Path

from live_pages_test import LivePages  # first: it finds the others
import numpy as np
from docs import first_steps
from image_files import Exr
from program import CHAPTER

SAMPLES, SIZE = 16, 128
TILE = 16  # pixels: Chromium's sine is coarser, so that some paths go another way


class LiveCamera(LivePages):
    def choose(self, control, value):
        self.frame(
            f"((frame.controls.{control}.value = '{value}'), frame.controls.{control}.dispatchEvent(new Event('change')), frame.film = null)"
        )

    def drag(self, *places):
        self.mouse("mousePressed", *places[0])
        for x, y in places[1:]:
            self.mouse("mouseMoved", x, y)
        self.mouse("mouseReleased", *places[-1])

    def key(self, code, until):
        """Holds a key of the picture until the expression is true."""
        self.frame("frame.picture.root.focus({ preventScroll: true })")
        self.browser.call("Input.dispatchKeyEvent", type="keyDown", code=code, key=code[-1].lower())
        self.wait(until, code)
        self.browser.call("Input.dispatchKeyEvent", type="keyUp", code=code, key=code[-1].lower())

    def tiles(self, image):
        return np.reshape(image, (SIZE // TILE, TILE, SIZE // TILE, TILE, 3)).mean(axis=(1, 3))

    def assert_same_picture(self, scene, *options):
        """The page shows what the program renders with these options."""
        self.wait(f"frame.film?.samples === {SAMPLES}", "a picture")
        shown = np.array(self.frame("Array.from(frame.film.sums)")) / SAMPLES
        wanted = {"samples": SAMPLES, "max-path-length": self.length(), "width": SIZE, "height": SIZE, "backend": "compute"}
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "picture.exr"
            arguments = [*(f"--{name}={value}" for name, value in wanted.items()), *options, "--quiet", "--output", file]
            subprocess.run([CHAPTER, scene, *arguments], check=True)
            exr = Exr(file)
        right = np.transpose([exr.channels[name] for name in "RGB"])
        shown, right = self.tiles(shown), self.tiles(right)
        self.assertGreater(right.mean(), 0.01)
        difference = np.abs(shown - right) / right.mean()
        self.assertLess(np.quantile(difference, 0.9), 0.02)

    def length(self):
        return self.frame("Number(frame.about.pictures[frame.controls.scene.value].name.replace(/.*_/, ''))")

    def verdict(self):
        return self.frame("frame.verdict.textContent")


class LiveCameraTest(LiveCamera, unittest.TestCase):
    def test_arrow_keys_turn_the_camera(self):
        self.start(1)
        self.end_pictures_after(SAMPLES)
        self.key("ArrowRight", "frame.picture.camera.forward[0] > 0.1")
        self.key("ArrowUp", "frame.picture.camera.forward[1] > 0.1")
        self.assertEqual(self.frame("frame.picture.camera.position"), [0, 1, 4])

    def test_first_steps_put_their_shaders_into_the_frame(self):
        self.browser.visit((self.site / "docs/first_steps.html").as_uri())
        self.assertEqual(self.browser.evaluate("document.querySelectorAll('.live-block').length"), 8)
        self.browser.evaluate("document.querySelector('.live-block').click()")
        self.wait("frame.verdict?.textContent === 'no verdict: the shader traces no ray'", "a picture")
        self.assertEqual(
            self.frame("frame.editor.field.value"), first_steps.shaders(first_steps.PAGE.read_text(encoding="utf-8"))["1"]
        )
        self.assert_no_complaints()


class LiveCamera_all(LiveCamera, unittest.TestCase):
    def scene(self, name):
        self.choose("scene", self.frame(f"frame.about.pictures.findIndex(picture => picture.name.startsWith('{name}'))"))

    def test_first_steps_offer_their_scenes(self):
        self.start(1, page="docs/first_steps.html")
        self.end_pictures_after(SAMPLES)
        self.scene("torus")
        self.assert_same_picture("torus")
        self.wait("frame.latest?.verdict", "a verdict")
        self.assertRegex(self.verdict(), "^agrees")
        self.scene("furnace")
        self.assert_same_picture("furnace")
        self.assertEqual(self.verdict(), "no verdict: this scene has no reference")
        mean = self.frame("frame.film.sums.reduce((sum, x) => sum + x, 0) / frame.film.sums.length / frame.film.samples")
        self.assertAlmostEqual(mean, 2 - 0.5**6, delta=0.05)
        self.assert_no_complaints()

    def test_the_background_is_that_of_the_option(self):
        self.start(1)
        self.end_pictures_after(SAMPLES)
        self.choose("sky", "0.5,1,2")
        self.assert_same_picture("cornell_box", "--background=0.5,1,2")
        self.assertEqual(self.verdict(), "no verdict: the background is not the scene's")
        self.frame(
            "(frame.controls.sky.value = '1,2', frame.controls.sky.dispatchEvent(new Event('change')), frame.controls.sky.blur())"
        )
        self.assertFalse(self.frame("frame.controls.sky.validity.valid"))
        self.choose("sky", "")
        self.wait("frame.film && frame.latest?.verdict", "a verdict")
        self.assertRegex(self.verdict(), "^agrees")

    def test_the_camera_moves_as_the_programs(self):
        self.start(1)
        self.end_pictures_after(SAMPLES)
        self.drag((0.5, 0.5), (0.52, 0.5), (0.4, 0.45))
        turned = np.array(self.frame("frame.picture.camera.forward"))
        # Two radians per height of the picture: to the left by 0.2, and up by 0.1.
        self.assertTrue(
            np.allclose(turned, [-np.sin(0.2) * np.cos(0.1), np.sin(0.1), -np.cos(0.2) * np.cos(0.1)], atol=1e-3), turned
        )
        self.key("KeyW", "frame.picture.camera.position[2] < 3.5")
        self.key("KeyD", "frame.picture.camera.position[0] > 0.3")
        self.frame("(frame.film = null, frame.picture.moved())")
        self.assertEqual(self.verdict(), "no verdict: the camera has changed")
        position, forward = self.frame("[frame.picture.camera.position, frame.picture.camera.forward]")
        target = [p + f for p, f in zip(position, forward)]
        text = [",".join(map(repr, vector)) for vector in (position, target)]
        self.assert_same_picture("cornell_box", f"--camera-position={text[0]}", f"--camera-target={text[1]}")
        self.assertEqual(self.verdict(), "no verdict: the camera has changed")
        self.assertFalse(self.frame("frame.controls.firstCamera.hidden"))
        self.key("KeyF", "frame.controls.firstCamera.hidden")
        self.wait("frame.film && frame.latest?.verdict", "a verdict")
        self.assertRegex(self.verdict(), "^agrees")
        self.assertFalse(self.browser.evaluate("document.querySelector('#__search').checked"), "F also opened the search")
        self.assert_no_complaints()


if __name__ == "__main__":
    unittest.main()
