"""Renders scenes with every chapter and writes output/report/index.html: speed against error.

Scenes are names or files with a reference (./lab reference makes one), or names of references in assets/references;
chapters are their numbers. Without any, all shipped scenes and all chapters are rendered, in about five minutes on two
cores. Ctrl-C keeps what was measured; the same command then goes on.
"""
from pathlib import Path

from project import CHAPTERS, ROOT, Parser, UserError, add_device_options, number
from references.images import find_references
from report.measurement import Measurement, report_cases, study_cases, working_variants
from report.page import write_report

GOES_ON = True


def parse():
    parser = Parser("./lab report", __doc__)
    parser.add_argument("words", nargs="*", metavar="SCENE or CHAPTER", help="default: all")
    add_device_options(parser)
    parser.add_argument("--seconds", type=number(float, 0.01), default=4.0,
                        help="of rendering for each chapter and scene, all repetitions together; default: 4")
    parser.add_argument("--repetitions", type=number(int, 1), default=5, help="runs with seeds 1, 2, …; default: 5")
    parser.add_argument("--peer", choices=["mitsuba"], help="render with Mitsuba 3 as well, where it is installed")
    parser.add_argument("--output", type=Path, default=ROOT / "output/report", metavar="FOLDER", help="default: output/report")
    parser.add_argument("--record", type=Path, metavar="FILE.json",
                        help="write no page, but measure what docs/results.md shows, as docs/records/chapters/DEVICE.json")
    return parser.parse_args()


def chosen_cases(options):
    chapters = {int(word) for word in options.words if word.isdigit()}
    for chapter in chapters - CHAPTERS.keys():
        raise UserError(f"there is no chapter {chapter}; ./lab run lists them")
    scenes = find_references([word for word in options.words if not word.isdigit()])
    variants = working_variants() if options.peer else []
    return report_cases(scenes, sorted(chapters) or CHAPTERS, variants)


def make_record(options, settings):
    if options.words or options.peer:
        raise UserError("--record measures a fixed list of cases: no scenes, chapters or peers go with it")
    measurement = Measurement(options.record, study_cases(), settings)
    measurement.measure()
    measurement.record["is_complete"] = True
    for run in (run for case in measurement.record["cases"] for run in case["runs"]):
        del run["rows"][:-1]  # the others are not shown there
    measurement.save()
    print(f"{options.record}: complete; python3 tools tables writes docs/results.md from records in docs/records/chapters")


def make_report(options, settings):
    folder = options.output.resolve()
    measurement = Measurement(folder / "record.json", chosen_cases(options), settings, folder / "pictures")
    try:
        measurement.measure()
        measurement.record["is_complete"] = True
    finally:
        if any(case["runs"] for case in measurement.record["cases"]):
            write_report(measurement.record, folder)
            measurement.save()
            print(f"report         {options.output / 'index.html'}")


def main():
    options = parse()
    settings = {"words": options.words, "backend": options.backend, "device": options.device, "seconds": options.seconds,
                "repetitions": options.repetitions, "peer": options.peer}
    make = make_record if options.record else make_report
    make(options, settings)
