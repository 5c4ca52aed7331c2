"""What ./lab check finds out about an incorrect shader: experiments, facts, and the names they leave."""

import unittest
from dataclasses import replace
from pathlib import Path
from unittest import mock

import tools_path  # noqa: F401  (first: it finds the others)
from check import diagnosis, grading
from check.diagnosis import reason, right_ones
from check.expected import expected_file
from check.experiments import Experiment, Point, Sight, experiment_files, experiments_of
from check.facts import fact
from check.findings import LONGEST, findings, shortened
from check.grading import RUNS
from check.submission import Submission
from check.words import MARGIN
from course.mistakes import catalogue
from project import UserError, read_json

from shown_facts import seen, sight

LINE = 100  # characters


class FactsTest(unittest.TestCase):
    def test_what_is_right_has_no_sentence(self):
        found = seen([1.002, 0.998, 1.0])
        self.assertTrue(found.is_right and found.is_surely_right)
        self.assertEqual(found.sentence, "")
        vague = seen([1.1, 0.95, 1.0], error=0.05)
        self.assertTrue(vague.is_right)
        self.assertFalse(vague.is_surely_right, "too vague to be called right")
        self.assertEqual(right_ones({"angle": vague}), [])

    def test_a_derivative_may_be_negative(self):
        expected = [-0.4, 0.5, 0.0]
        self.assertTrue(seen([1.0, 1.0, 0.0], expected=expected).is_surely_right)
        self.assertIn("at 20: 0.50 ±", seen([0.5, 1.0, 0.0], expected=expected).sentence)
        self.assertIn("at 20: -1.", seen([-1.0, 1.0, 0.0], expected=expected).sentence)
        self.assertIn("light where none should be", seen([1.0, 1.0, 0.5], expected=expected).sentence)

    def test_what_cannot_be_rendered_is_tried_again_at_leisure_and_then_decides(self):
        limits, known = [], read_json(expected_file(3))["experiments"]

        def fail(chapter, points, settings, *_, **__):
            limits.append(settings["time_limit"])
            raise UserError("ended")

        with mock.patch.object(diagnosis, "pictures", fail):
            facts, sights = diagnosis.observe(
                3, {"time_limit": 99.0, "first_seed": 0, "is_quiet": True}, known, diagnosis.is_deciding
            )
        self.assertEqual(limits.count(99.0), 1, "one is enough")
        self.assertTrue(reason(facts, sights, {"experiments": known, "mistakes": {}}, True)["is_beyond_doubt"])
        # Beside wrong pictures nothing is tried again, and a busy machine may be the reason.
        self.assertFalse(reason(facts, sights, {"experiments": known, "mistakes": {}}, False)["is_beyond_doubt"])

    def test_a_single_invalid_sample_decides(self):
        of, right = seen([1.0]).experiment, sight(0.5)
        self.assertFalse(fact(of, [right], [right]).is_beyond_doubt)
        self.assertTrue(fact(of, [replace(right, invalid=1)], [right]).is_beyond_doubt)

    def test_a_constant_factor_is_told_with_its_interval_and_its_name(self):
        self.assertEqual(
            seen([3.1416] * 4).sentence,
            "light of a lamp: 3.14 ± 0.01 times as bright as it should be (as by a factor π), whatever the angle",
        )
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
        root = [(1 / value) ** 0.5 for value in (1.2, 1.5, 2.0)]
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
        self.assertIn(
            "follows q times 1 / 1 - q".replace("1 - q", "(1 - q)"),
            seen([9.0, 2.333, 1.0, 0.4286], {"value": "q", "rest": "(1 - q)"}, (0.9, 0.7, 0.5, 0.3)).sentence,
            odds,
        )
        self.assertIn(
            "a factor of 1.50 ± 0.03 with each bounce", seen([1.5, 2.25, 3.375], {"per": "with each bounce"}, (1, 2, 3)).sentence
        )

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
        facts = {
            "angle": seen([2.0] * 3),
            "distance": seen([2.0] * 3, varies="the distance"),
            "size": seen([1.0] * 3, varies="the size"),
        }
        (told,) = self.told(*facts.values())
        self.assertEqual(told["text"], "2.00 ± 0.01 times as bright as it should be (as by a factor 2): light of a lamp")
        self.assertEqual(told["evidence"], [facts["angle"].sentence, facts["distance"].sentence])
        self.assertEqual(right_ones(facts), ["light of a lamp, whatever the size"])

    def test_what_is_missing_everywhere_is_told_once(self):
        subjects = [f"light number {i}" for i in range(14)]
        (told,) = self.told(*(seen([0.0] * 3, subject=subject) for subject in subjects), seen([1.0] * 3))
        self.assertRegex(told["text"], r"\Anothing is there: light number 0; .* and \d+ more\Z")
        self.assertEqual(len(told["evidence"]), 14)

    def test_a_factor_of_each_bounce_explains_its_powers(self):
        bounces = seen([0.5, 0.25, 0.125], {"per": "with each bounce"}, (1, 2, 3), subject="light in a ball")
        (told,) = self.told(
            bounces, seen([0.25] * 3, subject="light of a wall"), seen([1.0, 0.5, 0.25], subject="light of the sky")
        )
        self.assertRegex(told["text"], "0.50 ± 0.01 times as bright with each bounce .*factor 1/2.*: light in a ball and 2 more")
        self.assertEqual(len(told["evidence"]), 3)
        self.assertEqual(len(self.told(bounces, seen([0.4] * 3, subject="light of a wall"))), 2, "no power")
        (told,) = self.told(seen([0.97] * 2, {"per": "with each bounce"}, (2, 3)))
        self.assertRegex(told["text"], "0.97 ± 0.01 times as bright as it should be: ", "the same, however many bounces")

    def test_a_law_comes_first_and_what_has_nothing_in_common_is_told_by_its_side(self):
        law = seen([1.064, 1.305, 2.0, 3.864], {"cos": "the cosine of this angle"})
        others = [seen([1.0, value, 2 * value], subject=f"light {i}") for i, value in enumerate((1.1, 1.3, 1.7, 2.3))]
        told = self.told(*others, law, seen([1.0, 0.7, 0.5], subject="light 5"))
        self.assertEqual(
            [each["text"] for each in told],
            [
                "off by 1 / the cosine of the angle: light of a lamp",
                "too bright, up to 4.60 times: light 3; light 0; light 1; light 2",
                "too dark, down to 0.50 times: light 5",
            ],
        )

    def test_a_number_is_that_of_the_subject_that_is_named_first(self):
        bright = "light of a lamp that stands in the farthest corner of a room, seen in a mirror"
        values = {bright: [1.0, 1.7, 9.0], "light": [1.0, 1.2, 1.5], "all light": [1.0, 1.1, 0.2], "sky": [1.0, 3.0, 0.9]}
        told = self.told(*(seen(those, subject=subject) for subject, those in values.items()))
        self.assertEqual(
            {each["text"] for each in told},
            {f"too bright, up to 9.00 times: {bright} and 1 more", "too bright and too dark, down to 0.20 times: all light; sky"},
        )

    def test_the_variance_is_that_of_the_subject_that_is_named_first(self):
        values = {"fog": 2.0, "two lamps": 9.0, "sky": 3.0}
        facts = {subject: seen([1.0], subject=subject, name=subject) for subject in values}
        known = {"mean": [0.5], "error": [0.001], "noise": [1.0], "noise_error": [0.01], "rays": [2.0]}
        sights = {subject: [Sight(0.5, 0.001, value, 0.01, 1.0)] for subject, value in values.items()}
        self.assertEqual(
            [each["text"] for each in diagnosis.noise_findings(facts, sights, dict.fromkeys(values, known))],
            [
                "up to 9 times the variance of the chapter's own shader: two lamps; fog; sky",
                "down to 0.5 times the rays of the chapter's own shader: fog; sky; two lamps",
            ],
        )

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
        with mock.patch.object(
            diagnosis, "write_scene", side_effect=lambda scene, folder, name: grading.ROOT / f"{name}.json"
        ), mock.patch.object(diagnosis, "known_sights", return_value=[sight(0.5)] * 3):
            self.assertIn("light_1.json", diagnosis.next_step(Submission(3, Path("mine.glsl")), facts, sights, expected))

    def test_light_where_none_should_be_and_what_is_no_number_are_not_forgotten(self):
        invalid = fact(
            Experiment("x", "light of a lamp", "", [Point({}, "a")]), [Sight(1.0, 0.1, 1.0, 0.1, 2.0, invalid=3)], [sight(1.0)]
        )
        told = self.told(seen([2.0, 2.0, 0.3], expected=[0.5, 0.5, 0.0], subject="light of the sky"), invalid)
        self.assertEqual(
            sorted(each["text"].split(":")[0] for each in told),
            [
                "2.00 ± 0.01 times as bright as it should be (as by a factor 2)",
                "infinite or not a number",
                "light where none should be",
            ],
        )

    def test_a_text_is_short_whatever_the_experiments_are_called(self):
        for chapter in experiment_files():
            for one in experiments_of(chapter).values():
                values = [3.0 + i for i, _ in enumerate(one.points)]
                for those in ([0.0] * len(values), values, [1 / value for value in values]):
                    shown = [sight(value) for value in those]
                    for told in self.told(fact(one, shown, [sight(1.0)] * len(those))):
                        self.assertTrue(len(told["text"]) <= LONGEST or told["text"].endswith(one.subject), told["text"])
                        self.assertEqual(told["text"].count("\n"), 0)

    def test_a_subject_is_never_cut_since_its_end_tells_it_from_others(self):
        several = "light of a large lamp after one bounce, where each thread renders several samples"
        for way in ("0.82 ± 0.01 times as bright", "up to 1.4 times the rays"):
            for spared in (" as it should be", " of the chapter's own shader"):
                self.assertEqual(shortened(way + spared, several, [several]), f"{way}: {several}")
                self.assertEqual(shortened(way + spared, several, ["light", several, several]), f"{way}: {several} and 1 more")

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
            return {
                "scene": case["scene"],
                "verdict": verdict,
                "invalid_samples": 0,
                "image": [{"is_biased": off >= 9, "value": -0.01 * off, "half_width": 0.01}],
            }

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

    def test_a_closer_look_decides_alone(self):
        def scene(name, verdict, noise=1.0, value=-0.1):
            return {"scene": name, "verdict": verdict, "noise": [noise] * 3, "rays": 1.0, "most_noise": 1.5, "image": [value]}

        def render(_, settings, scenes):
            made.append((scenes, settings["runs"], settings["samples"], settings["first_seed"]))
            return [{"scene": name, "picture": "closer"} for name in scenes]

        for before, seen_closer, noise, verdict in (
            (1.0, "biased", 1.0, "biased"),
            (1.0, "correct", 1.0, "correct"),
            (1.0, "noisy", 9.0, "noisy"),
            (9.0, "correct", 1.0, "noisy"),
        ):
            made, pictures = [], ["first", "first"]
            result = {"samples": 8, "scenes": [scene("check_room_2", "biased", before), scene("textured_4", "correct")]}
            closer = scene("check_room_2", seen_closer, noise, 0.0)
            with mock.patch.object(grading, "render", render), mock.patch.object(grading, "grade", lambda *_, **__: dict(closer)):
                grading.look_closer(Submission(3, Path("mine.glsl")), {"first_seed": 1}, result, pictures)
            self.assertEqual((result["verdict"], [each["verdict"] for each in result["scenes"]]), (verdict, [verdict, "correct"]))
            self.assertEqual((result["scenes"][0]["image"], pictures), ([0.0], ["closer", "first"]))
            self.assertEqual(made, [(["check_room_2"], 16, 32, 1 + 2 * grading.MOST_RUNS)])

    def test_what_is_sure_needs_none(self):
        for verdict, off in (("biased", 9), ("correct", 1), ("expensive", 0)):
            self.assertEqual(self.judge((verdict, off), ("noisy" if off == 9 else "correct", 0)), (verdict, []))
