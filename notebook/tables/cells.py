"""What several tables show in their cells."""
from statistics import median

from report.numbers import last_rows, mean_of, short


def with_interval(values):
    """The text for [value, low, high]; a single run has no interval and low = None."""
    value, low, high = values
    return short(value, 2) + ("" if low is None else f" ({short(low, 2)} – {short(high, 2)})")


def with_range(values):
    """The median of runs, with the smallest and largest value in brackets."""
    return f"{median(values):.2f} ({min(values):.2f} – {max(values):.2f})"


def per_sample(case, key):
    """The mean over the runs of the rays or seconds per sample of a pixel."""
    return mean_of(last_rows(case["runs"]), key) / (case["samples"] * case["width"] * case["height"])
