"""docs/first_steps.md: its shaders compile and show what the page says; its pictures are what they render."""

import re
from contextlib import nullcontext
from dataclasses import replace

from program import CHAPTER, PROJECT, ProgramTest, RenderTest  # first: it finds the tools
import numpy as np
from check.submission import replaced
from docs import figures, first_steps
from PIL import Image
from project import read_json
from references.images import read_rgb
from report.plots import GAP, LABEL, encode_srgb

MOST_LINES = 25
SHADERS = first_steps.shaders(first_steps.PAGE.read_text(encoding="utf-8"))
WITH_AND_WITHOUT_SKY = ("quad.json", "cornell_box")
SIZE = 32  # of the pictures here
# In the Cornell box: the floor below the lamp, and most of the left wall.
FLOOR, WALL = np.s_[24:28, 12:16], np.s_[16:24, 0:4]
MIDDLE = np.s_[8:24, 8:24]  # of quad.json: only its surface of albedo 1/2 under a uniform sky
SEEDS, SURE = 8, 6  # renders per estimate; standard deviations that rule out noise


class FirstSteps_all(RenderTest):
    pictures = {}  # renders so far, shared by all tests

    def show(self, step, *arguments, scene="cornell_box"):
        """The render of a step, or of chapter 1 for None: [height, width, 3]."""
        key = (step, *arguments, scene)
        if key not in self.pictures:
            self.pictures[key] = self.rendered(step, *arguments, scene=scene)
        return self.pictures[key]

    def rendered(self, step, *arguments, scene):
        file = self.folder / "picture.exr"
        command = self.command("--quiet", "--output", file, *arguments, scene=scene, size=(SIZE, SIZE))
        own = PROJECT / "chapters" / CHAPTER.name / "path_trace.glsl"
        with replaced(own, SHADERS[step]) if step else nullcontext([]) as shaders:
            self.render(*command, *shaders, program=CHAPTER)
        return read_rgb(file)

    def runs(self, step, value, *arguments, scene="cornell_box"):
        """A number from the picture in each of SEEDS renders. Steps with the same seed have the same random numbers."""
        return np.array([value(self.show(step, f"--seed={seed}", *arguments, scene=scene)) for seed in range(1, SEEDS + 1)])

    def deviation(self, values):
        """Standard deviation of their mean."""
        return np.std(values, ddof=1) / np.sqrt(SEEDS)

    def assert_more(self, more, less):
        """The first is larger by more than noise; both are runs()."""
        self.assertGreater(np.mean(more - less), SURE * self.deviation(more - less))

    def assert_same_mean(self, first, second):
        deviation = self.deviation(first - second)
        self.assertLess(deviation, 0.02 * np.mean(first), "too noisy to tell")
        self.assertLess(abs(np.mean(first - second)), SURE * deviation)

    def assert_same(self, first, second):
        np.testing.assert_allclose(first, second, rtol=1e-5)

    def test_each_step_is_a_short_shader(self):
        self.assertEqual([key for key in SHADERS if key.isdigit()], [str(step) for step in range(1, 9)])
        self.assertEqual([key for key in SHADERS if "broken" in key], [f"{step} broken" for step in (3, 5, 6, 7, 8)])
        self.assertLessEqual(max(len(shader.splitlines()) for shader in SHADERS.values()), MOST_LINES)

    def test_1_is_one_colour(self):
        colours = np.unique(self.show("1", "--samples=1").reshape(-1, 3), axis=0)
        self.assertEqual(colours.tolist(), np.array([[0.2, 0.5, 0.8]], np.float32).tolist())

    def test_2_shows_the_directions_of_the_camera(self):
        camera = read_json(PROJECT / "assets/scenes/cornell_box.json")["camera"]
        self.assertEqual((camera["position"][:2], camera["up"]), (camera["target"][:2], [0, 1, 0]), "it looks along -z")
        half = np.tan(np.radians(camera["vertical_fov"] / 2))
        place = half * ((np.arange(SIZE) + 0.5) * 2 / SIZE - 1)
        x, y = np.meshgrid(place, -place)
        direction = np.stack([x, y, -np.ones_like(x)], axis=2)
        direction /= np.linalg.norm(direction, axis=2, keepdims=True)
        # A sample may lie anywhere in its pixel.
        self.assertLess(abs(self.show("2", "--samples=1") - (0.5 + 0.5 * direction)).max(), half / SIZE)

    def test_3_shows_the_normals(self):
        for scene in ("cornell_box", "torus"):
            normals = self.show(None, "--samples=4", "--view=normals", scene=scene)
            self.assert_same(self.show("3", "--samples=4", scene=scene), normals)
            broken = self.show("3 broken", "--samples=4", scene=scene)
            self.assertEqual(np.allclose(broken, normals, rtol=1e-5), scene == "cornell_box")

    def test_4_is_what_shines(self):
        for scene in WITH_AND_WITHOUT_SKY:
            image = self.show("4", "--samples=4", scene=scene)
            self.assert_same(image, self.show(None, "--samples=4", "--max-path-length=0", scene=scene))
            self.assertGreater(image.max(), 0)
            self.assertEqual(image.min(), 0)

    def test_5_is_one_bounce_of_the_loop(self):
        for scene in WITH_AND_WITHOUT_SKY:
            loop = self.show("6", "--samples=16", "--max-path-length=1", scene=scene)
            self.assert_same(self.show("5", "--samples=16", scene=scene), loop)
        self.assertEqual(np.unique(self.show("5", "--samples=4", scene="quad.json")[MIDDLE]).tolist(), [0.5])

    def test_5_without_the_rotation_is_right_on_the_back_wall_alone(self):
        normals = self.show("3", "--samples=16")
        back_wall = np.all(normals == [0.5, 0.5, 1], axis=2)
        self.assertGreater(np.count_nonzero(back_wall), 100)
        self.assert_same(self.show("5", "--samples=16")[back_wall], self.show("5 broken", "--samples=16")[back_wall])
        for where in (FLOOR, WALL):
            self.assert_more(*(self.runs(step, lambda image: image[where].mean(), "--samples=64") for step in ("5", "5 broken")))

    def test_6_needs_the_product_of_all_albedos(self):
        one_bounce = ("--samples=16", "--max-path-length=1")
        self.assert_same(self.show("6", *one_bounce), self.show("6 broken", *one_bounce))
        six_bounces = ("--samples=16", "--max-path-length=6")
        right, broken = (self.runs(step, np.mean, *six_bounces) for step in ("6", "6 broken"))
        self.assert_more(broken, right)
        # The left wall is red.
        right, broken = (
            self.runs(step, lambda image: np.divide(*image[WALL].mean(axis=(0, 1))[:2]), *six_bounces)
            for step in ("6", "6 broken")
        )
        self.assert_more(right, broken)

    def test_6_is_too_bright_below_the_lamp_and_too_dark_at_the_walls(self):
        for where, is_brighter in ((FLOOR, True), (WALL, False)):
            loop, weighted = (
                self.runs(step, lambda image: image[where].mean(), "--samples=64", "--max-path-length=1") for step in ("6", "7")
            )
            self.assert_more(*((loop, weighted) if is_brighter else (weighted, loop)))

    def test_6_and_7_agree_in_the_furnace(self):
        self.assert_same_mean(
            *(self.runs(step, np.mean, "--samples=16", "--max-path-length=6", scene="furnace") for step in ("6", "7"))
        )

    def test_7_is_chapter_1(self):
        for scene in WITH_AND_WITHOUT_SKY:
            pictures = (self.show(step, "--samples=16", "--max-path-length=6", scene=scene) for step in ("7", None))
            self.assert_same(*pictures)

    def test_7_without_the_sine_reflects_twice_an_even_sky(self):
        for step, reflected in (("7", 0.5), ("7 broken", 1.0)):
            self.assert_same_mean(
                self.runs(step, lambda image: image[MIDDLE].mean(), "--samples=16", scene="quad.json"), reflected
            )

    def test_7_without_the_sine_gains_most_below_the_lamp(self):
        def floor_over_wall(image):
            return image[FLOOR].mean() / image[WALL].mean()

        options = ("--samples=256", "--max-path-length=1")
        self.assert_more(*(self.runs(step, floor_over_wall, *options) for step in ("7 broken", "7")))

    def test_8_is_chapter_1_to_the_bit(self):
        chapter = (PROJECT / "chapters" / CHAPTER.name / "path_trace.glsl").read_text(encoding="utf-8")
        lines = [re.sub(r" *//.*", "", line) for line in chapter.splitlines()]
        self.assertEqual(SHADERS["8"].splitlines(), [line for line in lines if line])
        for scene, *options in (("quad.json",), ("cornell_box",), ("torus",), ("cornell_box", "--only-path-length=2")):
            image = self.show("8", "--samples=4", *options, scene=scene)
            np.testing.assert_array_equal(image, self.show(None, "--samples=4", *options, scene=scene))
        self.assertFalse(np.allclose(image, self.show("7", "--samples=4", "--only-path-length=2")))

    def test_8_without_random_numbers_has_no_noise_and_is_wrong(self):
        for step, is_noisy in (("8", True), ("8 broken", False)):
            values = np.unique(self.show(step, "--samples=4", scene="quad.json")[MIDDLE])
            self.assertEqual(len(values) > 1, is_noisy)
        self.assert_more(*(self.runs(step, np.mean, "--samples=64") for step in ("8 broken", "8")))


class FirstStepsPictures_all(ProgramTest):
    """Tiles of 256 samples are noisy and rendered smaller here, so means of large squares are compared. Other tiles are rendered
    at full size; there the squares only have to hide what JPEG does to noise."""

    def tiles(self, picture, count):
        """The tiles of a picture, as figure_plots.sheet() arranges them."""
        with Image.open(picture) as image:
            size = image.height - LABEL - GAP
            return [
                np.array(image.crop((x, LABEL, x + size, LABEL + size))) / 255
                for x in range(GAP, GAP + count * (size + GAP), size + GAP)
            ]

    def difference(self, first, second, squares):
        """Mean difference of the means of squares x squares parts of two pictures."""
        first, second = (
            image.reshape(squares, len(image) // squares, squares, -1, 3).mean(axis=(1, 3)) for image in (first, second)
        )
        return np.abs(first - second).mean()

    def test_are_what_the_steps_render(self):
        pictures = {}
        for render in figures.renders_of_first_steps():
            pictures.setdefault(render.name.split("_")[1], []).append(render)
        for number, renders in pictures.items():
            is_noisy = [256 in render.options for render in renders]
            renders = [replace(render, size=64) if noisy else render for render, noisy in zip(renders, is_noisy)]
            for render in renders:
                render.run(self.folder)
            images = [encode_srgb(read_rgb(render.file(self.folder))) for render in renders]
            tiles = self.tiles(figures.PICTURES / f"first_steps_{number}.jpg", len(renders))
            for i, tile in enumerate(tiles):
                differences = [self.difference(tile, image, 8 if is_noisy[i] else 64) for image in images]
                self.assertEqual(np.argmin(differences), i, f"{renders[i].name}: {differences}")
                # Measured: at most 0.019, and 0.036 between steps 6 and 7.
                self.assertLess(differences[i], 0.025, renders[i].name)
