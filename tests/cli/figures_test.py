"""./lab figures: what it makes, that it continues where it stopped, what it refuses."""

import re
import subprocess
import sys

from program import PROJECT, TOOLS, ProgramTest  # first: it finds the tools
from docs.bug_blocks import GALLERY
from project import read_json

# The command with its renders in the test's own folder, and with a single small figure of two renders.
COMMAND = """import sys
sys.path.insert(0, sys.argv.pop(1))
from pathlib import Path
import project
from docs import figures
figures.CACHE = Path("renders").resolve()
renders = [figures.Render(name, "01_uniform_sampling", "cornell_box", 16, ("--samples", 4, "--max-path-length", length))
           for name, length in (("only_0", 0), ("only_1", 1))]
figures.FIGURES["small"] = lambda: renders, figures.figure_plots.path_lengths
project.run_tool(figures)"""
MOST_BYTES = 20 * 2**20


class Figures_all(ProgramTest):
    def figures(self, *arguments):
        """Standard error of a run; the pictures are in the folder `pictures`."""
        command = ["-B", "-c", COMMAND, TOOLS, "--output=pictures", *arguments]
        code, _, err = self.run_program(*command, program=sys.executable)
        self.assertEqual(code, 0, err)
        return err

    def test_goes_on_after_what_is_there(self):
        self.assertIn("100 %", self.figures("small"))
        renders = sorted(self.folder.glob("renders/*/small/*.exr"))
        self.assertEqual([path.name[:6] for path in renders], ["only_0", "only_1"])
        names = [path.name for path in (self.folder / "pictures").iterdir()]
        self.assertEqual(sorted(names), ["path_length_at_most.jpg", "path_length_exactly.jpg"])
        # As if the first run had been interrupted in the second render.
        kept, lost = renders
        lost.rename(lost.with_suffix(".unfinished.exr"))
        before = kept.stat().st_mtime_ns
        self.figures("small")
        self.assertTrue(lost.exists())
        self.assertEqual(kept.stat().st_mtime_ns, before)

    def test_other_settings_are_other_renders(self):
        for samples in (4, 8):
            command = COMMAND.replace('"--samples", 4', f'"--samples", {samples}')
            self.render("-B", "-c", command, TOOLS, "--output=pictures", "small", program=sys.executable)
        self.assertEqual(len(list(self.folder.glob("renders/*/small/*.exr"))), 4)

    def test_points_need_no_renders(self):
        self.figures("sampler_points", "random_numbers")
        names = sorted(path.name for path in (self.folder / "pictures").iterdir())
        self.assertEqual(names, ["random_numbers.png", "sampler_points.png"])

    def test_makes_all_pictures_of_the_pages(self):
        made = "".join(
            file.read_text(encoding="utf-8")
            for file in [TOOLS / "docs/figure_plots.py", TOOLS / "docs/figures.py", *PROJECT.glob("chapters/*/chapter.json")]
        )
        names = {path.name for path in (PROJECT / "chapters").iterdir()} | {f"bugs_{name}" for name in GALLERY}
        exported = ("results_", "noise.", "equal_time.", "crossing.")  # by the notebook
        pictures = [path for path in (PROJECT / "docs/pictures").iterdir() if not path.name.startswith(exported)]
        for picture in pictures:
            # For a series, the code has the name without the numbers.
            self.assertTrue(picture.stem.rstrip("0123456789") in made or picture.stem in names, picture.name)
        self.assertLess(sum(picture.stat().st_size for picture in pictures), MOST_BYTES)
        pages = "".join(
            page.read_text(encoding="utf-8")
            for page in [*PROJECT.glob("*.md"), *PROJECT.glob("*/*.md"), *PROJECT.glob("*/*/*.md")]
        )
        shown = {name for name in re.findall(r"\]\([^)]*pictures/([^)]*)\)", pages) if not name.startswith(exported)}
        self.assertEqual(sorted(picture.name for picture in pictures), sorted(shown), "made but not shown, or the other way")

    def test_pictures_show_what_the_command_on_their_page_shows(self):
        shapes = []
        for folder in (PROJECT / "chapters").iterdir():
            for name, figure in read_json(folder / "chapter.json")["measure"].get("figures", {}).items():
                if "scene" in figure and "size" in figure and "--vertical-fov" not in figure["options"]:  # those are details
                    scene = read_json(PROJECT / f"assets/scenes/{figure['scene']}.json")
                    of_scene, of_picture = (scene.get("width", 512), scene.get("height", 512)), figure["size"]
                    self.assertEqual(
                        of_scene[0] * of_picture[1],
                        of_scene[1] * of_picture[0],
                        f"{name}: a scene of {of_scene} in a picture of {of_picture}",
                    )
                    shapes.append(of_scene)
        self.assertGreater(len(set(shapes)), 2)

    def test_other_names_are_refused(self):
        self.assert_tool_refused(["figures", "nothing"], "'nothing'", "--help")

    def test_a_failing_render_is_told(self):
        command = COMMAND.replace('"cornell_box"', '"no_such_scene"')
        result = subprocess.run(
            [sys.executable, "-B", "-c", command, TOOLS, "--output=pictures", "small"],
            cwd=self.folder,
            capture_output=True,
            text=True,
        )
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"\Aerror: only_0: [^\n]*no_such_scene[^\n]*\n\Z")
