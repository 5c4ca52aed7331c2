"""The C++ of the notebook is laid out as clang-format 14 does it, like that of the course."""

import shutil
import subprocess
import unittest

from paths import PROJECT


class FormatTest(unittest.TestCase):
    def test_sources_are_laid_out_by_clang_format(self):
        program = shutil.which("clang-format-14") or shutil.which("clang-format")
        if not program or " 14." not in subprocess.run([program, "--version"], capture_output=True, text=True).stdout:
            self.skipTest("needs clang-format 14")
        files = [*PROJECT.glob("notebook/measure/**/*.cpp"), *PROJECT.glob("notebook/measure/**/*.h")]
        self.assertGreater(len(files), 5)
        subprocess.run([program, "--dry-run", "-Werror", *files], check=True)


if __name__ == "__main__":
    unittest.main()
