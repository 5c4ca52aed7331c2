"""What pages get from the sources: tables, and blocks of code."""

import tempfile
import unittest
from pathlib import Path
from unittest import mock

import tools_path  # noqa: F401  (first: it finds the others)
from book import code_blocks
from docs import tables
import project
from project import UserError
from report import studies


class TablesTest(unittest.TestCase):
    def test_a_table_that_nobody_makes_is_named(self):
        with self.assertRaisesRegex(UserError, "there is no table 'nothing': shader, .* and bug NAME"):
            tables.table_named("nothing")


class CodeBlockTest(unittest.TestCase):
    SOURCE = "void f() {\n    for (;;) {\n        a = 1;\n\n        b = 2;\n    }\n}\nfloat b = 2;\n"

    def page(self, phrases, block="old\n"):
        return f"text\n<!-- code: a.glsl | {phrases} -->\n```glsl\n{block}```\n<!-- end of code -->\nmore\n"

    def filled(self, page):
        with tempfile.TemporaryDirectory() as folder, mock.patch.object(code_blocks, "ROOT", Path(folder)):
            (Path(folder) / "a.glsl").write_text(self.SOURCE)
            return code_blocks.fill(page, "page.md")

    def test_whole_lines_without_the_first_ones_indentation(self):
        expected = self.page("for (;;) | b = 2", "for (;;) {\n    a = 1;\n\n    b = 2;\n")
        self.assertEqual(self.filled(self.page("for (;;) | b = 2")), expected)
        self.assertEqual(self.filled(expected), expected)
        self.assertEqual(self.filled(self.page("a = 1 | a = 1")), self.page("a = 1 | a = 1", "a = 1;\n"))

    def test_blocks_are_filled_one_by_one(self):
        self.assertEqual(self.filled(2 * self.page("a = 1 | 1;")), 2 * self.page("a = 1 | 1;", "a = 1;\n"))

    def test_what_is_not_there_is_named(self):
        for page, words in (
            (self.page("b = 2 | }"), "page.md: code of a.glsl: 'b = 2' is in 2 lines"),
            (self.page("c = 3 | }"), "'c = 3' is in 0 lines"),
            (self.page("float b | a = 1"), "'a = 1' is in no line from 'float b' on"),
            (self.page("a = 1 | }").replace("a.glsl", "b.glsl"), "code of b.glsl: there is no such file"),
            (self.page("a = 1"), "must be followed by"),
            (self.page("a = 1 | }").replace("<!-- end", "<!--"), "must be followed by"),
        ):
            with self.assertRaisesRegex(UserError, words.replace("(", r"\(")):
                self.filled(page)


class StudiesTest(unittest.TestCase):
    def test_a_copied_name_belongs_to_the_first_chapter(self):
        measures = {"03_a": {"figures": {"one": 1}}, "20_b": {"figures": {"one": 2, "two": 3}}}
        with mock.patch.object(studies, "measures", lambda: measures):
            self.assertEqual(studies.named("figures"), {"one": ("03_a", 1), "two": ("20_b", 3)})

    def test_a_broken_file_is_named(self):
        with tempfile.TemporaryDirectory() as name:
            file = Path(name) / "chapters/01_a/chapter.json"
            file.parent.mkdir(parents=True)
            file.write_text("{", encoding="utf-8")
            with mock.patch.object(project, "ROOT", Path(name)), self.assertRaisesRegex(
                UserError, r"01_a/chapter\.json: not valid JSON: "
            ):
                project.description("01_a")
