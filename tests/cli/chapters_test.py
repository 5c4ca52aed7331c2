"""What chapters add to the common command line: their own options, and scenes that they refuse."""

import json
import re

from image_files import Exr
from program import BINARIES, PROJECT, QUAD_JSON, QUAD_MTL, UNOPTIMISED, ProgramTest, RenderTest

CHAPTERS = sorted(path.name for path in (PROJECT / "chapters").iterdir() if path.is_dir())
TINY = ["--width=16", "--height=16", "--samples=2", "--backend=compute"]


def description(chapter):
    return json.loads((PROJECT / "chapters" / chapter / "chapter.json").read_text(encoding="utf-8"))


def options_of(chapter):
    """The chapter's own options."""
    says = description(chapter)
    return (
        ["--strategy"] * ("strategies" in says) + says.get("options", []) + [choice["name"] for choice in says.get("choices", [])]
    )


class EveryChapter(ProgramTest):
    def test_has_its_own_options_and_no_others(self):
        every = {option for chapter in CHAPTERS for option in options_of(chapter)}
        for chapter in CHAPTERS:
            with self.subTest(chapter=chapter):
                out = self.render("--help", program=BINARIES / chapter)
                self.assertEqual({option for option in every if f"  {option} " in out}, set(options_of(chapter)))

    def test_renders_its_default_scene(self):
        for chapter in CHAPTERS:
            with self.subTest(chapter=chapter):
                out = self.render(*TINY, "--validation", program=BINARIES / chapter, environment=UNOPTIMISED)
                self.assertIn("validation     no complaints", out)
                self.assertIn(f"output/{chapter}.png", out)

    def test_shows_views(self):
        for chapter in CHAPTERS:
            with self.subTest(chapter=chapter):
                self.render(*TINY, "--view", "idle-lanes", program=BINARIES / chapter, environment=UNOPTIMISED)

    def test_refuses_glass_if_it_knows_no_dielectrics(self):
        for chapter in (chapter for chapter in CHAPTERS if not description(chapter).get("dielectrics")):
            self.assert_refused(["glass"], "dielectric", "chapter 6", program=BINARIES / chapter)

    def test_makes_no_report_of_a_picture_that_leaves_microfacets_out(self):
        for chapter in (chapter for chapter in CHAPTERS if description(chapter).get("dielectrics")):
            command = ["microfacets", *TINY, f"--report={self.folder}/report.json"]
            if description(chapter).get("microfacets"):
                self.render(*command, program=BINARIES / chapter, environment=UNOPTIMISED)
            else:
                self.assert_refused(command, "--report", "cannot render", r"microfacets\.json", program=BINARIES / chapter)


class SanitizedChapters_all(ProgramTest):
    """Neither indices nor arithmetic of any shader are wrong: --sanitize finds nothing."""

    REFUSALS = "dielectric.*use chapter 6|--view .* does not work with the backend native"

    def setUp(self):
        super().setUp()
        if not re.search(r"native +works", self.render("--list-devices")):
            self.skipTest("no device has the backend native")

    def find_nothing(self, chapter, *arguments):
        """Returns whether it rendered: the program may also refuse to."""
        with self.subTest(chapter=chapter, arguments=arguments):
            code, _, err = self.run_program(
                *arguments,
                "--headless",
                "--width=16",
                "--height=16",
                "--samples=2",
                "--sanitize",
                "--quiet",
                program=BINARIES / chapter,
            )
            if code == 0:
                self.assertEqual(err, "")
            else:
                self.assertRegex(err, rf"\Aerror: [^\n]*({self.REFUSALS})")
            return code == 0

    def test_on_every_scene(self):
        scenes = sorted(path.stem for path in (PROJECT / "assets/scenes").glob("*.json"))
        for chapter in CHAPTERS:
            rendered = sum(bool(self.find_nothing(chapter, scene)) for scene in scenes)
            self.assertGreater(rendered, len(scenes) / 2, chapter)

    def test_in_every_view(self):
        views = re.search(r"--view TEXT:\{(.*?)\}", self.render("--help"))[1].split(",")
        for scene in ("microfacets", "textured", "glass"):
            rendered = [view for view in views if self.find_nothing(CHAPTERS[-1], scene, "--view", view)]
            self.assertGreater(len(rendered), len(views) / 2, scene)


class ChapterOptions(ProgramTest):
    def refuse(self, number, *arguments):
        program = BINARIES / CHAPTERS[number - 1]
        self.assert_refused(["quad.json", *arguments], arguments[0].split("=")[0], program=program)

    def test_values_out_of_range(self):
        parts = ("0", "-0.5", "1.01", "nan", "inf")
        for number, option, values in (
            (4, "--splitting-factor", ("0", "1000000", "1.5", "-2", "nan")),
            (5, "--survival-cap", parts),
            (10, "--survival-weight", parts),
            (6, "--roulette-start", ("0", "-1", "2.5", "first")),
        ):
            for value in values:
                self.refuse(number, f"{option}={value}")

    def test_strategy(self):
        for value in ("none", "", "2"):
            self.refuse(7, f"--strategy={value}")
        self.refuse(2, "--strategy=bounces")
        self.refuse(3, "--strategy=both")

    def test_choices(self):
        for value in ("none", "", "SAMPLES_COSINES"):
            self.refuse(11, f"--facet-sampling={value}")
        self.refuse(10, "--facet-sampling=cosine")
        self.refuse(14, "--light-choice=area")
        self.refuse(13, "--light-choice=tree")

    def test_largest_settings_end(self):
        program = BINARIES / CHAPTERS[3]
        self.render("quad.json", *TINY, "--splitting-factor=1024", program=program)
        program = BINARIES / CHAPTERS[4]
        self.render("quad.json", *TINY, "--survival-cap=1", "--roulette-start=1000000", program=program)

    def test_the_limit_of_unlimited_paths_is_told(self):
        program = BINARIES / CHAPTERS[4]
        self.assertRegex(self.render("quad.json", *TINY, program=program), r"up to 10000 bounces; .* below \de-\d+")
        self.assertNotIn("bounces", self.render("quad.json", *TINY, "--max-path-length=3", program=program))
        self.assertRegex(self.render("--help", program=program), r"--max-path-length (?s:.)*?or\s+else\s+10000")
        self.write("short.json", QUAD_JSON.replace("{", '{"max_path_length": 3,', 1))
        self.assertNotIn("bounces", self.render("short.json", *TINY, "--output=short.exr", program=program))
        self.assertIn("--max-path-length 3 ", Exr(self.folder / "short.exr").text("settings"))
        for material in ("d 0", "Pr 0.5", "Pr 0.5\nPm 1"):  # what reflects everything at grazing angles
            self.write("quad.mtl", QUAD_MTL + material + "\n")
            self.assertRegex(
                self.render("quad.json", *TINY, program=BINARIES / CHAPTERS[10]), r"up to 10000 bounces; .* may be missing"
            )


class ChapterRenders(RenderTest):
    def picture_of(self, number, name, *arguments):
        file = self.folder / f"{name}.exr"
        self.render(*self.command(*arguments), "--quiet", "--output", file, program=BINARIES / CHAPTERS[number - 1])
        return file

    def test_other_settings_are_not_joined(self):
        first = self.picture_of(4, "first", "--samples=2", "--splitting-factor=2")
        for change in ("--splitting-factor=3", "--strategy=bounces"):
            with self.subTest(change=change):
                arguments = ["--samples=4", "--max-path-length=8", f"--resume={first}", change]
                program = BINARIES / CHAPTERS[3]
                self.assert_refused(self.command(*arguments), "settings|estimator", program=program)

    def test_strategies(self):
        for number, strategies in ((3, ("light", "bounces")), (7, ("both", "light", "bounces"))):
            pictures = [Exr(self.picture_of(number, name, "--samples=4", f"--strategy={name}")) for name in strategies]
            default = Exr(self.picture_of(number, "default", "--samples=4"))
            self.assertEqual(default.pixels(), pictures[0].pixels())
            self.assertEqual(len({str(picture.pixels()) for picture in pictures}), len(strategies))
            self.assertEqual(len({picture.text("settings") for picture in pictures}), len(strategies))

    def test_choices(self):
        ways = ("visible_normals", "normals", "cosine")
        of_balls = {"scene": "microfacets", "program": BINARIES / CHAPTERS[10]}
        pictures = [self.picture(name, "--samples=2", f"--facet-sampling={name}", **of_balls) for name in ways]
        default = self.picture("default", "--samples=2", **of_balls)
        self.assertEqual(default.pixels(), pictures[0].pixels())
        self.assertEqual(default.text("settings"), pictures[0].text("settings"))
        self.assertEqual(len({str(picture.pixels()) for picture in pictures}), len(ways))
        self.assertEqual(len({picture.text("settings") for picture in pictures}), len(ways))

    def test_a_derivative_says_of_which_material(self):
        def shown(*arguments):
            """What the program says on its standard output and in its notes."""
            _, out, err = self.run_program(*self.command("--samples=1"), *arguments, program=BINARIES / derivatives[0])
            return "".join(re.findall(r"(?m)^shows +(.*)", out)), err

        derivatives = [
            chapter
            for chapter in CHAPTERS
            if any(choice["name"] == "--derivative" for choice in description(chapter).get("choices", []))
        ]
        red, green = (f'a derivative (material {i} of 4: "{name}")' for i, name in ((2, "red"), (3, "green")))
        self.assertEqual(shown("--output=light.exr"), ("", ""))
        self.assertEqual(shown("--output=red.exr", "--derivative=2"), (red, ""))
        self.assertEqual(Exr(self.folder / "red.exr").text("shows"), red)
        _, note = shown("--output=none.exr", "--derivative=5")
        self.assertRegex(
            note, r'\Anote: --derivative 5 shows nothing: .*cornell_box\.json has 4 materials: "white", "red", .*\n\Z'
        )
        _, note = shown("--output=normals.exr", "--derivative=2", "--view=normals")
        self.assertEqual(note, "note: --derivative has no effect on --view normals\n")
        for reference, arguments, note in (
            ("light", [], ""),
            ("red", ["--derivative=2"], ""),
            ("red", ["--derivative=3"], f"note: red.exr: shows {red}, the image shows {green}\n"),
            ("red", [], f"note: red.exr: shows {red}, the image shows radiance\n"),
            ("light", ["--derivative=2"], f"note: light.exr: shows radiance, the image shows {red}\n"),
            ("normals", [], "note: normals.exr: shows the view normals, the image shows radiance\n"),
        ):
            with self.subTest(reference=reference, arguments=arguments):
                self.assertEqual(shown(f"--reference={reference}.exr", *arguments, "--output=compared.exr")[1], note)
