"""How fast the backend `native` is, compared with a Vulkan driver for CPUs and with one path at a time: CPU time for the same samples.

    ./lab notebook native_speed [--runs 5] [--samples 16] [CHAPTER:SCENE ...]

Prints for each case the times of `compute` and of `native` one by one over that of `native` in lanes, and their spread. The runs of the
three take turns. CPU time of the process without what starting takes: a run with one sample is subtracted.
"""
import argparse
import os
import statistics
import subprocess
import sys

from project import CHAPTERS, program_file

CASES = [
    *(f"{chapter}:cornell_box" for chapter in (1, 3, 5, 7, 9, 10)),
    "7:heart_light",
    "10:heart_light",
    "6:clear_glass",
    "10:clear_glass",
]


WAYS = {"native": ("native", {}), "compute": ("compute", {}), "one by one": ("native", {"LAB_LANES": "0"})}


def cpu_seconds(case, way, samples, device):
    backend, environment = WAYS[way]
    chapter, scene = case.split(":")
    command = [
        program_file(CHAPTERS[int(chapter)]),
        scene,
        "--headless",
        "--quiet",
        "--width=256",
        "--height=256",
        f"--samples={samples}",
        f"--backend={backend}",
        f"--device={device}",
        f"--output={os.devnull}.exr" if os.name == "nt" else "--output=/tmp/native_speed.exr",
    ]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL, env=os.environ | environment)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"error: {case} with {way}: exit status {status}")
    return usage.ru_utime + usage.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", default=CASES, metavar="CHAPTER:SCENE")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--device", default="llvmpipe")
    options = parser.parse_args()
    for case in options.cases:
        for way in WAYS:  # fills the caches
            cpu_seconds(case, way, 1, options.device)
        ratios = {way: [] for way in WAYS if way != "native"}
        for _ in range(options.runs):
            seconds = {
                way: cpu_seconds(case, way, options.samples, options.device) - cpu_seconds(case, way, 1, options.device)
                for way in WAYS
            }
            for way, all_of_it in ratios.items():
                all_of_it.append(seconds[way] / seconds["native"])
        print(
            f"{case:18} "
            + "   ".join(f"{way} {statistics.median(r):.2f} ({min(r):.2f} to {max(r):.2f})" for way, r in ratios.items()),
            flush=True,
        )
