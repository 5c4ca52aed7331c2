#!/usr/bin/env python3
"""Teaches ./lab check what the mistakes of the chapters do, and measures how often it names them right.

    tests/mistakes/learn.py learn      renders the chapters' own shaders and each mistake planted in them; writes
                                       knowledge.json in the chapters' folders
    tests/mistakes/learn.py confusion  plants each mistake again and lets it be named, with new seeds, on scenes that check does
                                       not use and in the differently written shaders of their variants; checks correct
                                       shaders as well; writes docs/records/check/confusion.json

Both do only what has changed since the last time: a shader or what it is rendered with. So both go on where they were
interrupted. --anew does everything again, which is needed where anything else has changed: shaders that chapters share, scenes,
references, or how check judges and names.
"""
import hashlib
import json
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import fmean
from threading import Lock

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools"))
import project  # noqa: E402  (found by the line above)
from check import grading  # noqa: E402
from check.likely_mistake import candidates, noise_and_rays, read_signatures, signature, surprises  # noqa: E402
from docs.ages import stamped  # noqa: E402
from planting import OTHER_SCENES, catalogue, own_shader, trials  # noqa: E402
from project import RECORDS, Parser, add_device_options, commit, number, read_json, show_progress, write_json  # noqa: E402

GOES_ON = True
RECORD = RECORDS / "check/confusion.json"
OTHER_KNOWLEDGE = "other_scenes.json"  # as grading.KNOWLEDGE, of OTHER_SCENES
DEPTH = 2  # of what has a line in these files and in the record
# Levels have the seeds of a check without --seed, see grading.first_seed(); the others have seeds that no check has.
LEVELS = {"runs": grading.RUNS, "first_seed": grading.first_seed(0), "factor": 1}
# The chapter that a chapter has less noise than with the same samples, where that is its lesson.
GAINS_OVER = {number: int(project.chapter_named(says["check"]["gains_over"])[:2]) for number, says in grading.DESCRIPTIONS.items()
              if "gains_over" in says.get("check", {})}
LEARNING = {"runs": 5, "first_seed": 1001, "factor": 2}  # times the samples of a check
TRYING = {"runs": grading.RUNS, "first_seed": 3001, "factor": 1}  # as a check does, with seeds that nothing was learnt from


def settings(chapter, plan, scenes=None):
    """What a verdict depends on besides the shader."""
    samples, own_scenes = grading.SCENES[chapter]
    return {"plan": plan, "samples": samples, "scenes": scenes or own_scenes, "options": grading.OPTIONS[chapter]}


def level_digest(chapter, scenes):
    """Of what the levels of a chapter depend on."""
    return digest(settings(chapter, LEVELS, scenes), *(own_text(number) for number in (chapter, GAINS_OVER.get(chapter)) if number))


def own_text(chapter):
    """All that a chapter's own shaders say."""
    return "".join(shader.read_text(encoding="utf-8") for shader in project.shaders_of(chapter))


def digest(*parts):
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()[:12]


class Workshop:
    """Judges shaders, several at a time."""

    def __init__(self, options):
        self.options = options

    def settings(self, chapter, plan, seed=0):
        samples = grading.SCENES[chapter][0] * plan["factor"]
        return {"backend": self.options.backend, "device": self.options.device, "time_limit": 600, "runs": plan["runs"],
                "samples": samples, "first_seed": plan["first_seed"] + seed, "is_quiet": True}

    def judge(self, chapter, shader, text, plan, levels, scenes, seed=0):
        """Judges a text in place of one of a chapter's shaders."""
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "path_trace.glsl"
            file.write_text(text, encoding="utf-8")
            return grading.judge(chapter, file, self.settings(chapter, plan, seed), levels, scenes, shader=shader)[0]

    def levels(self, chapter, scenes):
        """Those of the chapter's own shader, with what it gains over the one that chapter.json names."""
        def levels_of(number):
            cases = grading.render(number, own_shader(number), self.settings(chapter, LEVELS), scenes)
            return {case["scene"]: grading.level(case) for case in cases}

        levels = levels_of(chapter)
        if chapter in GAINS_OVER:
            for scene, base in levels_of(GAINS_OVER[chapter]).items():
                errors = [fmean(level["rel_mse"].values()) for level in (base, levels[scene])]
                levels[scene]["gain"] = float(f"{errors[0] / errors[1]:.3g}")
        return levels

    def map(self, what, function, items):
        """Calls a function for all items, with progress."""
        started = time.monotonic()
        with ThreadPoolExecutor(self.options.jobs) as pool:
            for done, _ in enumerate(pool.map(function, items), 1):
                show_progress(what, done, len(items), started)


def percentages(tests):
    """Text with a number of three digits for each difference; 0 for what lies within 1.5 times the half of its 95 % interval."""
    return " ".join(f"{100 * test['value']:+.3g}" if abs(test["value"]) > 1.5 * test["half_width"] else "0" for test in tests)


def written(result):
    """What a mistake does to each scene, as a person can read it: differences in percent, tiles as they lie in the picture."""
    scenes = {}
    for scene in result["scenes"]:
        rows = [[tile for tile in scene["tiles"] if tile["row"] == row]
                for row in range(scene["tiles"][-1]["row"] + 1)]
        noise, rays = (float(f"{value:.3g}") for value in noise_and_rays(scene))
        scenes[scene["scene"]] = {"noise": noise, "rays": rays, "image": percentages(scene["image"]), "tiles": list(map(percentages, rows))}
    return scenes


def read_knowledge(name, chapters):
    """Chapter -> what the file with this name in its folder knows."""
    files = {chapter: grading.knowledge_file(chapter, name) for chapter in chapters}
    return {chapter: read_json(file) for chapter, file in files.items() if file.exists()}


def planned_knowledge(scenes, before):
    """What is to be known of each chapter of `scenes`, names of references: the levels of its own shader and what its mistakes do.
    What `before` has of it and was measured alike is there, the rest is empty. With it a list of what is to be rendered."""
    knowledge, work = {}, []
    for chapter, names in scenes.items():
        known = before.get(chapter, {})
        measured = level_digest(chapter, names)
        levels = known["levels"] if known.get("measured") == measured else None
        knowledge[chapter] = {"title": grading.DESCRIPTIONS[chapter]["title"], "measured": measured, "levels": levels, "mistakes": {}}
    for bug in catalogue():
        if bug.chapter in scenes:
            name, chapter = bug.mistake["name"], knowledge[bug.chapter]
            entry = {key: bug.mistake[key] for key in ("hint", "slide")}
            entry["measured"] = digest(settings(bug.chapter, LEARNING, scenes[bug.chapter]), bug.text, chapter["measured"])
            known = before.get(bug.chapter, {"mistakes": {}})["mistakes"].get(name, {})
            entry["scenes"] = known["scenes"] if known.get("measured") == entry["measured"] else {}
            chapter["mistakes"][name] = entry
            if not entry["scenes"]:
                work.append((bug, entry))
    return knowledge, work


def unmeasured(knowledge, scenes):
    """What is missing or was measured with something else, as (chapter, name of a mistake or "levels")."""
    planned, _ = planned_knowledge(scenes, knowledge)
    missing = [(chapter, "levels") for chapter, entry in planned.items() if not entry["levels"]]
    return missing + [(chapter, name) for chapter, entry in planned.items() for name, mistake in entry["mistakes"].items()
                      if not mistake["scenes"]]


def learn(workshop, name, scenes, is_anew):
    """Fills the files of knowledge with this name with what they lack."""
    knowledge, work = planned_knowledge(scenes, {} if is_anew else read_knowledge(name, scenes))

    def write(chapter):
        write_json(grading.knowledge_file(chapter, name), knowledge[chapter], DEPTH)

    def learn_levels(chapter):
        knowledge[chapter]["levels"] = workshop.levels(chapter, scenes[chapter])

    workshop.map("levels", learn_levels, [chapter for chapter in scenes if not knowledge[chapter]["levels"]])
    lock = Lock()

    def learn_mistake(item):
        bug, entry = item
        levels = knowledge[bug.chapter]["levels"]
        result = workshop.judge(bug.chapter, bug.file, bug.text, LEARNING, levels, scenes[bug.chapter])
        with lock:
            entry["scenes"] = written(result)
            write(bug.chapter)

    for chapter in scenes:
        write(chapter)
    workshop.map("signatures", learn_mistake, work)
    return knowledge


def planned_trials():
    """Name -> a Trial, its scenes, and the digest of all that it depends on."""
    planned = {}
    for key, trial in trials().items():
        scenes = OTHER_SCENES[trial.chapter] if trial.is_elsewhere else None
        planned[key] = trial, scenes, digest(settings(trial.chapter, TRYING, scenes), trial.text, trial.seed, own_text(trial.chapter))
    return planned


def confusion(workshop, is_anew):
    own = read_knowledge(grading.KNOWLEDGE, project.course())
    others = learn(workshop, OTHER_KNOWLEDGE, OTHER_SCENES, is_anew)
    done = read_json(RECORD)["trials"] if RECORD.exists() and not is_anew else {}
    planned, lock = planned_trials(), Lock()
    kept = {key: trial for key, trial in done.items() if key in planned and trial["measured"] == planned[key][-1]}
    record = {"commit": commit(), "trials": kept}

    def try_naming(item):
        key, (trial, scenes, measured) = item
        knowledge = (others if scenes else own)[trial.chapter]
        result = workshop.judge(trial.chapter, trial.shader, trial.text, TRYING, knowledge["levels"], scenes, TRYING["runs"] * trial.seed)
        answer = {"mistake": trial.mistake, "verdict": result["verdict"], "named": [], "is_sure": False, "measured": measured, **effect(result)}
        if result["verdict"] != "correct":
            found = surprises(signature(result), read_signatures(knowledge["mistakes"]))
            answer |= {"named": list(found)[:3], "is_sure": len(candidates(found)) == 1}
        with lock:
            record["trials"][key] = answer
            write_json(RECORD, record, DEPTH)

    workshop.map("naming", try_naming, [item for item in planned.items() if item[0] not in kept])
    record["trials"] = {key: record["trials"][key] for key in planned}
    write_json(RECORD, stamped(record), DEPTH)


def effect(result):
    """The largest change of a picture's mean and the largest of its error, both as parts: what a check must find."""
    sure = [abs(test["value"]) for scene in result["scenes"] for test in scene["image"] if abs(test["value"]) > test["half_width"]]
    return {"bias": max(sure, default=0.0),
            "noise": max(scene["noise"][0] or 1.0 for scene in result["scenes"]), "rays": max(scene["rays"] for scene in result["scenes"])}


def main():
    parser = Parser("tests/mistakes/learn.py", __doc__)
    parser.add_argument("action", choices=["learn", "confusion"])
    parser.add_argument("--jobs", type=number(int, 1), default=1, help="shaders that are rendered at a time; default: 1")
    parser.add_argument("--anew", action="store_true", help="measure everything again")
    add_device_options(parser)
    options = parser.parse_args()
    workshop = Workshop(options)
    if options.action == "confusion":
        confusion(workshop, options.anew)
    else:
        learn(workshop, grading.KNOWLEDGE, {n: grading.SCENES[n][1] for n in project.course()}, options.anew)


if __name__ == "__main__":
    project.run_tool(sys.modules[__name__])
