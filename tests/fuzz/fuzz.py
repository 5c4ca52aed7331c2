#!/usr/bin/env python3
"""Lets libFuzzer attack the readers of all file formats with changed files, and sums up what happened.

    ./lab fuzz [FORMAT...] [--minutes CPU_MINUTES] [--record FILE.json]

Inputs that reach new code are kept in build-fuzz/corpus and serve as a start of the next run; one that crashes, hangs or
allocates too much is kept as build-fuzz/FORMAT-crash-..., and `build-fuzz/bin/fuzz_FORMAT FILE` shows why.
"""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2] / "tools"))
from project import ROOT, Parser, commit, number, read_json, write_json  # noqa: E402  (found by the line above)

BUILD = ROOT / "build-fuzz"
SEEDS = ROOT / "tests" / "fuzz" / "seeds"
FORMATS = ["obj", "mtl", "scene", "hdr", "exr", "texture"]
LIMITS = {"timeout": 5, "malloc_limit_mb": 1100, "rss_limit_mb": 6000, "max_len": 16384}
SLICE_SECONDS = 60  # per run; the next one continues with what it found


def run_slice(name, seconds):
    """Fuzzes a format for some seconds; returns executions, CPU seconds, peak MiB and whether it found a defect."""
    corpus = BUILD / "corpus" / name
    corpus.mkdir(parents=True, exist_ok=True)
    command = [
        BUILD / "bin" / f"fuzz_{name}",
        *(f"-{option}={value}" for option, value in LIMITS.items()),
        f"-max_total_time={seconds}",
        f"-artifact_prefix={BUILD / name}-",
        "-print_final_stats=1",
        corpus,
        SEEDS / name,
    ]
    log = BUILD / f"{name}.log"
    with open(log, "wb") as stream:
        process = subprocess.Popen(command, stdout=stream, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    text = log.read_text(encoding="utf-8", errors="replace")
    statistics = dict(re.findall(r"stat::(\w+): +(\d+)", text))
    if process.returncode != 0:
        print(f"{name}: a defect, see {log}", file=sys.stderr)
    return {
        "executions": int(statistics.get("number_of_executed_units", 0)),
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "peak_mib": usage.ru_maxrss / 1024,
        "defect": process.returncode != 0,
    }


def main():
    parser = Parser("./lab fuzz", __doc__)
    parser.add_argument("formats", nargs="*", metavar="FORMAT", help=f"{', '.join(FORMATS)} (default: all)")
    parser.add_argument(
        "--minutes", type=number(float, 0), default=6, help="CPU time for all formats together (default: %(default)s)"
    )
    parser.add_argument("--record", type=Path, help="record of the run; what it says of other formats stays")
    arguments = parser.parse_args()
    if unknown := set(arguments.formats) - set(FORMATS):
        parser.error(f"there is no format {', '.join(sorted(unknown))}; there are {', '.join(FORMATS)}")

    start = {
        "commit": commit(),
        "date": time.strftime("%Y-%m-%d"),
        "executions": 0,
        "cpu_seconds": 0,
        "peak_mib": 0,
        "defects": 0,
    }
    totals = {name: dict(start) for name in arguments.formats or FORMATS}
    budget = 60 * arguments.minutes / len(totals)
    for name, total in totals.items():
        while total["cpu_seconds"] < budget and total["defects"] == 0:
            result = run_slice(name, max(1, round(min(SLICE_SECONDS, budget - total["cpu_seconds"]))))
            total["executions"] += result["executions"]
            total["cpu_seconds"] += result["cpu_seconds"]
            total["peak_mib"] = max(total["peak_mib"], result["peak_mib"])
            total["defects"] += result["defect"]
        total["corpus_files"] = sum(1 for _ in (BUILD / "corpus" / name).iterdir())
        total["cpu_seconds"], total["peak_mib"] = round(total["cpu_seconds"]), round(total["peak_mib"])
        print(f"{name:8} {total['executions']:9} inputs in {total['cpu_seconds']} s, {total['defects']} defects", flush=True)

    if arguments.record:
        previous = read_json(arguments.record)["formats"] if arguments.record.exists() else {}
        write_json(
            arguments.record,
            {
                "engine": "libFuzzer with AddressSanitizer and UndefinedBehaviorSanitizer",
                "limits": LIMITS,
                "formats": previous | totals,
            },
        )
    sys.exit(any(total["defects"] for total in totals.values()))


if __name__ == "__main__":
    main()
