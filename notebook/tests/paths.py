"""Makes the modules of the notebook, of tools/ and of tests/ importable, in a Python that has the packages they need."""

import sys
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
sys.path += map(str, (PROJECT / "notebook", PROJECT / "tools", PROJECT / "tests", PROJECT / "tests/cli"))

import project  # noqa: E402  (found by the line above)

project.ensure_packages()
