"""docs/cluster.md: its commands, run as they stand there, give the picture of one long render."""

import os
import re
import subprocess

from image_files import Exr
from program import BINARIES, MERGE, PROJECT, RenderTest

# What the reader adapts: the settings before the first empty line of a block.
SETTINGS = """
renderer='build/bin/05_russian_roulette cornell_box --backend compute --width 24 --height 20'
devices='0'
samples=5
starts='0 5'
"""
# In the place of ./lab, which would install and build first.
LAB = f"""#!/bin/sh
[ "$1" = merge ] && shift && exec '{MERGE}' "$@"
"""


class ClusterTest(RenderTest):
    def setUp(self):
        super().setUp()
        (self.folder / "build").mkdir()
        (self.folder / "build/bin").symlink_to(BINARIES)
        self.write("lab", LAB).chmod(0o755)

    def block(self, heading):
        """The commands under a heading of the page, with settings for a test."""
        page = (PROJECT / "docs/cluster.md").read_text(encoding="utf-8")
        code = re.search(rf"^## {heading}.*?```sh\n(.*?)```", page, re.DOTALL | re.MULTILINE)[1]
        settings, commands = code.split("\n\n", 1)
        for name in re.findall(r"^(\w+)=", settings, re.MULTILINE):
            self.assertIn(f"\n{name}=", SETTINGS)
        return SETTINGS + commands

    def run_shell(self, text, **variables):
        result = subprocess.run(["bash", "-c", text], cwd=self.folder, env={**os.environ, **variables},
                                capture_output=True, text=True, timeout=120)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def assert_is_one_render(self, file):
        """The picture equals that of one render with all samples."""
        merged = Exr(self.folder / file)
        self.assertEqual(merged.text("samples"), "10")
        self.render("cornell_box", "--backend=compute", "--width=24", "--height=20", "--samples=10", "--quiet",
                    "--output=one.exr", program=BINARIES / "05_russian_roulette")
        self.assert_close(merged, Exr(self.folder / "one.exr"))

    def test_gnu_parallel(self):
        self.run_shell(self.block("Several GPUs"))
        self.assertEqual(len(list((self.folder / "parts").iterdir())), 2)
        self.assert_is_one_render("whole.exr")

    def test_slurm_array(self):
        """Slurm runs the script once for each number; a task that runs again resumes its part."""
        script = self.block("A cluster")
        for task in ("1", "0", "1"):
            self.run_shell(script, SLURM_ARRAY_TASK_ID=task)
        self.run_shell("./lab merge parts/*.exr -o whole.exr")
        self.assert_is_one_render("whole.exr")
