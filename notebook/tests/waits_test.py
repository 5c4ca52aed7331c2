"""./lab notebook waits, on what ctest and ninja note."""

import io
import sys
import tempfile
import unittest
from contextlib import redirect_stdout
from pathlib import Path
from unittest import mock

import paths  # noqa: F401  (first: it finds the others)
from measure import waits
from project import UserError

COSTS = "unit.Vector.Adds 3 0.5\ncli.Book 1 60\nunit.Never.Ran 0 0\n---\ncli.Book\n"
LOG = (
    "# ninja log v5\n0\t9000\t1\tbin/unit_tests\taa\n0\t4000\t1\tCMakeFiles/lab.dir/a.cpp.o\tbb\n0\t7000\t2\tbin/unit_tests\taa\n"
)


class WaitsTest(unittest.TestCase):
    def waits(self, build):
        with mock.patch.object(sys, "argv", ["waits", "--build", str(build)]), redirect_stdout(io.StringIO()) as output:
            waits.main()
        return output.getvalue()

    def test_the_longest_comes_first_and_the_last_run_of_a_step_counts(self):
        with tempfile.TemporaryDirectory() as folder:
            for file, text in ((waits.COSTS, COSTS), (waits.LOG, LOG)):
                (path := Path(folder) / file).parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            tests, steps, together, _ = self.waits(folder).split("\n\n")
        self.assertEqual(tests.splitlines()[2:], ["| cli.Book | 60.0 |", "| unit.Vector.Adds | 0.5 |", "| all 2 | 60 |"])
        self.assertEqual(
            steps.splitlines()[2:], ["| bin/unit_tests | 7.0 |", "| CMakeFiles/lab.dir/a.cpp.o | 4.0 |", "| all 2 | 11 |"]
        )
        names = ["| tests cli | 60.0 |", "| linking | 7.0 |", "| compiling lab | 4.0 |", "| tests unit | 0.5 |", "| all 4 | 72 |"]
        self.assertEqual(together.splitlines()[2:], names)

    def test_a_folder_without_a_build_is_an_error(self):
        with tempfile.TemporaryDirectory() as folder, self.assertRaisesRegex(UserError, "run ./lab test first"):
            self.waits(folder)


if __name__ == "__main__":
    unittest.main()
