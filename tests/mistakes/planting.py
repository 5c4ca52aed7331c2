"""Shaders with mistakes planted in them: those that ./lab check is to know, and those that it is tried with."""
from zlib import crc32

from course.mistakes import catalogue, own_shader, plant  # noqa: F401  (tests take them from here)
from project import CHAPTERS, ROOT, read_json  # noqa: F401

VARIANTS = ROOT / "tests/variants"
# Scenes that had no part in choosing the numbers in likely_mistake.py, for chapters that begin something: references.
OTHER_SCENES = {1: ["cornell_box_6", "torus_5"], 3: ["cornell_box_6", "heart_light_4"], 5: ["cornell_box_6", "heart_light_4"],
                6: ["cornell_box_6", "glass_8"], 7: ["cornell_box_6", "glossy_5"], 8: ["cornell_box_6", "studio_4"]}
CORRECT_CHECKS = 5  # of each correct shader, with other seeds


def variants():
    """(chapter, file, None or name of a mistake, text) for all shaders in tests/variants, and with their first mistake."""
    for variant in read_json(VARIANTS / "variants.json"):
        text = (VARIANTS / variant["file"]).read_text(encoding="utf-8")
        yield variant["chapter"], variant["file"], None, text
        for mistake in variant["mistakes"][:1]:
            what = f"{mistake['name']} in {variant['file']}"
            yield variant["chapter"], variant["file"], mistake["name"], plant(text, mistake["find"], mistake["replace"], what)


def is_tried_elsewhere(chapter, name):
    """Whether a mistake is tried on OTHER_SCENES: every fifth, chosen so that others may come and go."""
    return chapter in OTHER_SCENES and crc32(f"{chapter}/{name}".encode()) % 5 == 0


def trials():
    """What check is tried with: condition/place/mistake -> (chapter, name of the mistake or None, text, seed). All mistakes with
    new seeds, every fifth on other scenes, one in each variant, and each correct shader several times."""
    planted = list(catalogue())
    tried = {"new seeds": planted, "other scenes": [item for item in planted if is_tried_elsewhere(item[0], item[1]["name"])]}
    result = {f"{condition}/{chapter}/{mistake['name']}": (chapter, mistake["name"], text, 0)
              for condition, items in tried.items() for chapter, mistake, text in items}
    correct = [(chapter, f"{chapter:02}_path_trace.glsl", own_shader(chapter).read_text(encoding="utf-8")) for chapter in CHAPTERS]
    for chapter, file, name, text in variants():
        if name:
            result[f"variants/{file}/{name}"] = chapter, name, text, 0
        else:
            correct.append((chapter, file, text))
    return result | {f"correct/{file}/seed {seed}": (chapter, None, text, seed)
                     for chapter, file, text in correct for seed in range(CORRECT_CHECKS)}
