#!/usr/bin/env python3
"""Grades a shader of chapter N: is it correct, biased, or noisier or more expensive than its technique should be?

Renders scenes that have a reference image, each several times with seeds SEED+1, SEED+2, … The means of the whole image
and of its tiles are tested against the reference: a correct shader is called biased in one of 1000 checks. Error and rays
are compared with those of the chapter's own shader, as recorded in tools/check_levels.json: too much is 1.5 times.

Exit code: 0 correct, 1 biased, noisy or expensive, 2 cannot be graded.
"""
import argparse
import json
import shutil
import signal
import sys
import tempfile
import time
import traceback
from pathlib import Path

try:
    import numpy as np
    from command_line import Parser, add_device_options, at_least
    from measurement import BINARIES, CHAPTERS, new_case, run_case
    from progress import show_progress
    from reference_image import ROOT, find_references, read_reference, read_rgb
    from report_numbers import FALSE_ALARMS as FALSE_ALARMS_OF_REPORTS
    from report_numbers import bias, estimate, mean_of, ratio
    from scene_reader import UserError
except ImportError as error:
    sys.exit(f"error: {error}: ./lab check needs the Python packages numpy and matplotlib")

LEVELS = ROOT / "tools/check_levels.json"
# For each chapter: samples of a run, and references that show what its shader does.
SCENES = {
    1: (64, ["cornell_box_6", "textured_4", "glossy_5"]),
    2: (64, ["cornell_box_6", "textured_4", "glossy_5"]),
    3: (32, ["cornell_box_6", "textured_4", "heart_light_4"]),
    4: (12, ["cornell_box_6", "textured_4", "heart_light_4"]),
    5: (16, ["cornell_box_6", "textured_4", "glossy_5"]),
    6: (16, ["cornell_box_6", "textured_4", "glass_8"]),
}
TILE = 16  # pixels
FALSE_ALARMS = 0.001  # of all checks of correct shaders
TOO_MUCH = 1.5  # times the error of a sample or its rays
UNGRADED = 2  # exit code


def parse():
    parser = Parser(prog="./lab check", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("chapter", type=at_least(1, int), metavar="N", help="number of the chapter")
    parser.add_argument("file", nargs="?", type=Path, metavar="FILE", help="default: the chapter's path_trace.glsl")
    add_device_options(parser)
    parser.add_argument("--seed", type=at_least(0, int), default=0, help="default: 0")
    parser.add_argument("--runs", type=at_least(2, int), default=12, help="of each scene; default: 12")
    parser.add_argument("--samples", type=at_least(1, int), help="of each run; default: 12 to 64, as the chapter needs")
    parser.add_argument("--time-limit", type=at_least(0.1, float), default=30.0, metavar="SECONDS",
                        help="for each run, after which it is ended; default: 30")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")
    parser.add_argument("--record", action="store_true",
                        help="write error and rays of this shader to tools/check_levels.json: the others' yardstick")
    return parser.parse_intermixed_args()


def make_tree(chapter, file, tree):
    """Copies what a chapter's program reads, with `file` as its shader; returns the program there."""
    shutil.copytree(ROOT / "shaders", tree / "shaders")
    shutil.copytree(ROOT / "chapters" / chapter, tree / "chapters" / chapter)
    shutil.copy(file, tree / "chapters" / chapter / "path_trace.glsl")
    (tree / "assets").symlink_to(ROOT / "assets")
    (tree / "bin").mkdir()
    return shutil.copy(BINARIES / chapter, tree / "bin" / chapter)  # a program looks for shaders above itself


def regions(image):
    """Means of red, green and blue over the whole image [3], and of all channels over its tiles [rows * columns]."""
    height, width, _ = image.shape
    tiles = image.mean(axis=2).reshape(height // TILE, TILE, width // TILE, TILE).mean(axis=(1, 3))
    return [*image.mean(axis=(0, 1)).tolist(), *tiles.ravel().tolist()]


def reference_regions(file):
    """The same of a reference, as report_numbers.bias() wants it. Pixels and channels of the reference have errors of
    their own; those of channels may go together, at worst completely."""
    reference = read_reference(file)
    height, width, _ = reference.mean.shape
    deviation = np.sqrt(reference.variance).mean(axis=2, keepdims=True)
    variance = regions(reference.variance)[:3] + regions(deviation**2)[1:]
    pixels = [height * width] * 3 + [TILE**2] * (len(variance) - 3)
    return {"mean": regions(reference.mean), "variance": [v / n for v, n in zip(variance, pixels)],
            "freedom": max(int(reference.attributes.get("batches", 2)) - 1, 1)}


def render(cases, options, samples, folder, rename):
    """Adds to each case its runs: a row each, with the means of the regions."""
    settings = {"backend": options.backend, "device": options.device, "time_limit": options.time_limit}
    total, started = options.runs * len(cases), time.monotonic()
    for run in range(options.runs):
        for i, case in enumerate(cases):
            picture = folder / "picture.exr"
            try:
                report = run_case(case, settings, ["--samples", samples, "--seed", options.seed + run + 1, "--output", picture])
            except UserError as error:
                raise UserError(rename(str(error))) from None
            row = report["rows"][-1]
            row["mean"] = regions(read_rgb(picture))
            case["runs"].append({"rows": [row]})
            case["invalid_samples"] = case.get("invalid_samples", 0) + report["invalid_samples"]
            if not options.json:
                show_progress(case["scene"], run * len(cases) + i + 1, total, started)


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
    tests = [bias(case["runs"], region, reference, comparisons) for region in range(len(reference["mean"]))]
    noise = ratio(estimate(now["rel_mse"]), estimate(recorded["rel_mse"]))
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


def judge(options):
    """The result of a check; UserError where there is none."""
    programs = {int(name[:2]): name for name in CHAPTERS}
    if options.chapter not in SCENES or options.chapter not in programs:
        raise UserError(f"there is no chapter {options.chapter} to be checked; ./lab run lists them")
    chapter = programs[options.chapter]
    file = options.file or ROOT / "chapters" / chapter / "path_trace.glsl"
    if not file.is_file():
        raise UserError(f"{file}: no such file")
    samples, scenes = SCENES[options.chapter]
    samples = options.samples or samples
    with tempfile.TemporaryDirectory() as folder:
        program = make_tree(chapter, file, Path(folder))
        cases = [new_case(*pair, f"chapter {options.chapter}", program) for pair in find_references(scenes)]
        shader = str(Path(folder).resolve() / "chapters" / chapter / "path_trace.glsl")
        render(cases, options, samples, Path(folder), lambda text: text.replace(shader, str(file)))
    levels = json.loads(LEVELS.read_text(encoding="utf-8")) if LEVELS.exists() else {}
    if options.record:
        levels[str(options.chapter)] = {case["scene"]: level(case) for case in cases}
        LEVELS.write_text(json.dumps(levels, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    results = [grade(case, levels[str(options.chapter)][case["scene"]], len(cases)) for case in cases]
    verdicts = [result["verdict"] for result in results]
    verdict = next(word for word in ("biased", "noisy", "expensive", "correct") if word in verdicts)
    result = {"chapter": options.chapter, "file": str(file), "verdict": verdict, "runs": options.runs, "samples": samples,
              "seed": options.seed, "false_alarms": FALSE_ALARMS, "too_much": TOO_MUCH, "picture": None, "scenes": results}
    if verdict == "biased":
        result["picture"] = str(draw(result))
    return result


def draw(result):
    """Where in the images: each tile's difference from the reference; those that are sure have a frame."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(1, len(result["scenes"]), figsize=(4.2 * len(result["scenes"]), 4.4), layout="constrained")
    limit = min(1, max(abs(tile["value"]) for scene in result["scenes"] for tile in scene["tiles"]))
    for axis, scene in zip(axes, result["scenes"]):
        rows, columns = (max(tile[key] for tile in scene["tiles"]) + 1 for key in ("row", "column"))
        values = np.array([100 * tile["value"] for tile in scene["tiles"]]).reshape(rows, columns)
        image = axis.imshow(values, cmap="RdBu_r", vmin=-100 * limit, vmax=100 * limit)
        for tile in (tile for tile in scene["tiles"] if tile["is_biased"]):
            axis.add_patch(plt.Rectangle((tile["column"] - 0.46, tile["row"] - 0.46), 0.92, 0.92, fill=False, lw=1.2))
        axis.set_title(f"{scene['scene']}: {scene['verdict']}", fontsize=10)
        axis.set_axis_off()
    figure.colorbar(image, ax=axes, label="difference of a tile from the reference, %", shrink=0.8, extend="both")
    path = ROOT / f"output/check_{result['chapter']}.png"
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, dpi=110)
    plt.close(figure)
    return path.relative_to(ROOT)


def percent(value):
    return f"{100 * value:+.2g} %" if abs(value) < 0.1 else f"{100 * value:+.0f} %"


def explain(result):
    """The result as text, a line for each scene."""
    for scene in result["scenes"]:
        worst = max(scene["image"], key=lambda test: abs(test["value"]))
        biased = [tile for tile in scene["tiles"] if tile["is_biased"]]
        words = [f"mean {' '.join(percent(test['value']) for test in scene['image'])} (red, green, blue)"]
        if any(test["is_biased"] for test in scene["image"]):
            words.append("too bright" if worst["value"] > 0 else "too dark")
        if biased:
            words.append(f"{len(biased)} of {len(scene['tiles'])} tiles differ")
        if scene["invalid_samples"]:
            words.append(f"{scene['invalid_samples']} samples infinite or not a number")
        if scene["verdict"] != "biased":
            least = max(test["detectable"] for test in scene["image"])
            words.append(f"a bias from {100 * least:.2g} % would have shown")
            if scene["noise"][0] is not None:
                words.append(f"noise x {scene['noise'][0]:.2f} [{scene['noise'][1]:.2f}, {scene['noise'][2]:.2f}]")
            words.append(f"rays x {scene['rays']:.2f}")
        print(f"{scene['scene']:14} {scene['verdict']}: {', '.join(words)}")
    if result["picture"]:
        print(f"{'where':14} {result['picture']}")
    print(f"chapter {result['chapter']:<6} {result['verdict']}: {result['file']}")


def main():
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        options = parse()
    except SystemExit as end:
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
        sys.exit(UNGRADED if end.code else 0)
    try:
        result = judge(options)
    except (UserError, OSError) as error:
        if options.json:
            print(json.dumps({"chapter": options.chapter, "verdict": "not graded", "error": str(error)}))
        print(f"error: {error}", file=sys.stderr)
        sys.exit(UNGRADED)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(UNGRADED)
    print(json.dumps(result, indent=1)) if options.json else explain(result)
    sys.exit(result["verdict"] != "correct")


if __name__ == "__main__":
    try:
        main()
    except Exception:  # Python's exit code would be that of a biased shader
        traceback.print_exc()
        sys.exit(UNGRADED)
