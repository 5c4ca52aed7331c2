"""Makes the modules of tools/, tests/ and tests/mistakes importable, in a Python that has the packages they need."""

import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
TOOLS = PROJECT / "tools"
sys.path += map(str, (TOOLS, PROJECT / "tests", PROJECT / "tests/mistakes"))

import project  # noqa: E402  (found by the line above)

project.ensure_packages()
