#!/usr/bin/env python3
"""Renders scenes with every chapter and writes output/report/index.html: speed against error.

Scenes are names or files with a reference (./lab reference makes one), or names of references in assets/references;
chapters are their numbers. Without any, all shipped scenes and all chapters are rendered, in about five minutes on two
cores. Ctrl-C keeps what was measured; the same command then goes on.
"""
import argparse
import sys
from pathlib import Path

try:
    from command_line import Parser, add_device_options, at_least, run_resumable
    from measurement import CHAPTERS, Measurement, report_cases, study_cases, working_variants
    from reference_image import ROOT, find_references
    from report_page import write_report
    from scene_reader import UserError
except ImportError as error:
    sys.exit(f"error: {error}: ./lab report needs the Python packages numpy and matplotlib")


def parse():
    parser = Parser(prog="./lab report", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", nargs="*", metavar="SCENE or CHAPTER", help="default: all")
    add_device_options(parser)
    parser.add_argument("--seconds", type=at_least(0.01, float), default=4.0,
                        help="of rendering for each chapter and scene, all repetitions together; default: 4")
    parser.add_argument("--repetitions", type=at_least(1, int), default=5, help="runs with seeds 1, 2, …; default: 5")
    parser.add_argument("--peer", choices=["mitsuba"], help="render with Mitsuba 3 as well, where it is installed")
    parser.add_argument("--output", type=Path, default=ROOT / "output/report", metavar="FOLDER", help="default: output/report")
    parser.add_argument("--record", type=Path, metavar="FILE.json",
                        help="write no page, but measure what docs/results.md shows, as docs/records/chapters/DEVICE.json")
    return parser.parse_args()


def chosen_cases(options):
    programs, chapters = {int(name[:2]): name for name in CHAPTERS}, []
    for word in filter(str.isdigit, options.words):
        if int(word) not in programs:
            raise UserError(f"there is no chapter {word}; ./lab run lists them")
        chapters.append(programs[int(word)])
    scenes = find_references([word for word in options.words if not word.isdigit()])
    variants = working_variants() if options.peer else []
    return report_cases(scenes, sorted(set(chapters)) or CHAPTERS, variants)


def make_record(options, settings):
    if options.words or options.peer:
        raise UserError("--record measures a fixed list of cases: no scenes, chapters or peers go with it")
    measurement = Measurement(options.record, study_cases(), settings)
    measurement.measure()
    measurement.record["is_complete"] = True
    for run in (run for case in measurement.record["cases"] for run in case["runs"]):
        del run["rows"][:-1]  # the others are not shown there
    measurement.save()
    print(f"{options.record}: complete; tools/make_results.py writes docs/results.md from records in docs/records/chapters")


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
    run_resumable(lambda: make(options, settings), UserError)


if __name__ == "__main__":
    main()
