"""How ./lab builds: in a mock project, whose programs take no time to compile."""

import os
import shutil

from program import PROJECT, ProgramTest

NOBODY = 65534  # Debian's user of this name

# A build that takes a second and fails if another one is in progress.
CMAKE = """cmake_minimum_required(VERSION 3.25)
project(path_tracing_lab LANGUAGES NONE)
add_custom_target(01_first COMMAND mkdir ${CMAKE_BINARY_DIR}/busy && sleep 1
                  COMMAND ${CMAKE_COMMAND} -E copy ${CMAKE_SOURCE_DIR}/01_first ${CMAKE_BINARY_DIR}/bin/01_first
                  COMMAND rmdir ${CMAKE_BINARY_DIR}/busy)
"""


class LabBuildTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.tree = self.folder / "lab"
        (self.tree / "chapters/01_first").mkdir(parents=True)
        for name in ("lab", "CMakePresets.json"):
            shutil.copy(PROJECT / name, self.tree / name)
        self.write("lab/CMakeLists.txt", CMAKE)
        self.program_says("first")

    def program_says(self, text, tree="lab"):
        self.write(f"{tree}/01_first", f"#!/bin/sh\necho {text}\n").chmod(0o755)

    def run_chapter(self, lab):
        return self.render("run", 1, program=lab)

    def test_a_renamed_checkout_builds(self):
        self.assertEqual(self.run_chapter(self.tree / "lab"), "first\n")
        renamed = self.tree.rename(self.folder / "renamed")
        self.assertEqual(self.run_chapter(renamed / "lab"), "first\n")

    def test_a_copied_checkout_builds_its_own_sources(self):
        self.run_chapter(self.tree / "lab")
        shutil.copytree(self.tree, self.folder / "copy")
        self.program_says("copied", "copy")
        self.assertEqual(self.run_chapter(self.folder / "copy/lab"), "copied\n")
        self.assertEqual(self.run_chapter(self.tree / "lab"), "first\n")

    def test_a_link_finds_the_checkout(self):
        (self.folder / "link").symlink_to(self.tree / "lab")
        self.assertEqual(self.run_chapter(self.folder / "link"), "first\n")

    def test_commands_that_begin_together_build_one_after_the_other(self):
        both = [self.start("run", 1, program=self.tree / "lab") for _ in range(2)]
        ends = [process.communicate() for process in both]
        self.assertEqual([(process.returncode, out) for process, (out, _) in zip(both, ends)], [(0, "first\n")] * 2, ends)
        self.assertEqual(sum("waiting for another ./lab" in err for _, err in ends), 1, ends)

    def test_without_the_folder_for_temporary_files(self):
        (self.tree / "build").mkdir()
        environment = {"TMPDIR": str(self.folder / "nowhere")}
        code, out, err = self.run_program("run", 1, program=self.tree / "lab", environment=environment)
        self.assertEqual((code, out), (0, "first\n"), err)
        self.assertNotIn("mktemp", err)

    def test_others_run_what_they_may_not_build(self):
        """As in a computer room, whose checkout belongs to somebody else."""

        def become_somebody_else():
            if os.geteuid() == 0:
                os.setgroups([])
                os.setgid(NOBODY)
                os.setuid(NOBODY)

        self.folder.chmod(0o755)
        self.run_chapter(self.tree / "lab")
        self.program_says("changed")
        programs = self.tree / "build/bin"
        for folder in (self.tree, self.tree / "build", programs):
            folder.chmod(0o555)
        self.addCleanup(lambda: [folder.chmod(0o755) for folder in (self.tree, self.tree / "build", programs)])
        self.assertEqual(self.render("run", 1, program=self.tree / "lab", prepare=become_somebody_else), "first\n")
        programs.chmod(0o755)
        (programs / "01_first").unlink()
        programs.chmod(0o555)
        self.assert_refused(
            ["run", 1],
            "build cannot be written, and 01_first is missing there",
            program=self.tree / "lab",
            prepare=become_somebody_else,
        )

    def test_nobody_waits_for_a_program_that_runs(self):
        self.write("lab/01_first", "#!/bin/sh\necho first\nsleep 60\n").chmod(0o755)
        with self.start("run", 1, program=self.tree / "lab") as first:
            self.assertEqual(first.stdout.readline(), "first\n")
            self.program_says("second")
            self.assertEqual(self.run_chapter(self.tree / "lab"), "second\n")
            first.terminate()
