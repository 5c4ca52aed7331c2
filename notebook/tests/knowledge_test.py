"""What ./lab check knows about mistakes, and how often it is right."""

import json
import re
import unittest
from dataclasses import replace
from unittest import mock

from paths import PROJECT  # first: it finds the others
from check.experiments import experiments_of
from check.grading import MOST_RUNS, RUNS, SEED_STEP
from course.mistakes import catalogue
from learning import learn
from learning.confusion import TRYING
from learning.planting import CORRECT_CHECKS
from project import course
from tables.confusion_table import rates

KNOWLEDGE_OF = learn.read_knowledge(course())
KNOWN = {chapter: entry["mistakes"] for chapter, entry in KNOWLEDGE_OF.items()}
LEAST = 8  # known mistakes of each chapter


class KnowledgeTest(unittest.TestCase):
    def test_every_mistake_of_the_catalogue_is_known(self):
        expected = {chapter: {} for chapter in KNOWN}  # others are not measured yet
        for bug in (bug for bug in catalogue() if bug.chapter in KNOWN):
            expected[bug.chapter][bug.mistake["name"]] = {key: bug.mistake[key] for key in ("hint", "slide")}
        known = {
            chapter: {name: {key: entry[key] for key in ("hint", "slide")} for name, entry in entries.items()}
            for chapter, entries in KNOWN.items()
        }
        self.assertEqual(known, expected, "./lab notebook learn")
        for chapter, entries in known.items():
            self.assertGreaterEqual(len(entries), LEAST, f"chapter {chapter}")

    def test_every_mistake_that_was_measured_shows_in_an_experiment(self):
        for chapter, entry in KNOWLEDGE_OF.items():
            for name, mistake in entry["mistakes"].items():
                shown = any(mistake.get(kind, True) for kind in ("shows", "noise", "rays"))
                self.assertTrue(shown, f"chapter {chapter}: {name} shows in no experiment")

    def test_nothing_was_learnt_from_the_seeds_of_a_check(self):
        plan = TRYING
        seeds = list(range(plan["first_seed"], plan["first_seed"] + CORRECT_CHECKS * RUNS))
        self.assertTrue(all(2 * MOST_RUNS < seed <= SEED_STEP for seed in seeds), seeds)

    def test_every_slide_to_read_again_is_in_the_slide_map(self):
        titles = re.findall(r"^### (.*)$", (PROJECT / "docs/slides.md").read_text(encoding="utf-8"), re.MULTILINE)
        for entries in KNOWN.values():
            for name, entry in entries.items():
                self.assertIn(entry["slide"], titles, name)


class LearningTest(unittest.TestCase):
    def planned_with(self, change):
        """What is kept of chapter 1 after a change of one of its experiments and an interruption."""
        experiments = experiments_of(1) | {"angle": change(experiments_of(1)["angle"])}
        with mock.patch.object(learn, "experiments_of", lambda chapter: experiments if chapter == 1 else experiments_of(chapter)):
            return learn.planned_knowledge([1], learn.planned_knowledge([1], KNOWLEDGE_OF))[1]

    def test_an_experiment_with_other_words_need_not_be_measured_again(self):
        planned = self.planned_with(lambda angle: replace(angle, subject="other words", decides=not angle.decides))
        self.assertEqual(planned["experiments"]["angle"], KNOWLEDGE_OF[1]["experiments"]["angle"])
        self.assertEqual(planned["mistakes"], KNOWLEDGE_OF[1]["mistakes"])

    def test_of_a_mistake_only_what_a_changed_experiment_shows_is_measured_again(self):
        planned = self.planned_with(lambda angle: replace(angle, points=[replace(point, samples=1) for point in angle.points]))
        self.assertNotIn("mean", planned["experiments"]["angle"])
        for name, known in KNOWLEDGE_OF[1]["mistakes"].items():
            self.assertEqual(planned["mistakes"][name]["unseen"], ["angle"])
            self.assertEqual(
                planned["mistakes"][name]["shows"], {key: text for key, text in known["shows"].items() if key != "angle"}
            )


class ConfusionTest(unittest.TestCase):
    def record(self):
        return json.loads((PROJECT / "notebook/records/check/confusion.json").read_text(encoding="utf-8"))

    def test_what_matters_is_found_and_named_and_nothing_correct_is_refused(self):
        for condition, rate in rates(self.record()).items():
            if condition == "correct":
                self.assertGreaterEqual(rate.tried, 200)
                self.assertEqual(rate.found, 0, "correct shaders")
            else:
                self.assertEqual(rate.found_of_large, rate.large, condition)
                self.assertEqual(rate.told, rate.found, f"{condition}: never silent")
                self.assertGreaterEqual(rate.right / rate.alone, 0.98, f"{condition}: no wrong name alone")
                self.assertGreaterEqual(rate.among / rate.found, 0.9 if condition == "new seeds" else 0.8, condition)
        own = rates(self.record())["new seeds"]
        self.assertGreaterEqual(own.fitting / own.found, 0.9, "in all numbers, if the shader is the one that was measured")
