"""The numbers of ./lab report, from records whose truth is known."""

import math
import random
import sys
import unittest

from program import PROJECT

sys.path.insert(0, str(PROJECT / "tools"))
import report_numbers as numbers  # noqa: E402

PIXELS = 16 * 16
REFERENCE = {"mean": [0.5, 0.25, 0.125], "variance": [1e-10] * 3, "freedom": 63}


def synthetic_run(seed, samples=64, error=1.0, seconds=0.01, noise=0.0, exponent=-1.0, bias=0.0, deviation=0.2):
    """Rows at 1, 2, 4, …: error × samples^exponent with noise, and image means with a deviation for one sample."""
    dice = random.Random(seed)
    rows, done, sums = [], 0, [0.0] * 3
    while done < samples:
        added = max(done, 1)
        for channel, mean in enumerate(REFERENCE["mean"]):
            sums[channel] += mean * (added * (1 + bias) + deviation * math.sqrt(added) * dice.gauss(0, 1))
        done += added
        rows.append({"samples": done, "seconds": seconds * done, "device_seconds": 0.5 * seconds * done, "rays": 3 * PIXELS * done,
                     "rel_mse": error * done**exponent * math.exp(noise * dice.gauss(0, 1)), "mean": [s / done for s in sums]})
    return {"seed": seed, "command_seconds": rows[-1]["seconds"] + 0.3, "rows": rows}


def synthetic_case(name, count=5, first_seed=1, **truth):
    runs = [synthetic_run(seed, **truth) for seed in range(first_seed, first_seed + count)]
    return {"scene": "box", "case": name, "is_peer": name == "Mitsuba", "program": "", "backend": "", "note": "", "refused": None,
            "width": 16, "height": 16, "max_path_length": 3, "reference": REFERENCE, "runs": runs}


def summary(*cases):
    return numbers.summarize({"cases": list(cases)})[0]


class ReportNumbersTest(unittest.TestCase):
    def assert_covers(self, interval, truth):
        self.assertLess(interval[1], truth)
        self.assertGreater(interval[2], truth)

    def test_quantiles_of_students_distribution(self):
        for probability, freedom, expected in ((0.975, 4, 2.776445), (0.9995, 10, 4.586894), (0.975, 1e6, 1.959966), (0.6, 2, 0.288675)):
            self.assertAlmostEqual(numbers.student_quantile(probability, freedom), expected, delta=2e-6)

    def test_slopes(self):
        for exponent in (-1.0, -0.5):
            exact = summary(synthetic_case("a", exponent=exponent))["cases"][0]
            noisy = summary(synthetic_case("a", exponent=exponent, noise=0.1))["cases"][0]
            for key in ("slope_samples", "slope_seconds"):
                self.assertAlmostEqual(exact[key][0], exponent)
                self.assert_covers(noisy[key], exponent)
                self.assertLess(noisy[key][2] - noisy[key][1], 0.4)

    def test_efficiency_is_relative_to_the_first_case(self):
        first, second = summary(synthetic_case("a", error=4.0, seconds=0.01), synthetic_case("b", error=0.25, seconds=0.02))["cases"]
        self.assertEqual(first["efficiency"], [1.0, None, None])
        self.assertAlmostEqual(second["efficiency"][0], 8)
        self.assertAlmostEqual(second["device_efficiency"][0], 8)
        self.assertAlmostEqual(second["rays_per_path"], 3)
        self.assertAlmostEqual(second["rays_per_second"], 3 * PIXELS / 0.02)
        self.assertAlmostEqual(second["rays_per_device_second"], 3 * PIXELS / 0.01)

    def test_gain_over_a_peer_and_time_to_one_percent(self):
        scene = summary(synthetic_case("a", error=0.8, seconds=0.01, noise=0.05),
                        synthetic_case("Mitsuba", error=0.8, seconds=0.03, noise=0.05, first_seed=100))
        self.assert_covers(scene["gains"][0]["gain"], 3)
        self.assert_covers(scene["cases"][0]["seconds_to_target"], 0.3 + 0.8 / 1e-4 * 0.01)
        self.assertAlmostEqual(scene["cases"][0]["start_up_seconds"][0], 0.3)

    def test_intervals_cover_the_truth_as_often_as_they_say(self):
        trials, found = 400, 0
        for trial in range(trials):
            dice = random.Random(trial)
            now, base = ([dice.gauss(mean, 0.05 * mean) for _ in range(5)] for mean in (2.0, 1.0))
            quotient = numbers.ratio(numbers.estimate(now), numbers.estimate(base))
            found += quotient[1] < 2 < quotient[2]
        self.assertGreater(found / trials, 0.95 - 4 * math.sqrt(0.05 * 0.95 / trials))
        self.assertLess(found / trials, 0.95 + 4 * math.sqrt(0.05 * 0.95 / trials))

    def test_a_planted_bias_is_found_and_stated(self):
        for channel in summary(synthetic_case("a", bias=-0.14))["cases"][0]["bias"]:
            self.assertTrue(channel["is_biased"])
            self.assertAlmostEqual(channel["value"], -0.14, delta=2 * channel["half_width"])
            self.assertLess(channel["half_width"], 0.04)

    def test_without_bias_there_are_no_alarms(self):
        alarms = 0
        for trial in range(100):
            case = summary(synthetic_case("a", first_seed=10 * trial))["cases"][0]
            alarms += any(channel["is_biased"] for channel in case["bias"])
        self.assertLessEqual(alarms, 5)  # 1 % is expected

    def test_what_is_said_to_be_found_is_found(self):
        trials, found = 100, 0
        for trial in range(trials):
            truth = {"first_seed": 10 * trial, "deviation": 0.1}
            smallest = numbers.bias(synthetic_case("a", **truth)["runs"], 0, REFERENCE, 3)["detectable"]
            case = synthetic_case("a", bias=smallest, **truth | {"first_seed": 5000 + 10 * trial})
            found += numbers.bias(case["runs"], 0, REFERENCE, 3)["is_biased"]
        self.assertGreaterEqual(found, 85)  # 95 are expected, a few less since the smallest bias is an estimate itself
        self.assertLess(found, 100)

    def test_one_run_has_no_intervals_but_numbers(self):
        case = summary(synthetic_case("a", count=1))["cases"][0]
        self.assertEqual(case["error"][1:], [None, None])
        self.assertAlmostEqual(case["error"][0], 1 / 64)

    def test_an_error_lost_in_the_noise_of_the_reference_has_no_quotients(self):
        first, second = summary(synthetic_case("a"), synthetic_case("b", error=0.0))["cases"]
        self.assertEqual(second["error"], [None] * 3)
        self.assertEqual(second["efficiency"], [None] * 3)
        self.assertIsNone(second["slope_samples"])
        self.assertEqual(second["curve"], [])


if __name__ == "__main__":
    unittest.main()
