#!/usr/bin/env python3
"""Runs the statistical tests with other seeds: none may fail, and their p-values together must be uniform.

    tests/measure/false_alarms.py [SEEDS] [JOBS]        default: 5 seeds, 1 at a time

Counts the first p-value of each test and seed, since others of a test may come from the same paths. Prints how many
p-values a run has, which gives the rate of false alarms that it was designed for.
"""

import os
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]
sys.path += [str(TESTS), str(TESTS.parent / "tools")]
import project  # noqa: E402  (found by the line above)

project.ensure_packages()
import test_report  # noqa: E402
from project import BINARIES  # noqa: E402
from scipy.stats import kstest  # noqa: E402

PROGRAMS = ["shaders_tests", "convergence_tests", "hard_cases_tests"]
SIGNIFICANCE = 1e-6  # per expectation, as in tests/support/expect_statistics.h


def run(seed, folder):
    """Runs all tests with a seed; returns the failed tests and the lines test, what, p-value."""
    file = Path(folder) / f"{seed}.tsv"
    environment = {**os.environ, "LAB_TEST_SEED": str(seed), "LAB_TEST_P_VALUES": str(file)}
    failed = []
    for program in PROGRAMS:
        report = Path(folder) / f"{seed}.{program}.json"
        test_report.run(BINARIES / program, report, "--gtest_brief=1", f"--gtest_filter=-{test_report.ONLY_IN_ALL}", env=environment, stdout=sys.stderr)
        # A test's power varies a little with the seed; that says nothing about the estimator.
        failed += [
            test.full_name
            for test in test_report.read(report)[0]
            if any("too weak" not in failure for failure in test.failures)
        ]
    return failed, [line.split("\t") for line in file.read_text(encoding="utf-8").splitlines()]


def main():
    seeds = range(1, 1 + (int(sys.argv[1]) if len(sys.argv) > 1 else 5))
    jobs = int(sys.argv[2]) if len(sys.argv) > 2 else 1
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


if __name__ == "__main__":
    main()
