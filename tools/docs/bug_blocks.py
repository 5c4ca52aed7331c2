"""The bugs in docs/bugs.md, with texts from the catalogue of mistakes."""
import textwrap

from course.bug import caught_by, changes
from course.mistakes import bugs_of, records
from project import CHAPTERS, UserError

# Name of the mistake -> chapter and reference.
GALLERY = {
    mistake["name"]: (chapter, mistake["gallery"])
    for chapter, mistakes in records().items()
    for mistake in mistakes
    if "gallery" in mistake
}


def find_bug(name):
    """The bug of the gallery with this name, and its number within the chapter."""
    if name not in GALLERY:
        raise UserError(f"there is no bug '{name}' in the gallery: {', '.join(GALLERY)}")
    chapter, _ = GALLERY[name]
    return next((bug, index) for index, bug in enumerate(bugs_of(chapter), 1) if bug.mistake["name"] == name)


def bug_block(name):
    """The picture and the question, and the start of a collapsed answer: the changed lines, the explanation, and the test that
    catches it."""
    bug, index = find_bug(name)
    rows = [(mark, line) for mark, line, _ in changes(bug) if mark != " "]
    lines = textwrap.dedent("\n".join(line for _, line in rows)).split("\n")
    shown = "\n".join(f"{mark} {line}".rstrip() for (mark, _), line in zip(rows, lines))
    return (
        f"![Right, wrong and their difference](pictures/bugs_{name}.jpg)\n\n"
        f"`./lab bug {bug.chapter} {index} --scene {GALLERY[name][1]}` asks: *{bug.question}*\n\n"
        f"<!-- live: {GALLERY[name][1]} by {CHAPTERS[bug.chapter][3:]} bug {index} -->\n\n<details><summary>Answer</summary>\n\n"
        f"```diff\n{shown}\n```\n{bug.mistake['explanation']} `{caught_by(bug)[1]}` catches it.\n"
    )
