"""The numbers of a record of measurements: errors, slopes, efficiencies and the test for bias, with their intervals.

A record holds cases, what was rendered, each with runs of other seeds, each with rows: what a chapter reports at 1, 2,
4, … samples. Intervals hold 95 % of the time and come from the spread of the runs.
"""
import math
from typing import NamedTuple

CONFIDENCE = 0.95
FALSE_ALARMS = 0.01  # probability that a report calls anything biased that is not
TARGET_ERROR = 0.01  # for the time to it; the root of rel_mse
SLOPE_ROWS = 6  # the last ones, since the first are ruled by fixed costs
ROUNDING = 1e-5  # of a mean, which other programs sum in another order


# ---------------------------------------------------------------------------------------------- numbers as text
def short(value, digits=3):
    """A number with so many digits, without an exponent where that is readable."""
    if value is None or not math.isfinite(value):
        return "–"
    if value == 0 or isinstance(value, int) or not 1e-4 <= abs(value) < 1e7:
        return f"{value:,}" if isinstance(value, int) else f"{value:.{digits}g}"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{value:,.{decimals}f}"


def with_interval(values):
    """[value, low, high]; low is None where a single run tells no interval."""
    value, low, high = values
    return short(value, 2) + ("" if low is None else f" ({short(low, 2)} – {short(high, 2)})")


# ---------------------------------------------------------------------------------------------- Student's t
def incomplete_beta(a, b, x):
    """Regularised, by its continued fraction (Lentz's algorithm)."""
    if x > (a + 1) / (a + b + 2):  # where it converges slowly
        return 1 - incomplete_beta(b, a, 1 - x)
    if x <= 0:
        return 0.0
    front = math.exp(math.lgamma(a + b) - math.lgamma(a) - math.lgamma(b) + a * math.log(x) + b * math.log1p(-x)) / a
    c, d, fraction, tiny = 1.0, 0.0, 1.0, 1e-300
    for i in range(1000):
        m = i // 2
        if i == 0:
            term = 1.0
        elif i % 2 == 0:
            term = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m))
        else:
            term = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))
        d = 1 / (1 + term * d or tiny)
        c = 1 + term / c or tiny
        fraction *= c * d
        if abs(c * d - 1) < 1e-14:
            break
    return front * (fraction - 1)


def student_quantile(probability, freedom):
    """The t below which Student's distribution has this probability, which is above one half."""
    low, high = 0.0, 1.0

    def tail(t):
        return 0.5 * incomplete_beta(freedom / 2, 0.5, freedom / (freedom + t * t))

    while tail(high) > 1 - probability:
        high *= 2
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (middle, high) if tail(middle) > 1 - probability else (low, middle)
    return high


def two_sided(confidence, freedom):
    return student_quantile((1 + confidence) / 2, freedom)


# ---------------------------------------------------------------------------------------------- estimates
class Estimate(NamedTuple):
    """A mean, its standard error and the degrees of freedom of that; None and 0 for a single number."""
    mean: float
    error: float | None
    freedom: float


def estimate(numbers):
    mean = sum(numbers) / len(numbers)
    if len(numbers) < 2:
        return Estimate(mean, None, 0)
    variance = sum((x - mean) ** 2 for x in numbers) / (len(numbers) - 1)
    return Estimate(mean, math.sqrt(variance / len(numbers)), len(numbers) - 1)


def welch_freedom(*parts):
    """Degrees of freedom of a sum of independent parts (squared standard error, its degrees of freedom)."""
    total = sum(square for square, _ in parts)
    rest = sum(square**2 / freedom for square, freedom in parts)
    return total**2 / rest if rest > 0 else math.inf


def interval(number):
    """[mean, low, high] of an estimate; the ends are None where there is but one run."""
    if number.error is None:
        return [number.mean, None, None]
    half = two_sided(CONFIDENCE, number.freedom) * number.error
    return [number.mean, number.mean - half, number.mean + half]


def ratio(now, base):
    """[quotient, low, high] of two estimates; the interval is one of its logarithm. None where they are not positive:
    an error may be lost in the noise of the reference."""
    if now.mean <= 0 or base.mean <= 0:
        return [None, None, None]
    quotient = now.mean / base.mean
    if now.error is None or base.error is None:
        return [quotient, None, None]
    parts = [((number.error / number.mean) ** 2, number.freedom) for number in (now, base)]
    error = math.sqrt(sum(square for square, _ in parts))
    factor = math.exp(two_sided(CONFIDENCE, min(welch_freedom(*parts), 1e6)) * error)
    return [quotient, quotient / factor, quotient * factor]


def positive_interval(numbers):
    """[mean, low, high] of what cannot be negative."""
    return ratio(estimate(numbers), Estimate(1.0, 0.0, 1))


# ---------------------------------------------------------------------------------------------- of runs
def last_rows(runs):
    return [run["rows"][-1] for run in runs]


def products(runs, key):
    """Error times something, a run each: what the same error costs, however many samples were taken."""
    return [row["rel_mse"] * row[key] for row in last_rows(runs)]


def curve(runs):
    """For each number of samples that all runs report: samples, mean seconds, [error, low, high]."""
    points = []
    for rows in zip(*(run["rows"] for run in runs)):
        if len({row["samples"] for row in rows}) == 1 and all(row["rel_mse"] for row in rows):
            seconds = {key: mean_of(rows, key) for key in ("seconds", "device_seconds")}
            points.append({"samples": rows[0]["samples"], **seconds, "error": positive_interval([r["rel_mse"] for r in rows])})
    return points


def mean_of(rows, key):
    """None where a row lacks it."""
    values = [row.get(key) for row in rows]
    return None if None in values else sum(values) / len(values)


def slope(runs, key):
    """[exponent, low, high] of the error as a power of samples or seconds, fitted to each run's last rows."""
    slopes = []
    for run in runs:
        rows = [row for row in run["rows"][-SLOPE_ROWS:] if row["rel_mse"] and row.get(key)]
        x, y = [math.log(row[key]) for row in rows], [math.log(row["rel_mse"]) for row in rows]
        centre = sum(x) / len(x) if x else 0
        spread = sum((value - centre) ** 2 for value in x)
        if spread > 0:
            slopes.append(sum((a - centre) * b for a, b in zip(x, y)) / spread)
    return interval(estimate(slopes)) if slopes else None


def batches(runs, channel):
    """(samples, mean) of what each run added from one row to the next: independent of each other."""
    result = []
    for run in runs:
        before, mean_before = 0, 0.0
        for row in run["rows"]:
            samples, mean = row["samples"], row["mean"][channel]
            result.append((samples - before, (samples * mean - before * mean_before) / (samples - before)))
            before, mean_before = samples, mean
    return result


def bias(runs, channel, reference, comparisons):
    """The test for bias of a channel's mean over the image: difference from the reference as part of it.

    Welch's test: the batches' variance is that of one sample over their sizes; the reference's own counts as well.
    `comparisons` such tests together raise a false alarm in FALSE_ALARMS of all reports. `detectable` is the smallest
    bias that would have been found with 95 % probability.
    """
    parts = batches(runs, channel)
    samples = sum(count for count, _ in parts)
    mean = sum(count * value for count, value in parts) / samples
    expected = reference["mean"][channel]
    scale = expected or 1
    if len(parts) < 2:
        return {"value": (mean - expected) / scale, "half_width": None, "detectable": None, "is_biased": False}
    freedom = len(parts) - 1
    square = sum(count * (value - mean) ** 2 for count, value in parts) / freedom / samples
    noise = [(square, freedom), (reference["variance"][channel], reference["freedom"]), ((ROUNDING * expected) ** 2, 1e6)]
    error = math.sqrt(sum(part for part, _ in noise)) / abs(scale)
    freedom = min(welch_freedom(*noise), 1e6)
    limit = two_sided(1 - FALSE_ALARMS / comparisons, freedom) * error
    return {
        "value": (mean - expected) / scale,
        "half_width": two_sided(CONFIDENCE, freedom) * error,
        "detectable": limit + student_quantile(0.95, freedom) * error,
        "is_biased": abs(mean - expected) / abs(scale) > limit,
    }


# ---------------------------------------------------------------------------------------------- of a record
def seconds_to_target(runs):
    """[seconds, low, high] from the command to an error of TARGET_ERROR, start-up included, and that of start-up.

    The error is taken to fall as 1 / samples beyond the run.
    """
    start_ups = [run["command_seconds"] - run["rows"][-1]["seconds"] for run in runs]
    whole = [start + product / TARGET_ERROR**2 for start, product in zip(start_ups, products(runs, "seconds"))]
    return positive_interval(whole), positive_interval(start_ups)


def summarize_case(case, base, comparisons):
    """What the page shows of a case; `base` is the case that efficiencies are relative to."""
    runs = case["runs"]
    rows, pixels = last_rows(runs), case["width"] * case["height"]
    summary = {key: case[key] for key in ("case", "is_peer", "program", "backend", "note")}
    summary |= {"runs": len(runs), "samples": rows[0]["samples"], "seconds": mean_of(rows, "seconds"),
                "device_seconds": mean_of(rows, "device_seconds"), "rays": mean_of(rows, "rays"),
                "error": positive_interval([row["rel_mse"] for row in rows]), "curve": curve(runs),
                "slope_samples": slope(runs, "samples"), "slope_seconds": slope(runs, "seconds")}
    paths = summary["samples"] * pixels
    summary["paths_per_second"] = paths / summary["seconds"]
    if summary["rays"]:
        summary["rays_per_path"] = summary["rays"] / paths
        summary["rays_per_second"] = summary["rays"] / summary["seconds"]
        summary["rays_per_device_second"] = summary["rays"] / summary["device_seconds"]
    for key, name in (("seconds", "efficiency"), ("device_seconds", "device_efficiency")):
        if summary[key] and base["runs"]:
            summary[name] = [1.0, None, None] if case is base else ratio(
                estimate(products(base["runs"], key)), estimate(products(runs, key)))
    summary["seconds_to_target"], summary["start_up_seconds"] = seconds_to_target(runs)
    summary["bias"] = [bias(runs, channel, case["reference"], comparisons) for channel in range(3)]
    return summary


def summarize(record):
    """The content of report.json: a list of scenes with their cases, and how our chapters compare with peers."""
    measured = [case for case in record["cases"] if case["runs"]]
    comparisons = max(3 * len(measured), 1)
    scenes = []
    for name in dict.fromkeys(case["scene"] for case in record["cases"]):
        cases = [case for case in record["cases"] if case["scene"] == name]
        ours = [case for case in cases if case["runs"] and not case["is_peer"]]
        peers = [case for case in cases if case["runs"] and case["is_peer"]]
        scenes.append({
            **{key: cases[0][key] for key in ("scene", "width", "height", "max_path_length", "reference")},
            "refused": [{"case": case["case"], "why": case["refused"]} for case in cases if case["refused"]],
            "cases": [summarize_case(case, ours[0] if ours else case, comparisons) for case in ours + peers],
            # How often the time of one of ours fits into a peer's, for the same error.
            "gains": [{"case": case["case"], "peer": peer["case"],
                       "gain": ratio(*(estimate(products(of["runs"], "seconds")) for of in (peer, case)))}
                      for peer in peers for case in ours],
        })
    return scenes
