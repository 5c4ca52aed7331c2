"""Makes the modules of tools/, tests/ and tests/mistakes importable, in a Python that has the packages they need."""

import os
import sys
from importlib.util import find_spec
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
TOOLS = PROJECT / "tools"
DEBIANS_PYTHON = "/usr/bin/python3"  # has Debian's packages; the running Python may be another one

if not all(map(find_spec, ("matplotlib", "numpy", "PIL", "scipy"))) and sys.executable != DEBIANS_PYTHON:
    os.execv(DEBIANS_PYTHON, [DEBIANS_PYTHON, *sys.orig_argv[1:]])
sys.path += map(str, (TOOLS, PROJECT / "tests", PROJECT / "tests/mistakes"))
