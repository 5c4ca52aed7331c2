"""The numbers of a record of measurements: errors, slopes, error × time and the test for bias, with their intervals.

A record has cases; a case has runs with different seeds; a run has rows, the chapter's report at 1, 2, 4, … samples. Intervals
have a confidence of 95 %. They account for the spread of the runs and for the noise of the reference, which shifts the errors of
all runs of a scene together.
"""
import math
from typing import NamedTuple

import numpy as np
from project import has_low_discrepancy
from scipy.special import chdtri, nctdtrinc, stdtrit

CONFIDENCE = 0.95
FALSE_ALARMS = 0.01  # probability that an unbiased report calls anything biased
POWER = 0.95  # probability of finding the smallest bias that a test calls detectable
TARGET_ERROR = 0.01  # for the time to reach it; the root of rel_mse
SLOPE_ROWS = 6  # the last ones: fixed costs dominate the first
KNOWN = 1e6  # degrees of freedom of an error that is known, not estimated
ROUNDING = 1e-5  # of a mean: other programs sum in a different order
FAR = 1000  # standard errors: SciPy's time for nctdtrinc() grows with them, beyond any limit


# ---------------------------------------------------------------------------------------------- numbers as text
def short(value, digits=3):
    """A number with this many significant digits, without an exponent if that is readable."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0 or isinstance(value, int) or not 1e-4 <= abs(value) < 1e7:
        return f"{value:,}" if isinstance(value, int) else f"{value:.{digits}g}"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:,.{decimals}f}"


# ---------------------------------------------------------------------------------------------- intervals
def two_sided(confidence, freedom):
    """The t such that Student's distribution lies between -t and t with this probability."""
    return -stdtrit(freedom, (1 - confidence) / 2)


def detectable_shift(level, freedom):
    """The shift, in standard errors, of which a two-sided test finds the share POWER."""
    threshold = two_sided(1 - level, freedom)
    if threshold > FAR:  # there, it only matters by how much the standard error is overestimated
        return threshold * math.sqrt(chdtri(freedom, 1 - POWER) / freedom)
    return nctdtrinc(freedom, 1 - POWER, threshold)


def half_width(parts, factor=lambda freedom: two_sided(CONFIDENCE, freedom)):
    """Half the interval of a sum of independent parts (squared standard error, its degrees of freedom), numbers or arrays. After
    Cochran and Cox: conservative for any degrees of freedom, exact if one part dominates. Welch's interval is too short in the
    tails."""
    return np.sqrt(sum(square * factor(freedom) ** 2 for square, freedom in parts))


def mean_part(numbers):
    """The part for half_width() that the mean of independent numbers contributes."""
    return np.var(numbers, ddof=1) / len(numbers), len(numbers) - 1


def log_interval(value, parts):
    """[value, low, high] of a quotient; the parts are those of its logarithm."""
    factor = math.exp(half_width(parts))
    return [value, value / factor, value * factor]


class Series(NamedTuple):
    """Errors of a case, or quantities proportional to them, one per run. `shift` is the standard deviation of the reference's
    contribution, relative to their mean. It is common to all runs, and correlated among the cases of a scene."""

    numbers: dict  # seed -> number
    shift: float = 0.0

    @property
    def mean(self):
        return sum(self.numbers.values()) / len(self.numbers)

    def interval(self):
        """[mean, low, high] of a positive quantity. The mean is None if it is not positive: the noise of the reference hides
        the error."""
        mean = self.mean
        if mean <= 0 or len(self.numbers) < 2:
            return [mean if mean > 0 else None, None, None]
        return log_interval(mean, [mean_part([x / mean for x in self.numbers.values()]), (self.shift**2, KNOWN)])


def ratio(now, base, is_paired=False):
    """[quotient, low, high] of the means of two series. Runs are independent, or paired by their seeds."""
    if is_paired:
        seeds = sorted(now.numbers.keys() & base.numbers.keys())
        now, base = (Series({seed: of.numbers[seed] for seed in seeds}, of.shift) for of in (now, base))
    if not now.numbers or now.mean <= 0 or base.mean <= 0:
        return [None, None, None]
    quotient, relative = now.mean / base.mean, [[x / of.mean for x in of.numbers.values()] for of in (now, base)]
    if min(map(len, relative)) < 2:
        return [quotient, None, None]
    parts = [mean_part([a - b for a, b in zip(*relative)])] if is_paired else list(map(mean_part, relative))
    return log_interval(quotient, parts + [((now.shift - base.shift) ** 2, KNOWN)])


def paired_ratio(now, base):
    """The same for runs with equal seeds. They share random numbers, so their errors are correlated, and the interval follows
    from the spread of the differences between runs with the same seed."""
    return ratio(now, base, is_paired=True)


# ---------------------------------------------------------------------------------------------- of runs
def last_rows(runs):
    return [run["rows"][-1] for run in runs]


def mean_of(rows, key):
    """The mean of a key over rows; None if a row lacks it."""
    values = [row.get(key) for row in rows]
    return None if None in values else sum(values) / len(values)


def deviation(case):
    """Standard deviation of the reference's contribution to rel_mse."""
    return (case["reference"] or {}).get("rel_mse_deviation", 0.0)


def errors(case, key=None, index=-1):
    """Series of rel_mse in the rows with this index, or of rel_mse times `key`: the cost of a given error, whatever the number of
    samples."""
    rows = {run["seed"]: run["rows"][index] for run in case["runs"]}
    mean = mean_of(rows.values(), "rel_mse")
    numbers = {seed: row["rel_mse"] * (row[key] if key else 1) for seed, row in rows.items()}
    return Series(numbers, deviation(case) / mean if mean else 0.0)


def curve(case):
    """Points (samples, mean seconds, [error, low, high]) at the sample counts that all runs report."""
    points = []
    for index, rows in enumerate(zip(*(run["rows"] for run in case["runs"]))):
        if len({row["samples"] for row in rows}) == 1 and all(row["rel_mse"] for row in rows):
            seconds = {key: mean_of(rows, key) for key in ("seconds", "device_seconds")}
            points.append({"samples": rows[0]["samples"], **seconds, "error": errors(case, index=index).interval()})
    return points


def slope(case, key):
    """[exponent, low, high] of the error as a power of samples or seconds, fitted to each run's last rows."""
    slopes, shifts = [], []
    for run in case["runs"]:
        rows = [row for row in run["rows"][-SLOPE_ROWS:] if row["rel_mse"] and row.get(key)]
        x, y = (np.log([row[name] for row in rows]) for name in (key, "rel_mse"))
        if len(set(x)) > 1:
            weights = (x - x.mean()) / ((x - x.mean()) ** 2).sum()
            slopes.append(float(weights @ y))
            shifts.append(float(weights @ (deviation(case) / np.exp(y))))
    if not slopes:
        return None
    mean = sum(slopes) / len(slopes)
    if len(slopes) < 2:
        return [mean, None, None]
    half = float(half_width([mean_part(slopes), ((sum(shifts) / len(shifts)) ** 2, KNOWN)]))
    return [mean, mean - half, mean + half]


def runs_in_batches(case):
    """The runs of a case in the form for batches(), which needs batch means with a variance of 1 / size. With low-discrepancy
    points the variance falls faster, so only the two halves of a run's samples are kept, which have independent scrambles."""
    if not has_low_discrepancy(case["program"]):
        return case["runs"]
    return [{"rows": halves(run["rows"][-1])} for run in case["runs"]]


def halves(row):
    """Rows for the first half of the samples and for all of them."""
    if "difference" not in row or row["samples"] < 2:  # an earlier record
        return [row]
    half = {"samples": row["samples"] / 2, "mean": np.array(row["mean"]) + np.array(row["difference"]) / 2}
    return [half, row]


def batches(runs):
    """Sample counts [batch] and means [batch, channel] of the samples between consecutive rows, which are independent."""
    counts, means = [], []
    for run in runs:
        before, mean_before = 0, 0.0
        for row in run["rows"]:
            samples, mean = row["samples"], np.array(row["mean"])
            counts.append(samples - before)
            means.append((samples * mean - before * mean_before) / (samples - before))
            before, mean_before = samples, mean
    return np.array(counts), np.array(means)


def biases(runs, reference, comparisons):
    """Tests the mean of each channel over the image for bias, relative to the reference.

    Batches have the variance of one sample over their size, or all have the same size. The variance of the reference is added.
    `comparisons` such tests together raise a false alarm with the probability FALSE_ALARMS. `detectable` is the smallest bias that
    is found with the probability POWER (noncentral t-distribution), if the noise is as estimated.
    """
    counts, means = batches(runs)
    samples, expected = counts.sum(), np.array(reference["mean"])
    mean, scale = counts @ means / samples, np.where(expected != 0, expected, 1)
    values = (mean - expected) / scale
    if len(counts) < 2:
        return [{"value": value, "half_width": None, "detectable": None, "is_biased": False} for value in values.tolist()]
    freedom, level = len(counts) - 1, FALSE_ALARMS / comparisons
    parts = [
        (counts @ (means - mean) ** 2 / freedom / samples / scale**2, freedom),
        (np.array(reference["variance"]) / scale**2, reference["freedom"]),
        (ROUNDING**2, KNOWN),
    ]
    columns = {
        "value": values,
        "half_width": half_width(parts),
        "detectable": half_width(parts, lambda nu: detectable_shift(level, nu)),
        "is_biased": np.abs(values) > half_width(parts, lambda nu: two_sided(1 - level, nu)),
    }
    return [dict(zip(columns, row)) for row in zip(*(column.tolist() for column in columns.values()))]


# ---------------------------------------------------------------------------------------------- of a record
def seconds_to_target(case):
    """[seconds, low, high] from the command to an error of TARGET_ERROR, and those of start-up alone.

    Beyond the run, rel_mse is extrapolated as 1 / samples.
    """
    start_ups = {run["seed"]: run["command_seconds"] - run["rows"][-1]["seconds"] for run in case["runs"]}
    rendering = errors(case, "seconds")
    whole = Series({seed: start_ups[seed] + product / TARGET_ERROR**2 for seed, product in rendering.numbers.items()})
    part = rendering.mean / TARGET_ERROR**2 / whole.mean if whole.mean > 0 else 0.0
    return whole._replace(shift=part * rendering.shift).interval(), Series(start_ups).interval()


def summarize_case(case, base, comparisons):
    """The numbers of a case for the page; error × time is relative to the case `base`."""
    rows, pixels = last_rows(case["runs"]), case["width"] * case["height"]
    summary = {key: case[key] for key in ("case", "is_peer", "program", "options", "backend", "note", "paths_per_sample")}
    summary |= {
        "runs": len(rows),
        "samples": rows[0]["samples"],
        "seconds": mean_of(rows, "seconds"),
        "device_seconds": mean_of(rows, "device_seconds"),
        "rays": mean_of(rows, "rays"),
        "error": errors(case).interval(),
        "curve": curve(case),
        "slope_samples": slope(case, "samples"),
        "slope_seconds": slope(case, "seconds"),
    }
    samples = summary["samples"] * pixels
    summary["error_of_one_sample"] = summary["samples"] * case["scale"] ** 2 * errors(case).mean  # of a pixel of the reference
    summary["samples_per_second"] = samples / summary["seconds"]
    summary["paths_per_second"] = case["paths_per_sample"] * summary["samples_per_second"]
    if summary["rays"]:
        summary["rays_per_sample"] = summary["rays"] / samples
        summary["rays_per_second"] = summary["rays"] / summary["seconds"]
        summary["rays_per_device_second"] = summary["rays"] / summary["device_seconds"]
    for key, name in (("seconds", "error_time"), ("device_seconds", "error_device_time")):
        if summary[key] and base["runs"]:
            summary[name] = [1.0, None, None] if case is base else paired_ratio(errors(case, key), errors(base, key))
    summary["seconds_to_target"], summary["start_up_seconds"] = seconds_to_target(case)
    summary["bias"] = biases(runs_in_batches(case), case["reference"], comparisons)
    return summary


def summarize(record):
    """The content of report.json: scenes with their cases, and comparisons with peers."""
    measured = [case for case in record["cases"] if case["runs"]]
    comparisons = max(3 * len(measured), 1)
    scenes = []
    for name in dict.fromkeys(case["scene"] for case in record["cases"]):
        cases = [case for case in record["cases"] if case["scene"] == name]
        ours = [case for case in cases if case["runs"] and not case["is_peer"]]
        peers = [case for case in cases if case["runs"] and case["is_peer"]]
        scenes.append(
            {
                **{key: cases[0][key] for key in ("scene", "width", "height", "scale", "max_path_length", "reference")},
                "refused": [{"case": case["case"], "why": case["refused"]} for case in cases if case["refused"]],
                "cases": [summarize_case(case, ours[0] if ours else case, comparisons) for case in ours + peers],
                # How many times faster than a peer a case reaches the same error.
                "gains": [
                    {
                        "case": case["case"],
                        "peer": peer["case"],
                        "gain": paired_ratio(errors(peer, "seconds"), errors(case, "seconds")),
                    }
                    for peer in peers
                    for case in ours + peers
                    if case is not peer
                ],
            }
        )
    return scenes
