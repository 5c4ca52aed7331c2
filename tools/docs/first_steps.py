"""The shaders of docs/first_steps.md, taken from the page itself."""
import re

from project import ROOT, UserError

PAGE = ROOT / "docs/first_steps.md"
STEP = re.compile(r"^## (\d+)\. (.*?)(?=^## |\Z)", re.DOTALL | re.MULTILINE)
SHADER = re.compile(r"^```glsl\n(.*?)^```$", re.DOTALL | re.MULTILINE)
BREAK_IT = re.compile(r"\*Break it:\* change `([^`]+)` to `([^`]+)`")


def shaders(text):
    """Name -> shader in the page's text: "N" for step N, and "N broken" with the mistake that this step suggests."""
    found = {}
    for number, step in STEP.findall(text):
        blocks = SHADER.findall(step)
        if len(blocks) != 1:
            raise UserError(f"{PAGE.name}: step {number} has {len(blocks)} blocks of glsl instead of one")
        found[number] = blocks[0]
        for piece, mistake in BREAK_IT.findall(" ".join(step.split())):
            if blocks[0].count(piece) != 1:
                raise UserError(f"{PAGE.name}: step {number} has {blocks[0].count(piece)} places with {piece!r}")
            found[f"{number} broken"] = blocks[0].replace(piece, mistake)
    return found
