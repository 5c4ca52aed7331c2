"""The patterns of the tools read any text in a time that grows with its length: one of links once kept ./lab handout busy for an hour."""

import ast
import importlib
import json
import re
import subprocess
import sys
import unittest
from contextlib import suppress

from tools_path import TOOLS  # first: it finds the others
from project import UserError

MANY, PATIENCE = 40, 60  # seconds for a text, of which all patterns together take milliseconds
STARTS = [
    "",
    "[",
    "[`",
    "](",
    "<!-- ",
    "<!-- code: a | ",
    "| `f(",
    "\n\n    ",
    "<details><summary>\n\n",
    "```c\n",
    "Done when all tests named ",
]
PIECES = [
    "[",
    "]",
    "`a b` ",
    "`f(x)`, ",
    "[`a`",
    "[a](b",
    "`",
    "(",
    "((a)",
    "![a](b)",
    "a, ",
    "a b\n",
    "<!-- ",
    " ",
    "\n",
    "x_1 ",
    "\\frac{",
    "*",
    "0",
    '"',
    "// ",
]


def patterns():
    """The patterns that modules of the tools compile, and those that stand in calls of `re`, with their flags."""
    found = set()
    for file in sorted(TOOLS.rglob("*.py")):
        if file.name != "__main__.py":
            with suppress(ModuleNotFoundError, UserError):  # of a package that only a debugger or another renderer has
                module = importlib.import_module(".".join(file.relative_to(TOOLS).with_suffix("").parts))
                found |= {
                    (each.pattern, each.flags)
                    for value in vars(module).values()
                    for each in (value if isinstance(value, list) else [value])
                    if isinstance(each, re.Pattern)
                }
        for call in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if (
                isinstance(call, ast.Call)
                and isinstance(call.func, ast.Attribute)
                and getattr(call.func.value, "id", "") == "re"
                and isinstance(call.args[0], ast.Constant)
            ):
                found |= {(call.args[0].value, flags) for flags in (0, int(re.MULTILINE))}
    return sorted((pattern, flags) for pattern, flags in found if isinstance(pattern, str))


SEARCH = """
import json, re, sys
text, patterns = json.load(sys.stdin)
for pattern, flags in patterns:
    print(pattern, flush=True)
    re.sub(pattern, "", text, flags=flags)
"""


class PatternsTest(unittest.TestCase):
    def test_none_takes_forever(self):
        known = patterns()
        self.assertGreater(len(known), 60)
        for start in STARTS:
            text = "\n\n".join(start + piece * MANY for piece in PIECES)
            child = subprocess.Popen([sys.executable, "-c", SEARCH], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            try:
                child.communicate(json.dumps([text, known]), timeout=PATIENCE)
            except subprocess.TimeoutExpired:
                child.kill()
                self.fail(f"{start!r}: {child.communicate()[0].splitlines()[-1]}")
            self.assertEqual(child.returncode, 0)
