"""What ./lab check knows of mistakes: the catalogue, the signatures, and how often it has named them right."""

import json
import random
import re
import unittest

from program import PROJECT  # first: it finds the tools
import learn
from check.grading import KNOWLEDGE, MOST_RUNS, RUNS, SCENES, SEED_STEP, first_seed
from check.likely_mistake import Signature, candidates, place_that_tells, read_signatures, surprises
from docs.confusion_table import rates
from planting import CORRECT_CHECKS, OTHER_SCENES, catalogue
from project import course

KNOWLEDGE_OF = learn.read_knowledge(KNOWLEDGE, course())
KNOWN = {chapter: entry["mistakes"] for chapter, entry in KNOWLEDGE_OF.items()}
SIGNATURES = read_signatures(next(known for known in KNOWN.values() if "no-shadow-ray" in known))
LEAST = 8  # mistakes that are known of each chapter


class LikelyMistakeTest(unittest.TestCase):
    def test_every_mistake_of_the_catalogue_is_known(self):
        expected = {chapter: {} for chapter in KNOWN}  # others are not measured yet
        for bug in catalogue():
            expected[bug.chapter][bug.mistake["name"]] = {key: bug.mistake[key] for key in ("hint", "slide")}
        known = {chapter: {name: {key: entry[key] for key in ("hint", "slide")} for name, entry in entries.items()}
                 for chapter, entries in KNOWN.items()}
        self.assertEqual(known, expected, "tests/mistakes/learn.py learn")
        for chapter, entries in known.items():
            self.assertGreaterEqual(len(entries), LEAST, f"chapter {chapter}")

    def test_nothing_was_learnt_from_the_seeds_of_a_check(self):
        plans = (learn.LEARNING, learn.TRYING | {"runs": CORRECT_CHECKS * RUNS})
        seeds = [seed for plan in plans for seed in range(plan["first_seed"], plan["first_seed"] + plan["runs"])]
        self.assertEqual(len(set(seeds)), len(seeds))
        self.assertTrue(all(MOST_RUNS < seed <= SEED_STEP for seed in seeds), seeds)

    def test_levels_have_the_seeds_of_a_check_so_that_renders_are_compared_one_by_one(self):
        seeds = [str(first_seed(0) + run) for run in range(RUNS)]
        for chapter, entry in KNOWLEDGE_OF.items():
            for scene, level in entry["levels"].items():
                self.assertEqual(list(level["rel_mse"]), seeds, (chapter, scene))

    def test_every_slide_to_read_again_is_in_the_slide_map(self):
        titles = re.findall(r"^### (.*)$", (PROJECT / "docs/slides.md").read_text(encoding="utf-8"), re.MULTILINE)
        for entries in KNOWN.values():
            for name, entry in entries.items():
                self.assertIn(entry["slide"], titles, name)

    def seen(self, name, scatter):
        """The signature of a mistake as a noisy check would see it in a shader that differs a little."""
        generator, known = random.Random(name), SIGNATURES[name]
        errors = [scatter * 0.01] * len(known.differences)
        return Signature([0.95 * d + generator.gauss(0, e) for d, e in zip(known.differences, errors)], errors,
                         [1.1 * n for n in known.noise], known.rays)

    def test_what_is_seen_noisily_is_recognised(self):
        for name in SIGNATURES:
            self.assertEqual(list(surprises(self.seen(name, 0.2), SIGNATURES))[0], name)

    def test_what_is_like_no_mistake_has_no_name(self):
        known = SIGNATURES["no-shadow-ray"]
        count = len(known.differences)
        stripes = [0.5 if i % 2 else -0.3 for i in range(count)]
        self.assertEqual(list(surprises(Signature(stripes, [0.01] * count, [1.0] * 3, [1.0] * 3), SIGNATURES)), [])

    def test_two_that_are_about_as_likely_are_both_told_and_where_to_look(self):
        self.assertEqual(candidates({"a": 20.0, "b": 100.0, "c": 101.0}), ["a"])
        self.assertEqual(candidates({"a": 20.0, "b": 25.0, "c": 101.0}), ["a", "b"])
        rows, columns = 6, 9  # of tiles
        tiles = [{"row": row, "column": column} for row in range(rows) for column in range(columns)]
        result = {"scenes": [{"scene": scene, "image": [{}] * 3, "tiles": tiles} for scene in ("one", "two")]}
        count = 2 * (3 + len(tiles))
        seen = Signature([0.0] * count, [0.01] * count, [1.0] * 2, [1.0] * 2)
        first, second = (Signature([0.1] * count, [], [1.0] * 2, [1.0] * 2) for _ in range(2))
        second.differences[-1] = -0.3  # the last tile of the second scene
        place = {"scene": "two", "place": "at the bottom right of the picture", "effects": [0.1, -0.3]}
        self.assertEqual(place_that_tells(result, seen, first, second), place)


if __name__ == "__main__":
    unittest.main()


class FreshKnowledge_all(unittest.TestCase):
    """What was measured is no older than the shaders. Measuring anew takes hours on a CPU."""

    def test_knowledge_was_measured_with_the_shaders_and_settings_of_the_code(self):
        scenes = {chapter: SCENES[chapter][1] for chapter in course()}
        for file, names in ((KNOWLEDGE, scenes), (learn.OTHER_KNOWLEDGE, OTHER_SCENES)):
            self.assertEqual(learn.unmeasured(learn.read_knowledge(file, names), names), [],
                             f"{file} is stale: tests/mistakes/learn.py learn, then confusion")

    def test_the_confusion_matrix_has_every_trial_of_the_code(self):
        record = json.loads((PROJECT / "docs/records/check/confusion.json").read_text(encoding="utf-8"))
        expected = {key: measured for key, (_, _, measured) in learn.planned_trials().items()}
        self.assertEqual({key: trial["measured"] for key, trial in record["trials"].items()}, expected,
                         "stale: measure anew with tests/mistakes/learn.py confusion")

    def test_what_matters_is_found_and_named_and_nothing_correct_is_refused(self):
        record = json.loads((PROJECT / "docs/records/check/confusion.json").read_text(encoding="utf-8"))
        for condition, rate in rates(record).items():
            if condition == "correct":
                self.assertGreaterEqual(rate.tried, 200)
                self.assertEqual(rate.found, 0, "correct shaders")
            else:
                self.assertEqual(rate.found_of_large, rate.large, condition)
                self.assertGreaterEqual(rate.right / rate.found, 0.9 if condition == "new seeds" else 0.8, condition)
