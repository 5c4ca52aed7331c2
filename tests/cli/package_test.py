"""./lab package linux: the archive runs in another folder, without a compiler. windows_test does the same for Windows."""

import os
import subprocess
import tarfile

from program import PROJECT, ProgramTest  # first: it finds the tools
from package import make


class ArchiveFilesTest(ProgramTest):
    def test_files_for_teachers_stay_out(self):
        kept = ["LICENSE", "README.md", "chapters/01_a/chapter.json", "chapters/01_a/path_trace.glsl", "tools/check/grading.py"]
        for name in [
            *kept,
            "chapters/01_a/mistakes.json",
            "chapters/01_a/solutions/1.glsl",
            "notebook/variants/01_a/other.glsl",
            "chapters/01_a/solutions/README.md",
            "tools/course/bug.py",
            "tools/check/__pycache__/grading.pyc",
        ]:
            (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
            self.write(name, "")
        self.assertEqual(sorted(make.tree_files(self.folder)), kept)


class LinuxArchive_all(ProgramTest):
    def test_runs_in_another_folder_without_a_compiler(self):
        code, _, err = self.run_tool("package", "linux", timeout=600)
        self.assertEqual(code, 0, err)
        with tarfile.open(PROJECT / "output/path_tracing_lab-linux.tar.xz") as archive:
            archive.extractall(self.folder / "Übung 1")
        folder = self.folder / "Übung 1/path_tracing_lab-linux"
        for name in ("cmake", "g++"):
            self.write(f"bin/{name}", "#!/bin/sh\nexit 1\n").chmod(0o755)
        environment = {"PATH": f"{self.folder}/bin:{os.environ['PATH']}"}
        code, _, err = self.run_program(
            "run", "1", "quad.json", "--width=8", "--height=8", "--samples=1", program=folder / "lab", environment=environment
        )
        self.assertEqual((code, err), (0, ""))
        self.assertTrue((self.folder / "output/01_uniform_sampling.png").exists())
        libraries = subprocess.run(["ldd", folder / "build/bin/01_uniform_sampling"], capture_output=True, text=True).stdout
        self.assertIn(f"{folder}/build/lib/libglfw.so.3", libraries.replace("/bin/..", ""))
        # The backend native needs the sources, which the archive lacks, and 44 MB of Embree with them.
        self.assertNotRegex(" ".join(os.listdir(folder / "build/lib")), "embree|tbb")
