"""The bug gallery: shaders with a mistake in them, to be found by looking.

    ./lab bug 3             lists the bugs of chapter 3, without their names
    ./lab bug 3 2           renders the second one next to the right picture, with the same random numbers: output/bug_3_2.png
    ./lab bug 3 2 --answer  explains what is wrong, in which line, and what catches it
    ./lab bug 11 15 --sanitize  lets a sanitizer look for it, as docs/debugging.md says

The picture shows right, wrong and their difference: red is too bright, blue too dark. The verdict compares its mean with the
reference image, or with the right picture where the scene has none.
"""
import math
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from check.grading import OPTIONS, SCENES, TILE, TOO_MUCH
from check.submission import replaced
from check.words import percent
from course.mistakes import bugs_of
from lesson import diff
from project import (
    CHAPTERS,
    ROOT,
    Parser,
    UserError,
    add_device_options,
    has_low_discrepancy,
    number,
    program_file,
    show_progress,
    text_of,
)
from references.images import averaged, find_references, read_rgb, scene_file
from report.measurement import new_case, run_case
from report.numbers import batches, biases, last_rows, mean_of, runs_in_batches

SCALE = 2  # pixels per row for each of the reference's
SCRAMBLES = 4  # with low-discrepancy points
COLOURS = ("red", "green", "blue")


def parse():
    parser = Parser("./lab bug", __doc__)
    parser.add_argument("chapter", type=number(int, 1), metavar="N", help="number of the chapter")
    parser.add_argument("bug", type=number(int, 1), nargs="?", metavar="I", help="number of the bug; default: list them")
    parser.add_argument("--answer", action="store_true", help="tell what is wrong")
    parser.add_argument("--window", action="store_true", help="open the chapter with the bug in its window")
    parser.add_argument("--sanitize", action="store_true", help="let the sanitizer look for it")
    parser.add_argument("--scene", help="name or file; default: of the scenes of ./lab check, where the bug shows most")
    parser.add_argument("--samples", type=number(int, 4), help="per pixel; default: twice those of a run of ./lab check")
    add_device_options(parser)
    return parser.parse_intermixed_args()


def find_scene(word):
    """A scene's file and its reference, or None if there is none."""
    try:
        return find_references([word])[0]
    except UserError:
        if not scene_file(word).is_file():
            raise
        return scene_file(word), None


def new_render(chapter, scene, options=()):
    """What to render: with the path length of the reference, and SCALE times as large. Options of the chapter's own show something
    else than the reference does."""
    file, reference = find_scene(scene)
    case = new_case(file, None if options else reference, f"chapter {chapter}", CHAPTERS[chapter], [*OPTIONS[chapter], *options])
    return case | {"width": SCALE * case["width"], "height": SCALE * case["height"], "scale": SCALE if case["reference"] else 1}


def render(case, samples, options, shaders):
    """Adds runs with these options --shader to a case; returns the mean image. With correlated samples, several runs are needed for the error."""
    runs = min(SCRAMBLES, samples) if has_low_discrepancy(case["program"]) else 1
    case |= {"runs": [], "invalid_samples": 0}
    pictures = []
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "picture.exr"
        for seed in range(1, runs + 1):
            report = run_case(
                case, vars(options) | {"shaders": shaders}, ["--samples", samples // runs, "--seed", seed, "--output", picture]
            )
            case["runs"].append({"seed": seed, "rows": report["rows"]})
            case["invalid_samples"] += report["invalid_samples"]
            pictures.append(read_rgb(picture))
    return np.mean(pictures, axis=0)


def shown_by(bug):
    """The options without which a bug does not show."""
    return bug.mistake.get("options", "").split()


def telling_scene(bug, planted, options):
    """The scene of ./lab check whose picture the bug changes most, judged by the means of tiles with a single sample per
    pixel."""

    def change(scene):
        right, wrong = (
            averaged(render(new_render(bug.chapter, scene, shown_by(bug)), 1, options, shaders), SCALE * TILE)
            for shaders in ([], planted)
        )
        return np.abs(wrong - right).mean() / right.mean()

    return max(SCENES[bug.chapter][1], key=change)


def as_reference(case):
    """The mean of a render in the form that biases() needs, for scenes without a reference."""
    counts, means = batches(runs_in_batches(case))
    mean, freedom = counts @ means / counts.sum(), len(counts) - 1
    return {"mean": mean, "variance": counts @ (means - mean) ** 2 / freedom / counts.sum(), "freedom": freedom}


def verdict(right, wrong):
    """How two cases with these sample counts differ, in one line."""
    if wrong["invalid_samples"]:
        return f"broken: {wrong['invalid_samples']} samples infinite or not a number"
    tests = biases(runs_in_batches(wrong), wrong["reference"] or as_reference(right), len(COLOURS))
    means = ", ".join(
        f"{colour} {percent(test['value'])} ± {100 * test['half_width']:.2g} %" for colour, test in zip(COLOURS, tests)
    )
    means += "" if wrong["reference"] else " against the right picture, since the scene has no reference"
    if any(test["is_biased"] for test in tests):
        return f"biased: {means}"
    for key, text in (
        ("rel_mse", "noisy: {:.1f} times the error of the right picture"),
        ("rays", "expensive: {:.1f} times its rays"),
    ):
        now, own = (mean_of(last_rows(case["runs"]), key) for case in (wrong, right))
        if (now or 0) > TOO_MUCH * (own or math.inf):  # a noise-free picture has no noise to compare with
            return f"{text.format(now / own)}, the mean agrees: {means}"
    return f"nothing shows: {means}; a bias from {100 * max(test['detectable'] for test in tests):.2g} % would show"


def show(bug, index, scene, planted, options):
    """Renders with the right shader and with the wrong one, and says what to look for."""
    samples, started = options.samples or 2 * SCENES[bug.chapter][0], time.monotonic()
    cases = [new_render(bug.chapter, scene, shown_by(bug)) for _ in range(2)]
    images = []
    for case, shaders in zip(cases, ([], planted)):
        images.append(render(case, samples, options, shaders))
        show_progress(f"{('right', 'wrong')[len(images) - 1]} picture of {case['scene']}", len(images), len(cases), started)
    path = ROOT / f"output/bug_{bug.chapter}_{index}.png"
    path.parent.mkdir(exist_ok=True)
    from report.plots import right_and_wrong  # imported late: Matplotlib takes longer to load than everything else

    right_and_wrong(path, *images)
    taken = sum(row["samples"] for row in last_rows(cases[0]["runs"]))
    for name, text in (
        ("scene", f"{cases[0]['scene']}, {taken} samples per pixel"),
        ("verdict", verdict(*cases)),
        ("question", bug.question),
        ("picture", path.relative_to(ROOT)),
    ):
        print(f"{name:10} {text}")


def open_window(bug, scene, planted, options):
    """Shows the chapter with the bug, until its window is closed."""
    case = new_render(bug.chapter, scene, shown_by(bug))
    length = ["--max-path-length", case["max_path_length"]] if case["reference"] else []
    command = [
        program_file(case["program"]),
        ROOT / case["scene_file"],
        "--window",
        *planted,
        *length,
        *case["options"].split(),
        "--backend",
        options.backend,
        *(["--device", options.device] if options.device else []),
    ]
    result = subprocess.run(list(map(str, command)))
    if result.returncode != 0:
        raise UserError(f"the window of chapter {bug.chapter} ended with exit code {result.returncode}")


def sanitize(bug, planted, options):
    """Prints what the sanitizer finds first."""
    scene = bug.mistake.get("sanitizer", "").split() if not options.scene else []
    command = [
        program_file(CHAPTERS[bug.chapter]),
        *planted,
        *(scene or [find_scene(options.scene or SCENES[bug.chapter][1][0])[0]]),
        "--headless",
        "--quiet",
        "--sanitize",
        "--width=64",
        "--height=64",
        f"--samples={options.samples or 16}",
        *(["--device", options.device] if options.device else []),
    ]
    result = subprocess.run(list(map(str, command)), stderr=subprocess.PIPE, encoding="utf-8")
    text = result.stderr.replace(planted[1].partition("=")[2], str(bug.file)).replace(f"{ROOT.as_posix()}/", "")
    print(f"{'sanitizer':10} {text.strip() or 'finds nothing'}")


def caught_by(bug):
    """The test known to fail because of the bug, or None, and a command that finds it."""
    if "sanitizer" in bug.mistake:
        return None, f"./lab bug {bug.chapter} {1 + [other.text for other in bugs_of(bug.chapter)].index(bug.text)} --sanitize"
    test = bug.mistake.get("test")
    return test, f"./lab test -R mistakes.{bug.mistake['name']}" if test else f"./lab check {bug.chapter}"


def changes(bug):
    """Rows of the difference from the chapter's own shader, as lesson.diff shows them."""
    own = text_of(bug.file)
    return diff.compare(own.splitlines(), bug.text.splitlines())[0]


def answer(bug):
    print(f"{bug.mistake['name']}: {bug.mistake['explanation']}\n")
    diff.show([f"chapter {bug.chapter}", "with the bug"], changes(bug))
    test, command = caught_by(bug)
    print(f"\ncaught by {f'{test}: ' if test else ''}{command}")


def main():
    options = parse()
    if options.chapter not in CHAPTERS:
        raise UserError(f"there is no chapter {options.chapter}: ./lab run lists them")
    bugs = bugs_of(options.chapter)
    if not bugs:
        raise UserError(f"chapter {options.chapter} has no bugs: its folder has no mistakes.json, or none is in its shaders")
    if options.bug is None:
        for index, bug in enumerate(bugs, 1):
            print(f"{index:3}  {bug.question}")
        print(f"./lab bug {options.chapter} 1 shows the first one")
        return
    if options.bug > len(bugs):
        raise UserError(f"chapter {options.chapter} has the bugs 1 to {len(bugs)}: ./lab bug {options.chapter} lists them")
    bug = bugs[options.bug - 1]
    if options.answer:
        answer(bug)
        return
    with replaced(bug.file, bug.text) as planted:
        if options.sanitize:
            return sanitize(bug, planted, options)
        scene = options.scene or telling_scene(bug, planted, options)
        if options.window:
            open_window(bug, scene, planted, options)
        else:
            show(bug, options.bug, scene, planted, options)
