"""Grades a shader of chapter N: is it correct, biased, or noisier or more expensive than its technique should be?

Renders scenes that have a reference image, each several times. The means of the whole image
and of its tiles are tested against the reference: a correct shader is called biased in one of 1000 checks. Error and rays
are compared with those of the chapter's own shader: too much is 1.5 times. What is wrong is compared with what common
mistakes do to the pictures: the likely one is named, with a question to think about and the slide to read again.

Exit code: 0 correct, 1 biased, noisy or expensive, 2 cannot be graded.
"""
import json
import sys
import traceback
from pathlib import Path

import matplotlib

matplotlib.use("agg")
import numpy as np
from check.grading import MOST_RUNS, SCENES, first_seed, judge
from check.likely_mistake import likely_mistake
from matplotlib import pyplot
from project import CHAPTERS, ROOT, Parser, UserError, add_device_options, description, number

UNGRADED = 2  # exit code


def parse():
    parser = Parser("./lab check", __doc__)
    parser.add_argument("chapter", type=number(int, 1), metavar="N", help="number of the chapter")
    parser.add_argument("file", nargs="?", type=Path, metavar="FILE", help="default: the chapter's path_trace.glsl")
    add_device_options(parser)
    parser.add_argument("--seed", type=number(int, 0, 400000), default=0,
                        help="each chooses other random numbers; default: 0")
    parser.add_argument("--runs", type=number(int, 2, MOST_RUNS), default=12, help="of each scene; default: 12")
    parser.add_argument("--samples", type=number(int, 1), help="of each run; default: 16 to 64, as the chapter needs")
    parser.add_argument("--time-limit", type=number(float, 0.1), default=30.0, metavar="SECONDS",
                        help="for each run, after which it is ended; default: 30")
    parser.add_argument("--json", action="store_true", dest="is_quiet", help="print the result as JSON")
    return parser.parse_intermixed_args()


def check(options):
    """The result of a check; UserError where there is none."""
    if options.chapter not in SCENES or options.chapter not in CHAPTERS:
        raise UserError(f"there is no chapter {options.chapter} to be checked: ./lab check N FILE grades a file as chapter N's")
    if options.samples and description(CHAPTERS[options.chapter]).get("low_discrepancy"):
        raise UserError(f"--samples: in chapter {options.chapter} the error of a sample depends on how many there are: leave it out")
    file = options.file or ROOT / "chapters" / CHAPTERS[options.chapter] / "path_trace.glsl"
    if not file.is_file():
        raise UserError(f"{file}: no such file")
    result = judge(options.chapter, file, vars(options) | {"first_seed": first_seed(options.seed)})
    result["unfinished_line"] = find_todo(file) if result["verdict"] != "correct" else None
    result["likely_mistake"] = likely_mistake(result) if result["unfinished_line"] is None else None
    if result["verdict"] == "biased":
        result["picture"] = str(draw(result))
    return result


def find_todo(file):
    """Number of the first line that is still to be written, or None."""
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    return next((number for number, line in enumerate(lines, 1) if "TODO" in line), None)


def draw(result):
    """Where in the images: each tile's difference from the reference; those that are sure have a frame."""
    figure, axes = pyplot.subplots(1, len(result["scenes"]), figsize=(4.2 * len(result["scenes"]), 4.4), layout="constrained")
    limit = min(1, max(abs(tile["value"]) for scene in result["scenes"] for tile in scene["tiles"]))
    for axis, scene in zip(axes, result["scenes"]):
        rows, columns = (max(tile[key] for tile in scene["tiles"]) + 1 for key in ("row", "column"))
        values = np.array([100 * tile["value"] for tile in scene["tiles"]]).reshape(rows, columns)
        image = axis.imshow(values, cmap="RdBu_r", vmin=-100 * limit, vmax=100 * limit)
        for tile in (tile for tile in scene["tiles"] if tile["is_biased"]):
            axis.add_patch(pyplot.Rectangle((tile["column"] - 0.46, tile["row"] - 0.46), 0.92, 0.92, fill=False, lw=1.2))
        axis.set_title(f"{scene['scene']}: {scene['verdict']}", fontsize=10)
        axis.set_axis_off()
    figure.colorbar(image, ax=axes, label="difference of a tile from the reference, %", shrink=0.8, extend="both")
    path = ROOT / f"output/check_{result['chapter']}.png"
    path.parent.mkdir(exist_ok=True)
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
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
    if result["unfinished_line"]:
        print(f"{'unfinished':14} line {result['unfinished_line']} says TODO")
    if result["likely_mistake"]:
        print(f"{'likely cause':14} {result['likely_mistake']['name']}: {result['likely_mistake']['hint']}")
        print(f"{'read again':14} {result['likely_mistake']['slide']} (slides or blog)")
    print(f"chapter {result['chapter']:<6} {result['verdict']}: {result['file']}")


def main():
    try:
        options = parse()
        result = check(options)
    except SystemExit as end:  # of the parser
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
        sys.exit(UNGRADED if end.code else 0)
    except (UserError, OSError, KeyboardInterrupt) as error:
        message = "interrupted" if isinstance(error, KeyboardInterrupt) else str(error)
        if options.is_quiet:
            print(json.dumps({"chapter": options.chapter, "verdict": "not graded", "error": message}))
        print(f"error: {message}", file=sys.stderr)
        sys.exit(UNGRADED)
    except Exception:  # Python's exit code would be that of a biased shader
        traceback.print_exc()
        sys.exit(UNGRADED)
    print(json.dumps(result, indent=1)) if options.is_quiet else explain(result)
    sys.exit(result["verdict"] != "correct")
