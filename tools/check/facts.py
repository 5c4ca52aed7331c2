"""What an experiment has shown, as a fact: true whatever the mistake is. The sentences are for people who do not know this
program."""
import math
from dataclasses import dataclass
from itertools import product

import numpy as np

SURE = 4.0  # standard errors by which a difference must exceed the tolerance to count
BEYOND_DOUBT = 6.0  # standard errors, if a shader's verdict depends on it
TOLERANCE = 0.01  # relative to what is expected
CLOSE = 0.05  # what certainly differs by less is reported as right
INTERVAL = 2.0  # standard errors on both sides of a reported number
DARK = 1e-3  # relative to an experiment's brightest point: below this, the expected value counts as dark
CONSTANTS = {
    "π²": math.pi**2,
    "2π": 2 * math.pi,
    "4": 4.0,
    "π": math.pi,
    "3": 3.0,
    "2": 2.0,
    "π/2": math.pi / 2,
    "3/2": 1.5,
    "2/3": 2 / 3,
    "2/π": 2 / math.pi,
    "1/2": 0.5,
    "1/3": 1 / 3,
    "1/π": 1 / math.pi,
    "1/4": 0.25,
    "1/(2π)": 0.5 / math.pi,
    "1/π²": math.pi**-2,
}
FEW_PARTS = 0.03  # a named constant is reported only if the interval is narrower than this fraction of it
POWERS = {
    -3: "the third power of 1 / {}",
    -2: "the square of 1 / {}",
    -1: "1 / {}",
    -0.5: "the root of 1 / {}",
    0.5: "the root of {}",
    1: "{}",
    2: "the square of {}",
    3: "the third power of {}",
}
FUNCTIONS = {
    "value": lambda x: x,
    "rest": lambda x: 1 - x,
    "per": math.exp,
    "cos": lambda x: math.cos(math.radians(x)),
    "sin": lambda x: math.sin(math.radians(x)),
}


@dataclass
class Reading:
    """A point of an experiment: what a shader shows there, relative to the right value, or if that is zero, to the right value at
    the brightest point."""

    at: str
    value: float
    error: float
    is_dark: bool  # where nothing should be

    @property
    def expected(self):
        return 0.0 if self.is_dark else 1.0

    @property
    def is_right(self):
        return abs(self.value - self.expected) <= SURE * self.error + TOLERANCE

    @property
    def is_surely_right(self):
        return self.is_right and abs(self.value - self.expected) + INTERVAL * self.error <= CLOSE

    @property
    def evidence(self):
        """By how many standard errors it is wrong, none being taken for less than the tolerance."""
        return abs(self.value - self.expected) / math.hypot(self.error, TOLERANCE)

    @property
    def is_beyond_doubt(self):
        """Whether it is wrong by so much that a verdict may rely on it."""
        return abs(self.value - self.expected) > BEYOND_DOUBT * self.error + 2 * TOLERANCE


@dataclass
class Fact:
    """What an experiment has shown."""

    experiment: object
    readings: list  # empty if the shader cannot be rendered
    sentence: str = ""  # empty if all is right
    invalid: int = 0  # samples that are infinite or not a number

    @property
    def is_right(self):
        return not self.invalid and bool(self.readings) and all(reading.is_right for reading in self.readings)

    @property
    def is_surely_right(self):
        return self.is_right and all(reading.is_surely_right for reading in self.readings)

    @property
    def is_beyond_doubt(self):
        """Whether a verdict may rely on it that the shader is wrong."""
        return self.invalid > 0 or any(reading.is_beyond_doubt for reading in self.readings)


def readings(points, sights, expected):
    """Compares the Sights of a shader with those of the chapter's own."""
    brightest = max(abs(sight.mean) for sight in expected)
    found = []
    for point, now, right in zip(points, sights, expected):
        is_dark = abs(right.mean) <= DARK * brightest
        scale = brightest if is_dark else right.mean  # negative where more of a parameter means less light
        value = now.mean / scale
        error = math.hypot(now.error, 0.0 if is_dark else value * right.error) / abs(scale)
        found.append(Reading(point.at, value, error, is_dark))
    return found


def number(value, error):
    """A number with its interval, rounded up, to as many digits as the interval allows."""
    width = INTERVAL * error
    if value == 0 and width == 0:
        return "0"
    decimals = 1 if width >= 0.1 * max(value, 1) else 2 if value >= 0.2 else 3
    step = 10**-decimals
    return f"{value:.{decimals}f} ± {max(math.ceil(width / step - 0.5), 1) * step:.{decimals}f}"


def constant(value, error):
    """The name of the only well-known constant that a number can be, in brackets; or nothing. For what all points of an experiment
    share: a single number may be near a constant by chance."""
    width = INTERVAL * error + 0.003 * value
    fitting = [name for name, known in CONSTANTS.items() if abs(value - known) <= width]
    return f" (as by a factor {fitting[0]})" if len(fitting) == 1 and width <= FEW_PARTS * value else ""


def common_value(those):
    """The mean of readings that agree, with its error; otherwise None."""
    weights = np.array([1 / (reading.error**2 + (0.004 * reading.value) ** 2 + 1e-9) for reading in those])
    values = np.array([reading.value for reading in those])
    mean = float(weights @ values / weights.sum())
    agree = all(abs(reading.value - mean) <= 3 * reading.error + TOLERANCE * max(mean, 0.1) for reading in those)
    return (mean, float(weights.sum() ** -0.5)) if agree else None


def power_law(experiment, those):
    """(factor, its error, words for the power) if readings follow a power of the experiment's quantity; otherwise None."""
    points = {point.at: point.x for point in experiment.points if point.x is not None}
    those = [reading for reading in those if reading.at in points]
    values = np.array([reading.value for reading in those])
    if len(those) < 3 or not experiment.quantity or values.min() <= 0:
        return None
    errors = np.array([reading.error / reading.value + TOLERANCE / 3 for reading in those])
    arguments = {
        function: np.log([FUNCTIONS[function](points[reading.at]) for reading in those]) for function in experiment.quantity
    }
    if "per" in arguments:
        powers = [(float(np.polyfit(arguments["per"], np.log(values), 1, w=1 / errors)[0]),)]
    else:  # simplest first
        powers = sorted(
            product([0, *POWERS], repeat=len(arguments)), key=lambda those: (sum(map(bool, those)), sum(map(abs, those)))
        )
    for those_powers in powers:
        expected = sum(power * x for power, x in zip(those_powers, arguments.values()))
        offsets = np.log(values) - expected
        mean, error = float(np.average(offsets, weights=errors**-2)), float((errors**-2).sum() ** -0.5)
        if np.ptp(expected) < 6 * errors.max() or np.any(np.abs(offsets - mean) > 3 * errors):
            continue
        if (
            sum(map(bool, those_powers)) > 1 and abs(mean) > TOLERANCE + 2 * error
        ):  # two powers and a factor would fit almost anything
            continue
        phrases = [
            POWERS[power].format(words) for power, words in zip(those_powers, experiment.quantity.values()) if power in POWERS
        ]
        if "per" in arguments:
            phrases = [f"{number(math.exp(powers[0][0]), 0.01 * math.exp(powers[0][0]))} {experiment.quantity['per']}"]
        return math.exp(mean), math.exp(mean) * error, " times ".join(phrases)
    return None


def sentence(experiment, those):
    """What readings say if some of them are wrong."""
    subject, varies = experiment.subject, experiment.varies
    lit = [reading for reading in those if not reading.is_dark]
    leaks = [reading for reading in those if reading.is_dark and not reading.is_right]
    words = []
    wrong = [reading for reading in lit if not reading.is_right]
    whatever = f", whatever {varies}" if len(lit) > 1 else ""
    if wrong and all(reading.value == 0 for reading in lit):
        words.append(f"nothing of it is there{whatever}")
    elif wrong:
        common, law = common_value(lit), power_law(experiment, lit)
        if common and len(wrong) == len(lit):
            words.append(
                f"{number(*common)} times as bright as it should be{constant(*common) if len(lit) > 1 else ''}{whatever}"
            )
        else:
            if law:
                factor, error, phrase = law
                is_per = "per" in experiment.quantity
                once = f", and once by {number(factor, error)}" if is_per else f" times {number(factor, error)}"
                words.append(
                    f"wrong by a factor {'of' if is_per else 'that follows'} {phrase}{'' if abs(factor - 1) < 2 * error + TOLERANCE else once}"
                )
            words.append(", ".join(map(in_words, wrong)).replace(" times", " times as bright as it should be", 1))
            right = [reading.at for reading in lit if reading.is_surely_right]
            words += [f"right: {', '.join(right)}"] if right else []
    words += [
        f"light where none should be: {reading.at}: {number(reading.value, reading.error)} times that of the brightest place"
        for reading in leaks
    ]
    return f"{subject}: {'; '.join(words or ['what is counted of it is right'])}"


def in_words(reading):
    if reading.value == 0:
        return f"{reading.at}: nothing"
    return f"{reading.at}: {number(reading.value, reading.error)} times"


def fact(experiment, sights, expected):
    found = Fact(experiment, readings(experiment.points, sights, expected), invalid=sum(sight.invalid for sight in sights))
    if not found.is_right:
        found.sentence = sentence(experiment, found.readings)
        found.sentence += f"; {found.invalid} samples are infinite or not a number" if found.invalid else ""
    return found
