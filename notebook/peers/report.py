"""Compares the chapters with Mitsuba as ./lab report does, or writes what docs/results.md shows: --record.

With a name of your choice for DEVICE,

    ./lab notebook report --record notebook/records/chapters/DEVICE.json
    ./lab notebook report --record notebook/records/cpu/DEVICE.json --peer mitsuba --device llvmpipe
"""
from pathlib import Path

from peers.cases import cpu_cases, peer_cases, study_cases, working_variants
from peers.machine import find_device, processor
from peers.renderers import CPU_VARIANTS, GPU_VARIANT, SAMPLERS
from project import CHAPTERS, UserError, chapter_named
from report.make import chosen, make_report, new_parser, settings_of
from report.measurement import Measurement, driver_of, report_cases
from tables.sources import stamped

GOES_ON = True


def parse():
    parser = new_parser("./lab notebook report", __doc__)
    parser.add_argument("--peer", choices=["mitsuba"], help="render with Mitsuba 3 as well, where it is installed")
    parser.add_argument(
        "--peer-sampler",
        choices=SAMPLERS,
        action="append",
        default=[],
        help="of Mitsuba, besides independent; may be given several times",
    )
    parser.add_argument(
        "--record",
        type=Path,
        metavar="FILE.json",
        help="write no page, but measure what docs/results.md shows; with --peer compare the backends of a CPU with Mitsuba's",
    )
    return parser.parse_args()


def chosen_cases(options):
    scenes, chapters = chosen(options.words)
    cases = report_cases(scenes, chapters)
    if not options.peer:
        return cases
    variants = working_variants()
    cases = [
        case for pair in scenes for case in [*report_cases([pair], chapters), *peer_cases([pair], variants, options.peer_sampler)]
    ]
    if is_on_cpu(options, CHAPTERS[chapters[0]]):
        return cases
    on_gpu = [variant for variant in variants if variant == GPU_VARIANT]
    return cases + [
        case
        for pair in scenes
        for case in [
            *report_cases([pair], chapters, is_large=True),
            *peer_cases([pair], on_gpu, options.peer_sampler if on_gpu else [], is_large=True),
        ]
    ]


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
    measurement.record = stamped(measurement.record)
    measurement.save()
    print(f"{options.record}: complete; ./lab notebook export shows what is in notebook/records")


def main():
    options = parse()
    if options.peer_sampler and not options.peer:
        raise UserError("--peer-sampler needs --peer mitsuba, whose samplers these are")
    settings = settings_of(options) | {"peer": options.peer, "peer_samplers": options.peer_sampler}
    if options.record:
        make_record(options, settings)
    else:
        make_report(options.output, chosen_cases(options), settings)
