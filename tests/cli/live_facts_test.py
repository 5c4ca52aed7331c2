"""The facts of a page's check are those of ./lab check: both get the same numbers."""

import json
import shutil
import subprocess
import unittest

from tools_path import PROJECT, TOOLS  # first: it finds the others
import numpy as np
from book.live import RULES
from check import facts
from check.experiments import SIZE, Experiment, Point, Sight, look, together

NODE = shutil.which("node")
SAMPLES = 64
FACTORS = [1, 1.004, 0.5, 2 / 3, np.pi, 0, 1.2, 2.71, 0.04]


@unittest.skipUnless(NODE, "needs nodejs, which ./lab test installs")
class LiveFactsTest(unittest.TestCase):
    def test_are_those_of_the_check(self):
        random, cases = np.random.default_rng(1), []
        for _ in range(1000):
            count = int(random.integers(1, 5))
            points = [Point({}, f"place {i}") for i in range(count)]
            expected = [
                Sight(mean, 1e-3 * abs(mean), 0, 0, 1) for mean in map(float, random.choice([0.3, -0.5, 2.0, 1e-5], count))
            ]
            factors = random.choice(FACTORS, count) if random.integers(2) else [random.choice(FACTORS)] * count
            errors = random.choice([1e-3, 0.02], count)
            # Off by a few errors, so that the limits matter.
            sights = [
                Sight(
                    right.mean * factor * (1 + 2 * error * random.standard_normal()),
                    abs(right.mean) * factor * error,
                    0,
                    0,
                    1,
                    int(random.integers(20) == 0),
                )
                for right, factor, error in zip(expected, factors, errors)
            ]
            cases.append((Experiment("name", "light", "the place", points), expected, sights))
        images = random.gamma(2, size=(3, SIZE, SIZE, 3))
        report = {"rows": [{"rays": 1}], "invalid_samples": 2}
        channels = [None, 0, 2]
        task = {
            "rules": {name: getattr(facts, name) for name in RULES},
            "experiments": [
                {
                    "subject": e.subject,
                    "varies": e.varies,
                    "points": [{"at": p.at, "mean": s.mean, "error": s.error} for p, s in zip(e.points, right)],
                    "sights": [{"mean": s.mean, "error": s.error, "invalid": s.invalid} for s in now],
                }
                for e, right, now in cases
            ],
            "films": [
                {
                    "width": SIZE,
                    "height": SIZE,
                    "samples": SAMPLES,
                    "invalid": 2,
                    "channel": channel,
                    "sums": (SAMPLES * image).ravel().tolist(),
                }
                for image, channel in zip(images, channels)
            ],
        }
        output = subprocess.run(
            [NODE, PROJECT / "tests/browser/facts.js", TOOLS / "book/live"],
            input=json.dumps(task),
            capture_output=True,
            text=True,
            check=True,
        )
        found = json.loads(output.stdout)
        for (experiment, right, now), other in zip(cases, found["facts"]):
            fact = facts.fact(experiment, now, right)
            self.assertEqual((other["sentence"], other["isRight"]), (fact.sentence, fact.is_right))
        self.assertGreater(len({fact["sentence"] for fact in found["facts"]}), 100)
        for image, channel, other in zip(images, channels, found["sights"]):
            sight = look(image, report, SAMPLES, channel)
            self.assertTrue(
                np.allclose(
                    [other["mean"], other["error"], other["invalid"]], [sight.mean, sight.error, sight.invalid], rtol=1e-9
                )
            )
        sight, other = together([look(image, report, SAMPLES) for image in images]), found["together"]
        self.assertTrue(
            np.allclose([other["mean"], other["error"], other["invalid"]], [sight.mean, sight.error, sight.invalid], rtol=1e-9)
        )
