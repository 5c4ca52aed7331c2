"""What ./lab check knows about mistakes, and how often it is right."""

import json
import re
import unittest
from dataclasses import replace
from unittest import mock

from paths import PROJECT  # first: it finds the others
from check.diagnosis import noise_findings
from check.experiments import experiments_of, known_sights
from check.facts import DARK, fact
from check.findings import findings, wrong_readings
from check.grading import CLOSER_RUNS, MOST_RUNS, RUNS, SEED_STEP
from check.names import numbers, ratios_of
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
            expected[bug.chapter][bug.mistake["name"]] = learn.words_of(bug.mistake)
        known = {chapter: {name: learn.words_of(entry) for name, entry in entries.items()} for chapter, entries in KNOWN.items()}
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
        self.assertTrue(all(2 * MOST_RUNS + CLOSER_RUNS < seed <= SEED_STEP for seed in seeds), seeds)

    def test_every_slide_to_read_again_is_in_the_slide_map(self):
        titles = re.findall(r"^### (.*)$", (PROJECT / "docs/slides.md").read_text(encoding="utf-8"), re.MULTILINE)
        for entries in KNOWN.values():
            for name, entry in entries.items():
                self.assertIn(entry.get("slide", titles[0]), titles, name)


class FactsOfMistakesTest(unittest.TestCase):
    """What a student would read about each mistake, if the experiments showed just what was learnt."""

    def observed(self, chapter, mistake):
        """Facts and sights of all experiments."""
        facts, sights = {}, {}
        for name, experiment in experiments_of(chapter).items():
            own, count = known_sights(KNOWLEDGE_OF[chapter]["experiments"][name]), len(experiment.points)
            brightest = max(abs(sight.mean) for sight in own)
            shown, noise, rays = (
                numbers(mistake.get(kind, {}).get(name, "")) or [1.0] * count for kind in ("shows", "noise", "rays")
            )
            if name not in mistake["shows"]:
                shown = [float(abs(sight.mean) > DARK * brightest) for sight in own]
            sights[name] = [
                replace(
                    sight,
                    mean=value * (sight.mean if abs(sight.mean) > DARK * brightest else brightest),
                    noise=sight.noise * noisier,
                    rays=sight.rays * more,
                )
                for sight, value, noisier, more in zip(own, shown, noise, rays)
            ]
            facts[name] = fact(experiment, sights[name], own)
        return facts, sights

    def assert_number_is_of(self, text, subjects_and_values):
        """That a text names the subject first that has its number."""
        number = re.match(r"(?:.* to )?(\d\S*)(?: ± (\S+))? times", text)
        if number and "with each bounce" not in text:
            value, off = float(number[1]), float(number[2] or 0)
            subject = text[number.end() :].partition(": ")[2]
            own = [v for of, values in subjects_and_values for v in values if subject.startswith(of)]
            self.assertTrue(any(abs(v - value) <= off + 0.03 * max(value, 0.2) for v in own), f"{text}: {own}")

    def test_a_number_belongs_to_the_subject_that_is_named_first(self):
        for chapter, mistakes in KNOWN.items():
            known = KNOWLEDGE_OF[chapter]["experiments"]
            for name, mistake in mistakes.items():
                facts, sights = self.observed(chapter, mistake)
                for found in findings(facts.values()):
                    values = [
                        (seen.experiment.subject, [reading.value for reading in wrong_readings(seen)]) for seen in found.facts
                    ]
                    with self.subTest(chapter=chapter, mistake=name):
                        self.assert_number_is_of(found.told()["text"], values)
                for found in noise_findings(facts, sights, known):
                    ratios = ratios_of(sights, known)["rays" if "rays" in found["text"] else "noise"]
                    values = [(facts[each].experiment.subject, [v for v, _ in those]) for each, those in ratios.items()]
                    with self.subTest(chapter=chapter, mistake=name):
                        self.assert_number_is_of(found["text"], values)


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
