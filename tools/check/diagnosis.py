"""The differential diagnosis of an incorrect shader: facts first, and a name only if they leave a single one.

The chapter's experiments run in order, those with a condition (`when`) only if other experiments have met it.
assets/expected records what the chapter's own shader shows in each, and the notebook what the catalogue's mistakes do to it.
"""
import time

from check.experiments import experiments_of, known_sights, pictures, together, write_scene
from check.expected import DESCRIPTIONS, expected_file, known_mistakes
from check.facts import SURE, Fact, fact, readings
from check.findings import findings, shortened
from check.grading import TOO_MUCH, first_seed, look_closer
from check.names import names_of, ratios_of, similar_to
from project import CHAPTERS, ROOT, UserError, read_json, show_progress
from report.batch import Batch

FIRST_SEED, REPEATS = 7001, 3  # FIRST_SEED: of a check without --seed
PATIENCE = 15.0  # seconds per point's picture, which takes an idle core a tenth of a second


def repeats_of(chapter):
    """Number of pictures per point: if the samples of a pixel are correlated, those of different pixels may be, too."""
    return REPEATS if DESCRIPTIONS[chapter].get("low_discrepancy") else 1


def is_called_for(experiment, facts):
    """Whether the facts that its condition asks for are known and as required."""
    return all(name not in facts or facts[name].is_right == is_right for name, is_right in experiment.when.items())


def is_deciding(experiment, _):
    return experiment.decides


def look_at(chapter, points, settings, seed, batch, repeats, expected):
    """What a chapter shows at each of these points: a list of Sight. Only a point whose first picture looks wrong is rendered again."""
    seen = pictures(CHAPTERS[chapter], points, settings, seed, batch)
    if repeats > 1:
        wrong = [index for index, reading in enumerate(readings(points, map(together, seen), expected)) if not reading.is_right]
        more = pictures(
            CHAPTERS[chapter], [points[index] for index in wrong], settings, seed + len(points), batch, repeats=repeats - 1
        )
        for index, sights in zip(wrong, more):
            seen[index] += sights
    return [together(sights) for sights in seen]


def from_both_ends(items):
    """First, last, second, last but one and so on. Neighbouring experiments have the same shaders: two programs that begin one at the
    same time would both compile them."""
    count = len(items)
    return [items[i // 2 if i % 2 == 0 else count - 1 - i // 2] for i in range(count)]


def observe(chapter, settings, expected, chosen=is_called_for, seed=None):
    """Name -> Fact and name -> list of Sight, for the experiments of a chapter, with `seed` or else with what follows from --seed."""
    facts, sights, hasty = {}, {}, settings | {"time_limit": min(settings["time_limit"], PATIENCE)}
    seed = seed or FIRST_SEED + settings["first_seed"] - first_seed(0)
    experiments = experiments_of(chapter)
    waiting = [name for name in experiments if name in expected]
    count, started = len(waiting), time.monotonic()

    def look(name, settings=hasty):
        try:
            return look_at(
                chapter, experiments[name].points, settings, seed, batch, repeats_of(chapter), known_sights(expected[name])
            )
        except UserError as error:  # for example an endless loop that only this scene triggers
            return error

    def note(name, found):
        experiment = experiments[name]
        if isinstance(found, UserError):
            facts[name] = Fact(experiment, [], f"{experiment.subject}: cannot be rendered: {found}")
        else:
            sights[name] = found
            facts[name] = fact(experiment, found, known_sights(expected[name]))

    with Batch() as batch:
        while waiting:  # at the same time those whose conditions are known
            ready = [name for name in waiting if not set(experiments[name].when) & set(waiting)]
            names = from_both_ends([name for name in ready if chosen(experiments[name], facts)])
            waiting = [name for name in waiting if name not in ready]
            for left, (name, found) in zip(reversed(range(len(names))), zip(names, batch.map(look, names))):
                if not settings["is_quiet"]:
                    show_progress(f"{settings['what']}experiments", count - len(waiting) - left, count, started)
                note(name, found)
        if chosen is is_deciding:  # a verdict may depend on it: an endless loop, or just a busy machine?
            for name in [name for name, seen in facts.items() if not seen.readings]:
                note(name, look(name, settings))
                if not facts[name].readings:
                    break
    return tuple({name: those[name] for name in experiments if name in those} for those in (facts, sights))


# ---------------------------------------------------------------------------------------------- words
def right_ones(facts):
    """What is right: subjects, or if a subject is only partly right, what it does not depend on."""
    not_right = {seen.experiment.subject for seen in facts.values() if not seen.is_surely_right}
    right = [seen.experiment for seen in facts.values() if seen.is_surely_right]
    return list(
        dict.fromkeys(f"{each.subject}, whatever {each.varies}" if each.subject in not_right else each.subject for each in right)
    )


def noise_findings(facts, sights, expected):
    """Where a shader is noisier than the chapter's own, or traces more rays, or fewer: then its paths end elsewhere."""
    found = []
    for kind, words, is_much in (
        ("noise", "{:.2g} times the variance", lambda value, error: value - 1 > 4 * error + 0.2),
        ("rays", "{:.2g} times the rays", lambda value, error: abs(value - 1) > 4 * error + 0.05),
    ):
        much = {
            name: [
                (point.at, value) for point, (value, error) in zip(facts[name].experiment.points, seen) if is_much(value, error)
            ]
            for name, seen in ratios_of(sights, expected)[kind].items()
        }
        if much := {name: those for name, those in much.items() if those}:
            subjects = {name: facts[name].experiment.subject for name in much}
            most, first = max(
                ((value, subjects[name]) for name, those in much.items() for _, value in those), key=lambda pair: abs(pair[0] - 1)
            )
            way = f"{'up' if most > 1 else 'down'} to {words.format(most)} of the chapter's own shader"
            found.append(
                {
                    "text": shortened(way, first, subjects.values()),
                    "evidence": [
                        f"{subjects[name]}: {', '.join(f'{at}: {words.format(value)}' for at, value in those)} of the chapter's own shader"
                        for name, those in much.items()
                    ],
                }
            )
    return found


def too_much_noise(experiment, sights, expected):
    """The variance in an experiment about noise, in multiples of the chapter's own, if it is too large, as grade() judges pictures; or 0."""
    ratios = ratios_of({experiment.name: sights}, {experiment.name: expected})
    pairs = zip(ratios["noise"][experiment.name], ratios["rays"][experiment.name])
    much = [noise for (noise, error), (rays, _) in pairs if (noise - SURE * error) * min(rays, 1) > TOO_MUCH]
    return max(much, default=0) if experiment.is_of_noise else 0


def next_step(submission, facts, sights, expected):
    """How the student can see the first fact that is told: writes a scene file and returns it in a command, with the value to expect."""
    seen = next((seen for finding in findings(facts.values()) for seen in finding.facts if seen.readings), None)
    if not seen:
        return None
    name = seen.experiment.name
    worst = max(range(len(seen.readings)), key=lambda i: seen.readings[i].evidence)
    point, folder = seen.experiment.points[worst], ROOT / f"output/check_{submission.chapter}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        scene = write_scene(point.scene, folder, name)
    except OSError:  # in a read-only checkout, for instance
        return None
    copy = next(
        (number for number, name in CHAPTERS.items() if submission.file.resolve().parent == ROOT / "chapters" / name), None
    )
    where = "" if copy else ", with your shader in the chapter's folder"
    colour = ("red", "green", "blue")[point.channel] + " " if point.channel is not None else ""
    values = f"{sights[name][worst].mean:.3g} instead of {known_sights(expected[name])[worst].mean:.3g}"
    return f"{f'./lab run {copy or submission.chapter} {scene.relative_to(ROOT)} {point.options}'.rstrip()} shows {colour}{values}{where}"


def reason(facts, sights, known, is_correct):
    """What the facts say: what is wrong, each with a short text and its evidence, subjects that are right, and mistakes of the catalogue
    that fit or, if none fits, may fit."""
    told = [found.told() for found in findings(facts.values())]
    noises = [
        (too_much_noise(facts[name].experiment, seen, known["experiments"][name]), facts[name].experiment.subject)
        for name, seen in sights.items()
    ]
    noise, noisiest = max(noises, default=(0, None))
    told = told or (noise_findings(facts, sights, known["experiments"]) if noise or not is_correct else [])
    wrong = [name for name, seen in facts.items() if not seen.is_right]
    fitting = names_of(facts, sights, known["mistakes"], known["experiments"]) if told else []
    names = fitting or (similar_to(facts, known["mistakes"]) if wrong else [])
    return {
        "facts": told,
        "right": right_ones(facts),
        "wrong": wrong,
        "fits": bool(fitting),
        # What cannot be rendered was tried again only beside correct pictures; elsewhere the machine may just have been busy.
        "is_beyond_doubt": any(seen.is_beyond_doubt or is_correct and not seen.readings for seen in facts.values()),
        "too_noisy": [noisiest, round(noise, 2)] if noise else None,
        "mistakes": [
            {"name": name} | {key: known["mistakes"][name].get(key) for key in ("hint", "slide", "section")} for name in names
        ],
        "readings": {name: [[r.at, round(r.value, 4), round(r.error, 4)] for r in seen.readings] for name, seen in facts.items()},
    }


def diagnose(submission, settings, is_correct=False):
    """What experiments show about a submission, see reason(). If its pictures are correct, only those run that can decide as well."""
    chapter, started = submission.chapter, time.monotonic()
    known = read_json(expected_file(chapter)) | {"mistakes": known_mistakes(chapter)}
    facts, sights = observe(
        chapter, settings | {"shaders": submission.options}, known["experiments"], is_deciding if is_correct else is_called_for
    )
    for seen in facts.values():
        seen.sentence = submission.in_words(seen.sentence)
    return reason(facts, sights, known, is_correct) | {
        "next": next_step(submission, facts, sights, known["experiments"]),
        "seconds": round(time.monotonic() - started, 1),
    }


def decide(submission, settings, result, pictures):
    """The verdict on a shader, from the pictures that judge() has returned and the diagnosis. A bias that no experiment shows needs a
    closer look, and experiments may find a bias or noise that the pictures do not: by where they look, or behind their noise."""
    found = result["diagnosis"]
    if result["verdict"] == "biased" and not found["wrong"] and not any(scene["invalid_samples"] for scene in result["scenes"]):
        look_closer(submission, settings, result, pictures)
    if found["is_beyond_doubt"]:
        result["verdict"] = "biased"
    elif result["verdict"] == "correct" and found["too_noisy"]:
        result["verdict"] = "noisy"
