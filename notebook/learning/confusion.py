"""Measures how often ./lab check names mistakes right: notebook/records/check/confusion.json.

Plants each mistake of the catalogue again and lets it be named, with new seeds, and in the differently written shaders of
notebook/variants; checks correct shaders as well. Does only what has changed since the last time, as ./lab notebook learn does.
"""
import random
import tempfile
from pathlib import Path
from threading import Lock

import project
from check import grading
from check.diagnosis import decide, diagnose
from check.experiments import experiments_of
from check.submission import Submission
from learning.learn import Workshop, digest, own_text, parse, settings
from learning.planting import trials
from project import commit, read_json, write_json
from report.batch import run_all
from report.sources import code
from tables.records import RECORDS
from tables.sources import stamped

GOES_ON = True
RECORD = RECORDS / "check/confusion.json"
TRYING = {"runs": grading.RUNS, "first_seed": 3001}  # as a check does, with seeds that nothing was learnt from


def planned_trials(chapters):
    """Name -> a Trial and the digest of everything that it depends on."""
    return {
        key: (
            trial,
            digest(
                settings(trial.chapter, TRYING, grading.SCENES[trial.chapter][0]),
                code(trial.text),
                trial.seed,
                own_text(trial.chapter),
                [repr(e) for e in experiments_of(trial.chapter).values()],
            ),
        )
        for key, trial in trials().items()
        if trial.chapter in chapters
    }


def outdated():
    """The trials that the record lacks, or has of other shaders, experiments or settings."""
    done = read_json(RECORD)["trials"] if RECORD.exists() else {}
    return [
        key for key, (_, measured) in planned_trials(project.course()).items() if done.get(key, {}).get("measured") != measured
    ]


def confusion(workshop, chapters, is_anew, jobs):
    done = read_json(RECORD)["trials"] if RECORD.exists() and not is_anew else {}
    everything, lock = planned_trials(project.course()), Lock()
    record = {
        "commit": commit(),
        "trials": {key: trial for key, trial in done.items() if key in everything and trial["measured"] == everything[key][-1]},
    }

    def try_naming(item):
        key, (trial, measured) = item
        plan = workshop.settings(TRYING, 2 * TRYING["runs"] * trial.seed)
        with tempfile.TemporaryDirectory() as folder:
            submission = Submission(trial.chapter, Path(folder) / "path_trace.glsl", trial.shader)
            submission.file.write_text(trial.text, encoding="utf-8")
            result, pictures = grading.judge(submission, plan)
            result["diagnosis"] = found = diagnose(submission, plan, result["verdict"] == "correct")
            decide(submission, plan, result, pictures)
            answer = {
                "mistake": trial.mistake,
                "verdict": result["verdict"],
                "named": [each["name"] for each in found["mistakes"]],
                "fits": found["fits"],
                "facts": len(found["facts"]),
                "measured": measured,
                **effect(result),
            }
        with lock:
            record["trials"][key] = answer
            write_json(RECORD, record)

    missing = [(key, everything[key]) for key in planned_trials(chapters) if key not in record["trials"]]
    random.Random(0).shuffle(missing)  # what an interrupted run has done is a fair sample
    run_all("naming", try_naming, missing, jobs)
    record["trials"] = {key: record["trials"][key] for key in everything if key in record["trials"]}
    write_json(RECORD, stamped(record))


def effect(result):
    """The largest change of a picture's mean and of its error, both relative: what a check must find."""
    sure = [
        abs(test["value"]) for scene in result["scenes"] for test in scene["image"] if abs(test["value"]) > test["half_width"]
    ]
    return {
        "bias": max(sure, default=0.0),
        "noise": max(scene["noise"][0] or 1.0 for scene in result["scenes"]),
        "rays": max(scene["rays"] for scene in result["scenes"]),
    }


def main():
    options = parse("./lab notebook confusion", __doc__)
    confusion(Workshop(options), options.chapters, options.anew, options.jobs)
