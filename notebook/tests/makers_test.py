"""./lab notebook assets: the meshes, textures and light probes in assets/ are what its formulas give."""

from unittest import mock

import paths  # noqa: F401  (first: it finds the others)
from makers import make
from program import ProgramTest
from project import UserError


class AssetsTest(ProgramTest):
    def test_files_are_as_they_are_made(self):
        code, out, err = self.run_here(make.main, "--check")
        self.assertEqual((code, out, err), (0, "", ""))

    def test_another_file_is_named_and_made_anew(self):
        file = self.folder / "assets/meshes/one.obj"
        with mock.patch.multiple(make, ROOT=self.folder, make_files=lambda: {"meshes/one.obj": b"v 0 0 0\n"}):
            for before in (None, "v 1 0 0\n"):
                if before:
                    file.write_text(before, encoding="utf-8")
                with self.assertRaisesRegex(UserError, "meshes/one.obj: is not as its formula makes it"):
                    self.run_here(make.main, "--check")
                self.assertEqual(self.run_here(make.main)[0], 0)
                self.assertEqual(file.read_text(encoding="utf-8"), "v 0 0 0\n")
                self.assertEqual(self.run_here(make.main, "--check")[0], 0)
