"""Shaders with planted mistakes: those that ./lab check should know, and those it is tested with."""
from dataclasses import dataclass
from pathlib import Path

from course.mistakes import catalogue, own_shader, plant
from project import course, name_of, read_json
from tables.records import NOTEBOOK

CORRECT_CHECKS = 7  # per correct shader, with different seeds


@dataclass
class Trial:
    """A shader to be judged: this text instead of the file `shader`."""

    chapter: int
    mistake: str  # its name, or None
    text: str
    shader: Path
    seed: int = 0


def variants():
    """(chapter, file, shader that it replaces, mistakes) for all shaders written differently from their chapter's own."""
    for chapter in course():
        shader = own_shader(chapter)
        folder = NOTEBOOK / "variants" / shader.parent.name
        for variant in read_json(folder / "variants.json") if folder.exists() else []:
            yield chapter, folder / variant["file"], shader.with_name(variant.get("shader", shader.name)), variant["mistakes"]


def trials():
    """The trials of check: condition/chapter/mistake -> Trial. All mistakes with new seeds, those of each variant, and each
    correct shader several times."""
    result, correct = {}, [(chapter, "its own", own_shader(chapter), own_shader(chapter)) for chapter in course()]
    for bug in catalogue():
        result[f"new seeds/{name_of(bug.chapter)}/{bug.mistake['name']}"] = Trial(
            bug.chapter, bug.mistake["name"], bug.text, bug.file
        )
    for chapter, file, shader, mistakes in variants():
        text = file.read_text(encoding="utf-8")
        correct.append((chapter, file.stem, file, shader))
        for mistake in mistakes:
            wrong = plant(text, mistake["find"], mistake["replace"], f"{mistake['name']} in {file.name}")
            result[f"variants/{name_of(chapter)}/{file.stem}/{mistake['name']}"] = Trial(chapter, mistake["name"], wrong, shader)
    return result | {
        f"correct/{name_of(chapter)}/{what}/seed {seed}": Trial(chapter, None, file.read_text(encoding="utf-8"), shader, seed)
        for chapter, what, file, shader in correct
        for seed in range(CORRECT_CHECKS)
    }
