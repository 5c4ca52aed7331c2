"""Shaders with mistakes planted in them: those that ./lab check is to know, and those that it is tried with."""
from dataclasses import dataclass
from pathlib import Path
from zlib import crc32

from check.grading import DESCRIPTIONS
from course.mistakes import catalogue, own_shader, plant
from project import course, name_of, read_json

# References of scenes that had no part in choosing the numbers in likely_mistake.py, of the chapters that name some.
OTHER_SCENES = {chapter: says["check"]["other_references"] for chapter, says in DESCRIPTIONS.items()
                if "other_references" in says.get("check", {}) and chapter in course()}
CORRECT_CHECKS = 7  # of each correct shader, with other seeds


@dataclass
class Trial:
    """A shader that is to be judged: this text in place of the file `shader`."""
    chapter: int
    mistake: str  # its name, or None
    text: str
    shader: Path
    seed: int = 0
    is_elsewhere: bool = False  # on OTHER_SCENES


def variants():
    """(chapter, file, shader in whose place it is, mistakes) for all shaders that are written in another way than their chapter's own."""
    for chapter in course():
        folder = own_shader(chapter).with_name("variants")
        for variant in read_json(folder / "variants.json") if folder.exists() else []:
            yield chapter, folder / variant["file"], folder.with_name(variant.get("shader", "path_trace.glsl")), variant["mistakes"]


def is_tried_elsewhere(bug):
    """Whether a mistake is tried on OTHER_SCENES: every fifth, chosen so that others may come and go."""
    return bug.chapter in OTHER_SCENES and crc32(f"{name_of(bug.chapter)}/{bug.mistake['name']}".encode()) % 5 == 0


def trials():
    """What check is tried with: condition/chapter/mistake -> Trial. All mistakes with new seeds, every fifth on other scenes, those of
    each variant, and each correct shader several times."""
    result, correct = {}, [(chapter, "its own", own_shader(chapter), own_shader(chapter)) for chapter in course()]
    for is_elsewhere, condition in enumerate(("new seeds", "other scenes")):
        for bug in catalogue():
            if not is_elsewhere or is_tried_elsewhere(bug):
                result[f"{condition}/{name_of(bug.chapter)}/{bug.mistake['name']}"] = Trial(
                    bug.chapter, bug.mistake["name"], bug.text, bug.file, is_elsewhere=bool(is_elsewhere))
    for chapter, file, shader, mistakes in variants():
        text = file.read_text(encoding="utf-8")
        correct.append((chapter, file.stem, file, shader))
        for mistake in mistakes:
            wrong = plant(text, mistake["find"], mistake["replace"], f"{mistake['name']} in {file.name}")
            result[f"variants/{name_of(chapter)}/{file.stem}/{mistake['name']}"] = Trial(chapter, mistake["name"], wrong, shader)
    return result | {f"correct/{name_of(chapter)}/{what}/seed {seed}": Trial(chapter, None, file.read_text(encoding="utf-8"), shader, seed)
                     for chapter, what, file, shader in correct for seed in range(CORRECT_CHECKS)}
