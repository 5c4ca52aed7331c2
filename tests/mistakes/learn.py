#!/usr/bin/env python3
"""Teaches ./lab check what the mistakes of tests/mistakes/mistakes.json do, and measures how often it names them right.

    tests/mistakes/learn.py learn      renders the chapters' own shaders and each mistake planted in them; writes
                                       levels.json and signatures.json of tools/check
    tests/mistakes/learn.py confusion  plants each mistake again and lets it be named: with new seeds, in the differently
                                       written shaders of tests/variants, and on scenes that check does not use; writes
                                       docs/records/check/confusion.json, which goes on where it was interrupted

With --chapter N either does so for chapter N alone, and what it wrote of the others stays.
"""
import json
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Lock

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools"))
import project  # noqa: E402  (found by the line above)
from check import grading  # noqa: E402
from check.likely_mistake import SIGNATURES, rank, read_signatures, signature  # noqa: E402
from planting import OTHER_SCENES, catalogue, own_shader, trials  # noqa: E402
from project import (RECORDS, Parser, UserError, add_device_options, commit, number, read_json, show_progress,  # noqa: E402
                     write_json)

GOES_ON = True
RECORD = RECORDS / "check/confusion.json"
# With seeds that ./lab check never has.
LEARNING = {"runs": 5, "first_seed": 1001, "factor": 2}  # times the samples of a check
LEVELS = {"runs": 12, "first_seed": 2001, "factor": 1}
TRYING = {"runs": 12, "first_seed": 3001, "factor": 1}  # as a check does, with seeds that nothing was learnt from


def settings():
    """What the record of trials depends on, as it stands there."""
    depends = TRYING | {"scenes": grading.SCENES, "options": grading.OPTIONS, "other_scenes": OTHER_SCENES}
    return json.loads(json.dumps(depends))


def settings_of_others(all_settings, chapter):
    """The same without those of a chapter."""
    return {key: {number: value for number, value in values.items() if number != str(chapter)} if isinstance(values, dict) else values
            for key, values in all_settings.items()}


def kept_trials(record, chapter, names):
    """Those of all chapters but the one that is tried anew."""
    if settings_of_others(record["settings"], chapter) != settings_of_others(settings(), chapter):
        raise UserError("the settings of other chapters have changed as well: try all of them, without --chapter")
    return {key: trial for key, trial in record["trials"].items() if key in names}


class Workshop:
    """Judges shaders, several at a time."""

    def __init__(self, options):
        self.options = options

    def settings(self, chapter, plan):
        samples = grading.SCENES[chapter][0] * plan["factor"]
        return {"backend": self.options.backend, "device": self.options.device, "time_limit": 600, "runs": plan["runs"],
                "samples": samples, "first_seed": plan["first_seed"], "is_quiet": True}

    def judge(self, chapter, text, plan, levels=None, scenes=None):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "path_trace.glsl"
            file.write_text(text, encoding="utf-8")
            return grading.judge(chapter, file, self.settings(chapter, plan), levels, scenes)

    def levels(self, chapter, plan, scenes=None):
        cases = grading.render(chapter, own_shader(chapter), self.settings(chapter, plan), scenes)
        return {case["scene"]: grading.level(case) for case in cases}

    def map(self, what, function, items):
        """The results of all items, with progress."""
        started, results = time.monotonic(), []
        with ThreadPoolExecutor(self.options.jobs) as pool:
            for result in pool.map(function, items):
                results.append(result)
                show_progress(what, len(results), len(items), started)
        return results


def rounded(known):
    return {"differences": [round(x, 4) for x in known.differences], "errors": [float(f"{x:.2g}") for x in known.errors],
            "noise": [float(f"{x:.3g}") for x in known.noise], "rays": [float(f"{x:.3g}") for x in known.rays]}


def learn(workshop, scenes):
    """Levels of chapters, and the signatures of their mistakes: chapter -> name -> hint, slide and signature. `scenes` are
    names of references for each chapter."""
    levels = dict(zip(scenes, workshop.map("levels", lambda n: workshop.levels(n, LEVELS, scenes[n]), list(scenes))))
    planted = [item for item in catalogue() if item[0] in scenes]
    results = workshop.map(
        "signatures", lambda item: workshop.judge(item[0], item[2], LEARNING, levels[item[0]], scenes[item[0]]), planted)
    signatures = {chapter: {} for chapter in scenes}
    for (chapter, mistake, _), result in zip(planted, results):
        entry = {key: mistake["check"][key] for key in ("hint", "slide")}
        signatures[chapter][mistake["name"]] = entry | {"signature": rounded(signature(result))}
    return levels, signatures


def write_lines(file, knowledge):
    """JSON with a line for each entry of an entry."""
    blocks = []
    for chapter, entries in knowledge.items():
        lines = ",\n".join(f"  {json.dumps(name)}: {json.dumps(entry, ensure_ascii=False)}" for name, entry in entries.items())
        blocks.append(f' "{chapter}": {{\n{lines}\n }}')
    file.write_text("{\n" + ",\n".join(blocks) + "\n}\n", encoding="utf-8")


def confusion(workshop, chapter):
    record = read_json(RECORD) if RECORD.exists() else {"is_complete": True}
    open_trials = trials()
    if record["is_complete"] or record["settings"] != settings():
        others = {name for name, trial in open_trials.items() if trial[0] != chapter}
        kept = kept_trials(record, chapter, others) if chapter else {}
        record = {"is_complete": False, "commit": commit(), "settings": settings(), "trials": kept}
        levels, signatures = learn(workshop, {n: scenes for n, scenes in OTHER_SCENES.items() if chapter in (None, n)})
        record["other_scenes"] = {"levels": levels, "signatures": signatures}
        write_json(RECORD, record)
    record = json.loads(json.dumps(record))  # numbers of chapters as keys become text, as in a record that was read
    others, known, lock = record["other_scenes"], read_json(SIGNATURES), Lock()  # jobs share the record

    def try_naming(item):
        key, (chapter, name, text) = item
        place = (others["levels"][str(chapter)], OTHER_SCENES[chapter]) if key.startswith("other scenes") else ()
        candidates = read_signatures((others["signatures"] if place else known)[str(chapter)])
        result = workshop.judge(chapter, text, TRYING, *place)
        names = [] if result["verdict"] == "correct" else rank(signature(result), candidates)
        with lock:
            record["trials"][key] = {"mistake": name, "verdict": result["verdict"], "named": names[:3]}
            write_json(RECORD, record)

    workshop.map("naming", try_naming, [item for item in open_trials.items() if item[0] not in record["trials"]])
    del record["other_scenes"]  # no more use
    write_json(RECORD, record | {"is_complete": True})


def main():
    parser = Parser("tests/mistakes/learn.py", __doc__)
    parser.add_argument("action", choices=["learn", "confusion"])
    parser.add_argument("--jobs", type=number(int, 1), default=1, help="shaders that are rendered at a time; default: 1")
    parser.add_argument("--chapter", type=int, choices=grading.SCENES, metavar="N", help="default: all")
    add_device_options(parser)
    options = parser.parse_args()
    workshop = Workshop(options)
    if options.action == "confusion":
        confusion(workshop, options.chapter)
        return
    learnt = learn(workshop, {n: scenes for n, (_, scenes) in grading.SCENES.items() if options.chapter in (None, n)})
    for file, knowledge in zip((grading.LEVELS, SIGNATURES), learnt):
        before = read_json(file) if options.chapter else {}
        write_lines(file, before | {str(chapter): entry for chapter, entry in knowledge.items()})


if __name__ == "__main__":
    project.run_tool(sys.modules[__name__])
