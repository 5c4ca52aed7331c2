"""How fast the backend `native` is, compared with a Vulkan driver for CPUs: CPU time for the same samples.

    python3 tests/measure/native_speed.py [--runs 5] [--samples 16] [CHAPTER:SCENE ...]

Prints for each case the time of `compute` over that of `native`, and its spread. The runs of the two take turns. CPU time of the
process without what starting takes: a run with one sample is subtracted.
"""
import argparse
import os
import statistics
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
from project import CHAPTERS, program_file  # noqa: E402  the tools are found by then

CASES = [*(f"{chapter}:cornell_box" for chapter in (1, 3, 5, 7, 9, 10)), "7:heart_light", "10:heart_light", "6:clear_glass", "10:clear_glass"]


def cpu_seconds(case, backend, samples, device):
    chapter, scene = case.split(":")
    command = [program_file(CHAPTERS[int(chapter)]), scene, "--headless", "--quiet", "--width=256", "--height=256", f"--samples={samples}",
               f"--backend={backend}", f"--device={device}", f"--output={os.devnull}.exr" if os.name == "nt" else "--output=/tmp/native_speed.exr"]
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"error: {case} with {backend}: exit status {status}")
    return usage.ru_utime + usage.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", default=CASES, metavar="CHAPTER:SCENE")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--device", default="llvmpipe")
    options = parser.parse_args()
    for case in options.cases:
        for backend in ("native", "compute"):  # fills the caches
            cpu_seconds(case, backend, 1, options.device)
        ratios = []
        for _ in range(options.runs):
            native, compute = (cpu_seconds(case, backend, options.samples, options.device) - cpu_seconds(case, backend, 1, options.device)
                               for backend in ("native", "compute"))
            ratios.append(compute / native)
        print(f"{case:18} {statistics.median(ratios):.2f}  ({min(ratios):.2f} to {max(ratios):.2f})", flush=True)


if __name__ == "__main__":
    main()
