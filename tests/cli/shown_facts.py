"""Facts of experiments that tests make up."""

import tools_path  # noqa: F401  (first: it finds the others)
from check.experiments import Experiment, Point, Sight
from check.facts import fact


def sight(mean, error=0.001):
    return Sight(mean, error * abs(mean), 1.0, 0.1, 2.0)


def seen(values, quantity=None, x=(20.0, 40.0, 60.0, 75.0), expected=None, error=0.001, **details):
    """The fact of an experiment whose points show these multiples of the right values."""
    points = [Point({}, f"at {x_i:g}", x_i) for x_i, _ in zip(x, values)]
    expected = expected or [0.5] * len(values)
    shown = [sight(value * (right or max(map(abs, expected))), error) for value, right in zip(values, expected)]
    of = Experiment(
        details.get("name", "angle"),
        details.get("subject", "light of a lamp"),
        details.get("varies", "the angle"),
        points,
        quantity or {},
    )
    return fact(of, shown, [sight(right, 0.0002) for right in expected])
