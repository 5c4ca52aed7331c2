"""./lab solve: albedos from a picture."""

import json
import re
import shutil
import unittest

from program import BINARIES, ProgramTest  # first: it finds the tools
from lesson.solve import CHAPTER
from project import ROOT
from references.albedos import materials_of, write_scene
from references.images import scene_file

PICTURE = ROOT / "assets/references/cornell_box_6.exr"  # from another renderer


class SolveTest(ProgramTest):
    def solve(self, *arguments):
        """What the last step found, name -> three numbers, and two errors in per cent: of the picture, and of noise alone."""
        code, out, self.notes = self.run_tool("solve", *arguments)
        self.assertEqual(code, 0, self.notes)
        *_, last, errors = out.splitlines()
        parts = re.findall(r"(\w+) ([\d.]+) ([\d.]+) ([\d.]+)", last.split(maxsplit=2)[2])
        errors = re.fullmatch(r"error (\S+) %; noise alone would leave (\S+) %", errors).groups()
        return {name: list(map(float, numbers)) for name, *numbers in parts}, list(map(float, errors))

    def render_small(self, name, *arguments, scene="cornell_box"):
        """A small picture by the chapter of ./lab solve."""
        file = self.folder / name
        self.render(scene, "--headless", "--width=48", "--height=48", "--output", file, *arguments, program=BINARIES / CHAPTER)
        return file

    def test_finds_the_colours_of_two_walls(self):
        found, (error, noise) = self.solve("cornell_box", PICTURE, "red", "green", "--samples", 32)
        self.assertEqual(self.notes, "")
        self.assertAlmostEqual(error / noise, 1, delta=0.1)
        for name, albedo in (("red", (0.62, 0.12, 0.1)), ("green", (0.16, 0.46, 0.13))):
            for value, expected in zip(found[name], albedo):
                self.assertAlmostEqual(value / expected, 1, delta=0.02)

    def test_finds_the_scene_s_files_wherever_it_lies(self):
        folder = self.folder / "elsewhere"
        (folder / "scenes").mkdir(parents=True)
        shutil.copy(scene_file("cornell_box"), folder / "scenes")
        shutil.copytree(ROOT / "assets/meshes", folder / "meshes")
        found, _ = self.solve(folder / "scenes/cornell_box.json", PICTURE, "red", "--steps", 1, "--samples", 4)
        self.assertEqual(list(found), ["red"])

    def test_knows_the_noise_and_the_path_length_of_a_chapter_s_picture(self):
        for samples, own in ((3, 15), (16, 1)):  # halves of different and of equal size; a sample without halves
            picture = self.render_small("picture.exr", f"--samples={samples}", "--max-path-length=2")
            _, (error, noise) = self.solve("cornell_box", picture, "red", "green", "--samples", own)
            self.assertEqual(self.notes, "")
            self.assertAlmostEqual(error / noise, 1, delta=0.15)

    def test_says_if_albedos_do_not_explain_the_picture(self):
        picture = self.render_small("sky.exr", "--samples=16", "--background=0.2,0.2,0.2")
        self.solve("cornell_box", picture, "red", "--samples", 16)
        self.assertRegex(self.notes, r"\Anote: these albedos do not explain the picture: .*\n\Z")
        picture = self.render_small("bright.exr", "--samples=16", scene="furnace")
        self.solve("cornell_box", picture, "red", "--samples", 4)
        self.assertRegex(self.notes, r"\A.*\nnote: red: its albedo ended at the bound 1\n\Z")

    def test_reads_materials_as_the_chapters_do(self):
        """A file that stands for the mesh's own, with tabs, comments, and glass, which comes last."""
        (self.folder / "box.mtl").write_text(
            "newmtl white\nd 0\nNi 1.5\nnewmtl red # wall\n\tKd\t0.1 0.1 0.1\n  newmtl green\nKd 0.2 0.2 0.2\nnewmtl light\nKe 9 9 9\n"
        )
        (self.folder / "new").mkdir()
        scene = self.folder / "scene.json"
        mesh = ROOT / "assets/meshes/cornell_box.obj"
        scene.write_text(json.dumps({"meshes": [{"file": str(mesh), "materials": "box.mtl"}]}))
        self.assertEqual([material.name for material in materials_of(scene)], ["red", "green", "light", "white"])
        text = (write_scene(scene, {"red": (0.3, 0.4, 0.5)}, self.folder / "new").parent / "0.mtl").read_text()
        self.assertRegex(text, r"newmtl red.*\nKd 0\.3 0\.4 0\.5\n")
        self.assertNotIn("0.1", text)
        self.assertIn("Kd 0.2 0.2 0.2", text)

    def test_says_what_it_cannot_do(self):
        self.assert_tool_refused(["solve", "cornell_box", PICTURE, "blue"], "no material has this name: white, red, green, light")
        self.assert_tool_refused(["solve", ROOT / "assets/meshes/cornell_box.obj", PICTURE, "red"], "is no .json")
        self.assert_tool_refused(["solve", "nothing", PICTURE, "red"], "there is no such file")
        self.assert_tool_refused(
            ["solve", "cornell_box", ROOT / "docs/pictures/derivatives.jpg", "red"], "cannot be read as an EXR"
        )
        self.assert_tool_refused(["solve", "cornell_box", "nothing.exr", "red"], "there is no such file")
        self.assert_tool_refused(["solve", "cornell_box", PICTURE, "red", "green", "red"], "red: is named twice")
        derivative = self.render_small("derivative.exr", "--samples=1", "--derivative=2")
        self.assert_tool_refused(["solve", "cornell_box", derivative, "red"], 'shows a derivative .material 2 of 4: "red"')


if __name__ == "__main__":
    unittest.main()
