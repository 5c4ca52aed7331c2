"""Draws which rooms include which, as docs/diagrams/rooms.svg, from the lines with #include and import.

The rooms and their order are those of the table in common/README.md: a room may include only rooms below it. Only the programs include
the two annexes. The notebook includes rooms, and nothing outside includes the notebook.
"""
import re
from html import escape

from includes import INCLUDE, includes, named_files
from project import ROOT, Parser, write_bytes

DIAGRAM = ROOT / "docs/diagrams/rooms.svg"
TABLE_ROW = re.compile(r"^\| `([\w/]+)/` \|", re.MULTILINE)
IMPORT = re.compile(r"^ *(?:from|import) (\w+)", re.MULTILINE)
SUFFIXES = {".h", ".cpp", ".glsl", ".comp", ".rgen", ".rchit", ".rmiss", ".py"}
WIDTH, CELL, LEFT = 640, 16, 190  # in pixels; names are left of the cells
COLOURS = {"common": "#2f7de1", "shaders": "#2c8f4e", "chapters": "#b86e00", "tools": "#9b62d6"}
GREY = "#787d83"
ANNEXES = ("common/viewer", "common/native")


def read_rooms():
    """The existing rooms, from the top to the bottom of the table."""
    return [name for name in TABLE_ROW.findall((ROOT / "common/README.md").read_text(encoding="utf-8")) if (ROOT / name).is_dir()]


def files_of(rooms):
    """Source -> its room."""
    return {path: room for room in rooms for path in sorted((ROOT / room).rglob("*")) if path.suffix in SUFFIXES}


def included_files(path):
    """The files that a source includes or imports."""
    if path.suffix == ".py":
        return [ROOT / "tools" / name for name in IMPORT.findall(path.read_text(encoding="utf-8"))]
    first = min((ROOT / "chapters").iterdir())  # any chapter, where the programs decide which one
    return includes(path, named_files(path.parent if path.is_relative_to(first.parent) else first))


def uses():
    """(room, other room) -> one source of the room and what it includes from the other."""
    rooms = read_rooms()
    found = {}
    for path, room in files_of(rooms).items():
        for target in included_files(path):
            other = next((name for name in rooms if target.is_relative_to(ROOT / name)), room)
            if other != room:
                found.setdefault((room, other), f"{path.relative_to(ROOT)} includes {target.relative_to(ROOT)}")
    return found


def upward():
    """Sources that include a room above their own, and chapters that include a later one."""
    rooms = read_rooms()
    wrong = [text for (room, other), text in uses().items() if rooms.index(room) > rooms.index(other)]
    for path in sorted((ROOT / "chapters").glob("*/*.glsl")):
        wrong += [
            f"{path.relative_to(ROOT)} includes {target.relative_to(ROOT)}"
            for target in included_files(path)
            if target.is_relative_to(ROOT / "chapters") and target.parent.name > path.parent.name
        ]
    return wrong


def into_the_annexes():
    """Sources outside common/app that include the window or the native backend, which the course does without."""
    return [text for (room, other), text in uses().items() if other in ANNEXES and room != "common/app"]


def into_the_notebook():
    """Sources outside the notebook that include or import something of it, and those of no test that name a path into it. The tools know
    one: project.KNOWLEDGE."""

    def modules(folder):
        return {path.stem for path in (ROOT / folder).rglob("*.py")} | {path.name for path in (ROOT / folder).glob("*/")}

    found, own = [], modules("notebook") - modules("tools") - modules("tests")
    for folder in ("common", "shaders", "chapters", "tools", "tests"):
        for path in sorted(path for path in (ROOT / folder).rglob("*") if path.suffix in SUFFIXES):
            text = path.read_text(encoding="utf-8")
            names = [name for name in INCLUDE.findall(text) if (ROOT / "notebook" / name).is_file()] + [
                name for name in IMPORT.findall(text) if name in own
            ]
            if folder != "tests" and path != ROOT / "tools/project.py":
                names += re.findall(r"""["'/](notebook/[^"']*)""", text)
            found += [f"{path.relative_to(ROOT)} uses {name}" for name in names]
    return found


def picture():
    """SVG: a dot in row i and column j where room i includes room j. Dots left of the diagonal go upwards."""
    rooms, found, shapes, top = read_rooms(), uses(), [], 20

    def text(x, y, words, colour, anchor):
        shapes.append(f'<text x="{x}" y="{y}" font-size="12" fill="{colour}" text-anchor="{anchor}">{escape(words)}</text>')

    for i, room in enumerate(rooms):
        y, colour = top + CELL * i, COLOURS[room.split("/")[0]]
        shapes.append(
            f'<path d="M{LEFT} {y + CELL} L{LEFT + CELL * len(rooms)} {y + CELL}" stroke="{GREY}" stroke-width="0.3" fill="none"/>'
        )
        text(LEFT - 24, y + 12.5, f"{room}/", colour, "end")
        text(LEFT - 6, y + 12.5, str(i + 1), colour, "end")
        text(LEFT + CELL * i + CELL / 2, top - 6, str(i + 1), colour, "middle")
        shapes.append(
            f'<rect x="{LEFT + CELL * i + 3}" y="{y + 3}" width="{CELL - 6}" height="{CELL - 6}" fill="{GREY}" fill-opacity="0.4"/>'
        )
    for room, other in found:
        x, y = (rooms.index(name) * CELL + CELL / 2 for name in (other, room))
        shapes.append(f'<circle cx="{LEFT + x}" cy="{top + y}" r="4.5" fill="{COLOURS[room.split("/")[0]]}"/>')
    height = top + CELL * len(rooms) + 6
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" width="{WIDTH}" height="{height}" font-family="sans-serif">',
            "<title>Rooms and what they include</title>",
            "<desc>A dot says that the room of its row includes the room of its column. "
            "All dots are on the right of the diagonal: no room includes one above it.</desc>",
            *shapes,
            "</svg>",
            "",
        ]
    )


def main():
    Parser("python3 tools rooms", __doc__).parse_args()
    write_bytes(DIAGRAM, picture().encode())
