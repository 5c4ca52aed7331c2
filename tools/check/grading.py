"""Grades a shader of a chapter: renders scenes that have a reference image and judges bias, noise and cost.

Means of the whole image and of its tiles are tested against the reference. Error and rays are compared with those of the
chapter's own shader, as recorded in levels.json.
"""
import os
import shutil
import tempfile
import time
from pathlib import Path

import numpy as np
from project import BINARIES, CHAPTERS, ROOT, UserError, description, program_file, read_json, show_progress
from references.images import find_references, read_reference, read_rgb
from report.measurement import new_case, run_case
from report.numbers import FALSE_ALARMS as FALSE_ALARMS_OF_REPORTS
from report.numbers import Series, biases, mean_of, ratio

LEVELS = Path(__file__).with_name("levels.json")
# For each chapter: samples of a run, and references that show what its shader does.
ROOM = ["check_room_2", "check_room_6"]
SCENES = {
    1: (48, [*ROOM, "textured_4"]),
    2: (48, [*ROOM, "textured_4"]),
    3: (24, [*ROOM, "textured_4"]),
    4: (10, [*ROOM, "textured_4"]),
    5: (16, [*ROOM, "textured_4"]),
    6: (16, [*ROOM, "check_glass_8"]),
    7: (16, ["check_room_6", "plates_3", "check_glass_8"]),
    8: (12, ["check_room_6", "textured_4", "sunny_4"]),
    9: (32, ["check_room_6", "cornell_box_1", "textured_4"]),
    10: (32, ["check_room_6", "textured_4", "sunny_4"]),
}
# Roulette from the first bounce on and with a cap that matters: otherwise both hardly show.
ROULETTE = ["--roulette-start", "1", "--survival-cap", "0.35"]
OPTIONS = {number: ROULETTE if "--roulette-start" in description(CHAPTERS[number]).get("options", []) else []
           for number in SCENES if number in CHAPTERS}
TILE = 16  # pixels
FALSE_ALARMS = 0.001  # of all checks of correct shaders
TOO_MUCH = 1.5  # times the error of a sample or its rays
MOST_RUNS, SEED_STEP = 1000, 10000
VERDICTS = ("biased", "noisy", "expensive", "correct")  # the first of any scene counts


def first_seed(seed):
    """Of the runs of a check with this --seed: checks with different ones share no render. None has the seeds from MOST_RUNS + 1
    to SEED_STEP: with those the chapters' levels and the signatures of mistakes were measured."""
    return seed * SEED_STEP + 1


def make_tree(chapter, file, tree):
    """Copies what a chapter's program reads, with `file` as its shader; returns the program there and its shader."""
    shutil.copytree(ROOT / "shaders", tree / "shaders")
    shutil.copytree(ROOT / "chapters" / chapter, tree / "chapters" / chapter)
    shader = Path(shutil.copy(file, tree / "chapters" / chapter / "path_trace.glsl"))
    share(ROOT / "assets", tree / "assets")
    if (libraries := BINARIES.parent / "lib").exists():  # of an archive that ./lab package made
        share(libraries, tree / "lib")
    (tree / "bin").mkdir()
    return shutil.copy(program_file(chapter), tree / "bin"), shader  # a program looks for shaders above itself


def share(folder, place):
    """Windows lets few people make links."""
    place.symlink_to(folder) if os.name == "posix" else shutil.copytree(folder, place)


def regions(image):
    """Means of red, green and blue over the whole image [3], and of all channels over its tiles [rows * columns]."""
    height, width, _ = image.shape
    tiles = image.mean(axis=2).reshape(height // TILE, TILE, width // TILE, TILE).mean(axis=(1, 3))
    return [*image.mean(axis=(0, 1)).tolist(), *tiles.ravel().tolist()]


def reference_regions(file):
    """The same of a reference, as biases() wants it. Pixels and channels of the reference have errors of
    their own; those of channels may go together, at worst completely."""
    reference = read_reference(file)
    height, width, _ = reference.mean.shape
    deviation = np.sqrt(reference.variance).mean(axis=2, keepdims=True)
    variance = regions(reference.variance)[:3] + regions(deviation**2)[1:]
    pixels = [height * width] * 3 + [TILE**2] * (len(variance) - 3)
    return {"mean": regions(reference.mean), "variance": [v / n for v, n in zip(variance, pixels)],
            "freedom": reference.freedom}


def render(chapter, file, settings, scenes=None):
    """Cases with their runs, each a row with the means of the regions. `settings`: backend, device, time_limit, runs,
    samples, first_seed and is_quiet; `scenes` are names of references."""
    samples, own_scenes = SCENES[chapter]
    samples = settings["samples"] or samples
    with tempfile.TemporaryDirectory() as folder:
        program, shader = make_tree(CHAPTERS[chapter], file, Path(folder))
        cases = [new_case(*pair, f"chapter {chapter}", program, OPTIONS[chapter])
                 for pair in find_references(scenes or own_scenes)]
        picture, total, started = Path(folder) / "picture.exr", settings["runs"] * len(cases), time.monotonic()
        for run in range(settings["runs"]):
            for i, case in enumerate(cases):
                try:
                    report = run_case(case, settings,
                                      ["--samples", samples, "--seed", settings["first_seed"] + run, "--output", picture])
                except UserError as error:
                    raise UserError(str(error).replace(str(shader.resolve()), str(file))) from None
                row = report["rows"][-1]
                row["mean"] = regions(read_rgb(picture))
                case["runs"].append({"seed": run, "rows": [row]})
                case["invalid_samples"] = case.get("invalid_samples", 0) + report["invalid_samples"]
                if not settings["is_quiet"]:
                    show_progress(case["scene"], run * len(cases) + i + 1, total, started)
    return cases


def level(case):
    """What the technique needs: rel_mse of a single sample, from each run, and rays of a sample."""
    rows = [run["rows"][-1] for run in case["runs"]]
    pixels = case["width"] * case["height"]
    return {"rel_mse": [row["rel_mse"] * row["samples"] for row in rows],
            "rays": mean_of(rows, "rays") / rows[0]["samples"] / pixels}


def grade(case, recorded, comparisons):
    """The verdict on a scene, with the numbers that it follows from."""
    reference, now = reference_regions(ROOT / case["reference_file"]), level(case)
    comparisons *= len(reference["mean"]) * FALSE_ALARMS_OF_REPORTS / FALSE_ALARMS
    tests = biases(case["runs"], reference, comparisons)
    noise = ratio(*(Series(dict(enumerate(level["rel_mse"]))) for level in (now, recorded)))
    rays = now["rays"] / recorded["rays"]
    if case["invalid_samples"] or any(test["is_biased"] for test in tests):
        verdict = "biased"
    elif noise[1] is not None and noise[1] > TOO_MUCH:
        verdict = "noisy"
    else:
        verdict = "expensive" if rays > TOO_MUCH else "correct"
    columns = case["width"] // TILE
    tiles = [{"row": i // columns, "column": i % columns, **test} for i, test in enumerate(tests[3:])]
    return {"scene": case["scene"], "verdict": verdict, "invalid_samples": case["invalid_samples"], "image": tests[:3],
            "tiles": tiles, "noise": noise, "rays": rays}


def read_levels():
    """Chapter -> scene -> level of the chapter's own shader."""
    return read_json(LEVELS)


def judge(chapter, file, settings, levels=None, scenes=None):
    """The verdict on a shader and on each scene; UserError where there is none."""
    cases = render(chapter, file, settings, scenes)
    levels = levels or read_levels()[str(chapter)]
    results = [grade(case, levels[case["scene"]], len(cases)) for case in cases]
    verdict = next(word for word in VERDICTS if word in {result["verdict"] for result in results})
    return {"chapter": chapter, "file": str(file), "verdict": verdict, "runs": settings["runs"],
            "samples": settings["samples"] or SCENES[chapter][0], "first_seed": settings["first_seed"], "false_alarms": FALSE_ALARMS,
            "too_much": TOO_MUCH, "picture": None, "likely_mistake": None, "scenes": results}
