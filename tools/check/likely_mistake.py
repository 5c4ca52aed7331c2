"""Names the mistake that a shader probably makes, by comparing what it does to the pictures with what each known mistake does.

A signature tells of each scene how much the means of the image and its tiles differ from the reference, as parts of it, and
how often the chapter's own noise and rays a shader has. signatures.json has those of all known mistakes, written by
tests/mistakes/learn.py.
"""
import math
from dataclasses import dataclass
from pathlib import Path

from project import read_json

SIGNATURES = Path(__file__).with_name("signatures.json")
# Another student's shader has the same mistake but not quite the same signature: parts of a difference, and the least.
LOOSENESS, LEAST = 0.15, 0.005
NOISE_LOOSENESS, RAYS_LOOSENESS = 0.4, 0.1  # of their logarithms
# What a mistake must explain to be named: so much of the surprise of seeing this in a correct shader, and either half of that
# surprise or all but what chance leaves in each region.
LEAST_EXPLAINED, CHANCE = 8.0, 0.4


@dataclass
class Signature:
    differences: list  # of the regions of all scenes: value - reference, as part of the reference
    errors: list  # their standard errors
    noise: list  # of each scene, as multiple of the chapter's own
    rays: list


def signature(result):
    """Of a result of grading.judge()."""
    tests = [test for scene in result["scenes"] for test in (*scene["image"], *scene["tiles"])]
    return Signature([test["value"] for test in tests], [test["half_width"] / 2 for test in tests],
                     [scene["noise"][0] or 1.0 for scene in result["scenes"]], [scene["rays"] for scene in result["scenes"]])


def surprise(seen, known):
    """Of seeing one signature where another is known: minus the logarithm of a probability, up to a constant. Its tails are
    wide (Student's distribution with 3 degrees of freedom), so that no single region decides."""
    def term(difference, error):
        return 2 * math.log1p((difference / error) ** 2 / 3)

    total = sum(term(a - b, math.hypot(e, f, LOOSENESS * b, LEAST))
                for a, e, b, f in zip(seen.differences, seen.errors, known.differences, known.errors))
    for a, b in zip(seen.noise, known.noise):
        total += term(math.log(a / b), NOISE_LOOSENESS)
    return total + sum(term(math.log(a / b), RAYS_LOOSENESS) for a, b in zip(seen.rays, known.rays))


def rank(seen, known):
    """Names of known signatures (name -> Signature), the likeliest first; empty if none explains what is seen."""
    count = len(seen.differences)
    faultless = Signature([0.0] * count, [0.0] * count, [1.0] * len(seen.noise), [1.0] * len(seen.rays))
    surprises = {name: surprise(seen, other) for name, other in known.items()}
    names, unexplained = sorted(surprises, key=surprises.get), surprise(seen, faultless)
    least = min(surprises.values(), default=math.inf)
    is_explained = least < unexplained - LEAST_EXPLAINED and least < max(unexplained / 2, CHANCE * count)
    return names if is_explained else []


def read_signatures(entries):
    """Name -> Signature, of a chapter's entries in SIGNATURES."""
    return {name: Signature(**entry["signature"]) for name, entry in entries.items()}


def likely_mistake(result):
    """Name, hint and slide of the mistake that a shader with this result probably makes, or None."""
    if result["verdict"] == "correct":
        return None
    known = read_json(SIGNATURES)[str(result["chapter"])]
    names = rank(signature(result), read_signatures(known))
    return {"name": names[0], **{key: known[names[0]][key] for key in ("hint", "slide")}} if names else None
