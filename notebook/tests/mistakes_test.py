"""./lab notebook mistakes: the mistakes themselves take an hour; whether the code still has their places is seen at once."""

import unittest
from unittest import mock

from paths import PROJECT  # first: it finds the others
from course.mistakes import plant
from mistakes import cpp_mistake


class PlantedMistakesTest(unittest.TestCase):
    def test_sources_have_the_places_of_all_mistakes(self):
        with mock.patch.object(cpp_mistake, "TREE", PROJECT):
            for planted in cpp_mistake.load().values():
                source, text = cpp_mistake.find_source(planted)
                plant(text, planted["find"], planted["replace"], source.name)


if __name__ == "__main__":
    unittest.main()
