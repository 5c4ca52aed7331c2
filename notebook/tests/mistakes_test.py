"""./lab notebook mistakes and mutations: they themselves take hours; whether the code still has their places is seen at once."""

import json
import os
import sys
import unittest
from unittest import mock

from paths import PROJECT  # first: it finds the others
from course.mistakes import plant
from mistakes import cpp_mistake, mutations
from project import course, name_of


class PlantedMistakesTest(unittest.TestCase):
    def test_sources_have_the_places_of_all_mistakes(self):
        with mock.patch.object(cpp_mistake, "TREE", PROJECT):
            for planted in cpp_mistake.load().values():
                source, text = cpp_mistake.find_source(planted)
                plant(text, planted["find"], planted["replace"], source.name)


class MutationsTest(unittest.TestCase):
    def test_each_exercise_has_mutations_and_those_that_change_nothing_are_among_them(self):
        unchanged = json.loads(mutations.UNCHANGED.read_text(encoding="utf-8"))
        for chapter in course():
            changed = mutations.all_changes(chapter)
            self.assertGreaterEqual(len(changed), 10, chapter)
            self.assertLessEqual(set(unchanged.get(name_of(chapter), {})), set(changed), f"chapter {chapter}: stale")

    def test_it_grades_as_a_student_is_graded_without_the_cpp_compiler(self):
        with (
            mock.patch.dict(os.environ),
            mock.patch.object(sys, "argv", ["mutations", "--list", "--chapters", "12"]),
            mock.patch("builtins.print"),
        ):
            os.environ.pop("LAB_WITHOUT_NATIVE", None)
            mutations.main()
            self.assertEqual(os.environ.get("LAB_WITHOUT_NATIVE"), "1")

    def test_each_kind_of_change_is_made(self):
        text = "a = b * f(x, 2.0) - c;\n    if (!d) break;\n"
        found = {(text[begin:end].strip(), replacement.strip()) for begin, end, replacement in mutations.changes(text)}
        self.assertLessEqual(
            {
                ("a = b * f(x, 2.0) - c;", ";"),
                ("*", "/"),
                ("-", "+"),
                ("* f(x, 2.0)", ""),
                ("b *", ""),
                ("2.0", "4.0"),
                ("x, 2.0", "2.0, x"),
                ("(!d)", "(!(!d))"),
                ("!", ""),
                ("if (!d) break;", ";"),
            },
            found,
        )
