"""Renders scenes with every chapter and writes output/report/index.html: speed against error.

Scenes are names or files with a reference (./lab reference makes one), or names of references in assets/references;
chapters are their numbers. Without any, all shipped scenes and all chapters are rendered, in about a quarter of an hour on
two cores. Ctrl-C keeps what was measured; the same command then continues.
"""
from pathlib import Path

from project import (CHAPTERS, CPU_VARIANTS, GPU_VARIANT, ROOT, SAMPLERS, Parser, UserError, add_device_options, chapter_named, number,
                     processor)
from references.images import find_references
from report.measurement import Measurement, driver_of, find_device, report_cases, working_variants
from report.page import write_report
from report.studies import cpu_cases, study_cases

GOES_ON = True


def parse():
    parser = Parser("./lab report", __doc__)
    parser.add_argument("words", nargs="*", metavar="SCENE or CHAPTER", help="default: all")
    add_device_options(parser)
    parser.add_argument("--seconds", type=number(float, 0.01), default=4.0,
                        help="of rendering for each chapter and scene, all repetitions together; default: 4")
    parser.add_argument("--repetitions", type=number(int, 1), default=5, help="runs with seeds 1, 2, …; default: 5")
    parser.add_argument("--peer", choices=["mitsuba"], help="render with Mitsuba 3 as well, where it is installed")
    parser.add_argument("--peer-sampler", choices=SAMPLERS, action="append", default=[],
                        help="of Mitsuba, besides independent; may be given several times")
    parser.add_argument("--output", type=Path, default=ROOT / "output/report", metavar="FOLDER", help="default: output/report")
    parser.add_argument("--record", type=Path, metavar="FILE.json",
                        help="write no page, but measure what docs/results.md shows, as docs/records/chapters/DEVICE.json; with --peer "
                             "compare the backends of a CPU with Mitsuba's, as docs/records/cpu/DEVICE.json")
    return parser.parse_args()


def chosen_cases(options):
    chapters = {int(word) for word in options.words if word.isdigit()}
    for chapter in chapters - CHAPTERS.keys():
        raise UserError(f"there is no chapter {chapter}; ./lab run lists them")
    scenes = find_references([word for word in options.words if not word.isdigit()])
    chapters = sorted(chapters) or list(CHAPTERS)
    if not options.peer:
        return report_cases(scenes, chapters)
    variants = working_variants()
    cases = report_cases(scenes, chapters, variants, options.peer_sampler)
    if is_on_cpu(options, CHAPTERS[chapters[0]]):
        return cases
    on_gpu = [variant for variant in variants if variant == GPU_VARIANT]
    return cases + report_cases(scenes, chapters, on_gpu, options.peer_sampler if on_gpu else [], is_large=True)


def is_on_cpu(options, program):
    return driver_of(program, find_device(program, vars(options))).startswith("CPU")


def recorded_cases(options):
    if options.words or options.peer_sampler:
        raise UserError("--record measures a fixed list of cases: no scenes, chapters or samplers go with it")
    if not options.peer:
        return study_cases()
    if not is_on_cpu(options, chapter_named("path_regeneration")):
        raise UserError("--record with --peer compares backends of a CPU: choose it by --device, such as --device llvmpipe")
    if not set(CPU_VARIANTS) <= set(working_variants()):
        raise UserError("Mitsuba lacks LLVM here: install libllvm19, or a newer one, and let DRJIT_LIBLLVM_PATH name its library")
    return cpu_cases()


def make_record(options, settings):
    measurement = Measurement(options.record, recorded_cases(options), settings)
    measurement.measure()
    measurement.record["environment"] |= dict(zip(("processor", "cores"), processor()))
    measurement.finish()
    for run in (run for case in measurement.record["cases"] for run in case["runs"]):
        del run["rows"][:-1]  # the others are not displayed
    measurement.save()
    print(f"{options.record}: complete; python3 tools tables fills docs/results/ from records in docs/records")


def make_report(options, settings):
    folder = options.output.resolve()
    measurement = Measurement(folder / "record.json", chosen_cases(options), settings, folder / "pictures")
    try:
        measurement.measure()
        measurement.finish()
    finally:
        if any(case["runs"] for case in measurement.record["cases"]):
            write_report(measurement.record, folder)
            measurement.save()
            print(f"report         {options.output / 'index.html'}")


def main():
    options = parse()
    if options.peer_sampler and not options.peer:
        raise UserError("--peer-sampler needs --peer mitsuba, whose samplers these are")
    settings = {"words": options.words, "backend": options.backend, "device": options.device, "seconds": options.seconds,
                "repetitions": options.repetitions, "peer": options.peer, "peer_samplers": options.peer_sampler}
    make = make_record if options.record else make_report
    make(options, settings)
