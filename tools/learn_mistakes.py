#!/usr/bin/env python3
"""Teaches ./lab check what the mistakes of tests/mistakes/mistakes.json do, and measures how often it names them right.

    tools/learn_mistakes.py learn      renders the chapters' own shaders and each mistake planted in them; writes
                                       tools/check_levels.json and tools/mistake_signatures.json
    tools/learn_mistakes.py confusion  plants each mistake again and lets it be named: with new seeds, in the differently
                                       written shaders of tests/variants, and on scenes that check does not use; writes
                                       docs/records/check/confusion.json, which goes on where it was interrupted
"""
import argparse
import json
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import grading
from command_line import Parser, add_device_options, at_least, run_resumable
from likely_mistake import SIGNATURES, rank, read_signatures, signature
from measurement import commit
from planting import OTHER_SCENES, ROOT, Stale, catalogue, own_shader, trials
from progress import show_progress
from scene_reader import UserError

RECORD = ROOT / "docs/records/check/confusion.json"
LEARNING = {"runs": 5, "seed": 1000, "factor": 2}  # times the samples of a check
LEVELS = {"runs": 12, "seed": 2000, "factor": 1}
TRYING = {"runs": 12, "seed": 3000, "factor": 1}  # as a check does, with seeds that nothing was learnt from


class Workshop:
    """Judges shaders, several at a time."""

    def __init__(self, options):
        self.options = options

    def settings(self, chapter, plan):
        samples = grading.SCENES[chapter][0] * plan["factor"]
        return {"backend": self.options.backend, "device": self.options.device, "time_limit": 600, "runs": plan["runs"],
                "samples": samples, "seed": plan["seed"], "is_quiet": True}

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


def confusion(workshop):
    record = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {"is_complete": True}
    open_trials = trials()
    if record["is_complete"]:
        record = {"is_complete": False, "commit": commit(), "settings": TRYING, "trials": {}}
        levels, signatures = learn(workshop, OTHER_SCENES)
        record["other_scenes"] = {"levels": levels, "signatures": signatures}
        save(record)
    record = json.loads(json.dumps(record))  # numbers of chapters as keys become text, as in a record that was read
    others, known = record["other_scenes"], json.loads(SIGNATURES.read_text(encoding="utf-8"))

    def try_naming(item):
        key, (chapter, name, text) = item
        place = (others["levels"][str(chapter)], OTHER_SCENES[chapter]) if key.startswith("other scenes") else ()
        candidates = read_signatures((others["signatures"] if place else known)[str(chapter)])
        result = workshop.judge(chapter, text, TRYING, *place)
        names = [] if result["verdict"] == "correct" else rank(signature(result), candidates)
        record["trials"][key] = {"mistake": name, "verdict": result["verdict"], "named": names[:3]}
        save(record)

    workshop.map("naming", try_naming, [item for item in open_trials.items() if item[0] not in record["trials"]])
    del record["other_scenes"]  # no more use
    save(record | {"is_complete": True})


def save(record):
    RECORD.parent.mkdir(parents=True, exist_ok=True)
    RECORD.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def main():
    parser = Parser(prog="tools/learn_mistakes.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=["learn", "confusion"])
    parser.add_argument("--jobs", type=at_least(1, int), default=1, help="shaders that are rendered at a time; default: 1")
    add_device_options(parser)
    options = parser.parse_args()
    workshop = Workshop(options)
    if options.action == "confusion":
        confusion(workshop)
        return
    levels, signatures = learn(workshop, {chapter: scenes for chapter, (_, scenes) in grading.SCENES.items()})
    write_lines(grading.LEVELS, levels)
    write_lines(SIGNATURES, signatures)


if __name__ == "__main__":
    run_resumable(main, (UserError, Stale))
