"""Grades shaders written without a look at the catalogue of mistakes, and compares with what their authors say about them.

    ./lab notebook submissions notebook/submissions/held_out held_out

FOLDER has a folder for each submission, with a shader and submission.json. RECORD is the name of a file in notebook/records/check. It
gets the verdict, the facts and the names of each submission. Each fact is measured again with other random numbers and more samples:
it is true if both agree. What has been graded with the same shaders and experiments is not graded again, unless --anew asks for it: use
that if the check itself has changed. A person decides whether the facts and names point at what the wrong line means, and whether a single name is
right: "points" and "name_is_right" in the record, true, false or null, which are kept as long as the answer stays the same.
"""
import time
from pathlib import Path
from threading import Lock

from check import grading
from check.diagnosis import decide, diagnose
from check.expected import expected_file
from check.experiments import experiments_of, known_sights, pictures, together
from check.facts import readings
from check.submission import Submission
from learning.learn import LEVELS, Workshop, digest, own_text
from project import CHAPTERS, Parser, UserError, add_device_options, commit, number, read_json, write_json
from report.batch import Batch, run_all
from report.sources import code
from tables.records import RECORDS
from tables.sources import stamped

GOES_ON = True
SEED, PICTURES = 9001, 4  # of the second measurement, per point
AGREE = 3.5  # standard errors between two measurements of the same quantity
ROUNDING = 0.005


def untrue(submission, found, those):
    """Numbers of wrong experiments that a second measurement contradicts: (experiment, point, number, second number)."""
    chapter, contradicted = submission.chapter, []
    known = read_json(expected_file(chapter))["experiments"]
    those = those | {"shaders": submission.options}
    wrong = {
        name: experiments_of(chapter)[name].points
        for name, seen in found["readings"].items()
        if any(abs(value - 1) >= ROUNDING and value != 0 for _, value, _ in seen)
    }
    with Batch() as batch:
        sights = batch.map(lambda name: pictures(CHAPTERS[chapter], wrong[name], those, SEED, batch, repeats=PICTURES), wrong)
        for (name, points), seen in zip(wrong.items(), sights):
            anew = readings(points, list(map(together, seen)), known_sights(known[name]))
            contradicted += [
                [name, at, value, round(again.value, 4)]
                for (at, value, error), again in zip(found["readings"][name], anew)
                if abs(value - again.value) > AGREE * (error**2 + again.error**2) ** 0.5 + ROUNDING
            ]
    return contradicted


def measured(folder, seed):
    """Digest of what the answer to a submission depends on, besides ./lab check itself."""
    says = read_json(folder / "submission.json")
    return digest(
        says,
        [code(file.read_text(encoding="utf-8")) for file in folder.glob("*.glsl")],
        seed,
        own_text(says["chapter"]),
        [repr(experiment) for experiment in experiments_of(says["chapter"]).values()],
    )


def grade(folder, options):
    says = read_json(folder / "submission.json")
    submission = Submission(says["chapter"], next(folder.glob("*.glsl")))
    those = Workshop(options).settings(LEVELS | {"first_seed": grading.first_seed(options.seed)})
    started = time.monotonic()
    result, pictures = grading.judge(submission, those)
    seconds = [round(time.monotonic() - started, 1)]
    result["diagnosis"] = found = diagnose(submission, those, result["verdict"] == "correct")
    decide(submission, those, result, pictures)
    row = {
        "chapter": says["chapter"],
        "is_right": says["is_right"],
        "mistake": says["mistake"],
        "means": says["means"],
        "verdict": result["verdict"],
        "facts": found["facts"],
        "named": [each["name"] for each in found["mistakes"]],
        "fits": found["fits"],
        "next": found["next"],
        "seconds": [*seconds, found["seconds"]],
        "measured": measured(folder, options.seed),
    }
    return row | ({"untrue": untrue(submission, found, those)} if result["verdict"] != "correct" else {"untrue": []})


def main():
    parser = Parser("./lab notebook submissions", __doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("record")
    parser.add_argument("--jobs", type=number(int, 1), default=1, help="submissions that are graded at a time; default: 1")
    parser.add_argument("--seed", type=number(int, 0), default=0, help="default: 0")
    parser.add_argument("--anew", action="store_true", help="grade everything again")
    parser.add_argument("--only", nargs="+", default=[""], metavar="TEXT", help="submissions whose names begin so")
    add_device_options(parser)
    options = parser.parse_args()
    grading.stay_in_the_driver(options.backend)
    path = RECORDS / f"check/{options.record}.json"
    record = read_json(path) if path.exists() else {"submissions": {}}
    folders = sorted(
        file.parent for file in options.folder.glob("*/submission.json") if file.parent.name.startswith(tuple(options.only))
    )
    if not folders:
        raise UserError(f"{options.folder}: has no folders with submission.json")
    lock = Lock()

    def grade_one(folder):
        before, row = record["submissions"].get(folder.name, {}), grade(folder, options)
        is_same = all(before.get(key) == row[key] for key in ("verdict", "named")) and len(before["facts"]) == len(row["facts"])
        with lock:
            record["submissions"][folder.name] = row | {
                key: before.get(key) if is_same else None for key in ("points", "name_is_right")
            }
            record.update({"commit": commit(), "submissions": dict(sorted(record["submissions"].items()))})
            write_json(path, record)

    done = {} if options.anew else {name: row.get("measured") for name, row in record["submissions"].items()}
    run_all(
        "submissions",
        grade_one,
        [folder for folder in folders if done.get(folder.name) != measured(folder, options.seed)],
        options.jobs,
    )
    if options.anew and options.only == [""]:
        write_json(path, stamped({name: record[name] for name in ("submissions", "commit")}))
