"""./lab diff: the difference of neighbouring chapters' shaders, with counts of what has changed."""

import os
import subprocess
import unittest

from program import PROJECT as ROOT, open_terminal  # first: it finds the tools
from lesson import diff as show_diff

STEPS = show_diff.BEFORE


def diff(*arguments, **streams):
    return subprocess.run([ROOT / "lab", "diff", *map(str, arguments)], text=True, **streams)


class DiffTest(unittest.TestCase):
    def test_rows_are_the_two_shaders(self):
        for number in STEPS:
            before, after = map(show_diff.shader_lines, (STEPS[number], number))
            rows, _, moved = show_diff.compare(before, after)
            self.assertEqual([line for mark, line, _ in rows if mark != "-"], after)
            kept = [line for mark, line, _ in rows if mark != "+" and line.strip()]
            missing = len([line for line in before if line.strip()]) - len(kept)
            self.assertEqual(missing, sum(count for count, _ in moved))
            rest = iter(before)
            self.assertTrue(all(line in rest for line in kept), "in another order")

    def test_counts(self):
        before = ["// One.", "float a = 1.0;", "", "float b = 2.0;", "float c;"]
        after = ["// Two.", "float a = 1.5;", "", "float b = 2.0;  // still", "float d;", "float e;"]
        _, counts, _ = show_diff.compare(before, after)
        self.assertEqual(counts, {"code": 4, "comments": 1, "words": 4})  # 1.5; d and a line with float and e
        self.assertEqual(show_diff.compare(before, before)[1], {"code": 0, "comments": 0, "words": 0})

    def test_what_later_chapters_share_counts_as_moved(self):
        *_, moved = show_diff.compare(*map(show_diff.shader_lines, (3, 4)))
        body = (ROOT / "shaders/direct_light.glsl").read_text(encoding="utf-8").splitlines()[2:]
        self.assertEqual(moved, [(sum(bool(line.strip()) for line in body), "shaders/direct_light.glsl")])

    def test_is_plain_unless_on_a_terminal(self):
        plain = diff(5, stdout=subprocess.PIPE).stdout
        self.assertNotIn("\033", plain)
        self.assertIn("+             throughput /= survival_probability;\n", plain)
        leader, follower = open_terminal()
        self.assertEqual(diff(5, stdout=follower).returncode, 0)
        os.close(follower)
        self.assertIn(b"\033[32m", os.read(leader, 1 << 16))
        os.close(leader)

    def test_all_names_every_step(self):
        lines = diff("all", stdout=subprocess.PIPE).stdout.splitlines()
        self.assertEqual([line.split(":")[0] for line in lines], [f"Chapter {m} to {n}" for n, m in STEPS.items()])

    def test_other_words_are_refused(self):
        for word in ("1", "99", "", "two", "-3"):
            result = diff(word, capture_output=True)
            self.assertEqual(result.returncode, 1)
            self.assertRegex(result.stderr, r"\Aerror: [^\n]{20,}\n\Z")


if __name__ == "__main__":
    unittest.main()
