"""What ./lab check finds out about an incorrect shader: experiments, facts, and the names they leave."""

import json
import os
import re
import tempfile
import unittest
from io import StringIO
from pathlib import Path
from unittest import mock

import tools_path  # noqa: F401  (first: it finds the others)
from check import diagnosis, expected, grading
from check.diagnosis import reason, right_ones
from check.experiments import Experiment, Point, Sight, experiment, experiment_files, experiments_of, faces_of, merged, write_scene
from check.facts import DARK, fact
from check.findings import LONGEST, findings, shortened
from check.expected import expected_file, known_mistakes
from check.grading import RUNS, first_seed
from check.names import names_of, similar_to
from check.submission import Submission
from check.words import MARGIN, MOST_FACTS, headline, hint_lines, laid_out, smallest_bias
from course.mistakes import catalogue
from project import chapter_named, course, read_json

LINE = 100  # characters


def sight(mean, error=0.001):
    return Sight(mean, error * mean, 1.0, 0.1, 2.0)


def seen(values, quantity=None, x=(20.0, 40.0, 60.0, 75.0), expected=None, error=0.001, **details):
    """The fact of an experiment whose points show these multiples of the right values."""
    points = [Point({}, f"at {x_i:g}", x_i) for x_i, _ in zip(x, values)]
    expected = expected or [0.5] * len(values)
    shown = [sight(value * (right or max(expected)), error) for value, right in zip(values, expected)]
    of = Experiment(details.get("name", "angle"), details.get("subject", "light of a lamp"), details.get("varies", "the angle"), points, quantity or {})
    return fact(of, shown, [sight(right, 0.0002) for right in expected])


class FactsTest(unittest.TestCase):
    def test_what_is_right_has_no_sentence(self):
        found = seen([1.002, 0.998, 1.0])
        self.assertTrue(found.is_right and found.is_surely_right)
        self.assertEqual(found.sentence, "")
        vague = seen([1.1, 0.95, 1.0], error=0.05)
        self.assertTrue(vague.is_right)
        self.assertFalse(vague.is_surely_right, "too vague to be called right")
        self.assertEqual(right_ones({"angle": vague}), [])

    def test_a_constant_factor_is_told_with_its_interval_and_its_name(self):
        self.assertEqual(seen([3.1416] * 4).sentence,
                         "light of a lamp: 3.14 ± 0.01 times as bright as it should be (as by a factor π), whatever the angle")
        self.assertNotIn("factor", seen([1.23] * 4).sentence, "no well-known constant")
        self.assertNotIn("factor", seen([3.1] * 4, error=0.1).sentence, "3 or π")

    def test_what_a_single_point_shows_is_no_constant(self):
        for values in ([1.0, 0.6366, 1.0], [0.9, 0.6366, 0.5], [0.6366]):
            self.assertNotIn("as by a factor", seen(values).sentence, values)
            for told in findings([seen(values)]):
                self.assertNotIn("as by a factor", told.told()["text"], values)
        throughout, partly = seen([2.0] * 3, subject="light of the sky"), seen([1.0, 2.0, 1.0])
        self.assertIn("factor 2", findings([throughout, partly])[0].told()["text"])

    def test_a_law_holds_at_every_point_within_its_own_error(self):
        eta = {"value": "η"}
        root = [(1 / value)**0.5 for value in (1.2, 1.5, 2.0)]
        self.assertIn("follows the root of 1 / η", seen(root, eta, (1.2, 1.5, 2.0)).sentence)
        off = [root[0], root[1] * 1.03, root[2]]
        self.assertNotIn("follows", seen(off, eta, (1.2, 1.5, 2.0)).sentence)
        self.assertIn("follows", seen(off, eta, (1.2, 1.5, 2.0), error=0.02).sentence)

    def test_a_power_law_is_told_of_the_quantity_that_it_follows(self):
        angles = {"cos": "the cosine of this angle", "sin": "the sine of this angle"}
        self.assertIn("follows 1 / the cosine of this angle;", seen([1.064, 1.305, 2.0, 3.864], angles).sentence)
        self.assertIn("follows the sine of this angle times 1.57", seen([0.537, 1.01, 1.36, 1.517], angles).sentence)
        self.assertNotIn("follows", seen([1.0, 3.0, 0.5, 1.0], angles).sentence)
        odds = {"value": "q", "rest": "1 - q"}
        self.assertIn("follows q times 1 / 1 - q".replace("1 - q", "(1 - q)"),
                      seen([9.0, 2.333, 1.0, 0.4286], {"value": "q", "rest": "(1 - q)"}, (0.9, 0.7, 0.5, 0.3)).sentence, odds)
        self.assertIn("a factor of 1.50 ± 0.03 with each bounce", seen([1.5, 2.25, 3.375], {"per": "with each bounce"}, (1, 2, 3)).sentence)

    def test_light_where_none_should_be_and_light_that_is_missing(self):
        leak = seen([1.0, 0.3], expected=[0.5, 0.0]).sentence
        self.assertRegex(leak, "light where none should be: at 40: 0.30 ± 0.01 times that of the brightest place")
        self.assertIn("nothing of it is there", seen([0.0] * 3).sentence)
        self.assertRegex(seen([0.0, 1.0]).sentence, "at 20: nothing; right: at 40")


class FindingsTest(unittest.TestCase):
    """Experiments that are wrong in the same way are told together."""

    def told(self, *facts):
        return [found.told() for found in findings(facts)]

    def test_the_same_factor_is_told_once(self):
        facts = {"angle": seen([2.0] * 3), "distance": seen([2.0] * 3, varies="the distance"), "size": seen([1.0] * 3, varies="the size")}
        told, = self.told(*facts.values())
        self.assertEqual(told["text"], "2.00 ± 0.01 times as bright as it should be (as by a factor 2): light of a lamp")
        self.assertEqual(told["evidence"], [facts["angle"].sentence, facts["distance"].sentence])
        self.assertEqual(right_ones(facts), ["light of a lamp, whatever the size"])

    def test_what_is_missing_everywhere_is_told_once(self):
        subjects = [f"light number {i}" for i in range(14)]
        told, = self.told(*(seen([0.0] * 3, subject=subject) for subject in subjects), seen([1.0] * 3))
        self.assertRegex(told["text"], r"\Anothing is there: light number 0; .* and \d+ more\Z")
        self.assertEqual(len(told["evidence"]), 14)

    def test_a_factor_of_each_bounce_explains_its_powers(self):
        bounces = seen([0.5, 0.25, 0.125], {"per": "with each bounce"}, (1, 2, 3), subject="light in a ball")
        told, = self.told(bounces, seen([0.25] * 3, subject="light of a wall"), seen([1.0, 0.5, 0.25], subject="light of the sky"))
        self.assertRegex(told["text"], "0.50 ± 0.01 times as bright with each bounce .*factor 1/2.*: light")
        self.assertEqual(len(told["evidence"]), 3)
        self.assertEqual(len(self.told(bounces, seen([0.4] * 3, subject="light of a wall"))), 2, "no power")
        told, = self.told(seen([0.97] * 2, {"per": "with each bounce"}, (2, 3)))
        self.assertRegex(told["text"], "0.97 ± 0.01 times as bright as it should be: ", "the same, however many bounces")

    def test_a_law_comes_first_and_what_has_nothing_in_common_is_told_by_its_side(self):
        law = seen([1.064, 1.305, 2.0, 3.864], {"cos": "the cosine of this angle"})
        others = [seen([1.0, value, 2 * value], subject=f"light {i}") for i, value in enumerate((1.1, 1.3, 1.7, 2.3))]
        told = self.told(*others, law, seen([1.0, 0.7, 0.5], subject="light 5"))
        self.assertEqual([each["text"] for each in told], ["off by 1 / the cosine of the angle: light of a lamp",
                                                           "too bright, up to 4.60 times: light 3; light 2; light 1; light 0",
                                                           "too dark, down to 0.50 times: light 5"])

    def test_the_finding_with_the_most_evidence_is_told_first_and_shown_next(self):
        weak = seen([0.0, 1.0, 1.0], subject="light of the sky", name="sky")
        strong = [seen([2.0] * 3, subject=f"light {i}", name=f"light_{i}", error=error) for i, error in enumerate((0.05, 0.001))]
        first, second = self.told(weak, *strong)
        self.assertRegex(first["text"], "2.00 .* times as bright as it should be")
        self.assertEqual(first["evidence"], [strong[1].sentence, strong[0].sentence], "the most precise first")
        self.assertEqual(second["text"], "nothing is there: light of the sky")
        facts = {each.experiment.name: each for each in (weak, *strong)}
        sights = {name: [sight(1.0)] * 3 for name in facts}
        expected = {name: {} for name in facts}
        with mock.patch.object(diagnosis, "write_scene", side_effect=lambda scene, folder, name: grading.ROOT / f"{name}.json"), \
                mock.patch.object(diagnosis, "known_sights", return_value=[sight(0.5)] * 3):
            self.assertIn("light_1.json", diagnosis.next_step(Submission(3, Path("mine.glsl")), facts, sights, expected))

    def test_light_where_none_should_be_and_what_is_no_number_are_not_forgotten(self):
        invalid = fact(Experiment("x", "light of a lamp", "", [Point({}, "a")]), [Sight(1.0, 0.1, 1.0, 0.1, 2.0, invalid=3)], [sight(1.0)])
        told = self.told(seen([2.0, 2.0, 0.3], expected=[0.5, 0.5, 0.0], subject="light of the sky"), invalid)
        self.assertEqual(sorted(each["text"].split(":")[0] for each in told),
                         ["2.00 ± 0.01 times as bright as it should be (as by a factor 2)", "infinite or not a number", "light where none should be"])

    def test_a_text_is_short_whatever_the_experiments_are_called(self):
        for chapter in experiment_files():
            for one in experiments_of(chapter).values():
                values = [3.0 + i for i, _ in enumerate(one.points)]
                for those in ([0.0] * len(values), values, [1 / value for value in values]):
                    shown = [sight(value) for value in those]
                    for told in self.told(fact(one, shown, [sight(1.0)] * len(those))):
                        self.assertLessEqual(len(told["text"]), LONGEST)
                        self.assertEqual(told["text"].count("\n"), 0)

    def test_a_text_that_is_cut_does_not_end_in_the_middle_of_a_thought(self):
        coloured = "light in a glowing ball with a coloured wall, after three bounces"
        self.assertEqual(shortened("0.82 ± 0.01 times as bright as it should be", [coloured]),
                         "0.82 ± 0.01 times as bright: light in a glowing ball with a coloured wall …")
        self.assertEqual(shortened("up to 1.4 times the rays of the chapter's own shader", [coloured]),
                         "up to 1.4 times the rays: light in a glowing ball with a coloured wall …")
        self.assertEqual(shortened("too dark", ["light of a lamp that stands in the farthest corner of a room with a mirror in a frame of"] * 2),
                         "too dark: light of a lamp that stands in the farthest corner of a room … and 1 more")

    def test_what_a_student_reads_fits_into_a_line(self):
        self.assertLessEqual(MARGIN + LONGEST, LINE, "facts")
        for bug in catalogue():
            self.assertLessEqual(MARGIN + len(bug.mistake["hint"]), LINE, bug.mistake["name"])


class SecondLookTest(unittest.TestCase):
    """One bright path in a few runs, or its absence, is no mistake; whatever is off as a whole is one at once."""
    LEVELS = {name: {"rel_mse": {"1": 1.0, "2": 1.0}, "rays": 1.0} for name in ("check_room_2", "textured_4")}

    def judge(self, *looks):
        """The verdict, and (scenes, first seed) of each further look, if these are what grade() says one after the other: a verdict, and by how
        many half widths the picture is off, of which 9 are beyond doubt."""
        results = iter(looks)

        def grade(case, level, scenes, is_second_look):
            self.assertEqual((scenes, is_second_look), (len(made[-1][0] or self.LEVELS), len(made) > 1))
            verdict, off = next(results)
            return {"scene": case["scene"], "verdict": verdict, "invalid_samples": 0,
                    "image": [{"is_biased": off >= 9, "value": -0.01 * off, "half_width": 0.01}]}

        def render(_, settings, scenes=None, **__):
            made.append((scenes, settings["first_seed"]))
            return [{"scene": scene, "picture": None, "runs": [{}] * settings["runs"]} for scene in scenes or self.LEVELS]

        made, plan = [], {"first_seed": 1, "runs": RUNS, "samples": None}
        with mock.patch.object(grading, "render", render), mock.patch.object(grading, "grade", grade):
            result = grading.judge(Submission(3, Path("mine.glsl")), plan, self.LEVELS)[0]
        self.assertIsNone(next(results, None))
        self.assertEqual((result["runs"], [scene["scene"] for scene in result["scenes"]]), (RUNS, list(self.LEVELS)))
        self.assertEqual(made[0], (None, 1))
        return result["verdict"], made[1:]

    def test_doubt_needs_other_seeds_of_these_scenes_alone(self):
        for first in (("noisy", 0), ("biased", 0), ("correct", 2)):
            for second in (("correct", 2), ("biased", 0), ("noisy", 0)):
                again = [(["textured_4"], 1 + RUNS)]
                self.assertEqual(self.judge(("correct", 1), first, second), (second[0], again))

    def test_the_other_scenes_count_as_they_were_seen_first(self):
        self.assertEqual(self.judge(("expensive", 0), ("biased", 0), ("correct", 0))[0], "expensive")

    def test_what_is_sure_needs_none(self):
        for verdict, off in (("biased", 9), ("correct", 1), ("expensive", 0)):
            self.assertEqual(self.judge((verdict, off), ("noisy" if off == 9 else "correct", 0)), (verdict, []))


class NamesTest(unittest.TestCase):
    KNOWN = {"twice": {"shows": {"angle": "2 2 2"}}, "twice-at-a-slant": {"shows": {"angle": "1 1 2"}},
             "also-twice": {"shows": {"angle": "2 2 2", "size": "1 3 9"}}}

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
        once, twice = ({"other": {"shows": {"angle": shows}}, "twice": self.KNOWN["twice"]} for shows in ("2 2 2.27", "2.27 2 2.27"))
        self.assertEqual(names_of(facts, {}, once, {}), ["twice", "other"])
        self.assertEqual(names_of(facts, {}, twice, {}), ["twice"])

    def test_a_mistake_that_shows_elsewhere_alone_is_another_one(self):
        known = {"slightly": {"shows": {"angle": "1.09 1.09 1.09"}}, "elsewhere": {"shows": {"distance": "2 2 2"}}}
        self.assertEqual(names_of({"angle": seen([1.09] * 3)}, {}, known, {}), ["slightly"])


class SimilarNamesTest(unittest.TestCase):
    """If no name fits, one may: that of the mistake that is wrong at most of the same points in the same direction."""
    KNOWN = {"brighter": {"shows": {"angle": "1 2 4 8", "size": "2 2 2"}}, "darker": {"shows": {"angle": "1 0.5 0.3 0.1"}},
             "elsewhere": {"shows": {"distance": "3 3 3"}}, "other-scene": {"shows": {"angle": "0 0 0 0", "size": "3 3 3"}}}

    def names(self, **values):
        return similar_to({name: seen(those, name=name) for name, those in values.items()}, self.KNOWN)

    def test_the_same_points_in_the_same_direction(self):
        self.assertEqual(self.names(angle=[1.0, 1.5, 2.5, 8.0], size=[2.0, 2.0, 2.0]), ["brighter"])
        self.assertEqual(self.names(angle=[1.0, 0.8, 0.6, 0.1], size=[1.0] * 3), [], "half of the numbers differ")
        self.assertEqual(self.names(angle=[1.0, 0.8, 0.3, 0.1], size=[1.0] * 3), ["darker"])

    def test_the_nearest_of_several(self):
        facts = {"angle": seen([1.0, 1.5, 2.5, 8.0]), "size": seen([2.0] * 3, name="size")}
        self.assertEqual(similar_to(facts, {"farther": {"shows": {"angle": "1 3 3 8", "size": "2 2 3"}}} | self.KNOWN), ["brighter"])

    def test_none_if_the_nearest_explains_too_little(self):
        self.assertEqual(self.names(angle=[0.6, 0.5, 2.0, 1.0], size=[1.0] * 3), [], "one point of four")
        self.assertEqual(self.names(angle=[1.0, 1.5, 2.5, 5.0], size=[1.6] * 3), [], "directions alone")

    def test_a_point_that_is_right_contradicts_a_small_difference_unless_it_is_too_vague(self):
        known = {"everywhere": {"shows": {"angle": "1.08 1.08 0.92 2"}}}
        self.assertEqual(similar_to({"angle": seen([1.0, 1.0, 1.0, 2.0])}, known), [])
        self.assertEqual(similar_to({"angle": seen([1.08, 1.08, 0.92, 2.0])}, known), ["everywhere"])
        self.assertEqual(similar_to({"angle": seen([0.92, 0.92, 1.08, 2.0])}, known), [], "to the other side")
        self.assertEqual(similar_to({"angle": seen([1.04, 1.04, 0.96, 2.0], error=0.015)}, known), ["everywhere"], "cannot be told apart")

    def test_they_are_told_only_where_none_fits(self):
        known = {"experiments": {}, "mistakes": {name: entry | {"hint": "?", "slide": "s"} for name, entry in self.KNOWN.items()}}
        for values, fits, names in (([1.0, 2.0, 4.0, 8.0], True, ["brighter"]), ([1.0, 2.0, 4.0, 5.0], False, ["brighter"])):
            facts = {"angle": seen(values), "size": seen([2.0] * 3, name="size")}
            with mock.patch.object(diagnosis, "next_step"):
                found = reason(facts, {}, known, False)
            self.assertEqual((found["fits"], [each["name"] for each in found["mistakes"]]), (fits, names))

    def test_a_student_reads_that_they_may_be_wrong(self):
        found = {"facts": [{"text": "f", "evidence": ["long"]}], "right": [], "next": None, "mistakes": [{"hint": f"{n}?", "slide": "s"} for n in (1, 2)]}
        scene = {"scene": "room", "verdict": "biased", "image": [{"value": -0.2, "is_biased": True}], "tiles": []}
        for fits, heads, first in ((False, ["seen", "not sure", "maybe", "maybe", "read again"], "room is too dark (by up to -20 %)"),
                                   (True, ["seen", "or", "read again", "not sure"], "1?")):
            result = {"chapter": 3, "verdict": "biased", "unfinished_line": None, "diagnosis": found | {"fits": fits}, "scenes": [scene]}
            self.assertEqual([head for head, _ in hint_lines(result)], heads)
            self.assertEqual(headline(result), ("biased", first))

    def test_what_is_no_light_has_no_percentage(self):
        found = {"facts": [], "right": [], "next": None, "mistakes": [], "fits": False}
        for value, words in ((-0.2, "(by up to -20 %)"), (-3.0, "has negative light"), (-9e36, "has values that no light has"), (float("nan"), "has values that no light has")):
            scene = {"scene": "room", "verdict": "biased", "image": [{"value": value, "is_biased": True}], "tiles": []}
            self.assertIn(words, headline({"chapter": 3, "verdict": "biased", "unfinished_line": None, "diagnosis": found, "scenes": [scene]})[1])

    def test_a_single_name_that_may_fit_is_no_headline_and_leaves_the_next_experiment(self):
        found = {"facts": [{"text": "f", "evidence": ["long"]}], "right": [], "next": "./lab run 3", "mistakes": [{"hint": "1?", "slide": "s"}]}
        scene = {"scene": "room", "verdict": "biased", "image": [{"value": -0.2, "is_biased": True}], "tiles": []}
        for fits, heads in ((False, ["seen", "not sure", "maybe", "read again", "next"]), (True, ["seen", "read again"])):
            result = {"chapter": 3, "verdict": "biased", "unfinished_line": None, "diagnosis": found | {"fits": fits}, "scenes": [scene]}
            self.assertEqual([head for head, _ in hint_lines(result)], heads)
            self.assertEqual(headline(result)[1] == "1?", fits)

    def test_one_noisy_scene_does_not_speak_for_the_others(self):
        def told(**least):
            return smallest_bias([{"scene": name, "image": [{"detectable": value}]} for name, value in least.items()])

        self.assertEqual(told(plates_3=0.33, check_room_6=0.006, check_glass_8=0.013),
                         "; a bias from 1.3 % would have shown, or 33 % in plates_3")
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


class ExperimentsTest(unittest.TestCase):
    def test_each_chapter_of_the_course_has_about_a_dozen_and_each_is_described_once(self):
        files = experiment_files()
        self.assertEqual(list(files), course())
        names = [name for file in files.values() for name in file.get("experiments", {})]
        self.assertEqual(len(names), len(set(names)))
        for chapter in files:
            self.assertGreaterEqual(len(experiments_of(chapter)), 11)
            for one in experiments_of(chapter).values():
                self.assertLessEqual(set(one.when), set(experiments_of(chapter)), (chapter, one.name))
                self.assertTrue(one.subject and one.points and all(point.scene for point in one.points), (chapter, one.name))

    def test_a_chapter_uses_only_what_it_or_an_earlier_one_describes(self):
        """Otherwise it would be missing from a student's tree of the first chapters."""
        described = set()
        for chapter, file in experiment_files().items():
            described |= set(file.get("experiments", {}))
            self.assertLessEqual(set(file["uses"]), described, f"chapter {chapter}")

    def test_points_that_are_channels_of_one_colour_do_not_claim_all_colours(self):
        for chapter in experiment_files():
            for one in experiments_of(chapter).values():
                if all(point.channel is not None for point in one.points) and all(point.scene == one.points[0].scene for point in one.points):
                    self.assertEqual(one.varies, "the channel", f"{one.name}: a grey wall may be right")

    def test_points_differ_in_what_they_say(self):
        made = experiment("x", {"subject": "s", "scene": {"lamp": {"size": 1, "emits": 2}, "plate": {"size": 3}}, "options": "--a 1",
                                "points": [{"at": "one"}, {"at": "two", "scene": {"lamp": {"size": 4}, "plate": None}, "options": "--b 2"}]}, 8)
        self.assertEqual([point.scene for point in made.points], [{"lamp": {"size": 1, "emits": 2}, "plate": {"size": 3}},
                                                                  {"lamp": {"size": 4, "emits": 2}}])
        self.assertEqual([point.options for point in made.points], ["--a 1", "--a 1 --b 2"])
        self.assertEqual(merged({"a": 1}, {"a": 2, "b": {"c": 3}}), {"a": 2, "b": {"c": 3}})

    def test_plates_face_where_they_say_and_boxes_outwards(self):
        def normal(face):
            a, b = ([q - p for p, q in zip(face[0], other)] for other in (face[1], face[2]))
            return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]

        for direction in ([0, 1, 0], [1, 0, 0], [0, 0, -1], [0.6, 0.8, 0]):
            found = normal(faces_of({"centre": [1, 2, 3], "faces": direction, "size": [2, 1]})[0])
            for got, expected in zip(found, direction):
                self.assertAlmostEqual(got, 2 * expected)
        lamp = faces_of({"polar": 30, "azimuth": 180, "distance": 2, "size": 0.5})[0]
        centre = [sum(corner[i] for corner in lamp) / 4 for i in range(3)]
        self.assertAlmostEqual(centre[0], -1)
        self.assertLess(sum(c * n for c, n in zip(centre, normal(lamp))), 0, "towards the origin")
        for shape, sign in (({"box": [1, 2, 3], "turn": 20}, 1), ({"ball": 1}, -1)):
            for face in faces_of(shape):
                middle = [sum(corner[i] for corner in face) / len(face) for i in range(3)]
                self.assertGreater(sign * sum(c * n for c, n in zip(middle, normal(face))), 0, shape)


    def test_strips_and_corners_lie_where_they_say(self):
        def points(chapter, name):
            return [(point.at, point.scene) for point in experiments_of(int(chapter_named(chapter)[:2]))[name].points]

        for at, scene in points("lens", "lens_disc"):
            if "strip" in at:
                width, height = (max(corner[axis] for corner in faces_of(scene["lamp"])[0]) for axis in (0, 1))
                self.assertEqual(width > height, "horizontal" in at, at)
        for at, scene in points("next_event_estimation", "corners_of_a_lamp"):
            hidden = [sum(corner[axis] for corner in faces_of(scene["plate"])[0]) for axis in (0, 2)]
            self.assertEqual([hidden[0] > 0, hidden[1] > 0], ["left" in at, "behind" in at], at)

    def test_materials_are_rough_and_scenes_have_keys_only_where_they_say_so(self):
        plate = {"centre": [0, 0, 0], "faces": [0, 1, 0], "size": 1}
        said = {"plate": plate | {"rough": 0.4, "metal": 1}, "pane": plate | {"glass": 1.5, "rough": 0.2}, "multiple_scattering": True}
        with tempfile.TemporaryDirectory() as folder:
            keys, materials = [], []
            for name, scene in (("rough", said), ("smooth", {"plate": plate})):
                keys.append(set(json.loads(write_scene(scene, Path(folder), name).read_text(encoding="utf-8"))))
                materials.append((Path(folder) / f"{name}.mtl").read_text(encoding="utf-8"))
        self.assertEqual(keys[0] - keys[1], {"multiple_scattering"})
        self.assertEqual(re.findall(r"P[mr] .*", materials[0]), ["Pr 0.4", "Pm 1", "Pr 0.2", "Pm 0"])
        self.assertNotRegex(materials[1], r"P[mr]|Ks")



class ExpectedTest(unittest.TestCase):
    """What is recorded of the chapters' own shaders."""

    def known(self):
        return {chapter: read_json(expected_file(chapter)) for chapter in course() if expected_file(chapter).exists()}

    def test_all_experiments_are_known(self):
        self.assertTrue(self.known())
        for chapter, entry in self.known().items():
            self.assertEqual(list(entry["experiments"]), list(experiments_of(chapter)), f"chapter {chapter}: ./lab notebook learn")

    def test_every_lit_point_is_bright_enough_to_be_judged(self):
        """Beside a much brighter one it counts as dark, where only light that should not be there is wrong."""
        dim = {(chapter, name) for chapter, known in self.known().items() for name, seen in known["experiments"].items()
               if any(0 < mean <= DARK * max(seen["mean"]) for mean in seen["mean"])}
        self.assertEqual(dim, {(11, "frosted_ray")}, "whose lobe is dark beside the refracted ray")

    def test_levels_have_the_seeds_of_a_check_so_that_renders_are_compared_one_by_one(self):
        seeds = [str(first_seed(0) + run) for run in range(RUNS)]
        for chapter, entry in self.known().items():
            for scene, level in entry["levels"].items():
                self.assertEqual(list(level["rel_mse"]), seeds, (chapter, scene))

    def test_without_the_notebook_facts_have_no_names(self):
        facts = {"angle": seen([2.0] * 3)}
        with mock.patch.object(expected, "KNOWLEDGE", Path("/nowhere")):
            known = {"experiments": {}, "mistakes": known_mistakes(3)}
        with mock.patch.object(diagnosis, "next_step"):
            found = reason(facts, {}, known, False)
        self.assertEqual((found["mistakes"], found["fits"]), ([], False))
        self.assertRegex(found["facts"][0]["text"], "2.00 ± 0.01 times as bright")


class DecidingExperiments(unittest.TestCase):
    def verdict_with_noise(self, factor, is_of_noise=True):
        known = {key: [values] for key, values in {"mean": 0.5, "error": 0.001, "noise": 0.01, "noise_error": 0.0001, "rays": 3.0}.items()}
        of = Experiment("kept", "light", "why", [Point({}, "x")], decides=True, is_of_noise=is_of_noise)
        is_noisy = diagnosis.is_noisy(of, [Sight(0.5, 0.001, 0.01 * factor, 0.0001, 3.0)], known)
        return diagnosis.verdict_with("correct", {"is_beyond_doubt": False, "is_noisy": is_noisy})

    def test_noise_counts_where_an_experiment_is_about_it(self):
        self.assertEqual([self.verdict_with_noise(factor) for factor in (1.4, 2.0)], ["correct", "noisy"])
        self.assertEqual(self.verdict_with_noise(2.0, is_of_noise=False), "correct")
