"""Names the mistake that a shader probably makes, by comparing what it does to the pictures with what each known mistake does.

A signature tells of each scene how much the means of the image and its tiles differ from the reference, as parts of it, and
how often the chapter's own noise and rays a shader has. knowledge.json in a chapter's folder has those of the mistakes that are known in
it, written by tests/mistakes/learn.py.
"""
import math
from dataclasses import dataclass

from check.grading import knowledge_file
from project import read_json

# Another student's shader has the same mistake but not quite the same signature: parts of a difference, and the least.
LOOSENESS, LEAST = 0.15, 0.005
NOISE_LOOSENESS, RAYS_LOOSENESS = 0.2, 0.1  # of their logarithms
# What a mistake must explain to be named: so much of the surprise of seeing this in a correct shader, and it must leave less than
# this part of that surprise, or no more than chance leaves in each region.
LEAST_EXPLAINED, MOST_LEFT, CHANCE = 6.0, 0.45, 0.6
# It is named alone where the next one would be a surprise larger by so much, or by this part of what both leave unexplained.
SURE, SURE_PART = 10.0, 0.15
LEAST_RAYS = 0.01  # of what the chapter's own traces: a shader may trace none
SIDES = (("top", "middle", "bottom"), ("left", "middle", "right"))


@dataclass
class Signature:
    differences: list  # of the regions of all scenes: value - reference, as part of the reference
    errors: list  # their standard errors
    noise: list  # of each scene, as multiple of the chapter's own
    rays: list


def noise_and_rays(scene):
    """Noise and rays of a scene of a result, as multiples of the chapter's own. Neither is 0, since their logarithms are compared."""
    return scene["noise"][0] or 1.0, max(scene["rays"], LEAST_RAYS)


def signature(result):
    """The signature in a result of grading.judge()."""
    tests = [test for scene in result["scenes"] for test in (*scene["image"], *scene["tiles"])]
    return Signature([test["value"] for test in tests], [test["half_width"] / 2 for test in tests],
                     *map(list, zip(*map(noise_and_rays, result["scenes"]))))


def surprise(seen, known):
    """The surprise of seeing one signature where another is known: minus the logarithm of a probability, up to a constant. Its tails are
    wide (Student's distribution with 3 degrees of freedom), so that no single region decides."""
    def term(difference, error):
        return 2 * math.log1p((difference / error) ** 2 / 3)

    total = sum(term(a - b, math.hypot(e, LOOSENESS * b, LEAST))
                for a, e, b in zip(seen.differences, seen.errors, known.differences))
    for a, b in zip(seen.noise, known.noise):
        total += term(math.log(a / b), NOISE_LOOSENESS)
    return total + sum(term(math.log(a / b), RAYS_LOOSENESS) for a, b in zip(seen.rays, known.rays))


def surprises(seen, known):
    """The surprise of each known signature (name -> Signature), the likeliest first; empty if none explains what is seen."""
    count = len(seen.differences)
    faultless = Signature([0.0] * count, [0.0] * count, [1.0] * len(seen.noise), [1.0] * len(seen.rays))
    found = {name: surprise(seen, other) for name, other in known.items()}
    unexplained, least = surprise(seen, faultless), min(found.values(), default=math.inf)
    is_explained = least < unexplained - LEAST_EXPLAINED and least < max(MOST_LEFT * unexplained, CHANCE * count)
    return dict(sorted(found.items(), key=lambda pair: pair[1])) if is_explained else {}


def candidates(found):
    """The names of one mistake, or of two where it is not sure which; `found` is of surprises()."""
    names = list(found)[:2]
    if len(names) == 2 and found[names[1]] - found[names[0]] > SURE + SURE_PART * found[names[0]]:
        return names[:1]
    return names


def percentages(text):
    return [float(word) / 100 for word in text.split()]


def read_signature(scenes):
    """The signature of a mistake in knowledge.json, given as scene -> what it does there."""
    regions = [percentages(" ".join([scene["image"], *scene["tiles"]])) for scene in scenes.values()]
    return Signature(sum(regions, []), [], *([scene[key] for scene in scenes.values()] for key in ("noise", "rays")))


def read_signatures(mistakes):
    """Name -> Signature, of a chapter's mistakes in knowledge.json."""
    return {name: read_signature(entry["scenes"]) for name, entry in mistakes.items()}


def place_that_tells(result, seen, first, second):
    """Where two mistakes differ most, as far as noise lets it be seen: the scene, a place in its picture, and what either
    does there to the brightness, as part of it."""
    places = []
    for scene in result["scenes"]:
        places += [(scene["scene"], "in the whole picture")] * len(scene["image"])
        rows, columns = (max(tile[key] for tile in scene["tiles"]) + 1 for key in ("row", "column"))
        for tile in scene["tiles"]:
            side = f"{SIDES[0][3 * tile['row'] // rows]} {SIDES[1][3 * tile['column'] // columns]}"
            places.append((scene["scene"], f"at the {side} of the picture".replace("middle middle", "middle")))
    contrasts = [abs(a - b) / math.hypot(LEAST, error) for a, b, error in zip(first.differences, second.differences, seen.errors)]
    index = contrasts.index(max(contrasts))
    return {"scene": places[index][0], "place": places[index][1], "effects": [first.differences[index], second.differences[index]]}


def likely_mistake(result):
    """The mistakes that a shader with this result probably makes, at most two, each with name, question (hint) and slide; with two
    also where to look to tell them apart. None where nothing known explains it."""
    if result["verdict"] == "correct":
        return None
    known = read_json(knowledge_file(result["chapter"]))["mistakes"]
    seen, signatures = signature(result), read_signatures(known)
    names = candidates(surprises(seen, signatures))
    if not names:
        return None
    found = {"mistakes": [{"name": name, "hint": known[name]["hint"], "slide": known[name]["slide"]} for name in names]}
    if len(names) == 2:
        found["tell_apart"] = place_that_tells(result, seen, *(signatures[name] for name in names))
    return found
