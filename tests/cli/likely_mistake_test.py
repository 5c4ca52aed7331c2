"""What ./lab check knows of mistakes: the catalogue, the signatures, and how often it has named them right."""

import json
import random
import re
import unittest

from program import PROJECT  # first: it finds the tools
import learn
from check.grading import MOST_RUNS, SEED_STEP
from check.likely_mistake import SIGNATURES, Signature, rank, read_signatures
from docs.confusion_table import rates
from planting import catalogue, trials

KNOWN = json.loads(SIGNATURES.read_text(encoding="utf-8"))
CHAPTER_3 = read_signatures(KNOWN["3"])


class LikelyMistakeTest(unittest.TestCase):
    def test_every_mistake_of_the_catalogue_is_known(self):
        expected = {chapter: {} for chapter in KNOWN}
        for chapter, mistake, _ in catalogue():
            expected[str(chapter)][mistake["name"]] = {key: mistake["check"][key] for key in ("hint", "slide")}
        known = {chapter: {name: {key: entry[key] for key in ("hint", "slide")} for name, entry in entries.items()}
                 for chapter, entries in KNOWN.items()}
        self.assertEqual(known, expected, "tests/mistakes/learn.py learn")
        self.assertGreater(sum(map(len, known.values())), 70)

    def test_nothing_was_learnt_from_the_seeds_of_a_check(self):
        plans = (learn.LEARNING, learn.LEVELS, learn.TRYING)
        seeds = [seed for plan in plans for seed in range(plan["first_seed"], plan["first_seed"] + plan["runs"])]
        self.assertEqual(len(set(seeds)), len(seeds))
        self.assertTrue(all(MOST_RUNS < seed <= SEED_STEP for seed in seeds), seeds)

    def test_every_slide_to_read_again_is_in_the_slide_map(self):
        titles = re.findall(r"^### (.*)$", (PROJECT / "docs/slides.md").read_text(encoding="utf-8"), re.MULTILINE)
        for entries in KNOWN.values():
            for name, entry in entries.items():
                self.assertIn(entry["slide"], titles, name)

    def test_the_confusion_matrix_was_measured_with_the_settings_of_the_code(self):
        record = json.loads((PROJECT / "docs/records/check/confusion.json").read_text(encoding="utf-8"))
        self.assertEqual(record["settings"], learn.settings(), "stale: measure anew with tests/mistakes/learn.py confusion")

    def test_the_confusion_matrix_has_every_trial_and_four_fifths_are_named_right(self):
        record = json.loads((PROJECT / "docs/records/check/confusion.json").read_text(encoding="utf-8"))
        self.assertEqual(set(record["trials"]), set(trials()), "tests/mistakes/learn.py confusion")
        for (condition, is_mistake), (tried, found, right, _) in rates(record).items():
            if is_mistake:
                self.assertGreaterEqual(right / tried, 0.8, condition)
            else:
                # One ignores --roulette-start, and so traces more rays than it was asked to.
                self.assertLessEqual(found, 1, f"correct shaders, {condition}")

    def seen(self, name, scatter):
        """The signature of a mistake as a noisy check would see it in a shader that differs a little."""
        generator, known = random.Random(name), CHAPTER_3[name]
        errors = [scatter * 0.01] * len(known.differences)
        return Signature([0.95 * d + generator.gauss(0, e) for d, e in zip(known.differences, errors)], errors,
                         [1.1 * n for n in known.noise], known.rays)

    def test_what_is_seen_noisily_is_recognised(self):
        for name in CHAPTER_3:
            self.assertEqual(rank(self.seen(name, 0.2), CHAPTER_3)[0], name)

    def test_what_is_like_no_mistake_has_no_name(self):
        known = CHAPTER_3["no-shadow-ray"]
        count = len(known.differences)
        stripes = [0.5 if i % 2 else -0.3 for i in range(count)]
        self.assertEqual(rank(Signature(stripes, [0.01] * count, [1.0] * 3, [1.0] * 3), CHAPTER_3), [])


if __name__ == "__main__":
    unittest.main()
