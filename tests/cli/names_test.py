"""Which mistake ./lab check names, and how it says so."""


import os
import re
import unittest
from io import StringIO
from unittest import mock

import tools_path  # noqa: F401  (first: it finds the others)
from check import diagnosis
from check.diagnosis import reason
from check.names import names_of, similar_to
from check.words import MOST_FACTS, headline, hint_lines, laid_out, scene_words, smallest_bias

from shown_facts import seen

LINE = 100  # characters


def graded(diagnosis, value=-0.2):
    """The result of a submission whose only picture differs by this fraction."""
    scene = {"scene": "room", "verdict": "biased", "image": [{"value": value, "is_biased": True}], "tiles": []}
    return {"chapter": 3, "verdict": "biased", "unfinished_line": None, "diagnosis": diagnosis, "scenes": [scene]}


class NamesTest(unittest.TestCase):
    KNOWN = {
        "twice": {"shows": {"angle": "2 2 2"}},
        "twice-at-a-slant": {"shows": {"angle": "1 1 2"}},
        "also-twice": {"shows": {"angle": "2 2 2", "size": "1 3 9"}},
    }

    def names(self, values, size=(1.0, 1.0, 1.0)):
        facts = {"angle": seen(values), "size": seen(size, name="size")}
        return names_of(facts, {}, self.KNOWN, {})

    def test_a_name_is_told_alone_where_one_mistake_fits(self):
        self.assertEqual(self.names([2.01, 1.99, 2.0]), ["twice"])
        self.assertEqual(self.names([2.0, 2.0, 2.0], (1.0, 3.0, 9.0)), ["also-twice"])

    def test_what_no_mistake_shows_has_no_name(self):
        self.assertEqual(self.names([3.0, 3.0, 3.0]), [])
        self.assertEqual(self.names([2.0, 2.0, 2.5]), [])

    def test_what_the_experiments_cannot_tell_apart_is_told_together(self):
        facts = {"angle": seen([2.0] * 3)}
        self.assertEqual(sorted(names_of(facts, {}, self.KNOWN, {})), ["also-twice", "twice"])

    def test_one_doubtful_point_may_be_chance_but_not_two(self):
        facts = {"angle": seen([2.0] * 3)}
        once, twice = (
            {"other": {"shows": {"angle": shows}}, "twice": self.KNOWN["twice"]} for shows in ("2 2 2.27", "2.27 2 2.27")
        )
        self.assertEqual(names_of(facts, {}, once, {}), ["twice", "other"])
        self.assertEqual(names_of(facts, {}, twice, {}), ["twice"])

    def test_a_mistake_that_shows_elsewhere_alone_is_another_one(self):
        known = {"slightly": {"shows": {"angle": "1.09 1.09 1.09"}}, "elsewhere": {"shows": {"distance": "2 2 2"}}}
        self.assertEqual(names_of({"angle": seen([1.09] * 3)}, {}, known, {}), ["slightly"])


class SimilarNamesTest(unittest.TestCase):
    """If no name fits, one may: that of the mistake that is wrong at most of the same points in the same direction."""

    KNOWN = {
        "brighter": {"shows": {"angle": "1 2 4 8", "size": "2 2 2"}},
        "darker": {"shows": {"angle": "1 0.5 0.3 0.1"}},
        "elsewhere": {"shows": {"distance": "3 3 3"}},
        "other-scene": {"shows": {"angle": "0 0 0 0", "size": "3 3 3"}},
    }

    def names(self, **values):
        return similar_to({name: seen(those, name=name) for name, those in values.items()}, self.KNOWN)

    def test_the_same_points_in_the_same_direction(self):
        self.assertEqual(self.names(angle=[1.0, 1.5, 2.5, 8.0], size=[2.0, 2.0, 2.0]), ["brighter"])
        self.assertEqual(self.names(angle=[1.0, 0.8, 0.6, 0.1], size=[1.0] * 3), ["darker"], "two of three by other numbers")
        self.assertEqual(self.names(angle=[1.0, 0.8, 0.6, 1.0], size=[1.0] * 3), [], "and none by the same")

    def test_the_nearest_of_several_if_it_is_clearly_nearer(self):
        facts = {"angle": seen([1.0, 1.5, 2.5, 8.0]), "size": seen([2.0] * 3, name="size")}
        for sizes, names in (("1 1 1", ["brighter"]), ("2 2 2", [])):
            other = {"other": {"shows": {"angle": "1 3 3 8", "size": sizes}}}
            self.assertEqual(similar_to(facts, other | self.KNOWN), names)

    def test_none_if_the_nearest_explains_too_little(self):
        self.assertEqual(self.names(angle=[0.6, 0.5, 2.0, 1.0], size=[1.0] * 3), [], "one point of four")
        self.assertEqual(self.names(angle=[1.0, 1.5, 2.5, 1.0], size=[1.6] * 3), [], "directions alone, and not everywhere")

    def test_a_point_that_is_right_contradicts_a_small_difference_unless_it_is_too_vague(self):
        known = {"everywhere": {"shows": {"angle": "1.08 1.08 0.92 2"}}}
        self.assertEqual(similar_to({"angle": seen([1.0, 1.0, 1.0, 2.0])}, known), [])
        self.assertEqual(similar_to({"angle": seen([1.08, 1.08, 0.92, 2.0])}, known), ["everywhere"])
        self.assertEqual(similar_to({"angle": seen([0.92, 0.92, 1.08, 2.0])}, known), [], "to the other side")
        self.assertEqual(
            similar_to({"angle": seen([1.04, 1.04, 0.96, 2.0], error=0.015)}, known), ["everywhere"], "cannot be told apart"
        )

    def test_they_are_told_only_where_none_fits(self):
        known = {"experiments": {}, "mistakes": {name: entry | {"hint": "?", "slide": "s"} for name, entry in self.KNOWN.items()}}
        for values, fits, names in (([1.0, 2.0, 4.0, 8.0], True, ["brighter"]), ([1.0, 2.0, 4.0, 5.0], False, ["brighter"])):
            facts = {"angle": seen(values), "size": seen([2.0] * 3, name="size")}
            with mock.patch.object(diagnosis, "next_step"):
                found = reason(facts, {}, known, False)
            self.assertEqual((found["fits"], [each["name"] for each in found["mistakes"]]), (fits, names))

    def test_a_student_reads_that_they_may_be_wrong(self):
        found = {
            "facts": [{"text": "f", "evidence": ["long"]}],
            "right": [],
            "next": None,
            "mistakes": [{"hint": f"{n}?", "slide": "s", "section": None} for n in (1, 2)],
        }
        for fits, heads, first in (
            (False, ["seen", "not sure", "maybe", "maybe", "read again"], "room is too dark (by up to -20 %)"),
            (True, ["seen", "or", "read again", "not sure"], "1?"),
        ):
            result = graded(found | {"fits": fits})
            self.assertEqual([head for head, _ in hint_lines(result)], heads)
            self.assertEqual(headline(result), ("biased", first))

    def test_what_to_read_is_a_slide_or_from_where_the_lecture_ends_a_section(self):
        found = {"facts": [], "right": [], "next": None, "fits": True}
        for slide, section, page in (
            ("Dielectrics", None, r"^Dielectrics \(docs/slides.md\), chapters/03_\w+/README.md$"),
            (None, "Smoke", r"^chapters/03_\w+/README.md: Smoke$"),
        ):
            mistakes = [{"hint": "?", "slide": slide, "section": section}]
            self.assertRegex(dict(hint_lines(graded(found | {"mistakes": mistakes})))["read again"], page)

    def test_noise_is_told_with_its_limit_and_that_the_mean_is_right(self):
        scene = {"scene": "lamps", "verdict": "noisy", "noise": [1.234, 1.2, 1.3], "most_noise": 1.1}
        found = {"facts": [], "right": [], "next": None, "mistakes": [], "fits": False, "too_noisy": ["light of a lamp", 11.3]}
        for scenes, words in (
            ([scene], "the mean is right, but lamps has 1.23 times the noise of the chapter's own shader, and 1.10 is the limit"),
            (
                [scene | {"verdict": "correct"}],
                "the mean is right, but light of a lamp has 11 times the variance of the chapter's own shader, and 1.50 is the limit",
            ),
        ):
            result = graded(found) | {"verdict": "noisy", "scenes": scenes}
            self.assertEqual(headline(result), ("noisy", words))
            asked = found | {"mistakes": [{"hint": "1?", "slide": "s", "section": None}], "fits": True}
            result |= {"diagnosis": asked}
            self.assertEqual((headline(result)[1], hint_lines(result)[0]), ("1?", ("seen", words)))

    def test_a_scene_that_tells_nothing_is_not_said_to_tell_something(self):
        for detectable, is_told in ((0.02, True), (6.1, False)):
            scene = {"verdict": "correct", "image": [{"value": 0.1, "is_biased": False, "detectable": detectable}]}
            scene |= {"tiles": [], "invalid_samples": 0, "noise": [None] * 3, "rays": 1.0}
            self.assertEqual("would have shown" in " ".join(scene_words(scene)), is_told)

    def test_what_is_no_light_has_no_percentage(self):
        found = {"facts": [], "right": [], "next": None, "mistakes": [], "fits": False}
        for value, words in (
            (-0.2, "(by up to -20 %)"),
            (-3.0, "has negative light"),
            (-9e36, "has values that no light has"),
            (float("nan"), "has values that no light has"),
        ):
            self.assertIn(words, headline(graded(found, value))[1])

    def test_a_single_name_that_may_fit_is_no_headline_and_leaves_the_next_experiment(self):
        found = {
            "facts": [{"text": "f", "evidence": ["long"]}],
            "right": [],
            "next": "./lab run 3",
            "mistakes": [{"hint": "1?", "slide": "s", "section": None}],
        }
        for fits, heads in ((False, ["seen", "not sure", "maybe", "read again", "next"]), (True, ["seen", "read again"])):
            result = graded(found | {"fits": fits})
            self.assertEqual([head for head, _ in hint_lines(result)], heads)
            self.assertEqual(headline(result)[1] == "1?", fits)

    def test_one_noisy_scene_does_not_speak_for_the_others(self):
        def told(**least):
            return smallest_bias([{"scene": name, "image": [{"detectable": value}]} for name, value in least.items()])

        self.assertEqual(
            told(plates_3=0.33, check_room_6=0.006, check_glass_8=0.013),
            "; a bias from 1.3 % would have shown, or 33 % in plates_3",
        )
        self.assertEqual(told(check_room_6=0.006, check_glass_8=0.013), ", and a bias from 1.3 % would have shown")
        self.assertEqual(told(fog_5=0.02), ", and a bias from 2 % would have shown")

    def test_a_few_facts_are_enough(self):
        facts = [{"text": f"fact {i}", "evidence": []} for i in range(MOST_FACTS + 3)]
        found = {"facts": facts, "right": [], "next": None, "mistakes": [], "fits": False}
        lines = hint_lines({"chapter": 3, "verdict": "biased", "unfinished_line": None, "diagnosis": found, "scenes": []})
        self.assertEqual([text for _, text in lines], [*(f"fact {i}" for i in range(MOST_FACTS)), "and 3 more things"])


class TerminalTest(unittest.TestCase):
    LINES = [("biased", "why? " * 30), ("seen", "short")]

    def test_elsewhere_a_line_stays_a_line_without_colours(self):
        for stream in (None, StringIO()):
            self.assertEqual(laid_out(self.LINES, stream), f"biased         {'why? ' * 30}\nseen           short")

    def test_on_a_terminal_lines_are_wrapped_and_coloured(self):
        terminal = mock.Mock(isatty=lambda: True)
        with mock.patch("shutil.get_terminal_size", return_value=os.terminal_size((60, 24))):
            with mock.patch.dict(os.environ, {"NO_COLOR": ""}):
                del os.environ["NO_COLOR"]
                text = laid_out(self.LINES, terminal)
            self.assertIn("\033[31mbiased", text)
            self.assertLessEqual(max(len(line) for line in re.sub(r"\033\[\d+m", "", text).splitlines()), 60)
            self.assertGreater(len(text.splitlines()), 3)
            with mock.patch.dict(os.environ, {"NO_COLOR": "1"}):
                self.assertNotIn("\033", laid_out(self.LINES, terminal))
