"""Runs the statistical tests with other seeds: none may fail, and their p-values together must be uniform.

Counts the first p-value of each test and seed, since others of a test may come from the same paths. Prints how many
p-values a run has, which gives the rate of false alarms that it was designed for.
"""

import os
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import test_report
from project import BINARIES, Parser, number
from scipy.stats import kstest

PROGRAMS = ["shaders_tests", "convergence_tests", "hard_cases_tests"]
SIGNIFICANCE = 1e-6  # per expectation, as in tests/support/expect_statistics.h


def run(seed, folder):
    """Runs all tests with a seed; returns the failed tests and the lines test, what, p-value."""
    file = Path(folder) / f"{seed}.tsv"
    environment = {**os.environ, "LAB_TEST_SEED": str(seed), "LAB_TEST_P_VALUES": str(file)}
    failed = []
    for program in PROGRAMS:
        report = Path(folder) / f"{seed}.{program}.json"
        test_report.run(
            BINARIES / program,
            report,
            "--gtest_brief=1",
            f"--gtest_filter=-{test_report.ONLY_IN_ALL}",
            env=environment,
            stdout=sys.stderr,
        )
        # A test's power varies a little with the seed; that says nothing about the estimator.
        failed += [
            test.full_name for test in test_report.read(report)[0] if any("too weak" not in failure for failure in test.failures)
        ]
    return failed, [line.split("\t") for line in file.read_text(encoding="utf-8").splitlines()]


def main():
    parser = Parser("./lab notebook false_alarms", __doc__)
    parser.add_argument("--seeds", type=number(int, 1), default=5, help="default: 5")
    parser.add_argument("--jobs", type=number(int, 1), default=1, help="seeds at a time; default: 1")
    options = parser.parse_args()
    seeds, jobs = range(1, 1 + options.seeds), options.jobs
    failures, first_p_values = 0, []
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(jobs) as pool:
        for seed, (failed, lines) in zip(seeds, pool.map(lambda seed: run(seed, folder), seeds)):
            failures += len(failed)
            first = {}
            for test, _, p_value in lines:
                first.setdefault(test, float(p_value))
            first_p_values += first.values()
            smallest = min(float(line[2]) for line in lines)
            print(f"seed {seed}: {len(lines)} p-values of {len(first)} tests, smallest {smallest:.2g}, failed: {failed}")
    uniformity = kstest(first_p_values, "uniform").pvalue
    print(f"{len(first_p_values)} p-values: Kolmogorov-Smirnov p = {uniformity:.2g}", flush=True)
    print(f"designed rate of false alarms of a run: {1 - (1 - SIGNIFICANCE) ** len(lines):.2g}")
    sys.exit(failures > 0 or uniformity < 0.001)
