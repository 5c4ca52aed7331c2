"""./lab benchmark: the table it prints and the file behind it."""

import json
import math
import re
import socket

from program import BINARIES, PROJECT, ProgramTest

SMALL = ["cornell_box_1", "--backend=compute", "--seconds=0.2", "--output=benchmark.json"]


class BenchmarkTest(ProgramTest):
    def start_benchmark(self, *arguments):
        return self.start_tool("benchmark", *arguments, environment={"LAB_BINARIES": str(BINARIES)})

    def test_table_and_file_say_what_was_measured(self):
        with self.start_benchmark(*SMALL) as process:
            out, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, err)
        record = json.loads((self.folder / "benchmark.json").read_text())
        self.assertTrue(record["is_complete"])
        case, row = record["cases"][0], record["summary"][0]  # GPUs have a larger one as well
        self.assertEqual([run["seed"] for run in case["runs"]], [1, 2, 3, 4, 5])
        self.assertEqual((row["scene"], row["backend"], len(row["paths_per_second"])), ("cornell_box", "compute", 5))
        seconds = [run["rows"][-1]["seconds"] * run["rows"][-1]["rel_mse"] / 0.01**2 for run in case["runs"]]
        self.assertAlmostEqual(row["seconds_to_1_percent"] - row["start_up_seconds"], sum(seconds) / 5, places=9)
        self.assertTrue(0 < row["start_up_seconds"] < math.inf)
        for name in ("device", "driver", "commit", "date", "system"):
            self.assertIn(record["environment"][name], out)
        cells = [cell.strip() for cell in re.search(r"\| cornell_box \|.*", out)[0].split("|")]
        self.assertEqual(cells[2], "`compute`")
        self.assertAlmostEqual(float(cells[4]) * 1e6 / sorted(row["paths_per_second"])[2], 1, delta=0.01)
        self.assertEqual(cells[6], "1.00 (1.00 – 1.00)")
        self.assertNotIn(str(PROJECT), json.dumps(record) + out)
        self.assertNotRegex(record["environment"]["system"], rf"\b{re.escape(socket.gethostname())}\b")

    def test_wrong_arguments(self):
        for arguments, *words in ((["no_such_scene"], "no_such_scene", "cornell_box"), (["--seconds=0"], "seconds", "lab benchmark --help")):
            with self.start_benchmark(*arguments) as process:
                _, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 1)
            for word in words:
                self.assertRegex(err, word)
            self.assertEqual(err.count("\n"), 1, err)
