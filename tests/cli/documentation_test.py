"""The pages name files and code: what they name must exist."""

import re
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools"))
import make_numerics  # noqa: E402  (found by the line above)

PAGES = [ROOT / "README.md", *sorted(ROOT.glob("docs/*.md")), *sorted(ROOT.glob("chapters/*/README.md"))]


def sources():
    """The text of all code, where identifiers of the pages are looked up."""
    files = [
        path
        for folder in ("common", "shaders", "chapters", "tools", "tests")
        for path in (ROOT / folder).rglob("*")
        if path.suffix in {".h", ".cpp", ".glsl", ".comp", ".rgen", ".rchit", ".rmiss", ".py"}
    ]
    return "\n".join(path.read_text(encoding="utf-8") for path in [*files, ROOT / "lab"])


class DocumentationTest(unittest.TestCase):
    def test_links_lead_to_files(self):
        for page in PAGES:
            for target in re.findall(r"\]\(([^)#]+)\)", page.read_text(encoding="utf-8")):
                if "://" not in target:
                    self.assertTrue((page.parent / target).exists(), f"{page.name}: no file {target}")

    def test_code_that_is_named_exists(self):
        text = sources()
        for page in PAGES:
            for code in re.findall(r"`([^`\n]+)`", page.read_text(encoding="utf-8")):
                # Names with an underscore or a scope, and calls, are taken for identifiers of ours or of Vulkan's.
                for name in re.findall(r"\b[A-Za-z]\w*(?:::\w+)+|\b[a-z]\w*_\w+\b|\b\w+(?=\()", code):
                    last = name.split("::")[-1]
                    if last.startswith("VK_") or last in KNOWN_ELSEWHERE:
                        continue
                    self.assertIn(last, text, f"{page.name}: `{code}` names {last}, which no source has")

    def test_results_are_what_the_records_say(self):
        for tool in ("make_results.py", "make_numerics.py"):
            subprocess.run([sys.executable, "-B", ROOT / "tools" / tool, "--check"], check=True)

    def test_every_numerical_trap_has_tests_that_exist(self):
        cases = make_numerics.load_cases()
        listed = {case["research"] for case in cases}
        self.assertEqual([trap for trap in NUMERICAL_TRAPS if trap not in listed], [])
        for case in cases:
            self.assertEqual(bool(case["tests"]), case["research"] not in TRAPS_THAT_CANNOT_OCCUR, case["case"])
        self.assertEqual(make_numerics.missing_tests(), [])


# Section 3 of our survey of renderers; there is no sampling by solid angle (3.7) that could go wrong.
NUMERICAL_TRAPS = [f"3.{number}" for number in range(1, 25)]
TRAPS_THAT_CANNOT_OCCUR = {"3.7"}

# What the pages quote from the slides, the blog and GLSL.
KNOWN_ELSEWHERE = {"pixel_index", "frame_index", "my_model"}

if __name__ == "__main__":
    unittest.main()
