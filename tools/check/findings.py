"""What the facts of a check have in common: experiments that are wrong in the same way become one finding, since they probably have
the same cause."""
import math
import re
from dataclasses import dataclass, field

from check.facts import TOLERANCE, common_value, constant, number, power_law

LONGEST = 85  # characters of a finding's text with several subjects: with its head, a line of 100
SPARED = r" as it should be| of the chapter's own shader"  # what goes without saying where a text would be too long
SHARE = 0.5  # of what is wrong: a factor that fewer experiments have in common is a coincidence
INVALID = "infinite or not a number"
NOTHING = 1e-9  # a factor that is as good as 0
BOUNCES = 4  # at most, of an experiment


@dataclass
class Finding:
    """A way of being wrong, and the facts that are."""

    way: str
    facts: list = field(default_factory=list)
    farthest: object = None  # the fact that has the number, if they are too bright or too dark and have nothing else in common

    def told(self):
        subjects = [seen.experiment.subject for seen in self.facts]
        first = self.farthest.experiment.subject if self.farthest else min(subjects, key=len)
        return {"text": shortened(self.way, first, subjects), "evidence": [seen.sentence for seen in self.facts]}


def shortened(way, first, subjects):
    """A text with as many of the subjects as fit into it, the first one in any case and in full: what tells it from others stands at its
    end, such as where it is seen, or with what."""
    subjects = [first, *sorted(set(subjects) - {first}, key=lambda subject: (len(subject), subject))]
    brief = re.sub(SPARED, "", way)
    for start in (way, brief):
        for count in range(len(subjects), 0, -1):
            rest = f" and {len(subjects) - count} more" if count < len(subjects) else ""
            if len(text := f"{start}: {'; '.join(subjects[:count])}{rest}") <= LONGEST:
                return text
    return f"{brief}: {first}{rest}"


def wrong_readings(seen):
    """Those where light is expected."""
    return [reading for reading in seen.readings if not reading.is_dark and not reading.is_right]


def factor_of_bounces(facts):
    """(factor, its error) with which every bounce multiplies the light, if an experiment that counts bounces shows one; or None."""
    for seen in facts:
        counts = {point.at: point.x for point in seen.experiment.points}
        those = [reading for reading in seen.readings if reading.value > 0]
        if "bounce" in seen.experiment.quantity.get("per", "") and len(those) == len(counts) and not common_value(those):
            roots = [
                (reading.value ** (1 / counts[reading.at]), reading.error / reading.value / counts[reading.at])
                for reading in those
            ]
            factor, error = roots[0][0], roots[0][0] * roots[0][1]
            if all(abs(root / factor - 1) <= TOLERANCE + 3 * math.hypot(part, error / factor) for root, part in roots):
                return factor, error
    return None


def is_power(reading, factor, error):
    """Whether a reading is that of some bounces, each with this factor."""
    return any(
        abs(reading.value - factor**k) <= 3 * math.hypot(reading.error, k * factor ** (k - 1) * error) + TOLERANCE * factor**k
        for k in range(1, BOUNCES + 1)
    )


def own_way(seen, bounces):
    """What is wrong in an experiment, in words that do not depend on it, or None if no simple words say it."""
    wrong = wrong_readings(seen)
    if not seen.readings:
        return "cannot be rendered"
    if not wrong:
        return None
    if all(reading.value == 0 for reading in wrong):
        return "nothing is there"
    if bounces and all(is_power(reading, *bounces) for reading in wrong):
        return f"{number(*bounces)} times as bright with each bounce{constant(*bounces)}"
    lit = [reading for reading in seen.readings if not reading.is_dark]
    if (law := power_law(seen.experiment, lit)) and not common_value(lit):
        return f"off by {law[2].replace('this angle', seen.experiment.varies)}"
    return None


def same_factors(facts):
    """Lists of facts whose wrong readings all agree, with what they agree on: (value, error)."""
    groups = []
    for seen in facts:
        group = next((group for group in groups if common_value([*group[0], *wrong_readings(seen)])), None)
        if not group:
            groups.append(group := ([], []))
        group[0].extend(wrong_readings(seen))
        group[1].append(seen)
    return [(common_value(readings), those) for readings, those in groups]


def sides(seen):
    """On which sides of what is right the wrong readings of a fact are, in words."""
    return " and ".join(
        words
        for words, is_bright in (("too bright", True), ("too dark", False))
        if any((reading.value > 1) == is_bright for reading in wrong_readings(seen))
    )


def farthest_value(seen):
    """The wrong reading that is the most times too bright or too dark."""
    return max((reading.value for reading in wrong_readings(seen)), key=distance)


def distance(value):
    """How far a factor is from 1, on either side."""
    return abs(math.log(max(value, NOTHING)))


def is_wrong_throughout(seen):
    """Whether all points of an experiment with several are wrong."""
    return 1 < len(wrong_readings(seen)) == sum(not reading.is_dark for reading in seen.readings)


def strongest(seen):
    return max((reading.evidence for reading in seen.readings), default=math.inf)


def rank(finding):
    """What findings are ordered by: what is not even a number first, what has only its side in common last, and the more points are
    beyond doubt, the earlier."""
    points = sum(reading.is_beyond_doubt for seen in finding.facts for reading in seen.readings)
    return finding.way == INVALID, not finding.farthest, points


def findings(facts):
    """The wrong ones of some facts by what they have in common: a list of Finding, those with the most evidence first, as are the
    facts of each."""
    wrong, found, others = [seen for seen in facts if not seen.is_right], {}, []
    bounces = factor_of_bounces(wrong)

    def add(way, *those):
        found.setdefault(way, Finding(way)).facts.extend(those)

    for seen in wrong:
        if seen.invalid:
            add(INVALID, seen)
    for seen in wrong:
        if way := own_way(seen, bounces):
            add(way, seen)
        elif wrong_readings(seen):
            others.append(seen)
        if any(reading.is_dark and not reading.is_right for reading in seen.readings):
            add("light where none should be", seen)
    factors = [(common, those) for common, those in same_factors(others) if common and len(those) >= SHARE * len(wrong)]
    for common, those in factors:
        add(
            f"{number(*common)} times as bright as it should be{constant(*common) if any(map(is_wrong_throughout, those)) else ''}",
            *those,
        )
    rest = [seen for seen in others if not any(seen is each for _, those in factors for each in those)]
    for side in dict.fromkeys(map(sides, rest)):
        those = [seen for seen in rest if sides(seen) == side]
        farthest = max(those, key=lambda seen: distance(farthest_value(seen)))
        value = farthest_value(farthest)
        add(way := f"{side}, {'up' if value > 1 else 'down'} to {value:.2f} times", *those)
        found[way].farthest = farthest
    for finding in found.values():
        finding.facts.sort(key=strongest, reverse=True)
    return sorted(found.values(), key=rank, reverse=True)
