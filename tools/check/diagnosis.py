"""The differential diagnosis of an incorrect shader: facts first, and a name only if they leave a single one.

The chapter's experiments run in order, those with a condition (`when`) only if other experiments have met it.
knowledge.json in the chapter's folder records what its own shader shows in each, and what the catalogue's mistakes do to it.
"""
import tempfile
import time
from pathlib import Path

from check.experiments import experiments_of, known_sights, pictures, together, write_scene
from check.facts import Fact, common_value, constant, fact, number, readings
from check.grading import DESCRIPTIONS, knowledge_file, make_tree
from check.names import names_of, ratios_of, similar_to
from project import CHAPTERS, ROOT, UserError, read_json
from report.batch import Batch

FIRST_SEED, REPEATS = 7001, 3
PATIENCE = 15.0  # seconds per point's picture, which takes an idle core a tenth of a second


def repeats_of(chapter):
    """Number of pictures per point: if the samples of a pixel are correlated, those of different pixels may be, too."""
    return REPEATS if DESCRIPTIONS[chapter].get("low_discrepancy") else 1


def is_called_for(experiment, facts):
    """Whether the facts that its condition asks for are known and as required."""
    return all(name not in facts or facts[name].is_right == is_right for name, is_right in experiment.when.items())


def is_deciding(experiment, _):
    return experiment.decides


def look_at(program, points, settings, seed, batch, repeats, expected):
    """What a program shows at each of these points: a list of Sight. Only a point whose first picture looks wrong is rendered again."""
    seen = pictures(program, points, settings, seed, batch)
    if repeats > 1:
        wrong = [index for index, reading in enumerate(readings(points, map(together, seen), expected)) if not reading.is_right]
        more = pictures(program, [points[index] for index in wrong], settings, seed + len(points), batch, repeats=repeats - 1)
        for index, sights in zip(wrong, more):
            seen[index] += sights
    return [together(sights) for sights in seen]


def from_both_ends(items):
    """First, last, second, last but one and so on. Neighbouring experiments have the same shaders: two programs that begin one at the
    same time would both compile them."""
    count = len(items)
    return [items[i // 2 if i % 2 == 0 else count - 1 - i // 2] for i in range(count)]


def observe(chapter, program, settings, expected, chosen=is_called_for, seed=FIRST_SEED):
    """Name -> Fact and name -> list of Sight, for the experiments of a chapter."""
    facts, sights, settings = {}, {}, settings | {"time_limit": min(settings["time_limit"], PATIENCE)}
    experiments = experiments_of(chapter)
    waiting = [name for name in experiments if name in expected]

    def look(name):
        try:
            return look_at(program, experiments[name].points, settings, seed, batch, repeats_of(chapter), known_sights(expected[name]))
        except UserError as error:  # for example an endless loop that only this scene triggers
            return error

    with Batch() as batch:
        while waiting:  # at the same time those whose conditions are known
            ready = [name for name in waiting if not set(experiments[name].when) & set(waiting)]
            names = from_both_ends([name for name in ready if chosen(experiments[name], facts)])
            waiting = [name for name in waiting if name not in ready]
            for name, found in zip(names, list(batch.map(look, names))):
                experiment = experiments[name]
                if isinstance(found, UserError):
                    facts[name] = Fact(experiment, [], f"{experiment.subject}: cannot be rendered: {found}")
                else:
                    sights[name] = found
                    facts[name] = fact(experiment, found, known_sights(expected[name]))
    return tuple({name: those[name] for name in experiments if name in those} for those in (facts, sights))


# ---------------------------------------------------------------------------------------------- words
def sentences(facts):
    """What is wrong, in the order of the experiments. Experiments that are wrong by the same factor at all points are reported
    together."""
    groups, others = [], []
    for name, seen in facts.items():
        lit = [reading for reading in seen.readings if not reading.is_dark]
        is_clear = lit and not seen.is_right and not seen.invalid and all(r.is_right for r in seen.readings if r.is_dark)
        common = common_value(lit) if is_clear else None
        if not common or any(reading.is_right for reading in lit) or common[0] == 0:
            others += [] if seen.is_right else [seen.sentence]
            continue
        group = next((group for group in groups if common_value([*group["readings"], *lit])), None)
        if not group:
            groups.append(group := {"readings": [], "of": []})
        group["readings"] += lit
        group["of"].append(seen.experiment)
    told = []
    for group in groups:
        value = common_value(group["readings"])
        subjects = {}
        for experiment in group["of"]:
            subjects.setdefault(experiment.subject, []).append(experiment.varies)
        words = [f"{subject} (whatever {', '.join(varies)})" for subject, varies in subjects.items()]
        told.append(f"{number(*value)} times as bright as it should be{constant(*value)}: {'; '.join(words)}")
    return told + others


def right_ones(facts):
    """What is right: subjects, or if a subject is only partly right, what it does not depend on."""
    not_right = {seen.experiment.subject for seen in facts.values() if not seen.is_surely_right}
    right = [seen.experiment for seen in facts.values() if seen.is_surely_right]
    return list(dict.fromkeys(f"{each.subject}, whatever {each.varies}" if each.subject in not_right else each.subject for each in right))


def noise_sentences(facts, sights, expected):
    """Where a shader is noisier than the chapter's own, or traces more rays, or fewer: then its paths end elsewhere."""
    told = []
    for kind, words, is_much in (("noise", "noisier than the chapter's own shader: so many times its variance", lambda value, error: value - 1 > 4 * error + 0.2),
                                 ("rays", "so many times the rays of the chapter's own shader", lambda value, error: abs(value - 1) > 4 * error + 0.05)):
        for name, seen in ratios_of(sights, expected)[kind].items():
            experiment = facts[name].experiment
            much = [f"{point.at}: {value:.2g}" for point, (value, error) in zip(experiment.points, seen) if is_much(value, error)]
            if much:
                told.append(f"{experiment.subject}: {words}; {', '.join(much)}")
    return told


def next_step(chapter, facts):
    """How the student can see the first wrong thing: writes a scene file and returns it with a command."""
    seen = next((seen for seen in facts.values() if not seen.is_right and seen.readings), None)
    if not seen:
        return None
    worst = max(range(len(seen.readings)), key=lambda i: abs(seen.readings[i].value - seen.readings[i].expected))
    point, folder = seen.experiment.points[worst], ROOT / f"output/check_{chapter}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        scene = write_scene(point.scene, folder, seen.experiment.name)
    except OSError:  # in a read-only checkout, for instance
        return None
    return f"./lab run {chapter} {scene.relative_to(ROOT)} {point.options}".rstrip()


def reason(chapter, facts, sights, known, is_correct):
    """What the facts say: sentences about what is wrong, subjects that are right, mistakes of the catalogue that fit, or if
    none fits, may fit, and a command that shows the first of the facts."""
    told = sentences(facts) or ([] if is_correct else noise_sentences(facts, sights, known["experiments"]))
    wrong = [name for name, seen in facts.items() if not seen.is_right]
    fitting = names_of(facts, sights, known["mistakes"], known["experiments"]) if told else []
    names = fitting or (similar_to(facts, known["mistakes"]) if wrong else [])
    return {"facts": told, "right": right_ones(facts), "next": next_step(chapter, facts),
            "wrong": wrong, "fits": bool(fitting),
            "is_beyond_doubt": any(reading.is_beyond_doubt for seen in facts.values() for reading in seen.readings),
            "mistakes": [{"name": name} | {key: known["mistakes"][name][key] for key in ("hint", "slide")} for name in names],
            "readings": {name: [[r.at, round(r.value, 4), round(r.error, 4)] for r in seen.readings] for name, seen in facts.items()}}


def diagnose(chapter, file, settings, shader=None, is_correct=False):
    """What experiments show about a shader, see reason(). If its pictures are correct, only those run that can decide as well."""
    known, started = {"experiments": {}} | read_json(knowledge_file(chapter)), time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        program, copies = make_tree(CHAPTERS[chapter], file, Path(folder), shader)
        facts, sights = observe(chapter, program, settings, known["experiments"], is_deciding if is_correct else is_called_for)
    return reason(chapter, facts, sights, known, is_correct) | {"seconds": round(time.monotonic() - started, 1)}


def verdict_with(verdict, diagnosis):
    """The verdict on a shader. Experiments may find a bias where the pictures of a correct one do not look."""
    return "biased" if verdict == "correct" and diagnosis["is_beyond_doubt"] else verdict
