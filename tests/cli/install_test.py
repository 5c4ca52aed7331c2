"""./lab install and the container: what they would install. tests/fresh_machine tries whether it works."""

import re
import subprocess
import unittest
import venv
from pathlib import Path

from program import PROJECT, TOOLS, ProgramTest

LAB = (PROJECT / "lab").read_text(encoding="utf-8")


def lab(*arguments):
    return subprocess.run([PROJECT / "lab", *arguments], capture_output=True, text=True)


class InstallTest(unittest.TestCase):
    def test_lists_every_package_that_the_commands_ask_for(self):
        """All lists at the top of lab except those of ./lab fuzz and ./lab package, and browsers for tests."""
        lists = dict(re.findall(r"^packages_to_(\w+)='\n(.*?)'$", LAB, re.MULTILINE | re.DOTALL))
        del lists["fuzz"], lists["package"], lists["browse"], lists["browse_all"]
        self.assertEqual(set(lists), {"run", "script", "test", "report", "book"})
        names = [name for text in lists.values() for line in text.splitlines() for name in line.split("|")[0].split()]
        self.assertEqual(lab("install", "--list").stdout.split(), names)

    def test_other_words_are_refused(self):
        result = lab("install", "everything")
        self.assertEqual((result.returncode, result.stdout), (1, ""))
        self.assertRegex(result.stderr, r"\Alab: 'everything' [^\n]*\n\Z")

    def test_the_container_uses_commands_that_exist(self):
        steps = re.findall(r"^RUN \./lab (\w+)", (PROJECT / "Containerfile").read_text(encoding="utf-8"), re.MULTILINE)
        self.assertEqual(steps, ["install"])
        self.assertIn("\ncommand_install()", LAB)


class BareMachineTest(ProgramTest):
    """Without Python, and with an apt that has nothing installed and installs nothing."""

    def test_commands_in_python_install_it(self):
        commands = self.folder / "bin"
        commands.mkdir()
        for path in (path for folder in ("/usr/bin", "/bin") for path in Path(folder).iterdir()):
            if not path.name.startswith(("python", "apt", "dpkg", "sudo")) and not (commands / path.name).exists():
                (commands / path.name).symlink_to(path)
        for name in ("apt-get", "dpkg-query"):
            self.write(f"bin/{name}", "#!/bin/sh\nexit 1\n").chmod(0o755)
        for command in ("diff", "reference", "fuzz", "test", "package", "install", "notebook"):
            code, _, err = self.run_program(command, "--help", program=PROJECT / "lab", environment={"PATH": str(commands)})
            self.assertEqual((code, err), (0, ""), f"help of {command} installs nothing")
        for command in (["diff", "2"], ["reference", "--all"]):
            code, _, err = self.run_program(*command, program=PROJECT / "lab", environment={"PATH": str(commands)})
            self.assertEqual(code, 1, err)
            self.assertRegex(err, r"these packages are needed[^\n]*\n +python3 +\w")


class OtherPythonTest(ProgramTest):
    """In a Python that has no packages, as one has that the user installed."""

    def test_programs_go_on_in_the_one_with_the_packages(self):
        venv.create(self.folder / "bare")
        code, out, err = self.run_program("-B", TOOLS, "figures", "--help", program=self.folder / "bare/bin/python")
        self.assertEqual((code, err), (0, ""))
        self.assertIn("usage:", out)
