"""Pictures: the same command gives the same bits, parts add up to the whole, and every file format is correct."""

import math
import re
import stat

from image_files import Exr, read_png
from program import BINARIES, MERGE, ProgramTest, RenderTest
from project import write_bytes


class Determinism(RenderTest):
    def test_the_same_command_gives_the_same_bits(self):
        first = self.picture("a", "--samples=16")
        self.assertEqual(first.pixels(), self.picture("b", "--samples=16").pixels())
        self.assertGreater(max(first.pixels()), 0)

    def test_every_backend_of_the_device_gives_the_same_bits_again(self):
        devices = self.render("--list-devices").split("\n1  ")[0]
        for backend in re.findall(r"(?m)^ +(\w+) +works$", devices):
            with self.subTest(backend=backend):
                arguments = ["cornell_box", "--device=0", "--width=40", "--height=40", "--samples=9"]
                for name in ("a.exr", "b.exr"):
                    self.render(*arguments, "--backend", backend, "--output", name)
                first, second = Exr(self.folder / "a.exr"), Exr(self.folder / "b.exr")
                self.assertEqual(first.text("backend"), backend)
                self.assertEqual(first.pixels(), second.pixels())

    def test_seeds_and_sample_ranges_give_other_pictures_with_the_same_mean(self):
        means = []
        pictures = [
            self.picture("a", "--samples=64"),
            self.picture("b", "--samples=64", "--seed=2"),
            self.picture("c", "--samples=64", "--first-sample=64"),
        ]
        for picture in pictures:
            means.append(sum(picture.mean()))
        self.assertEqual(len({tuple(picture.pixels()) for picture in pictures}), 3)
        self.assertLess(max(means) - min(means), 0.2 * means[0])

    def test_more_samples_begin_with_the_same_ones(self):
        """Sample i depends only on pixel, seed and i: 3 samples plus the following one are the first 4."""
        three, last, four = (
            self.picture("a", "--samples=3"),
            self.picture("b", "--samples=1", "--first-sample=3"),
            self.picture("c", "--samples=4"),
        )
        for a, b, c in zip(three.pixels(), last.pixels(), four.pixels()):
            self.assertAlmostEqual((3 * a + b) / 4, c, delta=1e-6 * (1 + abs(c)))


class LargeImages(RenderTest):
    def test_all_pixels_of_an_image_that_shaders_see_in_parts_have_their_sample(self):
        """Mesa's driver for CPUs binds 4.2 million pixels at a time."""
        out = self.render("quad.json", "--width=4096", "--height=1100", "--samples=1", "--output=a.png")
        self.assertRegex(out, "samples +1 a pixel, 4.51 M paths")


class SampleRanges(RenderTest):
    def test_halves_merge_to_the_whole(self):
        self.picture("first", "--samples=32")
        self.picture("second", "--samples=32", "--first-sample=32")
        whole = self.picture("whole", "--samples=64")
        self.render("second.exr", "first.exr", "-o", "merged.exr", program=MERGE)
        merged = Exr(self.folder / "merged.exr")
        self.assert_close(whole, merged)
        self.assert_same_error(whole, merged)
        for name in ("samples", "first_sample", "seed", "chapter", "scene", "invalid_samples"):
            self.assertEqual(merged.text(name), whole.text(name))

    def test_uneven_parts_merge_to_the_whole(self):
        parts = []
        for first, count in ((5, 7), (2, 3), (12, 21)):
            self.picture(f"part{first}", f"--samples={count}", f"--first-sample={first}")
            parts.append(f"part{first}.exr")
        self.render(*parts, "-o", "merged.exr", program=MERGE)
        whole, merged = self.picture("whole", "--samples=31", "--first-sample=2"), Exr(self.folder / "merged.exr")
        self.assert_close(whole, merged)
        self.assert_same_error(whole, merged)

    def assert_same_error(self, whole, merged):
        """If a part starts at an odd sample of the whole, its halves are swapped."""
        for name in ("difference.R", "difference.G", "difference.B"):
            for a, b in zip(whole.channels[name], merged.channels[name]):
                self.assertAlmostEqual(a, b, delta=1e-5 * max(whole.channels["G"]))

    def test_what_does_not_belong_together_is_refused(self):
        self.picture("a", "--samples=4")
        self.picture("overlap", "--samples=4", "--first-sample=3")
        self.picture("gap", "--samples=4", "--first-sample=5")
        self.picture("seed", "--samples=4", "--first-sample=4", "--seed=7")
        self.picture("length", "--samples=4", "--first-sample=4", "--max-path-length=2")
        self.picture("size", "--samples=4", "--first-sample=4", size=(8, 20))
        self.picture("scene", "--samples=4", "--first-sample=4", scene="quad.json")
        self.picture("view", "--samples=4", "--first-sample=4", "--view=normals")
        for other in ("a", "overlap", "gap", "seed", "length", "size", "scene", "view"):
            self.assert_refused(["a.exr", f"{other}.exr", "-o", "merged.exr"], rf"{other}\.exr", program=MERGE)


class PathLengths(RenderTest):
    def test_lengths_sum_to_the_whole(self):
        longest = 4
        whole = self.picture("whole", "--samples=16", f"--max-path-length={longest}").pixels()
        total = [0.0] * len(whole)
        for length in range(longest + 1):
            only = self.picture(f"only{length}", "--samples=16", f"--max-path-length={longest}", f"--only-path-length={length}")
            total = [a + b for a, b in zip(total, only.pixels())]
        brightness = sum(whole) / len(whole)
        for a, b in zip(total, whole):
            self.assertAlmostEqual(a, b, delta=1e-5 * (abs(b) + brightness))

    def test_length_0_shows_emission(self):
        emission = self.picture("view", "--samples=16", "--view=emission").pixels()
        self.assertEqual(self.picture("zero", "--samples=16", "--max-path-length=0").pixels(), emission)
        self.assertGreater(max(emission), 0)


class Sky(RenderTest):
    away = ["--camera-position=0,0,3", "--camera-target=0,0,9"]

    def test_a_constant_sky_is_exact(self):
        picture = self.picture("sky", "--samples=5", *self.away, "--background=0.25,0.5,3", scene="quad.json")
        for name, radiance in zip("RGB", (0.25, 0.5, 3)):
            self.assertEqual(set(picture.channels[name]), {radiance})

    def test_a_scene_without_a_sky_can_be_given_one(self):
        options = ["--samples=4", "--max-path-length=1"]
        self.assertEqual(max(self.picture("black", *options, *self.away).pixels()), 0)
        picture = self.picture("lit", *options, *self.away, "--background=0.25,0.5,3")
        for name, radiance in zip("RGB", (0.25, 0.5, 3)):
            self.assertEqual(set(picture.channels[name]), {radiance})
        # It also lights surfaces.
        self.assertGreater(self.picture("box", *options, "--background=1,1,1").mean(), self.picture("no_sky", *options).mean())

    def test_a_bare_mesh_is_a_scene(self):
        """Its bounding box determines the camera."""
        dark = self.picture("dark", "--samples=4", "--background=0,0,0", scene="quad.obj")
        self.assertEqual(max(dark.pixels()), 0)
        picture = self.picture("lit", "--samples=64", "--background=1,1,1", scene="quad.obj")
        middle = picture.channels["R"][picture.width * (picture.height // 2) + picture.width // 2]
        self.assertAlmostEqual(middle, 0.5, delta=0.25)  # albedo 0.5 under a sky of radiance 1


class Views(RenderTest):
    def test_normals(self):
        picture = self.picture("view", "--samples=1", "--view=normals", scene="furnace")
        for colour in zip(*(picture.channels[name] for name in "RGB")):
            normal = [2 * number - 1 for number in colour]
            self.assertAlmostEqual(sum(number * number for number in normal), 1, places=5)
        self.assertGreater(len(set(picture.pixels())), 1)

    def test_depth(self):
        picture = self.picture("view", "--samples=1", "--view=depth", "--vertical-fov=1", scene="quad.json")
        for depth in picture.pixels():
            self.assertAlmostEqual(depth, 3, delta=0.01)

    def test_focus_shows_the_circle_of_confusion_in_pixels(self):
        # The quad is 3 units away. In the plane in focus, 2 units away, a pixel is 2 * 2 * tan(20 degrees) / 16 high.
        picture = self.picture(
            "view",
            "--samples=1",
            "--view=focus",
            "--aperture-diameter=0.5",
            "--focus-distance=2",
            scene="quad.json",
            size=(16, 16),
            program=BINARIES / "12_lens",
        )
        self.assertAlmostEqual(
            picture.channels["R"][8 * 16 + 8], 0.5 * (3 - 2) / 3 / (4 * math.tan(math.radians(20)) / 16), delta=0.01
        )

    def test_chapters_without_media_say_so(self):
        _, _, err = self.run_program(
            "fog", "--samples=1", "--width=8", "--height=8", "--headless", "--output=a.exr", program=BINARIES / "12_lens"
        )
        self.assertIn("leaves out its media", err)
        self.assert_refused(["fog", "--report=r.json", "--headless"], "cannot render the media", program=BINARIES / "12_lens")

    def test_chapters_without_a_lens_say_so(self):
        code, _, err = self.run_program("quad.json", "--aperture-diameter=0.1", "--samples=1", "--headless", "--output=a.exr")
        self.assertEqual(code, 0)
        self.assertIn("leaves out its lens", err)
        self.assert_refused(["quad.json", "--aperture-diameter=0.1", "--report=r.json", "--headless"], "cannot render the lens")
        self.assert_refused(
            ["focus", "--report=r.json", "--headless"], "cannot render the lens", program=BINARIES / "11_microfacets"
        )
        for bad in ("--aperture-diameter=-1", "--aperture-diameter=nan", "--focus-distance=0", "--focus-distance=inf"):
            self.assert_refused(["quad.json", bad, "--headless"], bad.split("=")[0])

    def test_albedo_and_emission(self):
        self.assertEqual(set(self.picture("a", "--samples=1", "--view=albedo", scene="furnace").pixels()), {0.5})
        self.assertEqual(set(self.picture("b", "--samples=1", "--view=emission", scene="furnace").pixels()), {1.0})

    def test_texture_coordinates(self):
        picture = self.picture("view", "--samples=1", "--view=texture-coordinates", scene="textured")
        self.assertGreater(len(set(picture.channels["R"])), 10)
        self.assertGreater(len(set(picture.channels["G"])), 10)

    def test_triangle_and_instance_ids_have_distinct_colours(self):
        def colours(view):
            picture = self.picture(view, "--samples=1", f"--view={view}", size=(64, 64))
            return len(set(zip(*(picture.channels[name] for name in "RGB"))))

        self.assertGreater(colours("triangles"), 15)
        self.assertEqual(colours("instances"), 2)  # the box, and what surrounds it

    def test_traversal_steps(self):
        picture = self.picture("view", "--samples=1", "--view=bvh-steps", scene="torus")
        self.assertGreater(min(picture.pixels()), 0)
        self.assertGreater(len(set(picture.pixels())), 5)
        self.assertTrue(all(steps == int(steps) for steps in picture.pixels()))


class PictureFiles(RenderTest):
    def test_all_kinds_of_files_at_once(self):
        names = ["a.exr", "a.hdr", "a.png", "a.jpg", "new/folder/b.png"]
        outputs = [argument for name in names for argument in ("--output", name)]
        self.render(*self.command("--samples=4", *outputs))
        starts = [b"\x76\x2f\x31\x01", b"#?RADIANCE\n", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n"]
        for name, start in zip(names, starts):
            self.assertTrue((self.folder / name).read_bytes().startswith(start), name)
        self.assertIn(b"-Y 20 +X 24\n", (self.folder / "a.hdr").read_bytes())
        self.assertFalse((self.folder / "output").exists())

    def test_endings_may_be_capital_letters(self):
        self.render(*self.command("--samples=1", "--output", "A.PNG", "--output", "A.EXR"))
        self.assertEqual(read_png(self.folder / "A.PNG")[:2], (24, 20))
        self.assertEqual(Exr(self.folder / "A.EXR").width, 24)

    def test_png_is_the_srgb_encoded_radiance(self):
        def encoded(radiance, exposure):
            value = min(max(radiance * 2**exposure, 0), 1)
            return 255 * (12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055)

        for exposure in (0, 1.5, -2):
            exr = self.picture("a", "--samples=16", f"--exposure={exposure}", "--output=a.png")
            width, height, pixels = read_png(self.folder / "a.png")
            self.assertEqual((width, height), (exr.width, exr.height))
            for shown, radiance in zip(pixels, zip(*(exr.channels[name] for name in "RGB"))):
                for a, b in zip(shown, radiance):
                    self.assertAlmostEqual(a, encoded(b, exposure), delta=0.51)

    def test_the_exr_tells_how_it_came_about(self):
        exr = self.picture("a", "--samples=3", "--seed=9", "--first-sample=5")
        expected = {"samples": "3", "seed": "9", "first_sample": "5", "chapter": "01_uniform_sampling"}
        expected |= {"backend": "compute", "invalid_samples": "0", "scene": "cornell_box.json"}
        for name, value in expected.items():
            self.assertEqual(exr.text(name), value)
        self.assertTrue(exr.text("device"))
        self.assertGreater(float(exr.text("seconds")), 0)


class WrittenFilesTest(ProgramTest):
    def test_links_are_followed_and_modes_are_kept(self):
        file, link = self.write("kept/file.png", "older contents"), self.folder / "link.png"
        file.chmod(0o600)
        link.symlink_to("kept/file.png")
        for write in (
            lambda: write_bytes(link, b"contents"),
            lambda: self.render("quad.json", "--samples=1", "--width=4", "--height=4", "--output", link),
        ):
            before = file.read_bytes()
            write()
            self.assertTrue(link.is_symlink())
            self.assertNotEqual(file.read_bytes(), before)
            self.assertEqual(stat.S_IMODE(file.stat().st_mode), 0o600)
            self.assertEqual(list(file.parent.iterdir()), [file])
