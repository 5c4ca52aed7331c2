"""The names that the facts leave: mistakes of the catalogue that show the same, or where none does, the most similar one."""
import math
from dataclasses import replace
from statistics import fmean

from check.experiments import known_sights

# Another student's shader has the same mistake but not quite the same numbers: relative tolerance, and its minimum.
LOOSENESS, LEAST = 0.03, 0.01
FITS, EXCLUDED = 3.5, 5.0  # standard errors: within the first it fits, beyond the second it is a different mistake
MOST_DOUBTS = 1  # points between the two: more of them exclude it as well
NOISE_LOOSENESS, RAYS_LOOSENESS = 0.25, 0.08  # of their logarithms
# One that only may fit: how much of what is wrong it must explain, and how much more than the second one. Chosen by the notebook's
# variants, which have mistakes of the catalogue, and submissions, which have others.
LEAST_LIKENESS, LEAST_LEAD = 0.5, 0.15


def numbers(text):
    return [float(word) for word in text.split()]


def compared(shown, facts):
    """What a mistake of the catalogue shows (name of an experiment -> text) beside the facts: a reading, the catalogue's number for
    its point, and their difference in standard errors."""
    for name, seen in facts.items():
        for reading, known in zip(seen.readings, numbers(shown[name]) if name in shown else [r.expected for r in seen.readings]):
            width = math.hypot(reading.error, LOOSENESS * max(abs(known), abs(reading.value)), LEAST)
            yield reading, known, abs(reading.value - known) / width


def distance(shown, facts):
    """How far what a mistake shows is from the facts, in standard errors at the point that contradicts it most."""
    far = 0.0 if all(seen.readings for seen in facts.values()) else math.inf
    return max([far, *(off for _, _, off in compared(shown, facts))])


def is_doubtful(shown, facts):
    """Whether several points speak against a mistake, though none of them enough to exclude it."""
    return sum(off > FITS for _, _, off in compared(shown, facts)) > MOST_DOUBTS


def noise_distance(entry, ratios):
    """The same for noise and rays, as multiples of those of the chapter's own shader."""
    far = 0.0
    for kind, looseness in (("noise", NOISE_LOOSENESS), ("rays", RAYS_LOOSENESS)):
        for name, seen in ratios[kind].items():
            for (value, error), known in zip(seen, numbers(entry.get(kind, {}).get(name, "")) or [1.0] * len(seen)):
                far = max(
                    far, abs(math.log(max(value, 0.01) / max(known, 0.01))) / math.hypot(error / max(value, 0.01), looseness)
                )
    return far


def ratios_of(sights, expected):
    """Noise and rays of what was seen, as multiples of the chapter's own, with errors; 1 where it has none."""
    found = {"noise": {}, "rays": {}}
    for name, seen in sights.items():
        pairs = list(zip(seen, known_sights(expected[name])))
        found["noise"][name] = [
            (now.noise / own.noise, math.hypot(now.noise_error / own.noise, now.noise * own.noise_error / own.noise**2))
            if own.noise > 1e-6 * own.mean**2 and now.noise > 0
            else (1.0, 1.0)
            for now, own in pairs
        ]
        found["rays"][name] = [(now.rays / own.rays, 0.01) for now, own in pairs]
    return found


def names_of(facts, sights, known, expected):
    """The names of the catalogue's mistakes that the facts leave: those that fit and those not far enough away to be excluded,
    nearest first; empty if none fits."""
    wrong = {name for name, seen in facts.items() if not seen.is_right}
    # A small difference is near to none, but a mistake that is right wherever the shader is wrong is another one.
    far = {
        name: distance(entry["shows"], facts)
        for name, entry in known.items()
        if "unseen" not in entry and (not wrong or wrong & set(entry["shows"]))
    }
    if not wrong:
        ratios = ratios_of(sights, expected)
        those = {
            name: known[name] for name in far if known[name].get("noise") or known[name].get("rays")
        }  # the rest shows elsewhere
        far = {name: max(far[name], noise_distance(entry, ratios)) for name, entry in those.items()}
    ordered = sorted(far, key=far.get)
    if not ordered or far[ordered[0]] > FITS:
        return []
    return [name for name in ordered if far[name] <= EXCLUDED and not is_doubtful(known[name]["shows"], facts)]


def likeness(shown, facts):
    """How much of what is wrong a mistake explains, from 0 to 1: the mean over the points that are wrong in either, 1 where both are too
    bright or both too dark by the same, 1/2 where by something else, and 0 where they contradict each other. A point that is too vague to
    tell whether it does counts as none."""
    marks = []
    for reading, known, off in compared(shown, facts):
        both = [reading, replace(reading, value=known)]
        sides = {0 if one.is_right else math.copysign(1, one.value - one.expected) for one in both}
        if sides == {0}:
            continue
        if len(sides) == 1:
            marks.append(1.0 if off <= FITS else 0.5)
        elif abs(reading.value - known) > FITS * reading.error:
            marks.append(0.0)
    return fmean(marks) if marks else 0.0


def similar_to(facts, known):
    """The name that may fit if none does, in a list: a shader written in another way shows a mistake at the same points, but not always
    with the same numbers. None unless it explains much of what is wrong, and clearly more than any other does."""
    alike = [(likeness(entry["shows"], facts), name) for name, entry in known.items() if "unseen" not in entry]
    (second, _), (most, name) = sorted([(0.0, ""), (0.0, ""), *alike])[-2:]
    return [name] if most >= LEAST_LIKENESS and most - second >= LEAST_LEAD else []
