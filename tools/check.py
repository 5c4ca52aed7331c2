#!/usr/bin/env python3
"""Grades a shader of chapter N: is it correct, biased, or noisier or more expensive than its technique should be?

Renders scenes that have a reference image, each several times with seeds SEED+1, SEED+2, … The means of the whole image
and of its tiles are tested against the reference: a correct shader is called biased in one of 1000 checks. Error and rays
are compared with those of the chapter's own shader: too much is 1.5 times. What is wrong is compared with what common
mistakes do to the pictures: the likely one is named, with a question to think about and the slide to read again.

Exit code: 0 correct, 1 biased, noisy or expensive, 2 cannot be graded.
"""
import argparse
import json
import signal
import sys
import traceback
from pathlib import Path

try:
    import numpy as np
    from command_line import Parser, add_device_options, at_least
    from grading import SCENES, judge, programs
    from likely_mistake import likely_mistake
    from reference_image import ROOT
    from scene_reader import UserError
except ImportError as error:
    sys.exit(f"error: {error}: ./lab check needs the Python packages numpy and matplotlib")

UNGRADED = 2  # exit code


def parse():
    parser = Parser(prog="./lab check", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("chapter", type=at_least(1, int), metavar="N", help="number of the chapter")
    parser.add_argument("file", nargs="?", type=Path, metavar="FILE", help="default: the chapter's path_trace.glsl")
    add_device_options(parser)
    parser.add_argument("--seed", type=at_least(0, int), default=0, help="default: 0")
    parser.add_argument("--runs", type=at_least(2, int), default=12, help="of each scene; default: 12")
    parser.add_argument("--samples", type=at_least(1, int), help="of each run; default: 16 to 64, as the chapter needs")
    parser.add_argument("--time-limit", type=at_least(0.1, float), default=30.0, metavar="SECONDS",
                        help="for each run, after which it is ended; default: 30")
    parser.add_argument("--json", action="store_true", dest="is_quiet", help="print the result as JSON")
    return parser.parse_intermixed_args()


def check(options):
    """The result of a check; UserError where there is none."""
    if options.chapter not in SCENES or options.chapter not in programs():
        raise UserError(f"there is no chapter {options.chapter} to be checked: ./lab check N FILE grades a file as chapter N's")
    file = options.file or ROOT / "chapters" / programs()[options.chapter] / "path_trace.glsl"
    if not file.is_file():
        raise UserError(f"{file}: no such file")
    result = judge(options.chapter, file, vars(options))
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
    if result["unfinished_line"]:
        print(f"{'unfinished':14} line {result['unfinished_line']} says TODO")
    if result["likely_mistake"]:
        print(f"{'likely cause':14} {result['likely_mistake']['name']}: {result['likely_mistake']['hint']}")
        print(f"{'read again':14} {result['likely_mistake']['slide']} (slides or blog)")
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
        result = check(options)
    except (UserError, OSError) as error:
        if options.is_quiet:
            print(json.dumps({"chapter": options.chapter, "verdict": "not graded", "error": str(error)}))
        print(f"error: {error}", file=sys.stderr)
        sys.exit(UNGRADED)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(UNGRADED)
    print(json.dumps(result, indent=1)) if options.is_quiet else explain(result)
    sys.exit(result["verdict"] != "correct")


if __name__ == "__main__":
    try:
        main()
    except Exception:  # Python's exit code would be that of a biased shader
        traceback.print_exc()
        sys.exit(UNGRADED)
