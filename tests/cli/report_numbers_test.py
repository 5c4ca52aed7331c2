"""The numbers of ./lab report, from records whose true values are known."""

import math
import random
import unittest

import tools_path  # noqa: F401  (first: it finds the others)
import numpy as np
from project import chapter_named
from references.images import Reference
from report import numbers

PIXELS = 16 * 16
REFERENCE = {"mean": [0.5, 0.25, 0.125], "variance": [1e-10] * 3, "freedom": 63}


def synthetic_run(
    dice_seed, samples=64, error=1.0, seconds=0.01, noise=0.0, exponent=-1.0, bias=0.0, deviation=0.2, evenness=0.5
):
    """Rows at 1, 2, 4, …: error × samples^exponent with noise, and image means with the given deviation for one sample, which
    falls like samples^-evenness."""
    dice = random.Random(dice_seed)
    rows, done, sums = [], 0, [0.0] * 3
    while done < samples:
        added = max(done, 1)
        for channel, mean in enumerate(REFERENCE["mean"]):
            sums[channel] += mean * (added * (1 + bias) + deviation * added ** (1 - evenness) * dice.gauss(0, 1))
        done += added
        rows.append(
            {
                "samples": done,
                "seconds": seconds * done,
                "device_seconds": 0.5 * seconds * done,
                "rays": 3 * PIXELS * done,
                "rel_mse": error * done**exponent * math.exp(noise * dice.gauss(0, 1)),
                "mean": [s / done for s in sums],
            }
        )
    return {"command_seconds": rows[-1]["seconds"] + 0.3, "rows": rows}


def synthetic_case(name, count=5, first_dice=1, program="", **truth):
    runs = [synthetic_run(dice, **truth) | {"seed": seed} for seed, dice in enumerate(range(first_dice, first_dice + count), 1)]
    return {
        "scene": "box",
        "case": name,
        "is_peer": name == "Mitsuba",
        "program": program,
        "options": "",
        "backend": "",
        "note": "",
        "refused": None,
        "width": 16,
        "height": 16,
        "scale": 1,
        "paths_per_sample": 1,
        "max_path_length": 3,
        "reference": REFERENCE,
        "runs": runs,
    }


def summary(*cases):
    return numbers.summarize({"cases": list(cases)})[0]


class ReportNumbersTest(unittest.TestCase):
    def assert_covers(self, interval, truth):
        self.assertLess(interval[1], truth)
        self.assertGreater(interval[2], truth)

    def test_quantiles_of_students_distribution(self):
        for confidence, freedom, expected in (
            (0.95, 4, 2.776445),
            (0.999, 10, 4.586894),
            (0.95, 1e6, 1.959966),
            (0.2, 2, 0.288675),
        ):
            self.assertAlmostEqual(numbers.two_sided(confidence, freedom), expected, delta=2e-6)

    def test_slopes(self):
        for exponent in (-1.0, -0.5):
            exact = summary(synthetic_case("a", exponent=exponent))["cases"][0]
            noisy = summary(synthetic_case("a", exponent=exponent, noise=0.1))["cases"][0]
            for key in ("slope_samples", "slope_seconds"):
                self.assertAlmostEqual(exact[key][0], exponent)
                self.assert_covers(noisy[key], exponent)
                self.assertLess(noisy[key][2] - noisy[key][1], 0.4)

    def test_error_times_time_is_relative_to_the_first_case(self):
        first, second = summary(synthetic_case("a", error=4.0, seconds=0.01), synthetic_case("b", error=0.25, seconds=0.02))[
            "cases"
        ]
        self.assertEqual(first["error_time"], [1.0, None, None])
        self.assertAlmostEqual(second["error_time"][0], 1 / 8)
        self.assertAlmostEqual(second["error_device_time"][0], 1 / 8)
        self.assertAlmostEqual(second["rays_per_sample"], 3)
        self.assertAlmostEqual(second["rays_per_second"], 3 * PIXELS / 0.02)
        self.assertAlmostEqual(second["rays_per_device_second"], 3 * PIXELS / 0.01)

    def test_gain_over_a_peer_and_time_to_one_percent(self):
        scene = summary(
            synthetic_case("a", error=0.8, seconds=0.01, noise=0.05),
            synthetic_case("Mitsuba", error=0.8, seconds=0.03, noise=0.05, first_dice=100),
        )
        self.assert_covers(scene["gains"][0]["gain"], 3)
        self.assertEqual([gain["case"] for gain in scene["gains"]], ["a"])  # no gain of the peer over itself
        self.assert_covers(scene["cases"][0]["seconds_to_target"], 0.3 + 0.8 / 1e-4 * 0.01)
        self.assertAlmostEqual(scene["cases"][0]["start_up_seconds"][0], 0.3)

    def assert_share(self, found, trials, probability):
        """As many as the probability implies, up to chance."""
        self.assertLess(abs(found / trials - probability), 4 * math.sqrt(probability * (1 - probability) / trials))

    def covered(self, ratio, shared, trials=2000):
        """How many intervals of a quotient contain the true value, 2, if the two series share this much of their noise."""
        found = 0
        for trial in range(trials):
            dice = np.random.default_rng(trial)
            noise = [shared * both + math.sqrt(1 - shared**2) * dice.normal(size=5) for both in [dice.normal(size=5)] * 2]
            now, base = (numbers.Series(dict(enumerate(mean * (1 + 0.05 * part)))) for mean, part in zip((2, 1), noise))
            _, low, high = ratio(now, base)
            found += low < 2 < high
        return found, trials

    def test_intervals_cover_the_truth_as_often_as_they_say(self):
        found, trials = self.covered(numbers.ratio, 0.0)
        self.assertGreater(found / trials, 0.95)  # never less, see half_width()
        self.assertLess(found / trials, 0.98)

    def test_intervals_of_cases_that_share_seeds_cover_the_truth_as_often_as_they_say(self):
        for shared in (0.0, 0.9):
            self.assert_share(*self.covered(numbers.paired_ratio, shared), 0.95)

    def test_error_times_time_pairs_the_runs_with_the_same_seed(self):
        """For runs that are equal up to a factor the quotient is known exactly, however much they vary."""
        first, second = (synthetic_case(name, error=error, noise=0.5) for name, error in (("a", 4.0), ("b", 2.0)))
        second["runs"].reverse()
        for end in summary(first, second)["cases"][1]["error_time"]:
            self.assertAlmostEqual(end, 0.5)

    def test_intervals_hold_the_noise_of_the_reference(self):
        """Runs that all miss the true value alike, by as much as the reference says that it may contribute."""
        trials, found = 400, {"error": 0, "error_time": 0, "gain": 0, "slope": 0}
        for trial in range(trials):
            shift = 0.001 * random.Random(-trial).gauss(0, 1)
            cases = [
                synthetic_case(name, error=error, noise=0.01, first_dice=10 * trial + 1)
                for name, error in (("a", 1.0), ("b", 0.5))
            ]
            cases.append(synthetic_case("Mitsuba", error=2.0, noise=0.01, first_dice=-10 * trial - 9))
            for case in cases:
                case["reference"] = REFERENCE | {"rel_mse_deviation": 0.001}
                for row in (row for run in case["runs"] for row in run["rows"]):
                    row["rel_mse"] += shift
            scene = summary(*cases)
            first, second, _ = scene["cases"]
            gain = next(gain["gain"] for gain in scene["gains"] if gain["case"] == "b")
            for name, (_, low, high), truth in (
                ("error", first["error"], 1 / 64),
                ("error_time", second["error_time"], 1 / 2),
                ("gain", gain, 4),
                ("slope", first["slope_samples"], -1),
            ):
                found[name] += low < truth < high
        for name in found:
            self.assert_share(found[name], trials, 0.95)

    def test_the_noise_of_the_reference_is_what_it_says(self):
        """Many references of the same scene: how much rel_mse of one image varies."""
        dice, batches = np.random.default_rng(1), 64
        truth = dice.uniform(0.1, 1, (16, 16, 1)) * np.ones(3)
        results, stated = [], []
        for _ in range(1000):
            samples = truth + 0.2 * truth * dice.normal(size=(batches, 16, 16, 1))  # channels are correlated
            reference = Reference(samples.mean(axis=0), samples.var(axis=0, ddof=1) / batches, {"batches": str(batches)})
            weights = 1 / (truth**2 + 0.01 * truth.mean() ** 2)
            results.append((weights * ((truth - reference.mean) ** 2 - reference.variance)).mean())
            stated.append(reference.rel_mse_deviation)
        self.assertAlmostEqual(np.std(results) / np.mean(stated), 1, delta=0.1)

    def test_samples_paths_and_large_pictures_are_told_apart(self):
        plain, branching = synthetic_case("a"), synthetic_case("b") | {"paths_per_sample": 4}
        large = synthetic_case("c") | {"width": 128, "height": 128, "scale": 8}
        plain, branching, large = summary(plain, branching, large)["cases"]
        self.assertAlmostEqual(branching["samples_per_second"], plain["samples_per_second"])
        self.assertAlmostEqual(branching["paths_per_second"], 4 * plain["paths_per_second"])
        self.assertAlmostEqual(large["samples_per_second"], 64 * plain["samples_per_second"])
        self.assertAlmostEqual(plain["error_of_one_sample"], 1)
        self.assertAlmostEqual(large["error_of_one_sample"], 64)  # 64 samples in a pixel of the reference err as one here

    def test_a_planted_bias_is_found_and_stated(self):
        for channel in summary(synthetic_case("a", bias=-0.14))["cases"][0]["bias"]:
            self.assertTrue(channel["is_biased"])
            self.assertAlmostEqual(channel["value"], -0.14, delta=2 * channel["half_width"])
            self.assertLess(channel["half_width"], 0.04)

    def test_without_bias_there_are_no_alarms(self):
        alarms = 0
        for trial in range(100):
            case = summary(synthetic_case("a", first_dice=10 * trial))["cases"][0]
            alarms += any(channel["is_biased"] for channel in case["bias"])
        self.assertLessEqual(alarms, 5)  # 1 % is expected

    def test_points_that_are_spread_evenly_have_the_error_of_their_scrambles(self):
        """How much the means of reports vary, and the error that each of them states."""
        for program, evenness in (("", 0.5), (chapter_named("low_discrepancy_points"), 0.75)):
            with self.subTest(evenness=evenness):
                values, variances = [], []
                for trial in range(1000):
                    case = synthetic_case("a", first_dice=10 * trial, program=program, evenness=evenness)
                    runs = numbers.runs_in_batches(case)
                    test = numbers.biases(runs, REFERENCE, 1)[0]
                    freedom = sum(len(run["rows"]) for run in runs) - 1
                    values.append(test["value"])
                    variances.append((test["half_width"] / numbers.two_sided(numbers.CONFIDENCE, freedom)) ** 2)
                self.assertAlmostEqual(np.mean(variances) / np.var(values), 1, delta=0.2)

    def share_called_biased(self, runs, bias, part, level, trials=40000):
        """Share of many tests that find a bias, each on its own render and its own reference with `part` of the render's noise;
        also the detectable bias as stated, in standard errors of the mean."""
        dice, deviation, freedom = np.random.default_rng(runs), 0.1, 63
        error = deviation / math.sqrt(runs)
        reference = {
            "mean": 1 + part * error * dice.normal(size=trials),
            "freedom": freedom,
            "variance": (part * error) ** 2 * dice.chisquare(freedom, trials) / freedom,
        }
        means = 1 + bias * error + deviation * dice.normal(size=(runs, trials))
        tests = numbers.biases(
            [{"rows": [{"samples": 1, "mean": mean}]} for mean in means], reference, numbers.FALSE_ALARMS / level
        )
        # Noise of exactly the stated size: means of two values at the corresponding distance.
        known = [
            {"rows": [{"samples": 1, "mean": [1 + deviation * math.sqrt((runs - 1) / runs) * (-1) ** run]}]}
            for run in range(runs)
        ]
        sure = {"mean": [1.0], "variance": [(part * error) ** 2], "freedom": freedom}
        stated = numbers.biases(known, sure, numbers.FALSE_ALARMS / level)[0]["detectable"] / error
        return sum(test["is_biased"] for test in tests), trials, stated

    def test_levels_and_powers_are_those_that_are_stated(self):
        for runs in (4, 12):
            for level in (0.05, 0.001):
                with self.subTest(runs=runs, level=level):
                    found, trials, stated = self.share_called_biased(runs, 0.0, 0.02, level)
                    self.assert_share(found, trials, level)
                    found, trials, _ = self.share_called_biased(runs, stated, 0.02, level)
                    self.assertAlmostEqual(found / trials, numbers.POWER, delta=0.006)

    def test_what_two_runs_detect_among_thousands_of_tiles(self):
        """For the largest of these numbers, SciPy's function alone does not return."""
        for comparisons in (1, 30, 1000, 1e5, 1e8):
            with self.subTest(comparisons=comparisons):
                level = numbers.FALSE_ALARMS / comparisons
                shift = numbers.detectable_shift(level, 1)
                # With one degree of freedom, the estimate is the size of a normal number: by trapezoids over it.
                size = np.linspace(0, 6, 200001)
                threshold = numbers.two_sided(1 - level, 1)
                found = np.vectorize(math.erfc, otypes=[float])((threshold * size - shift) / math.sqrt(2)) / 2
                density = math.sqrt(2 / math.pi) * np.exp(-(size**2) / 2)
                self.assertAlmostEqual(np.trapz(found * density, size), numbers.POWER, delta=1e-4)

    def test_no_level_is_exceeded_where_the_reference_is_noisy(self):
        for runs in (2, 4, 12):
            for part in (0.1, 1.0, 5.0):
                with self.subTest(runs=runs, part=part):
                    found, trials, stated = self.share_called_biased(runs, 0.0, part, 0.001)
                    self.assertLess(found / trials, 0.001 + 4 * math.sqrt(0.001 / trials))
                    found, trials, _ = self.share_called_biased(runs, stated, part, 0.001)
                    self.assertGreater(found / trials, numbers.POWER - 0.006)

    def test_one_run_has_no_intervals_but_numbers(self):
        case = summary(synthetic_case("a", count=1))["cases"][0]
        self.assertEqual(case["error"][1:], [None, None])
        self.assertAlmostEqual(case["error"][0], 1 / 64)

    def test_an_error_lost_in_the_noise_of_the_reference_has_no_quotients(self):
        first, second = summary(synthetic_case("a"), synthetic_case("b", error=0.0))["cases"]
        self.assertEqual(second["error"], [None] * 3)
        self.assertEqual(second["error_time"], [None] * 3)
        self.assertIsNone(second["slope_samples"])
        self.assertEqual(second["curve"], [])
