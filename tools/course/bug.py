"""The bug gallery: shaders with a mistake in them, to be found by looking.

    ./lab bug 3             lists the bugs of chapter 3, without their names
    ./lab bug 3 2           renders the second one beside the right picture, with the same random numbers: output/bug_3_2.png
    ./lab bug 3 2 --answer  tells what is wrong, in which line, and what catches it

The picture shows right, wrong and their difference: red is too bright, blue too dark. The verdict is that of the reference image.
"""
import subprocess
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from check.command import percent
from check.grading import OPTIONS, SCENES, TOO_MUCH, make_tree, reference_regions
from check.likely_mistake import SIGNATURES
from course.mistakes import CATALOGUE, bugs_of, own_shader
from docs.figure_plots import right_and_wrong
from lesson import diff
from project import CHAPTERS, ROOT, Parser, UserError, add_device_options, number, read_json, show_progress
from references.images import find_references, read_rgb
from report.measurement import new_case, run_case
from report.numbers import biases

SCALE = 2  # pixels in a row for each of the reference's
COLOURS = ("red", "green", "blue")


def parse():
    parser = Parser("./lab bug", __doc__)
    parser.add_argument("chapter", type=number(int, 1), metavar="N", help="number of the chapter")
    parser.add_argument("bug", type=number(int, 1), nargs="?", metavar="I", help="number of the bug; default: list them")
    parser.add_argument("--answer", action="store_true", help="tell what is wrong")
    parser.add_argument("--window", action="store_true", help="open the chapter with the bug in its window")
    parser.add_argument("--scene", help="one that has a reference; default: of those of ./lab check, where the bug shows most")
    parser.add_argument("--samples", type=number(int, 4), help="a pixel; default: twice those of a run of ./lab check")
    add_device_options(parser)
    return parser.parse_intermixed_args()


@contextmanager
def program_with(chapter, text):
    """The program of a chapter in a temporary copy of what it reads, with this text as its shader."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "path_trace.glsl"
        file.write_text(text, encoding="utf-8")
        yield make_tree(CHAPTERS[chapter], file, Path(folder) / "tree")[0]


def telling_scene(bug):
    """The name of the reference in which the bug shows most, by what ./lab check knows of it."""
    scenes = SCENES[bug.chapter][1]
    known = read_json(SIGNATURES)[str(bug.chapter)].get(bug.mistake["name"])
    if not known:
        return scenes[-1]
    ends = np.cumsum([len(reference_regions(file)["mean"]) for _, file in find_references(scenes)])
    parts = np.split(np.abs(known["signature"]["differences"]), ends[:-1])
    shown = [part.mean() + abs(np.log(noise)) / 10 for part, noise in zip(parts, known["signature"]["noise"])]
    return scenes[int(np.argmax(shown))]


def new_render(bug, options, program):
    """What is to be rendered: in the size of the reference, and its path length."""
    (pair,) = find_references([options.scene or telling_scene(bug)])
    return new_case(*pair, f"chapter {bug.chapter}", program, OPTIONS[bug.chapter])


def render(case, samples, options):
    """Adds a run to a case, SCALE times as large as the reference; returns the image."""
    case |= {"width": SCALE * case["width"], "height": SCALE * case["height"], "scale": SCALE}
    with tempfile.TemporaryDirectory() as folder:
        picture = Path(folder) / "picture.exr"
        report = run_case(case, vars(options), ["--samples", samples, "--seed", 1, "--output", picture])
        case |= {"runs": [{"seed": 1, "rows": report["rows"]}], "invalid_samples": report["invalid_samples"]}
        return read_rgb(picture)


def verdict(right, wrong):
    """What shows of two cases with so many samples, in a line."""
    tests = biases(wrong["runs"], wrong["reference"], len(COLOURS))
    last, own = (case["runs"][0]["rows"][-1] for case in (wrong, right))
    means = ", ".join(f"{colour} {percent(test['value'])} ± {100 * test['half_width']:.1g} %" for colour, test in zip(COLOURS, tests))
    if wrong["invalid_samples"]:
        return f"broken: {wrong['invalid_samples']} samples infinite or not a number"
    if any(test["is_biased"] for test in tests):
        return f"biased: {means}"
    for key, text in (("rel_mse", "noisy: {:.1f} times the error of the right picture"), ("rays", "expensive: {:.1f} times its rays")):
        if last[key] > TOO_MUCH * own[key]:
            return f"{text.format(last[key] / own[key])}, the mean agrees: {means}"
    return f"nothing shows: {means}; a bias from {100 * max(test['detectable'] for test in tests):.2g} % would"


def show(bug, index, options):
    """Renders the right shader and the wrong one, and says what is to be seen."""
    samples, started = options.samples or 2 * SCENES[bug.chapter][0], time.monotonic()
    texts = {"right": own_shader(bug.chapter).read_text(encoding="utf-8"), "wrong": bug.text}
    cases, images = {}, {}
    for done, (name, text) in enumerate(texts.items(), 1):
        with program_with(bug.chapter, text) as program:
            cases[name] = new_render(bug, options, program)
            images[name] = render(cases[name], samples, options)
        show_progress(f"{name} picture of {cases[name]['scene']}", done, len(texts), started)
    path = ROOT / f"output/bug_{bug.chapter}_{index}.png"
    path.parent.mkdir(exist_ok=True)
    right_and_wrong(path, **images)
    print(f"{'scene':10} {cases['wrong']['scene']}, {samples} samples a pixel\n"
          f"{'verdict':10} {verdict(**cases)}\n{'question':10} {bug.question}\n{'picture':10} {path.relative_to(ROOT)}")


def open_window(bug, options):
    """The chapter with the bug, until its window is closed."""
    with program_with(bug.chapter, bug.text) as program:
        case = new_render(bug, options, program)
        command = [program, ROOT / case["scene_file"], "--window", "--max-path-length", case["max_path_length"], *OPTIONS[bug.chapter],
                   "--backend", options.backend, *(["--device", options.device] if options.device else [])]
        result = subprocess.run(list(map(str, command)), cwd=Path(program).parent)
    if result.returncode != 0:
        raise UserError(f"the window of chapter {bug.chapter} ended with exit code {result.returncode}")


def caught_by(bug):
    """What finds the bug, as text: a test that has been seen to fail because of it, or the check."""
    name, test = bug.mistake["name"], bug.mistake.get("test")
    if test:
        return f"{test}: ./lab test -R mistakes.{name} plants it and expects that test to fail"
    return f"./lab check {bug.chapter}"


def changes(bug):
    """Rows of the difference from the chapter's own shader, for lesson.diff."""
    own = own_shader(bug.chapter).read_text(encoding="utf-8")
    return diff.compare(own.splitlines(), bug.text.splitlines())[0]


def answer(bug):
    print(f"{bug.mistake['name']}: {bug.mistake['explanation']}\n")
    diff.show([f"chapter {bug.chapter}", "with the bug"], changes(bug))
    print(f"\ncaught by {caught_by(bug)}")


def main():
    options = parse()
    if options.chapter not in CHAPTERS:
        raise UserError(f"there is no chapter {options.chapter}: ./lab run lists them")
    bugs = bugs_of(options.chapter)
    if not bugs:
        raise UserError(f"chapter {options.chapter} has no bugs: {CATALOGUE.relative_to(ROOT)} knows none in its shader")
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
    elif options.window:
        open_window(bug, options)
    else:
        show(bug, options.bug, options)
