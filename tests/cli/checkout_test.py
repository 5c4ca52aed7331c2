"""The command lab in a checkout: its line ends, and what it builds for each tool."""

import os
import re
import shutil
import subprocess
import sys

from program import PROJECT, ProgramTest

INSTALLED = "#!/bin/sh\nfor name; do printf '%s:installed ' \"$name\"; done\n"
NOTING = "#!/bin/sh\necho \"${{0##*/}}${{LAB_TEST_COPY:+, copy $LAB_TEST_COPY:}} $@\" >>'{notes}'\n"
# The scripts in Python that only choose what to build do so.
CHOOSING = NOTING + "case $2 in chapters|targets|run) exec '{python}' -B \"$@\";; esac\n"
# A test program that has one test.
LISTING = NOTING + "[ $1 != --gtest_list_tests ] || echo '  AreThree'\n"


class LineEnds(ProgramTest):
    def test_a_checkout_of_git_for_windows_has_those_of_its_sources(self):
        prefix = ["git", "-c", "core.autocrlf=true", "checkout-index", f"--prefix={self.folder}/tree/", "--"]
        files = [
            "lab",
            "chapters/01_uniform_sampling/path_trace.glsl",
            "tests/fuzz/seeds/obj/bare.obj",
            "assets/references/plates_3.exr",
        ]
        result = subprocess.run([*prefix, *files], cwd=PROJECT, capture_output=True, text=True)
        if "not a git repository" in result.stderr:
            self.skipTest("no repository")
        self.assertEqual(result.returncode, 0, result.stderr)
        for file in files:
            recorded = subprocess.run(
                ["git", "cat-file", "blob", f":{file}"], cwd=PROJECT, capture_output=True, check=True
            ).stdout
            self.assertEqual((self.folder / "tree" / file).read_bytes(), recorded, file)


class WhatIsBuilt(ProgramTest):
    """lab in its own tree, where everything is installed and nothing is built. Chapter 20 is a copy of chapter 3."""

    def setUp(self):
        super().setUp()
        for folder in ("build", "bin", "tests/shaders", "tests/cli", "tools/lesson"):
            (self.folder / "tree" / folder).mkdir(parents=True)
        for name, title in (("03_three", "Three"), ("12_twelve", "Twelve"), ("20_mine", "Three")):
            page = f"# {title}\nDone\n   when all tests named `{title}Things` and `More` pass.\n"
            for file, text in (("chapter.json", f'{{\n    "title": "{title}"\n}}\n'), ("README.md", page)):
                (self.folder / "tree/chapters" / name).mkdir(parents=True, exist_ok=True)
                self.write(f"tree/chapters/{name}/{file}", text)
        self.write("tree/tests/shaders/three_test.cpp", "TEST_P(ThreeThings, AreThree) {\nTEST(Other, IsOther) {\n")
        self.write("tree/tests/cli/four_test.py", "class FourTest(TestCase):\n")
        self.write("tree/CMakeLists.txt", "")
        for name in (
            "lab",
            *(f"tools/{name}.py" for name in ("__main__", "project", "lesson/chapters")),
            *(f"tests/{name}.py" for name in ("__main__", "cited_tests", "kept_results", "test_report")),
        ):
            shutil.copy(PROJECT / name, self.folder / "tree" / name)
        for name, script in (("dpkg-query", INSTALLED), ("cmake", NOTING), ("python3", CHOOSING), ("ctest", NOTING)):
            self.write(f"tree/bin/{name}", script.format(notes=self.folder / "notes", python=sys.executable)).chmod(0o755)

    def noted(self, *arguments, code=0):
        """What a command of lab calls, one line each."""
        path = f"{self.folder / 'tree/bin'}:{os.environ['PATH']}"
        actual, _, err = self.run_program(*arguments, program=self.folder / "tree/lab", environment={"PATH": path})
        self.assertEqual(actual, code, err)
        text = (self.folder / "notes").read_text()
        (self.folder / "notes").unlink()
        return text

    def test_the_chapter_to_be_checked_is_built_wherever_its_number_stands(self):
        for arguments in (
            ["3", "--all", "work"],
            ["--all", "work", "3"],
            ["--teacher", "03", "mine.glsl"],
            ["--all", "12/work", "3"],
        ):
            noted = self.noted("check", *arguments)
            self.assertRegex(noted, r"(?m)^cmake --build .* --target 03_three$", arguments)
            self.assertRegex(noted, rf"(?m)^python3 .*/tools check {' '.join(arguments)}$")

    def test_a_copy_is_checked_by_the_program_of_its_original(self):
        self.assertRegex(self.noted("check", 20), r"(?m)^cmake --build .* --target 03_three 20_mine$")

    def test_tests_that_are_chosen_are_built_alone(self):
        for regex, targets in (
            ("ThreeThings", "shaders_tests"),
            ("shaders.*IsOther", "shaders_tests"),
            ("FourTest", "all only_in_all"),
            ("mistakes", "all only_in_all"),
            ("Nothing", "all only_in_all"),
            ("ThreeThings|FourTest", "all only_in_all"),
        ):
            noted = self.noted("test", "-R", regex, code=1)
            self.assertRegex(noted, rf"(?m)^cmake --build .* --target {targets}$", regex)
            self.assertRegex(noted, rf"(?m)^ctest .* -R {re.escape(regex)}$")

    def test_the_name_of_a_test_may_not_be_missing(self):
        for arguments, words in (
            (["test", "-R"], "-R needs the name of a test"),
            (["test", 3, "-R"], "-R needs the name of a test"),
            (["test", "-R", "("], "lab: -R needs a regular expression"),
        ):
            self.assert_refused(arguments, words, program=self.folder / "tree/lab", environment={"PYTHONDONTWRITEBYTECODE": "1"})

    def test_what_is_not_named_is_left_to_all(self):
        for arguments, targets, choice in (
            ((), "all", r" -LE \^all\$"),
            (("--all",), "all only_in_all", ""),
            (("--quick",), "quick_tests", r" -L \^quick\$"),
            (("-I", "1,,6"), "all", r" -LE \^all\$ -I 1,,6"),
        ):
            noted = self.noted("test", *arguments, code=1)
            self.assertRegex(noted, rf"(?m)^cmake --build .* --target {targets}$")
            self.assertRegex(noted, rf"(?m)^ctest .* --no-tests=error{choice}$")

    def test_the_tests_of_a_copy_are_those_of_its_originals_exercise(self):
        """Only the files that have them are built, and only their tests run."""
        self.write("tree/build/bin/shaders_three_test", LISTING.format(notes=self.folder / "notes")).chmod(0o755)
        noted = self.noted("test", 20)
        self.assertRegex(noted, r"(?m) --target shaders_three_test$")
        self.assertRegex(
            noted,
            r"(?m)^shaders_three_test, copy 20_mine: --gtest_brief=1 --gtest_filter=ThreeThings\.\*:\*/ThreeThings\.\*:More\.\*:"
            r"\*/More\.\*-\*/chapter_12_twelve:\*/chapter_12_twelve_all:\*/chapter_20_mine:\*/chapter_20_mine_all$",
        )
        self.assertNotIn("ctest", noted)

    def test_other_tests_may_be_chosen_for_a_copy(self):
        noted = self.noted("test", 20, "-R", "IsOther", code=1)
        self.assertRegex(noted, r"(?m) --target shaders_tests$")
        self.assertIn(r" -R IsOther -E /chapter_(12_twelve|20_mine)(_all)?$" + "\n", noted)
        self.assertIn("\nctest, copy 20_mine: ", "\n" + noted)

    def test_the_summary_counts_what_ran(self):
        """A run in which nothing runs has failed."""
        cases = {
            "a.Passes": "   Passed    1.00 sec",
            "a.IsSlow": "   Passed   22.50 sec",
            "a.Fails": "***Failed    3.00 sec",
            "a.IsOff": "***Not Run (Disabled)   0.00 sec",
            "a.NeedsXvfb": "***Skipped   0.00 sec",
            "a.IsMissing": "***Not Run   0.00 sec",
        }
        for names, code_of_ctest, code, last in (
            (cases, 8, 1, "2 passed, 2 failed, 2 skipped"),
            (["a.Passes", "a.IsSlow"], 0, 0, "2 passed, 0 failed"),
            (["a.IsOff"], 0, 1, "0 passed, 0 failed, 1 skipped"),
        ):
            lines = "\n".join(f"1/{len(names)} Test  #1: {name} ......{cases[name]}" for name in names)
            self.write("tree/bin/ctest", f"#!/bin/sh\ncat <<'END'\n{lines}\nEND\nexit {code_of_ctest}\n")
            path = f"{self.folder / 'tree/bin'}:{os.environ['PATH']}"
            actual, out, err = self.run_program("test", program=self.folder / "tree/lab", environment={"PATH": path})
            self.assertEqual((actual, out.splitlines()[-1]), (code, last), err)
            if code == 0:
                self.assertIn("slowest:\n   22.5 s  a.IsSlow\n    1.0 s  a.Passes\n", out)

    def test_all_goes_on_with_what_is_not_green_and_tells_how_things_stand(self):
        """Each test runs once, until what it reads changes: mistakes read no pages, and a command may read anything."""
        self.write(
            "tree/bin/ctest",
            f"""#!/bin/sh
case "$*" in
*-N*-I*) printf '  Test %s\\n' ' #3: cli.D' '#14: unit.E.F'; exit ;;
*-N*-L*) printf '  Test %s\\n' ' #2: mistakes.c' '#14: unit.E.F'; exit ;;
*-N*) printf '  Test %s\\n' '#1: unit.A.B' ' #2: mistakes.c' ' #3: cli.D' '#14: unit.E.F'; exit ;;
esac
for last; do :; done
echo "$last" >> {self.folder}/asked
case $last in *,1*) echo '1/4 Test  #1: unit.A.B ...   Passed    1.00 sec' ;; esac
case $last in *,2*) echo '2/4 Test  #2: mistakes.c ...   Passed    1.00 sec' ;; esac
case $last in *,3*) echo '3/4 Test  #3: cli.D ...   Passed    7200.00 sec' ;; esac
case $last in *,4*) echo '4/4 Test #14: unit.E.F ...***Failed    1.00 sec'; exit 8 ;; esac
""",
        )
        environment = {"PATH": f"{self.folder / 'tree/bin'}:{os.environ['PATH']}"}
        (self.folder / "tree/bin/ctest").chmod(0o755)

        def test(*arguments, code):
            actual, out, err = self.run_program("test", *arguments, program=self.folder / "tree/lab", environment=environment)
            self.assertEqual(actual, code, out + err)
            return out

        def asked():
            return (self.folder / "asked").read_text().split()[-1]

        self.write("tree/.gitignore", "build/\n")
        subprocess.run(["git", "init", "-q"], cwd=self.folder / "tree", check=True)
        for folder in ("docs", "common"):
            (self.folder / "tree" / folder).mkdir()
        self.assertIn("4 never run", test("--all", "--status", code=0))
        test("--all", code=1)
        self.assertEqual(asked(), "0,0,0,1,2,3,4")
        for choice, number in (([], 4), (["-I", "3,,1"], 4), (["-L", "all"], 2)):
            test("--all", *choice, code=int(number == 4))
            self.assertEqual(asked(), f"0,0,0,{number}", f"the red one, as ctest counts it with {choice}")
        self.assertRegex(test("--all", "--status", code=0), r"3 green, 1 red\n  red: unit.E.F\n.* took 2.0 hours")
        self.write("tree/docs/new.md", "a page")
        self.assertIn("2 green, 1 old, 1 red", test("--all", "--status", code=0))
        self.write("tree/common/new.h", "// a header")
        self.assertIn("4 old", test("--all", "--status", code=0))
        self.assertIn("--status goes with --all", self.run_program("test", "--status", program=self.folder / "tree/lab")[2])
