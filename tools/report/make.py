"""Renders scenes with every chapter and writes output/report/index.html: speed against error.

Scenes are names or files with a reference (./lab reference makes one), or names of references in assets/references;
chapters are their numbers. Without any, all shipped scenes and all chapters are rendered, in about a quarter of an hour on
two cores. Ctrl-C keeps what was measured; the same command then continues.
"""
from pathlib import Path

from project import CHAPTERS, ROOT, Parser, UserError, add_device_options, number
from references.images import find_references
from report.measurement import Measurement, report_cases
from report.page import write_report

GOES_ON = True


def new_parser(name, description):
    parser = Parser(name, description)
    parser.add_argument("words", nargs="*", metavar="SCENE or CHAPTER", help="default: all")
    add_device_options(parser)
    parser.add_argument(
        "--seconds",
        type=number(float, 0.01),
        default=4.0,
        help="of rendering for each chapter and scene, all repetitions together; default: 4",
    )
    parser.add_argument("--repetitions", type=number(int, 1), default=5, help="runs with seeds 1, 2, …; default: 5")
    parser.add_argument("--output", type=Path, default=ROOT / "output/report", metavar="FOLDER", help="default: output/report")
    return parser


def chosen(words):
    """The scenes with their references, and the chapters, that these words name."""
    chapters = {int(word) for word in words if word.isdigit()}
    for chapter in chapters - CHAPTERS.keys():
        raise UserError(f"there is no chapter {chapter}; ./lab run lists them")
    return find_references([word for word in words if not word.isdigit()]), sorted(chapters) or list(CHAPTERS)


def settings_of(options):
    return {key: getattr(options, key) for key in ("words", "backend", "device", "seconds", "repetitions")}


def make_report(output, cases, settings):
    folder = output.resolve()
    measurement = Measurement(folder / "record.json", cases, settings, folder / "pictures")
    try:
        measurement.measure()
        measurement.finish()
    finally:
        if any(case["runs"] for case in measurement.record["cases"]):
            write_report(measurement.record, folder)
            measurement.save()
            print(f"report         {output / 'index.html'}")


def main():
    options = new_parser("./lab report", __doc__).parse_args()
    make_report(options.output, report_cases(*chosen(options.words)), settings_of(options))
