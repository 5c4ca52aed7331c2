"""docs/cluster.md: its commands, run as written, give the picture of one long render."""

import os
import re
import signal
import subprocess
import time

from image_files import Exr
from program import BINARIES, MERGE, PROJECT, RenderTest

# What readers adapt: the settings before the first empty line of a block.
SETTINGS = """
renderer='build/bin/05_russian_roulette cornell_box --backend compute --width 24 --height 20'
devices='0'
samples=5
starts='0 5'
hosts='1/first,1/second'
"""
# Replaces ssh: both "hosts" are this machine. The second one dies in the middle of its first render, and stays dead.
SSH = """#!/bin/bash
host=$1 && shift && [[ $1 != -- ]] || shift
echo "$host" >>hosts
[[ $host == first ]] && exec bash -c "$*"
setsid bash -c "$*" & sleep 0.2; kill -KILL -- -$! 2>/dev/null; exit 255
"""
# Replaces ./lab, which would install and build first.
LAB = f"""#!/bin/sh
[ "$1" = merge ] && shift && exec '{MERGE}' "$@"
"""


class Cluster:
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
        result = subprocess.run(
            ["bash", "-c", text], cwd=self.folder, env={**os.environ, **variables}, capture_output=True, text=True, timeout=120
        )
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def assert_is_one_render(self, file, samples=10):
        """The picture equals that of a single render with all samples, to 2 ulp."""
        merged = Exr(self.folder / file)
        self.assertEqual(merged.text("samples"), str(samples))
        self.render(
            "cornell_box",
            "--backend=compute",
            "--width=24",
            "--height=20",
            f"--samples={samples}",
            "--quiet",
            "--output=one.exr",
            program=BINARIES / "05_russian_roulette",
        )
        self.assert_close(merged, Exr(self.folder / "one.exr"))


class ClusterTest(Cluster, RenderTest):
    def test_gnu_parallel(self):
        self.run_shell(self.block("Several GPUs"))
        self.assertEqual(len(list((self.folder / "parts").iterdir())), 2)
        self.assert_is_one_render("whole.exr")

    def test_slurm_array(self):
        """Slurm runs the script once per number; a task that runs again resumes its part."""
        script = self.block("A cluster")
        for task in ("1", "0", "1"):
            self.run_shell(script, SLURM_ARRAY_TASK_ID=task)
        self.run_shell("./lab merge parts/*.exr -o whole.exr")
        self.assert_is_one_render("whole.exr")


class ClusterRehearsal_all(Cluster, RenderTest):
    def test_several_machines_one_of_which_dies(self):
        ssh = self.write("ssh", SSH)
        ssh.chmod(0o755)
        commands = self.block("Several machines")
        self.run_shell(commands, PARALLEL_SSH=str(ssh))
        hosts = (self.folder / "hosts").read_text().split()
        self.assertIn("second", hosts)
        self.assertGreaterEqual(hosts.count("first"), 2)  # its own part, and the dead machine's
        self.assert_is_one_render("whole.exr")
        # A part rendered twice, on another machine: the log of the first render is gone.
        before = (self.folder / "parts/5.exr").read_bytes()
        (self.folder / "parts/log").unlink()
        self.run_shell(commands, PARALLEL_SSH=str(ssh))
        self.assertGreater(len((self.folder / "hosts").read_text().split()), len(hosts))
        self.assert_close(Exr(self.folder / "parts/5.exr"), Exr(self.write("before.exr", before)))
        self.assert_is_one_render("whole.exr")

    def test_slurm_requeues_a_task_whose_node_dies(self):
        script = self.block("A cluster").replace("--save-every 60", "--save-every 0.1")
        long = script.replace("samples=5", "samples=100000")
        process = subprocess.Popen(
            ["bash", "-c", long], cwd=self.folder, env={**os.environ, "SLURM_ARRAY_TASK_ID": "0"}, start_new_session=True
        )
        part, end = self.folder / "parts/0.exr", time.monotonic() + 60
        while not part.exists() and time.monotonic() < end:
            time.sleep(0.02)
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        done = int(Exr(part).text("samples"))  # the checkpoint is intact
        self.assertTrue(0 < done < 100000, done)
        samples = 2 * done
        script = script.replace("samples=5", f"samples={samples}")
        for task in ("0", "1"):
            self.run_shell(script, SLURM_ARRAY_TASK_ID=task)
        self.run_shell("./lab merge parts/*.exr -o whole.exr")
        self.assert_is_one_render("whole.exr", 2 * samples)
