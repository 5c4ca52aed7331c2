"""Teaches ./lab check what the chapters' own shaders show, and the mistakes of the catalogue.

Renders the chapters' own shaders in the scenes and experiments of ./lab check and writes assets/expected; then each mistake planted in
them in the experiments, and writes notebook/knowledge. Does only what has changed since the last time: a shader or what it is rendered
with. So it continues where it was interrupted. --anew does everything again, which is needed if anything else has changed: shaders that
chapters share, scenes, references, or how check judges and names. --chapters does those alone.
"""
import hashlib
import json
import math
from statistics import fmean
from threading import Lock

import project
from check import grading
from check.diagnosis import observe
from check.expected import DESCRIPTIONS, expected_file, known_mistakes
from check.experiments import experiments_of, pictures, together
from check.names import ratios_of
from check.submission import Submission, replaced
from course.mistakes import catalogue, own_shader
from includes import shaders_of
from project import CHAPTERS, Parser, add_device_options, number, read_json, write_json
from report.batch import Batch, run_all
from report.sources import code
from tables.records import NOTEBOOK

GOES_ON = True
# Levels use the seeds of a check without --seed, see grading.first_seed(); the others use seeds that no check has.
LEVELS = {"runs": grading.RUNS, "first_seed": grading.first_seed(0)}
# The chapter that a chapter should beat in noise with the same samples, if that is its lesson.
GAINS_OVER = {
    number: int(project.chapter_named(says["check"]["gains_over"])[:2])
    for number, says in DESCRIPTIONS.items()
    if "gains_over" in says.get("check", {})
}
OWN_SEED, OWN_PICTURES, MISTAKE_SEED = 5001, 4, 6001  # of experiments


def settings(chapter, plan, samples, scenes=None):
    """What a verdict depends on besides the shader."""
    return {"plan": plan, "samples": samples, "scenes": scenes or grading.SCENES[chapter][1], "options": grading.OPTIONS[chapter]}


def level_digest(chapter):
    """Digest of what the levels of a chapter depend on."""
    return digest(
        settings(chapter, LEVELS, grading.SCENES[chapter][0]),
        *(own_text(number) for number in (chapter, GAINS_OVER.get(chapter)) if number),
    )


def experiment_digest(chapter, name):
    """Digest of what an experiment measures: its words may change."""
    points = experiments_of(chapter)[name].points
    return digest([[point.scene, point.options, point.samples, point.channel] for point in points], own_text(chapter))


def words_of(entry):
    """What ./lab check says about a mistake."""
    return {key: entry[key] for key in ("hint", "slide", "section") if key in entry}


def own_text(chapter):
    """The code of all of a chapter's own shaders."""
    return code("".join(shader.read_text(encoding="utf-8") for shader in shaders_of(chapter)))


def digest(*parts):
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()[:12]


class Workshop:
    """Renders shaders."""

    def __init__(self, options):
        self.options = options

    def settings(self, plan, seed=0):
        return {
            "backend": self.options.backend,
            "device": self.options.device,
            "time_limit": 600,
            "runs": plan["runs"],
            "samples": None,
            "first_seed": plan["first_seed"] + seed,
            "is_quiet": True,
        }

    def levels(self, chapter):
        """Levels of the chapter's own shader, with its gain over the chapter that chapter.json names."""

        def levels_of(number):
            plan = self.settings(LEVELS) | {"samples": grading.SCENES[chapter][0]}
            return {
                case["scene"]: grading.level(case)
                for case in grading.render(Submission(number, own_shader(number)), plan, grading.SCENES[chapter][1])
            }

        levels = levels_of(chapter)
        if chapter in GAINS_OVER:
            for scene, base in levels_of(GAINS_OVER[chapter]).items():
                errors = [fmean(level["rel_mse"].values()) for level in (base, levels[scene])]
                levels[scene]["gain"] = float(f"{errors[0] / errors[1]:.3g}")
        return levels

    def own_sights(self, chapter, experiment):
        """What the chapter's own shader shows in an experiment, as lists."""
        # Not one picture of more samples: the spread of its pixels would tell more of what they show and less of their noise.
        with Batch() as batch:
            sights = [
                together(seen)
                for seen in pictures(
                    CHAPTERS[chapter], experiment.points, self.settings(LEVELS), OWN_SEED, batch, repeats=OWN_PICTURES
                )
            ]
        return {
            key: [float(f"{getattr(sight, key):.4g}") for sight in sights]
            for key in ("mean", "error", "noise", "noise_error", "rays")
        }

    def shown(self, bug, expected, before):
        """What a mistake shows in experiments, as text with a number per point: brightness where it differs from the chapter's
        own, or if that is right everywhere, noise and rays. `before` has what earlier experiments have shown."""
        with replaced(bug.file, bug.text) as shaders:
            facts, sights = observe(
                bug.chapter, self.settings(LEVELS) | {"shaders": shaders}, expected, lambda *_: True, MISTAKE_SEED
            )
        shows = before["shows"] | {
            name: to_digits(reading.value for reading in seen.readings) for name, seen in facts.items() if not seen.is_right
        }
        if shows:
            return {"shows": shows}
        ratios = ratios_of(sights, expected)
        noise = {
            name: to_digits((v for v, _ in those), 2)
            for name, those in ratios["noise"].items()
            if any(abs(math.log(max(v, 0.01))) > 0.2 + 3 * e for v, e in those)
        }
        rays = {
            name: to_digits((v for v, _ in those), 3)
            for name, those in ratios["rays"].items()
            if any(abs(v - 1) > 0.05 for v, _ in those)
        }
        return {"shows": {}, "noise": before.get("noise", {}) | noise, "rays": before.get("rays", {}) | rays}


def to_digits(values, digits=4):
    """Text with this many significant digits in each number."""
    return " ".join(f"{value:.{digits}g}" for value in values)


def read_knowledge(chapters):
    """Chapter -> what is known about it, of those that were measured."""
    files = {chapter: expected_file(chapter) for chapter in chapters}
    return {chapter: read_json(file) | {"mistakes": known_mistakes(chapter)} for chapter, file in files.items() if file.exists()}


def planned_knowledge(chapters, before):
    """What should be known about chapters: levels and experiments of their own shader, and what their mistakes show. Filled in as
    far as `before` has it, measured alike; the rest is empty, and `unseen` lists experiments in which a mistake is not measured yet.
    """
    knowledge = {}
    for chapter in chapters:
        known = before.get(chapter, {})
        measured = level_digest(chapter)
        entry = {
            "title": DESCRIPTIONS[chapter]["title"],
            "measured": measured,
            "levels": known["levels"] if known.get("measured") == measured else None,
            "experiments": {},
            "mistakes": {},
        }
        digests = {name: experiment_digest(chapter, name) for name in experiments_of(chapter)}
        for name, now in digests.items():
            old = known.get("experiments", {}).get(name, {})
            entry["experiments"][name] = old if old.get("measured") == now else {"measured": now}
        for bug in (bug for bug in catalogue() if bug.chapter == chapter):
            now, old = digest(code(bug.text)), known.get("mistakes", {}).get(bug.mistake["name"], {})
            old = old if old.get("measured") == now else {"unseen": list(digests)}
            unseen = [name for name in digests if name in old.get("unseen", []) or "mean" not in entry["experiments"][name]]
            seen = {
                kind: {name: text for name, text in old[kind].items() if name in digests and name not in unseen}
                for kind in ("shows", "noise", "rays")
                if kind in old
            }
            entry["mistakes"][bug.mistake["name"]] = (
                words_of(bug.mistake) | {"measured": now, "shows": {}} | seen | ({"unseen": unseen} if unseen else {})
            )
        knowledge[chapter] = entry
    return knowledge


def unmeasured(knowledge):
    """What is missing or was measured differently, as (chapter, name of an experiment or a mistake, or "levels")."""
    planned = planned_knowledge(project.course(), knowledge)
    missing = [(chapter, "levels") for chapter, entry in planned.items() if not entry["levels"]]
    missing += [
        (chapter, name) for chapter, entry in planned.items() for name, seen in entry["experiments"].items() if "mean" not in seen
    ]
    return missing + [
        (chapter, name) for chapter, entry in planned.items() for name, seen in entry["mistakes"].items() if "unseen" in seen
    ]


def learn(workshop, chapters, is_anew, jobs):
    """Completes the files of the chapters."""
    knowledge, lock = planned_knowledge(chapters, {} if is_anew else read_knowledge(chapters)), Lock()

    def write(chapter):
        with lock:
            file = expected_file(chapter)
            write_json(file, {key: known for key, known in knowledge[chapter].items() if key != "mistakes"})
            write_json(NOTEBOOK / "knowledge" / file.name, knowledge[chapter]["mistakes"])

    def learn_levels(chapter):
        knowledge[chapter]["levels"] = workshop.levels(chapter)
        write(chapter)

    def learn_experiment(item):
        chapter, name = item
        knowledge[chapter]["experiments"][name] |= workshop.own_sights(chapter, experiments_of(chapter)[name])
        write(chapter)

    def learn_mistake(bug):
        entry, experiments = knowledge[bug.chapter]["mistakes"][bug.mistake["name"]], knowledge[bug.chapter]["experiments"]
        shown = workshop.shown(bug, {name: experiments[name] for name in entry["unseen"]}, entry)
        knowledge[bug.chapter]["mistakes"][bug.mistake["name"]] = words_of(entry) | {"measured": entry["measured"]} | shown
        write(bug.chapter)

    run_all("levels", learn_levels, [chapter for chapter in chapters if not knowledge[chapter]["levels"]], jobs)
    run_all(
        "experiments",
        learn_experiment,
        [
            (chapter, name)
            for chapter in chapters
            for name, seen in knowledge[chapter]["experiments"].items()
            if "mean" not in seen
        ],
        jobs,
    )
    run_all(
        "mistakes",
        learn_mistake,
        [
            bug
            for bug in catalogue()
            if bug.chapter in chapters and "unseen" in knowledge[bug.chapter]["mistakes"][bug.mistake["name"]]
        ],
        jobs,
    )
    for chapter in chapters:
        write(chapter)


def parse(name, description):
    """The options of what renders shaders for ./lab check."""
    parser = Parser(name, description)
    parser.add_argument("--jobs", type=number(int, 1), default=1, help="shaders that are rendered at a time; default: 1")
    parser.add_argument("--anew", action="store_true", help="measure everything again")
    parser.add_argument("--chapters", type=number(int, 1), nargs="+", default=project.course(), metavar="N", help="default: all")
    add_device_options(parser)
    options = parser.parse_args()
    grading.stay_in_the_driver(options.backend)
    return options


def main():
    options = parse("./lab notebook learn", __doc__)
    learn(Workshop(options), options.chapters, options.anew, options.jobs)
