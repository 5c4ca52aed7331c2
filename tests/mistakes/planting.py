"""Shaders with mistakes planted in them: those that ./lab check is to know, and those that it is tried with."""
from course.mistakes import catalogue, own_shader, plant  # noqa: F401  (tests take them from here)
from project import CHAPTERS, ROOT, read_json  # noqa: F401

VARIANTS = ROOT / "tests/variants"
# Scenes that had no part in choosing the numbers in likely_mistake.py, for chapters that begin something: references.
OTHER_SCENES = {1: ["cornell_box_6", "torus_5"], 3: ["cornell_box_6", "heart_light_4"], 6: ["cornell_box_6", "glass_8"]}


def variants():
    """(chapter, file, None or name of a mistake, text) for all shaders in tests/variants, and with their first two mistakes."""
    for variant in read_json(VARIANTS / "variants.json"):
        text = (VARIANTS / variant["file"]).read_text(encoding="utf-8")
        yield variant["chapter"], variant["file"], None, text
        for mistake in variant["mistakes"][:2]:
            what = f"{mistake['name']} in {variant['file']}"
            yield variant["chapter"], variant["file"], mistake["name"], plant(text, mistake["find"], mistake["replace"], what)


def trials():
    """What check is tried with: condition/place/mistake -> (chapter, name of the mistake or None, text). All mistakes with new
    seeds, every other one on other scenes, two in each variant: so that two cores need an hour."""
    planted = list(catalogue())
    tried = {"new seeds": planted, "other scenes": [item for item in planted if item[0] in OTHER_SCENES][::2]}
    result = {f"{condition}/{chapter}/{mistake['name']}": (chapter, mistake["name"], text)
              for condition, items in tried.items() for chapter, mistake, text in items}
    return result | {f"variants/{file}/{name or 'correct'}": (chapter, name, text) for chapter, file, name, text in variants()}
