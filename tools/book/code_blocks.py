"""Fills the code on the pages from its source. In a page, the text between the lines

<!-- code: FILE | first phrase | last phrase -->
```glsl
...
```
<!-- end of code -->

is replaced by lines of FILE, a path from the project's root. The excerpt begins with the only line that contains the first phrase and ends
with the next line that contains the last phrase. The indentation of its first line is removed.
"""
import re

from project import ROOT, UserError

MARKER = "<!-- code:"
BLOCK = re.compile(
    r"(?P<marker><!-- code: (?P<file>\S+) \| (?P<first>[^\n]+?) \| (?P<last>[^\n]+?) -->\n)"
    r"(?P<fence>```\w*\n)(?P<lines>.*?)(?P<end>```\n<!-- end of code -->)",
    re.DOTALL,
)


def excerpt(text, first, last, name):
    """The lines of a text from the first phrase to the last. `name` is for messages."""
    lines = text.splitlines()
    places = [number for number, line in enumerate(lines) if first in line]
    if len(places) != 1:
        raise UserError(f"{name}: '{first}' is in {len(places)} lines: name a phrase that is in exactly one")
    end = next((number for number in range(places[0], len(lines)) if last in lines[number]), None)
    if end is None:
        raise UserError(f"{name}: '{last}' is in no line from '{first}' on: name a phrase of the block's last line")
    chosen = lines[places[0] : end + 1]
    indent = re.match(" *", chosen[0])[0]
    return "".join(line.removeprefix(indent) + "\n" for line in chosen)


def fill(text, page):
    """The text of a page with its blocks updated from the sources. `page` is for messages."""

    def filled(block):
        marker, file, first, last, fence, _, end = block.groups()
        if not (ROOT / file).is_file():
            raise UserError(f"{page}: code of {file}: there is no such file")
        return marker + fence + excerpt((ROOT / file).read_text(encoding="utf-8"), first, last, f"{page}: code of {file}") + end

    if len(BLOCK.findall(text)) != text.count(MARKER):
        raise UserError(
            f"{page}: '{MARKER}' must be followed by FILE | first phrase | last phrase -->, a block in ``` and "
            "<!-- end of code -->, a line each"
        )
    return BLOCK.sub(filled, text)


def find_once(text, piece, exercise):
    if text.count(piece) != 1:
        raise UserError(f"stale: {exercise['file']} has {text.count(piece)} places with {piece!r}")
    return text.index(piece)


def exercise_parts(text, exercise):
    """The solution as it stands in a shader, and the placeholder that goes there."""
    begin = find_once(text, exercise["first"], exercise)
    end = find_once(text, exercise["last"], exercise) + len(exercise["last"])
    if begin >= end:
        raise UserError(f"stale: {exercise['file']}: {exercise['last']!r} is before {exercise['first']!r}")
    indent = " " * (begin - text.rindex("\n", 0, begin) - 1)
    return text[begin:end], f"\n{indent}".join(exercise["placeholder"])


def take_out(text, exercise):
    """The shader with the placeholder instead of the solution, and the solution."""
    solution, placeholder = exercise_parts(text, exercise)
    return text.replace(solution, placeholder), solution
