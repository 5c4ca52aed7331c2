"""What docs/results.md shows of ./lab check: how often it finds mistakes and names them right."""
from project import table

HEADER = """
## What ./lab check finds

We planted mistakes ([mistakes.json](../tests/mistakes/mistakes.json)) into correct shaders. The check had to find the mistakes and
to name them. `tests/mistakes/learn.py confusion` makes this test, and [confusion.json](records/check/confusion.json) has each
single answer. There are three kinds of trials:

- The chapters' own shaders, with other random numbers than the check has learnt from.
- The same shaders on scenes that the check does not use.
- Shaders that are correct but written in another way ([tests/variants](../tests/variants)).

A mistake counts as found where the check says anything but correct. In a row of correct shaders, a number above 0 under
"found" would be a false alarm.
"""

CONDITIONS = {"new seeds": "chapters' own shaders, new seeds", "other scenes": "the same on other scenes",
              "variants": "shaders written in another way"}


def rates(record):
    """For each condition and whether there is a mistake: [tried, found, named right, right among the first two]."""
    counts = {}
    for key, trial in record["trials"].items():
        count = counts.setdefault((key.split("/")[0], trial["mistake"] is not None), [0, 0, 0, 0])
        count[0] += 1
        count[1] += trial["verdict"] != "correct"
        count[2] += trial["named"][:1] == [trial["mistake"]]
        count[3] += trial["mistake"] in trial["named"][:2]
    return counts


def confusion_table(record):
    """A table of the rates, and a list of what was not found or took another name."""
    rows, counts = [], rates(record)
    for condition, words in CONDITIONS.items():
        for is_mistake in (False, True):
            if (condition, is_mistake) in counts:
                tried, found, right, near = counts[condition, is_mistake]
                named = [f"{right} ({100 * right / tried:.0f} %)", str(near)] if is_mistake else ["-", "-"]
                rows.append([f"{words}: {'mistakes' if is_mistake else 'correct'}", str(tried), str(found), *named])
    text = "\n" + table(["", "tried", "found", "named right", "among the first two"], rows)
    missed = []
    for key, trial in record["trials"].items():
        if trial["mistake"] and trial["named"][:1] != [trial["mistake"]]:
            condition, place, _ = key.split("/")
            place = f"chapter {place}" if place.isdigit() else place
            missed.append([f"{place}, {condition}", trial["mistake"], trial["verdict"], ", ".join(trial["named"]) or "-"])
    return text + "\nNot found, or taken for another:\n\n" + table(["where", "mistake", "verdict", "named"], missed, left=4)
