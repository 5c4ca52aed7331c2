"""./lab sample: points from the shaders' samplers, their density and the integrals they estimate."""

import re
import shutil
import sys
from unittest import mock

from program import BINARIES, TOOLS, UNOPTIMISED, ProgramTest, copy_project  # first: it finds the tools
import mistake
import numpy as np
from lesson import sample, sample_plots

NAMES = ["1d", "kd", "numbers", "blog-hash", "uniform-angles", "cosine", "light-point", "points", "lens"]


class SampleTest(ProgramTest):
    def text(self, *arguments, **options):
        """The printed text; nothing is drawn."""
        with mock.patch.multiple(sample_plots, save_overview=mock.DEFAULT, save_point_sets=mock.DEFAULT):
            return self.sample(*arguments, **options)

    def sample(self, *arguments, binaries=BINARIES):
        """Standard output of the command, run in this process. Its picture is picture.png."""
        with mock.patch.object(sample, "PROGRAM", binaries / "sample_points"), mock.patch.dict("os.environ", UNOPTIMISED):
            code, out, err = self.run_here(sample.main, *arguments, f"--output={self.folder / 'picture.png'}")
        self.assertEqual(code, 0, err)
        return out

    def refuse(self, arguments, *words):
        self.assert_tool_refused(["sample", *arguments], *words)

    def test_names_are_listed(self):
        code, out, err = self.run_tool("sample")
        self.assertEqual(code, 0, err)
        self.assertEqual(re.findall(r"^  ([\w-]+)  ", out, re.MULTILINE), NAMES)

    def test_every_sampler_follows_its_density_and_finds_its_integral(self):
        for name in NAMES:
            with self.subTest(name=name):
                out = self.sample(name, "--seed=2")
                self.assertNotIn("too large", out)
                # The last row of each integral: N, estimate, half of the 95 % interval, error.
                rows = re.findall(r"^ +4096 +([\d.]+) +± ([\d.]+) +([+-][\d.]+)$", out, re.MULTILINE)
                self.assertEqual(len(rows), out.count("∫"))
                for _, half, error in rows:
                    self.assertLess(abs(float(error)), 2.5 * float(half) + 1e-5)
                self.assertEqual((self.folder / "picture.png").read_bytes()[:4], b"\x89PNG")

    def test_the_chi_square_test_sees_what_one_coordinate_does_not_show(self):
        random = np.random.default_rng(1)
        for name in ("numbers", "cosine", "light-point"):
            playground = sample.PLAYGROUNDS[name]
            heights, others = random.random(4096), random.random(4096)
            for is_right in (True, False):
                second = others if is_right else 0.75 * others  # a quarter of the azimuths is missing, for instance
                if name == "cosine":
                    z, phi = np.sqrt(heights), 2 * np.pi * (second - 0.5)
                    points = np.stack([np.sqrt(1 - z**2) * np.cos(phi), np.sqrt(1 - z**2) * np.sin(phi), z, z], axis=1)
                elif name == "light-point":
                    w = 1 - np.sqrt(1 - heights)
                    points = np.stack([w, (1 - w) * second], axis=1)
                else:
                    points = np.stack([heights, second], axis=1)
                statistic, freedom, chance = sample.chi_square(playground, points)
                self.assertGreater(freedom, 100)
                self.assertEqual(chance > 1e-3, is_right, (name, statistic))

    def test_a_copy_shows_its_own_sampler(self):
        """By its number, in the folder of a student's copy: its points, right or wrong."""
        tree = self.folder / "lab"
        copy_project(tree, program=BINARIES / "sample_points")
        for number, replace, chance in (
            (20, "2.0 * PI * u.x - PI", "which is chance"),
            (21, "1.5 * PI * u.x - PI", "too large for chance"),
        ):
            copy = shutil.copytree(tree / "chapters/02_cosine_sampling", tree / f"chapters/{number}_mine")
            shader = copy / "sample_hemisphere.glsl"
            shader.write_text(shader.read_text(encoding="utf-8").replace("2.0 * PI * u.x - PI", replace), encoding="utf-8")
            out = self.render(
                "-B",
                tree / "tools",
                "sample",
                number,
                "--output",
                self.folder / "picture.png",
                program=sys.executable,
                environment=UNOPTIMISED | {"LAB_BINARIES": None},
            )
            self.assertIn(f"directions of chapter {number}", out)
            self.assertRegex(out, rf"chi² of cos θ and φ: .*{chance}")

    def test_cosine_sampling_is_exact_for_the_cosine(self):
        out = self.text("cosine")
        self.assertRegex(out, r"(?m)^ +4096 +3\.141593 +± 0\.000000 +[+-]0\.000000$")

    def test_a_grid_is_worse_in_more_dimensions(self):
        """Corners of a grid err by about 1/(2n) with n points along each axis, so 2^12 of them err by 2^(-12/k) / 2."""
        for dimensions in (2, 4):
            out = self.text("kd", f"--dimensions={dimensions}")
            error = float(re.findall(r"^ +4096 +([\d.]+) +[\d.]+$", out, re.MULTILINE)[0])
            self.assertAlmostEqual(error * 2 ** (1 + 12 / dimensions), 1, delta=0.1)

    def slopes(self, **options):
        """For the two integrals: slopes with grid points, random ones, Sobol's and scrambled ones."""
        out = self.text("points", **options)
        return [list(map(float, line.split()[1:])) for line in out.splitlines() if line.split()[:1] == ["slope"]]

    def test_errors_with_scrambled_points_fall_fast(self):
        disk, smooth = self.slopes()
        self.assertAlmostEqual(disk[1], -0.5, delta=0.06)
        self.assertAlmostEqual(smooth[1], -0.5, delta=0.06)
        self.assertLess(disk[3], -0.65)
        self.assertLess(smooth[3], -1.3)

    def test_a_mistake_in_the_points_shows(self):
        """If both numbers of a pair are equal, the estimate converges to a different integral."""
        _, smooth = self.slopes(binaries=self.tree_with("one-dimension-for-both"))
        self.assertGreater(smooth[3], -0.5)

    def tree_with(self, name):
        """Binaries that read shaders with a mistake from mistakes.json."""
        tree = self.folder / "tree"
        mistake.make(mistake.load()[name], tree)
        for name in ("tools/lesson", "bin"):
            (tree / name).mkdir(parents=True, exist_ok=True)
        shutil.copy(TOOLS / "lesson/sample_points.comp", tree / "tools/lesson")
        shutil.copy(BINARIES / "sample_points", tree / "bin")
        return tree / "bin"

    def test_a_mistake_in_the_chapter_shows(self):
        binaries = self.tree_with("flat-hemisphere")
        self.assertIn("too large for chance", self.text("cosine", binaries=binaries))

    def test_other_words_are_refused(self):
        self.refuse(["nothing"], "'nothing'", "cosine")
        self.refuse(["4"], "'4'", "cosine", "copy")
        self.refuse(["cosine", "--count=0"], "--count", "0")
        self.refuse(["cosine", "--count=1e9"], "--count")
        self.refuse(["kd", "--dimensions=9"], "--dimensions")
        self.refuse(["cosine", "--dimensions=2"], "kd")
        self.refuse(["cosine", "--output=picture.bmp"], "png")
        self.refuse(["cosine", "--output=/proc/picture.png"], "cannot be written")
