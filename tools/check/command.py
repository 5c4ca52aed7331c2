"""Grades a shader of chapter N, or of the chapter that N is a copy of: is it correct, biased, or noisier or more expensive than its technique should be?

Renders scenes that have a reference image, each several times. Tests the means of the whole image and of its tiles
against the reference: a correct shader is called biased in about one of 1000 checks. Compares error and rays with those of
the chapter's own shader: the limit is 1.5 times, unless one pays for the other, and lower if less noise is the lesson.
After a third of the renders a first verdict says what is certain by then. The others are left out if a bias is certain and
experiments confirm it. If a shader is not correct, small experiments find out what is wrong and what is right: each varies a single
thing, such as an angle, a distance or the albedo. If only one common mistake fits all of their results, the check asks a question and
names the slide to read again; --teacher names the mistake.

--all grades each shader in a folder: files NAME.glsl, and shaders in separate folders. It writes results.csv
and a page with pictures, and continues after an interruption. For autograders see docs/grading.

Exit code: 0 correct, 1 biased, noisy or expensive, 2 cannot be graded; with --all: 0, or 2 if some cannot be graded.
"""
import json
import sys
import tempfile
import traceback
from pathlib import Path

from check.diagnosis import decide, diagnose
from check.folder import UNGRADED, grade_all
from check.formats import as_gradescope, as_github
from check.expected import DESCRIPTIONS
from check.grading import MOST_RUNS, RUNS, SCENES, first_seed, is_sure, judge, stay_in_the_driver
from check.submission import Submission
from check.words import detail_lines, hints_of, laid_out, scene_words, short_lines, tell_early, worst_scene
from project import CHAPTERS, ROOT, Parser, UserError, add_device_options, number, original, printable
from report.measurement import relative

POINTS = 10


def parse():
    parser = Parser("./lab check", __doc__)
    parser.add_argument("chapter", type=number(int, 1), metavar="N", help="number of the chapter")
    parser.add_argument("file", nargs="?", type=Path, metavar="FILE", help="default: the chapter's own")
    parser.add_argument("--all", type=Path, metavar="FOLDER", dest="folder", help="grade all shaders in this folder")
    parser.add_argument("--output", type=Path, metavar="FOLDER", help="for --all; default: output/check_N")
    parser.add_argument("--teacher", action="store_true", help="name the mistake instead of only asking")
    parser.add_argument("--details", action="store_true", help="print all scenes and experiments as well")
    add_device_options(parser)
    parser.add_argument("--seed", type=number(int, 0, 400000), default=0, help="each chooses other random numbers; default: 0")
    parser.add_argument("--runs", type=number(int, 2, MOST_RUNS), default=RUNS, help=f"of each scene; default: {RUNS}")
    parser.add_argument("--samples", type=number(int, 1), help="of each run; default: 8 to 32, as the chapter needs")
    parser.add_argument(
        "--time-limit",
        type=number(float, 0.1),
        default=30.0,
        metavar="SECONDS",
        help="for each run, after which it is ended, and ten times as much for a whole check; default: 30",
    )
    parser.add_argument("--memory-limit", type=number(float, 0.1), metavar="GIGABYTES", help="for each run; default: none")
    forms = parser.add_mutually_exclusive_group()
    forms.add_argument("--json", action="store_const", const="json", dest="form", help="print the result as JSON")
    forms.add_argument(
        "--gradescope",
        action="store_const",
        const="gradescope",
        dest="form",
        help="print results.json of a Gradescope autograder, with points for each scene",
    )
    forms.add_argument(
        "--github", action="store_const", const="github", dest="form", help="print annotations for GitHub's actions as well"
    )
    parser.add_argument("--points", type=number(float, 0), default=POINTS, help=f"for --gradescope; default: {POINTS}")
    options = parser.parse_intermixed_args()
    options.is_quiet, options.what = options.form in ("json", "gradescope"), ""
    return options


def refuse(options):
    """Raises UserError if a check cannot start."""
    if options.chapter not in SCENES:
        raise UserError(f"there is no chapter {options.chapter} to be checked: ./lab check N FILE grades a file as chapter N's")
    if options.samples and DESCRIPTIONS[options.chapter].get("low_discrepancy"):
        raise UserError(
            f"--samples: in chapter {options.chapter} the error per sample depends on how many there are: leave it out"
        )
    if options.folder and (options.file or options.form):
        raise UserError("--all grades a folder into results.csv: leave out the file and the form of the output")


def check(options, submission, picture=None):
    """Returns the result of a check; raises UserError if there is none. Incorrect shaders always get a picture, others only if
    `picture` is a file for it."""
    watch = (lambda cases: None) if options.is_quiet or options.folder else tell_early
    settings = vars(options) | {"first_seed": first_seed(options.seed)}
    todo = submission.first_todo()

    def is_enough(results):
        """What is unfinished need not be measured. Elsewhere points are given for each scene, so that each takes all runs, or experiments
        should confirm a bias: in so few runs all may lack the same bright paths."""
        if todo[1]:
            return any(scene["verdict"] != "correct" for scene in results)
        return options.form != "gradescope" and is_sure(results)

    result, pictures = judge(submission, settings, watch=watch, is_enough=is_enough)
    is_correct = result["verdict"] == "correct"
    result["unfinished_file"], result["unfinished_line"] = (None, None) if is_correct else todo
    if not result["unfinished_line"]:
        found = diagnose(submission, settings, is_correct)
        if result["runs"] < options.runs and not found["is_beyond_doubt"]:
            judged, pictures = judge(submission, settings)
            result |= judged
        result["diagnosis"] = found
        decide(submission, settings, result, pictures)
        if not options.teacher:
            for mistake in result["diagnosis"]["mistakes"]:
                del mistake["name"]
    if picture or result["verdict"] != "correct":
        from check.pictures import draw  # imported late: Matplotlib takes longer to load than everything else

        name = f"check_{options.chapter}.png"
        try:
            path = draw(result, pictures, picture or ROOT / "output" / name)
        except OSError:  # in a read-only checkout, for instance
            path = draw(result, pictures, Path(tempfile.mkdtemp()) / name)
        result["picture"] = relative(path)
    return result


def report(options, result):
    """Prints a result, or {"error": …} if there is none, in the requested form."""
    hints = [f"not graded: {result['error']}"] if "error" in result else hints_of(result)
    if options.form == "json":
        print(json.dumps(result, indent=1))
    elif options.form == "gradescope":
        scenes = [(scene["scene"], scene["verdict"], ", ".join(scene_words(scene))) for scene in result.get("scenes", [])]
        if scenes and result["verdict"] not in ("correct", *(verdict for _, verdict, _ in scenes)):
            scenes.append(("experiments", result["verdict"], worst_scene(result)))
        passed_anyway = DESCRIPTIONS.get(options.chapter, {}).get("check", {}).get("passed_by_placeholder", [])
        print(
            json.dumps(as_gradescope(scenes, hints, options.points, passed_anyway, bool(result.get("unfinished_line"))), indent=1)
        )
    elif "error" not in result:
        more = detail_lines(result) if options.details else [("more", "every scene and experiment: --details")]
        print(laid_out([*short_lines(result), *more], sys.stdout))
    if options.form == "github":
        file = result.get("unfinished_file") or options.file and printable(options.file)
        print(as_github(result["verdict"], file, result.get("unfinished_line"), hints), end="")


def main():
    options = None
    try:
        options = parse()
        refuse(options)
        stay_in_the_driver(options.backend)
        file = options.file or ROOT / "chapters" / CHAPTERS[options.chapter] / "path_trace.glsl"
        options.chapter = original(options.chapter)
        if options.folder:
            sys.exit(grade_all(options, check))
        if not file.is_file():
            raise UserError(
                f"{printable(file)}: " + ("a folder: name one of its files, or take --all" if file.is_dir() else "no such file")
            )
        result = check(options, Submission(options.chapter, file))
    except SystemExit as end:  # by the parser
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
            sys.exit(UNGRADED)
        raise
    except (Exception, KeyboardInterrupt) as error:  # Python's exit code would be that of a biased shader
        is_expected = isinstance(error, (UserError, OSError, KeyboardInterrupt))
        message = "interrupted" if isinstance(error, KeyboardInterrupt) else str(error) if is_expected else repr(error)
        if options and options.form:
            report(options, {"chapter": options.chapter, "verdict": "not graded", "error": message})
        print(f"error: {message}" if is_expected else traceback.format_exc(), file=sys.stderr)
        sys.exit(UNGRADED)
    report(options, result)
    sys.exit(result["verdict"] != "correct")
