"""The tables of docs/results/check.md on ./lab check: how often it finds mistakes and names them correctly."""
from project import CHAPTERS, name_of, table
from scipy.stats import binomtest

CONDITIONS = {"new seeds": "chapters' own shaders, new seeds", "other scenes": "the same on other scenes",
              "variants": "shaders written in another way", "correct": "correct shaders"}
LARGE_BIAS, LARGE_NOISE = 0.02, 1.5


class Rate:
    """Counts of trials. `right` counts the mistakes that were named first, `near` those among the first two names."""

    def __init__(self, trials):
        large = [trial for trial in trials if trial["bias"] >= LARGE_BIAS or trial["noise"] >= LARGE_NOISE]
        right = [trial for trial in trials if trial["named"][:1] == [trial["mistake"]]]
        self.tried, self.large, self.right = len(trials), len(large), len(right)
        self.found, self.found_of_large = (sum(trial["verdict"] != "correct" for trial in some) for some in (trials, large))
        self.near = sum(trial["mistake"] in trial["named"][:2] for trial in trials)
        self.sure, self.right_of_sure = (sum(trial["is_sure"] for trial in some) for some in (trials, right))


def rates(record, key_of=lambda key: key.split("/")[0]):
    """A Rate for each value of key_of(name of the trial), by default its condition; trials with None are left out."""
    groups = {}
    for key, trial in record["trials"].items():
        groups.setdefault(key_of(key), []).append(trial)
    return {key: Rate(trials) for key, trials in groups.items() if key is not None}


def part(count, of):
    """A rate with its 95 % interval."""
    if of == 0:
        return "–"
    interval = binomtest(count, of).proportion_ci()
    return f"{count} of {of} ({100 * interval.low:.0f} – {100 * interval.high:.0f} %)"


def row(words, rate):
    return [words, str(rate.tried), part(rate.found_of_large, rate.large), str(rate.found), part(rate.right, rate.found),
            part(rate.near, rate.found), part(rate.right_of_sure, rate.sure)]


def confusion_table(record):
    """A table of rates by condition, one by chapter, and a list of mistakes that were missed or misnamed."""
    head = ["tried", "large ones found", "found", "named right", "among the first two", "right where it is sure"]
    conditions = rates(record)
    correct = conditions.pop("correct")
    text = f"\nThe check refused correct shaders {part(correct.found, correct.tried)} times.\n\n"
    text += table(["", *head], [row(words, conditions[key]) for key, words in CONDITIONS.items() if key in conditions])
    numbers = {name_of(number): number for number in CHAPTERS}
    chapters = rates(record, lambda key: numbers[key.split("/")[1]] if key.startswith("new seeds") else None)
    text += "\nThe first row for each chapter:\n\n" + table(
        ["chapter", *head], [row(str(chapter), rate) for chapter, rate in sorted(chapters.items())])
    missed = []
    for key, trial in record["trials"].items():
        if trial["mistake"] and trial["named"][:1] != [trial["mistake"]]:
            condition, chapter, *variant, _ = key.split("/")
            place = ", ".join([f"chapter {numbers[chapter]}", *variant])
            effect = f"{100 * trial['bias']:.2g} %, × {trial['noise']:.2g}"
            missed.append([f"{place}, {condition}", trial["mistake"], effect, trial["verdict"], ", ".join(trial["named"]) or "-"])
    head = ["where", "mistake", "change of mean and error", "verdict", "named"]
    return text + "\nNot found, or taken for another:\n\n" + table(head, missed, left=5)
