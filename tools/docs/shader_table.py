"""The tables of docs/shader.md: what the chapters use of the shaders that all share, and of each other. Each line is a declaration, the
first sentence of its comment, and the first chapter that uses it.
"""
import re
from pathlib import Path
from typing import NamedTuple

from includes import shaders_of
from project import CHAPTERS, ROOT, UserError, course, table

INTERFACE = "shaders/interface.h"
TOPICS = {  # heading: sources
    "Rays": [
        "shaders/world/ray.glsl",
        "shaders/world/camera.glsl",
        "shaders/engine/trace_ray/compute.glsl",
        "shaders/engine/render_samples.glsl",
    ],
    "The point that a ray hits": ["shaders/world/shading_data.glsl", "shaders/world/frame.glsl"],
    "Random numbers": ["shaders/world/random.glsl", "shaders/world/random_words.glsl"],
    "Materials": [
        "shaders/world/scene.glsl",
        "shaders/world/brdf.glsl",
        "shaders/world/materials.glsl",
        *sorted(path.relative_to(ROOT).as_posix() for path in (ROOT / "shaders/world/materials").glob("*.glsl")),
    ],
    "Lights and the background": ["shaders/world/lights.glsl", "shaders/world/background.glsl", "shaders/world/light_probe.glsl"],
    "Media": ["shaders/world/boundaries.glsl"],
    "Light for other pixels": ["shaders/engine/splats.glsl"],
    "Filters": ["shaders/engine/filter_steps.glsl"],
    "Options and constants": ["shaders/world/constants.glsl", INTERFACE],
}
NO_CODE = re.compile(r"//[^\n]*|/\*.*?\*/|#include[^\n]*", re.DOTALL)
DECLARATIONS = [
    re.compile(pattern)
    for pattern in (  # with the groups code and name
        r"(struct (\w+)) \{",
        r"(?:const \w+|SHARED_\w+|#define) (([A-Z]\w*))\b",
        r"(\w+ (\w+)\([^()]*\)) \{",
        r"layout.* buffer \w+ \{ (\w+ (\w+)\[\]);",
    )
]
ARRAY = re.compile(r"^layout.* buffer \w+ \{ (\w+) (\w+)\[\];", re.MULTILINE)  # its elements and its name
MEMBER = re.compile(r"^ {4}(\w+ (\w+)(?:\[\w+\])?);", re.MULTILINE)  # code and name
PARAMETERS = "RenderParameters"  # shaders read its members as parameters.NAME


class Item(NamedTuple):
    """What a source declares. `comment` is empty if it has none."""

    code: str
    name: str
    comment: str


def read(file):
    return (ROOT / file).read_text(encoding="utf-8")


def comment_of(lines, index):
    """The comment beside a line, or else the first sentence of the one above it; lines for the preprocessor may lie between."""
    beside = lines[index].partition(";  ")[2].partition("// ")[2]
    above = []
    for line in reversed([] if beside else lines[:index]):
        if line.startswith("// "):
            above.insert(0, line[3:])
        elif above or not line.startswith("#"):
            break
    return (beside or re.split(r"(?<=\.) (?=[A-Z(`])", " ".join(above))[0]).strip().rstrip(".")


def declared(path):
    """The items of a source, without second declarations for scenes that lack a feature."""
    lines, found = read(path).splitlines(), {}
    for index, line in enumerate(lines):
        if match := next(filter(None, (pattern.match(line) for pattern in DECLARATIONS)), None):
            found.setdefault(match[1], Item(*match.groups(), comment_of(lines, index)))
    return list(found.values())


def members(path, struct):
    lines = read(path).splitlines()
    first = lines.index(f"struct {struct} {{")
    inner = lines[first + 1 : lines.index("};", first)]
    return [Item(*match.groups(), comment_of(inner, index)) for index, line in enumerate(inner) if (match := MEMBER.match(line))]


def first_uses(shaders):
    """A function that returns the number of the first chapter that uses a name, or None. `shaders` is {number: files}."""
    texts = {number: NO_CODE.sub("", "\n".join(map(read, files))) for number, files in shaders.items()}
    return lambda name: next(
        (number for number, text in texts.items() if re.search(rf"(?:\b|(?=\.)){re.escape(name)}\b", text)), None
    )


def row(item, number, path):
    """A line of a table. No chapter may read a member of a struct by itself."""
    if not item.comment:
        raise UserError(f"{path}: '{item.code}' has no comment: say what it is and in which units, beside it or above it")
    comment = item.comment.replace("|", "\\|").replace("<", "&lt;").replace("*", "\\*")
    return [f"`{item.code}`", comment, f"[{number}](../chapters/{CHAPTERS[number]}/README.md)" if number else "–"]


def rows_of(path, first_use, elements):
    """The lines for a source. Members of a struct follow it; of the parameters, those that chapters use. `elements` has the array of
    a struct's name, since shaders may use a struct without naming it."""
    for item in declared(path):
        number = first_use(item.name) or first_use(elements.get(item.name, item.name))
        is_struct = item.code.startswith("struct ")
        if number:
            yield row(item, number, path)
        if is_struct and item.name == PARAMETERS:
            named = [member._replace(code=f"parameters.{member.name}") for member in members(path, item.name)]
            yield from (row(member, first_use(member.code), path) for member in named if first_use(member.code))
        elif is_struct and number:
            uses = [(member, first_use(f".{member.name}")) for member in members(path, item.name)]
            yield from (
                row(member._replace(code=member.code.replace(" ", f" {item.name}.")), use and max(use, number), path)
                for member, use in uses
            )


def section(heading, paths, rows):
    sources = ", ".join(f"[{Path(path).name}](../{path})" for path in paths)
    return f"\n## {heading}\n\nFrom {sources}.\n\n" + table(["name", "what it is", "chapter"], rows, left=3)


def shared_between(shaders):
    """{source: the lines for it} of the chapters' files that other chapters get or include."""
    taken = {file for number, files in shaders.items() for file in shaders_of(number) if file not in files}
    paths = {file.relative_to(ROOT).as_posix(): number for number, files in shaders.items() for file in files if file in taken}
    return {
        path: [row(item, number, path) for item in declared(path) if item.name != "path_trace"] for path, number in paths.items()
    }


def shader_tables():
    shaders = {number: sorted((ROOT / "chapters" / CHAPTERS[number]).glob("*.glsl")) for number in course()}
    first_use, elements = first_uses(shaders), dict(ARRAY.findall(read("shaders/world/scene.glsl")))
    text = "".join(
        section(heading, paths, [line for path in paths for line in rows_of(path, first_use, elements)])
        for heading, paths in TOPICS.items()
    )
    shared = {path: rows for path, rows in shared_between(shaders).items() if rows}
    return text + section("What chapters share", shared, [line for rows in shared.values() for line in rows]) + "\n"
