"""The catalogue of mistakes, tests/mistakes/mistakes.json, and how they are planted into the chapters' shaders."""
from dataclasses import dataclass

from project import CHAPTERS, ROOT, UserError, read_json

CATALOGUE = ROOT / "tests/mistakes/mistakes.json"
NO_QUESTION = "Where do the two pictures differ, and which line decides that?"


class Stale(UserError):
    """A piece of text to be replaced is not where it was."""


@dataclass
class Bug:
    """A mistake in a chapter: its entry in the catalogue and the chapter's shader with it."""
    chapter: int
    mistake: dict
    text: str

    @property
    def question(self):
        return self.mistake.get("check", {}).get("hint", NO_QUESTION)


def own_shader(chapter):
    return ROOT / "chapters" / CHAPTERS[chapter] / "path_trace.glsl"


def plant(text, find, replace, what):
    if text.count(find) != 1:
        raise Stale(f"stale: {what}: {text.count(find)} places with {find!r}")
    return text.replace(find, replace)


def planted(mistake, chapter, piece):
    """The bug that a piece with `find` and `replace` makes of a chapter's shader."""
    text = own_shader(chapter).read_text(encoding="utf-8")
    return Bug(chapter, mistake, plant(text, piece["find"], piece["replace"], f"{mistake['name']} in chapter {chapter}"))


def plantings(mistake):
    """Pairs (chapter, piece) in which ./lab check is to know a mistake."""
    return [(chapter, {**mistake, **planting}) for planting in mistake.get("check", {}).get("plantings", [])
            for chapter in planting["chapters"]]


def catalogue():
    """(chapter, mistake, text of the chapter's shader with it) for all mistakes that check is to know."""
    for mistake in read_json(CATALOGUE):
        for chapter, piece in plantings(mistake):
            yield chapter, mistake, planted(mistake, chapter, piece).text


def bugs_of(chapter):
    """The bugs of a chapter in the order of the catalogue: those that check is to know, and those that a test plants into this
    shader. One that stands there under two names counts once."""
    own, bugs = str(own_shader(chapter).relative_to(ROOT)), {}
    for mistake in read_json(CATALOGUE):
        pieces = [piece for number, piece in plantings(mistake) if number == chapter]
        if not pieces and mistake.get("file") == own:
            pieces = [mistake]
        for piece in pieces:
            bug = planted(mistake, chapter, piece)
            bugs.setdefault(bug.text, bug)
    return list(bugs.values())
