"""Which shaders ./lab check grades together, and what becomes of a class whose submissions have faults of their own."""

import csv
import json
import os
import shutil
from pathlib import Path
from unittest import mock

from program import PROJECT, ProgramTest  # first: it finds the tools
from check import command, folder
from check.submission import Submission, replacement
from project import CHAPTERS, UserError, course, read_json

FEW = (3, "--runs", 5, "--samples", 4, "--backend", "compute")
TECHNIQUE = "direct_light.glsl"
# A right solution that moves a line to the estimator, and one with a factor too much: neither shows in path_trace.glsl.
RIGHT = {
    "geometry * light.inverse_density": "geometry * get_inverse_density(light)",
    "// Estimates the direct light": "float get_inverse_density(LightTriangle light) { return light.inverse_density; }\n// Estimates the direct light",
}
WRONG = {"return get_brdf(s, omega) * geometry": "return 2.0 * get_brdf(s, omega) * geometry"}


def chapter_folder(chapter):
    return PROJECT / "chapters" / CHAPTERS[chapter]


def changed(chapter, name, changes):
    text = (chapter_folder(chapter) / name).read_text(encoding="utf-8")
    for find, replace in changes.items():
        assert find in text, find
        text = text.replace(find, replace)
    return text


class Submissions:
    def copy_chapter(self, chapter, place, changes=None):
        """A copy of a chapter's folder in the test's folder, where the program under test also runs."""
        copy = Path(shutil.copytree(chapter_folder(chapter), self.folder / place))
        for name, each in (changes or {}).items():
            (copy / name).write_text(changed(chapter, name, each), encoding="utf-8")
        return copy

    def tree(self, chapter, file):
        """Name -> text of the shaders that a check reads instead of the chapter's own."""
        given = Submission(chapter, file).options
        self.assertEqual(given[::2], ["--shader"] * (len(given) // 2))
        return {
            Path(place).name: Path(source).read_text(encoding="utf-8")
            for place, _, source in (text.partition("=") for text in given[1::2])
        }

    def check(self, *arguments):
        code, out, err = self.run_tool("check", *arguments, "--json")
        self.assertIn(code, (0, 1), err)
        return json.loads(out)


class GradedTogether(Submissions, ProgramTest):
    def test_a_file_in_a_copy_brings_all_shaders_of_it(self):
        """In every chapter, by a relative path as well, and a new file that the others include."""
        for chapter in course():
            copy = self.copy_chapter(chapter, f"{chapter}_mine")
            shaders = sorted(path.name for path in copy.glob("*.glsl"))
            for name in shaders:
                text = (copy / name).read_text(encoding="utf-8")
                (copy / name).write_text(f"{text}// mine: {name}\n", encoding="utf-8")
            (copy / "helper.glsl").write_text("// mine: helper.glsl\n", encoding="utf-8")
            for file in ("path_trace.glsl", read_json(copy / "chapter.json")["exercise"]["file"], "helper.glsl"):
                for path in (copy / file, Path(os.path.relpath(copy / file))):
                    self.assertEqual(
                        [name for name, text in self.tree(chapter, path).items() if f"// mine: {name}" not in text], [], path
                    )

    def test_without_chapter_json_the_names_tell(self):
        """As on platforms that collect files."""
        for name in ("path_trace.glsl", TECHNIQUE):
            self.write(Path("submission") / name, f"// mine: {name}")
        tree = self.tree(3, self.folder / "submission" / TECHNIQUE)
        self.assertEqual(tree, {name: f"// mine: {name}" for name in tree})

    def test_a_file_with_another_name_stands_alone(self):
        """In a folder of a class."""
        mine = changed(3, TECHNIQUE, RIGHT)
        self.write("path_trace.glsl", "somebody else's")
        tree = self.tree(3, self.write("anna.glsl", mine))
        self.assertEqual(tree, {TECHNIQUE: mine})

    def test_a_file_with_helpers_of_its_own_is_known_by_the_functions_that_others_call(self):
        for chapter, name, helper in ((9, "random_words.glsl", "scramble_reversed"), (11, "sample_normal.glsl", None)):
            text = (chapter_folder(chapter) / name).read_text(encoding="utf-8")
            mine = self.write("anna.glsl", text.replace(helper, "my_scramble") if helper else text)
            self.assertEqual(Submission(chapter, mine).shader.name, name)
        estimator = self.write("bob.glsl", "vec3 path_trace(Ray ray, inout uvec2 seed) {\n    return vec3(0.0);\n}\n")
        for chapter in course():
            self.assertEqual(Submission(chapter, estimator).shader.name, "path_trace.glsl")

    def test_a_shader_that_a_chapter_includes_from_another_is_known_by_name_or_functions(self):
        """The others in its folder belong to that chapter. Chapter 13 has a file of the same name in its own folder, with one function more."""
        for chapter, place in (
            (10, (7, "extend_path.glsl")),
            (8, (2, "sample_hemisphere.glsl")),
            (12, (10, "sample_loop.glsl")),
            (12, (11, "brdf.glsl")),
            (14, (13, "scatter.glsl")),
            (13, (13, "extend_path.glsl")),
            (14, (7, "weights.glsl")),
        ):
            original, alone = chapter_folder(place[0]) / place[1], Path(f"alone_as_{chapter}_{place[1]}")
            copy = self.copy_chapter(place[0], f"{place[0]}_as_{chapter}")
            text = original.read_text(encoding="utf-8")
            mine = [
                original,
                copy / original.name,
                self.write(alone / original.name, text),
                self.write("anna.glsl", text.replace("add_light", "my_add")),
            ]
            for file in mine:
                with self.subTest(chapter=chapter, file=file):
                    given = Submission(chapter, file).options
                    self.assertEqual(given[-2:], replacement(original, file))
                    self.assertTrue(len(given) == 2 or chapter == place[0], given)

    def test_a_new_file_beside_an_estimator_replaces_what_it_has_the_name_of(self):
        copy = self.copy_chapter(10, "10_mine")
        shutil.copy(chapter_folder(7) / "extend_path.glsl", copy)
        for file in ("path_trace.glsl", "extend_path.glsl"):
            self.assertIn(f"{CHAPTERS[7]}/extend_path.glsl={copy / 'extend_path.glsl'}", Submission(10, copy / file).options)

    def test_a_file_with_no_function_of_the_chapter_is_refused_with_the_names_that_are_known(self):
        for file in (
            chapter_folder(6) / "dielectric.glsl",
            self.write("anna.glsl", "float half_of(float x) {\n    return 0.5 * x;\n}\n"),
        ):
            code, out, err = self.run_tool("check", 3, file)
            self.assertEqual((code, out), (2, ""))
            self.assertRegex(
                err, rf"\Aerror: .*{file.name}: defines no function of chapter 3's shaders.*path_trace.glsl, {TECHNIQUE}\n\Z"
            )

    def test_an_empty_file_is_called_empty(self):
        for name in ("anna.glsl", TECHNIQUE):
            self.assert_tool_refused(["check", 3, self.write(name, "\n")], f"{name}: is empty", code=2)

    def test_errors_name_the_file_that_they_are_in(self):
        copy = self.copy_chapter(3, "21_mine")
        line = (copy / TECHNIQUE).read_text(encoding="utf-8").count("\n") + 1
        with open(copy / TECHNIQUE, "a", encoding="utf-8") as file:
            file.write("nothing;\n")
        code, out, err = self.run_tool("check", *FEW, "21_mine/path_trace.glsl")
        self.assertEqual((code, out), (2, ""))
        self.assertRegex(err, rf"\Aerror: [^\n]*(?<!/)21_mine/{TECHNIQUE}:{line}: [^\n]+\n\Z")

    def test_a_todo_beside_the_file_is_named(self):
        copy = self.copy_chapter(
            3, "21_mine", {TECHNIQUE: {"return get_brdf(s, omega) * geometry": "return vec3(0.0);  // TODO"}}
        )
        result = self.check(*FEW, copy / "path_trace.glsl")
        self.assertEqual((result["unfinished_file"], result["diagnosis"]), (str(copy / TECHNIQUE), None))


class GradedTogether_all(Submissions, ProgramTest):
    def test_the_verdict_is_that_of_the_copy(self):
        with self.subTest("right"):
            self.copy_chapter(3, "21_right", {TECHNIQUE: RIGHT})
            self.assertEqual(self.check(*FEW, "21_right/path_trace.glsl")["verdict"], "correct")
        with self.subTest("wrong"):
            self.copy_chapter(3, "22_wrong", {TECHNIQUE: WRONG})
            self.assertEqual(self.check(*FEW, "22_wrong/path_trace.glsl")["verdict"], "biased")


class WholeClass(Submissions, ProgramTest):
    """Grading itself is replaced: it has its own tests."""

    def grade(self, *arguments):
        """Submission -> row of the table, and the name of the file that was graded below its folder, if any."""
        graded = {}

        def check(_, submission, picture):
            file = submission.file
            graded[picture.stem] = str(file.relative_to(self.folder / "all"))
            if "unreadable" in file.read_text(encoding="utf-8"):
                raise UserError("does not compile")
            return {
                "chapter": 3,
                "verdict": "correct",
                "unfinished_line": None,
                "diagnosis": None,
                "scenes": [],
                "picture": None,
                "file": str(file),
            }

        with mock.patch.object(command, "check", check):
            code, out, err = self.run_here(
                command.main, *FEW, "--all", self.folder / "all", "--output", self.folder / "graded", *arguments
            )
        table = csv.DictReader((self.folder / "graded/results.csv").read_text(encoding="utf-8-sig").splitlines())
        return code, {row["submission"]: (row["verdict"], graded.get(row["submission"]), row["error"]) for row in table}, out

    def submit(self, name, text="text"):
        path = self.folder / "all" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def test_a_folder_hands_in_the_exercises_shader(self):
        for name in (TECHNIQUE, "path_trace.glsl"):
            self.submit(f"anna/{name}")
        self.submit(f"bob/lab/chapters/{CHAPTERS[3]}/{TECHNIQUE}")
        self.submit(f"bob/lab/old/{TECHNIQUE}")
        self.submit("carl/mine.glsl")
        self.submit(f"carl/__MACOSX/._{TECHNIQUE}")
        code, rows, _ = self.grade()
        self.assertEqual(
            (code, rows),
            (
                0,
                {
                    "anna": ("correct", f"anna/{TECHNIQUE}", ""),
                    "bob": ("correct", f"bob/lab/chapters/{CHAPTERS[3]}/{TECHNIQUE}", ""),
                    "carl": ("correct", "carl/mine.glsl", ""),
                },
            ),
        )

    def test_what_is_wrong_with_one_is_said_at_it_and_the_others_go_on(self):
        self.submit("anna.glsl")
        self.submit("anna/direct_light.glsl")
        self.submit("bob/first.glsl")
        self.submit("bob/second.glsl")
        self.submit("carl/readme.txt")
        self.submit("dora.glsl", "unreadable")
        (self.folder / "all/emil.glsl").symlink_to("nowhere")
        code, rows, out = self.grade()
        self.assertEqual(code, 2)
        self.assertEqual(
            {name: row[0] for name, row in rows.items()},
            {"anna": "correct", "anna.glsl": "correct"} | dict.fromkeys(("bob", "carl", "dora", "emil"), "not graded"),
        )
        self.assertEqual((rows["anna"][1], rows["anna.glsl"][1]), ("anna/direct_light.glsl", "anna.glsl"))
        for name, words in (
            ("bob", "2 shaders, such as first.glsl and second.glsl: .*direct_light.glsl"),
            ("carl", "no shader: direct_light.glsl is missing"),
            ("dora", "does not compile"),
            ("emil", "No such file"),
        ):
            self.assertRegex(rows[name][2], words)
        self.assertEqual(len(out.splitlines()), 6)

    def test_a_submission_is_graded_anew_if_a_file_beside_it_changes(self):
        for name in (TECHNIQUE, "path_trace.glsl"):
            self.submit(f"anna/{name}")
        self.submit("bob.glsl")
        self.grade()
        self.assertEqual([row[1] for row in self.grade()[1].values()], [None, None], "both are known")
        self.submit("anna/path_trace.glsl", "other text")
        self.assertEqual([row[1] for row in self.grade()[1].values()], [f"anna/{TECHNIQUE}", None])

    def test_mistakes_without_a_name_are_not_counted_as_one(self):
        names = ["same?"] * 2 + [None] * 3
        rows = [{"causes": [name or folder.NAMELESS], "facts": "too dark | more"} for name in names]
        self.assertEqual(folder.summary(rows), ["2 of 5: same?: too dark", f"3 of 5: {folder.NAMELESS}"])

    def test_the_output_is_no_submission(self):
        self.submit("anna.glsl")
        with mock.patch.object(folder, "ROOT", self.folder):
            self.assertEqual(list(folder.submissions(self.folder / "all", self.folder / "all/graded")), ["anna"])
            (self.folder / "all/graded").mkdir()
            self.assertEqual(list(folder.submissions(self.folder / "all", self.folder / "all/graded")), ["anna"])
