"""The pages of the notebook: links, and commands, which other pages name as well."""

import re
import unittest
from unittest import mock

from paths import PROJECT  # first: it finds the others
import documentation_test

NOTEBOOK = PROJECT / "notebook"
PAGES = [NOTEBOOK / "README.md", *sorted(NOTEBOOK.glob("results/*.md"))]
QUESTIONS = re.findall(r'"(\w+)": "\w+\.\w+"', (NOTEBOOK / "__main__.py").read_text(encoding="utf-8"))


class PagesTest(unittest.TestCase):
    def test_links_lead_to_files_and_headings(self):
        with mock.patch.object(documentation_test, "PAGES", PAGES):
            documentation_test.DocumentationTest("test_links_lead_to_files_and_headings").debug()

    def test_commands_exist(self):
        texts = {
            page: page.read_text(encoding="utf-8") for page in [*PAGES, *documentation_test.PAGES, PROJECT / "CONTRIBUTING.md"]
        }
        options = "".join(
            file.read_text(encoding="utf-8")
            for folder in ("notebook", "tools")
            for kind in ("py", "cpp")
            for file in (PROJECT / folder).rglob(f"*.{kind}")
        )
        named = {
            (page, *command) for page, text in texts.items() for command in re.findall(r"\./lab notebook (\w+)([^`\n]*)", text)
        }
        for page, question, arguments in named:
            self.assertTrue(
                question == "test" or question in QUESTIONS or (NOTEBOOK / f"measure/{question}.cpp").is_file(),
                f"{page}: {question}",
            )
            for option in re.findall(r"--\w[\w-]*", arguments):
                self.assertIn(option, options, f"{page}: {question}")
        answered = {question for page, question, _ in named if page == PAGES[0]}
        self.assertEqual(
            sorted(set(QUESTIONS) - answered - {"peer"}), [], "README.md names every question; `peer` is a part of one"
        )
