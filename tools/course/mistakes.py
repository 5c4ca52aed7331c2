"""The mistakes in the chapters' mistakes.json, and how to plant them into the chapters' shaders.

A record replaces the text `find`, which must occur exactly once, by `replace`: in a shader of its chapter's folder, in one that these
include from other chapters, or in `file`. If a chapter can have an earlier chapter's mistake, it has its own record with that name. These
need to be in one of the records only: the "explanation"; for ./lab check the "hint" and the "slide" to read again; the "test" that the
mistake turns red. Where the lecture has no slide, a record names the "section" of its own chapter's page.
A mistake that leaves the picture right has instead a "question", and under "sanitizer" a scene, and options, with which --sanitize finds it.
"""
from dataclasses import dataclass
from pathlib import Path

from includes import shaders_of
from project import CHAPTERS, ROOT, UserError, course, original, read_json, text_of

NO_QUESTION = "Where do the two pictures differ, and which line decides that?"
SAID_ONCE = ("explanation", "hint", "slide", "test")
# In shaders that no chapter teaches.
ENGINE = ROOT / "tests/mistakes/engine.json"


class Stale(UserError):
    """A piece of text to be replaced is no longer where it was."""


@dataclass
class Bug:
    """A mistake in a chapter: its record, and one of the chapter's shaders containing it."""

    chapter: int
    mistake: dict
    file: Path
    text: str

    @property
    def question(self):
        return self.mistake.get("hint") or self.mistake.get("question", NO_QUESTION)


def own_shader(chapter):
    return ROOT / "chapters" / CHAPTERS[chapter] / "path_trace.glsl"


def plant(text, find, replace, what):
    if text.count(find) != 1:
        raise Stale(f"stale: {what}: {text.count(find)} places with {find!r}")
    return text.replace(find, replace)


def records():
    """The mistakes of each chapter as its file lists them, and the engine's under None. Of chapters with the same title only the
    first one counts."""
    files = {chapter: own_shader(chapter).with_name("mistakes.json") for chapter in course()} | {None: ENGINE}
    return {chapter: read_json(file) for chapter, file in files.items() if file.exists()}


def complete(record, everything):
    """A record completed from other records of the same mistake; the first one with an entry counts."""
    same = [other for others in everything.values() for other in others if other["name"] == record["name"]]
    return {key: other[key] for other in reversed(same) for key in SAID_ONCE if key in other} | record


def shader_of(chapter, record):
    """The shader that contains the text to be replaced, or else the estimator."""
    if "file" in record:
        folders = [own_shader(chapter).parent, ROOT] if chapter else [ROOT]
        return next((folder / record["file"] for folder in folders if (folder / record["file"]).exists()), ROOT / record["file"])
    return next((file for file in shaders_of(chapter) if record["find"] in text_of(file)), own_shader(chapter))


def planted(chapter, mistake):
    """The bug that a record makes in a chapter's shaders."""
    file = shader_of(chapter, mistake)
    listed = own_shader(chapter).with_name("mistakes.json") if chapter else ENGINE
    what = f"{mistake['name']} in {listed.relative_to(ROOT)} (correct or delete it): {file.name}"
    return Bug(chapter, mistake, file, plant(text_of(file), mistake["find"], mistake["replace"], what))


def bugs_of(chapter):
    """The bugs of a chapter, or of the one it is a copy of, in the order of its file. A bug listed under two names counts
    once."""
    everything, bugs = records(), {}
    for record in everything.get(original(chapter), []):
        if "file" not in record:
            bug = planted(chapter, complete(record, everything))
            bugs.setdefault(bug.text, bug)
    return list(bugs.values())


def catalogue():
    """The bugs that ./lab check should know, of all chapters."""
    return [bug for chapter in records() if chapter for bug in bugs_of(chapter) if "hint" in bug.mistake]
