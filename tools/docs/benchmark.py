"""Measures how fast this machine renders and prints a table to post and compare; also in output/benchmark.json.

Every backend of the device renders the Cornell box, a scene lit by a mesh and one of glass, with the chapter whose
measure.json says how: five runs of each, interleaved. "Seconds to 1 % error" is the time from the command to a picture with a
relative error of 0.01 (the root of rel_mse). Shorter runs are extrapolated: the error falls with one over the root of the samples.
Paths and rays per second use the device's clock. GPUs render 1024 x 1024 pixels, because the reference's size is too
small to fill them. Takes less than two minutes. Ctrl-C keeps what was measured; the same command then continues.
"""
import os
import platform
import re
import sys
from pathlib import Path
from statistics import median

from project import ROOT, Parser, add_device_options, number, processor, table
from references.images import find_references
from report.measurement import Measurement, devices_text, driver_of, find_device, new_case
from report.numbers import seconds_to_target, with_range
from report.studies import measures

GOES_ON = True
SCENES = ["cornell_box", "heart_light", "glass"]
CHAPTER, OPTIONS = next((folder, measure["benchmark"].split()) for folder, measure in measures().items() if "benchmark" in measure)
GPU_SIZE = 1024  # for pictures without a reference
RUNS = 5


def parse():
    parser = Parser("./lab benchmark", __doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"with a reference; default: {' '.join(SCENES)}")
    add_device_options(parser)
    parser.add_argument("--seconds", type=number(float, 0.01), default=55.0, help="of rendering in all; default: 55")
    parser.add_argument("--output", type=Path, default=ROOT / "output/benchmark.json", metavar="FILE.json",
                        help="default: output/benchmark.json")
    return parser.parse_args()


def system_text():
    """Operating system, processor and memory, without the machine's name."""
    try:
        name = platform.freedesktop_os_release()["PRETTY_NAME"]
    except OSError:
        name = platform.system()
    cpu, threads = processor()
    memory = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") / 2**30
    return f"{name}, {cpu}, {threads} threads, {memory:.0f} GiB"


def backends_of(device):
    listed = re.search(rf"^ *\d+ +{re.escape(device)} .*\n((?: +\w+ +(?:works|lacks).*\n?)+)", devices_text(CHAPTER), re.MULTILINE)
    return re.findall(r"^ +(\w+) +works$", listed[1], re.MULTILINE)


def benchmark_cases(scenes, backends, is_cpu):
    """For each scene and backend, a case with the reference for the error, and on GPUs a large one for the speed."""
    cases = []
    for scene, reference in scenes:
        for backend in backends:
            these = [new_case(scene, reference, f"{backend}, error", CHAPTER, OPTIONS)]
            if not is_cpu:
                large = {"width": GPU_SIZE, "height": GPU_SIZE}
                these.append(new_case(scene, None, f"{backend}, speed", CHAPTER, OPTIONS) | large)
            cases += [case | {"scene": scene.stem, "backend": backend} for case in these]
    return cases


def summarize(cases):
    """One row for each scene and backend that was measured."""
    rows = []
    for error in (case for case in cases if case["reference"]):
        key = (error["scene"], error["backend"])
        speed = [case for case in cases if (case["scene"], case["backend"]) == key][-1]
        if not speed["runs"] or not error["runs"]:
            continue
        last = [run["rows"][-1] for run in speed["runs"]]
        paths = [row["samples"] * speed["width"] * speed["height"] / row["device_seconds"] for row in last]
        (seconds, _, _), (start_up, _, _) = seconds_to_target(error)
        rows.append({"scene": speed["scene"], "backend": speed["backend"], "pixels": f"{speed['width']}², {error['width']}²", "paths_per_second": paths,
                     "rays_per_second": [row["rays"] / row["device_seconds"] for row in last],
                     "seconds_to_1_percent": seconds, "start_up_seconds": start_up})
    for row in rows:
        base = next(other for other in rows if other["scene"] == row["scene"])
        row["speed_ratios"] = [a / b for a, b in zip(row["paths_per_second"], base["paths_per_second"])]
    return rows


def markdown(record):
    environment = record["environment"]
    head = ["scene", "backend", "pixels: speed, error", "million paths/s", "million rays/s", "speed, relative (range of runs)",
            "seconds to 1 % error", "of them start-up"]
    rows = []
    for row in record["summary"]:
        rows.append([row["scene"], f"`{row['backend']}`", row["pixels"], f"{median(row['paths_per_second']) / 1e6:.3g}",
                     f"{median(row['rays_per_second']) / 1e6:.3g}", with_range(row["speed_ratios"]),
                     f"{row['seconds_to_1_percent']:.3g}", f"{row['start_up_seconds']:.2g}"])
    return (f"**{environment['device']}** ({environment['driver']}), {environment['system']}; the path tracing lab, commit "
            f"{environment['commit']}, {environment['date']}\n\n" + table(head, rows, left=2).rstrip())


def main():
    options = parse()
    settings = {"scenes": options.scenes, "backend": options.backend, "device": options.device, "repetitions": RUNS}
    scenes = find_references(options.scenes or SCENES)
    device = find_device(CHAPTER, settings | {"backend": "compute"})
    backends = [options.backend] if options.backend != "auto" else backends_of(device)
    cases = benchmark_cases(scenes, backends, driver_of(CHAPTER, device).startswith("CPU"))
    settings["seconds"] = options.seconds / len(cases)
    measurement = Measurement(options.output, cases, settings)
    record = measurement.record
    try:
        measurement.measure()
        record["is_complete"] = True
    finally:
        record["summary"] = summarize(record["cases"])
        if record["summary"]:
            record["environment"]["system"] = system_text()
            measurement.save()
            print(markdown(record))
            print(f"All runs are in {options.output}", file=sys.stderr)
