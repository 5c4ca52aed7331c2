"""The C++ of the notebook is laid out as clang-format 14 does it, like that of the course, and records have a row a line."""

import shutil
import subprocess
import unittest

from paths import PROJECT  # first: it finds the others
from project import json_rows, read_json
from tables.records import RECORDS


class FormatTest(unittest.TestCase):
    def test_sources_are_laid_out_by_clang_format(self):
        program = shutil.which("clang-format-14") or shutil.which("clang-format")
        if not program or " 14." not in subprocess.run([program, "--version"], capture_output=True, text=True).stdout:
            self.skipTest("needs clang-format 14")
        files = [*PROJECT.glob("notebook/measure/**/*.cpp"), *PROJECT.glob("notebook/measure/**/*.h")]
        self.assertGreater(len(files), 5)
        subprocess.run([program, "--dry-run", "-Werror", *files], check=True)

    def test_records_have_a_row_a_line(self):
        for file in RECORDS.glob("*/*.json"):
            with self.subTest(record=file.relative_to(RECORDS)):
                self.assertTrue(
                    file.read_text(encoding="utf-8") == json_rows(read_json(file)) + "\n",
                    "./lab notebook ages --stamp FILE lays it out",
                )
