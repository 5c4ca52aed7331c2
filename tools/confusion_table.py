"""What docs/results.md shows of ./lab check: how often it finds mistakes and names them right."""

HEADER = """
## What ./lab check finds

Mistakes were planted into correct shaders ([mistakes.json](../tests/mistakes/mistakes.json)), and the check had to find and to
name them (`tools/learn_mistakes.py confusion`; each single answer is in [confusion.json](records/check/confusion.json)): into
the chapters' own shaders, with other random numbers than it had learnt from and on scenes that it does not use, and into shaders
that are correct but written in another way ([tests/variants](../tests/variants)). A correct shader is found where it is called
anything but correct.
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
    counts = rates(record)
    text = "\n| | tried | found | named right | among the first two |\n|---|---:|---:|---:|---:|\n"
    for condition, words in CONDITIONS.items():
        if (condition, False) in counts:
            tried, found, *_ = counts[condition, False]
            text += f"| {words}: correct | {tried} | {found} | - | - |\n"
        if (condition, True) in counts:
            tried, found, right, near = counts[condition, True]
            text += f"| {words}: mistakes | {tried} | {found} | {right} ({100 * right / tried:.0f} %) | {near} |\n"
    text += "\nNot found, or taken for another:\n\n| where | mistake | verdict | named |\n|---|---|---|---|\n"
    for key, trial in record["trials"].items():
        if trial["mistake"] and trial["named"][:1] != [trial["mistake"]]:
            condition, place, _ = key.split("/")
            place = f"chapter {place}" if place.isdigit() else place
            text += f"| {place}, {condition} | {trial['mistake']} | {trial['verdict']} | {', '.join(trial['named']) or '-'} |\n"
    return text
