"""Where sources find what they include, as programs do: see common/tracing/tracer.h and common/gpu/shader_compiler.h."""
import re
from pathlib import Path

from project import CHAPTERS, ROOT, read_json, text_of

INCLUDE = re.compile(r'^ *#include "([^"]+)"', re.MULTILINE)
FOLDERS = ("shaders", "chapters", "common", ".")  # of all sources


def continued(folder):
    """The folder of a chapter, that of the chapter which it continues, and so on."""
    while folder:
        yield folder
        file = folder / "chapter.json"
        name = file.exists() and read_json(file).get("continues")
        folder = name and ROOT / "chapters" / name


def named_files(folder):
    """{name: file} of the estimator in a chapter's folder and of the files that chapters may replace: its own, or those that it gets instead."""
    named, folders = {"path_trace.glsl": folder / "path_trace.glsl"}, list(continued(folder))
    for file in map(Path, read_json(ROOT / "shaders/replaceable.json")):
        places = [*(other / file.name for other in folders), ROOT / "shaders" / file]
        named |= {file.name: place for place in [next(filter(Path.exists, places), None)] if place}
    return named


def included(line, source, named):
    """The file that a line of a source includes, or None. The names that `named` has stand for those files."""
    if not (match := INCLUDE.match(line)):
        return None
    name = match[1]
    places = [named.get(name, source.parent / name), *(ROOT / folder / name for folder in FOLDERS)]
    return next((place.resolve() for place in places if place.is_file()), None)


def includes(source, named):
    """The files that a source includes."""
    return [file for line in text_of(source).splitlines() if (file := included(line, source, named))]


def shaders_of(number):
    """The shaders that make up a chapter: those in its folder, and those of other chapters that it gets or includes."""
    chapters = ROOT / "chapters"
    folder = chapters / CHAPTERS[number]
    named = named_files(folder)
    shaders = list(
        dict.fromkeys([*sorted(folder.glob("*.glsl")), *(file for file in named.values() if file.is_relative_to(chapters))])
    )
    for shader in shaders:  # grows meanwhile
        shaders += [file for file in includes(shader, named) if file.is_relative_to(chapters) and file not in shaders]
    return shaders
