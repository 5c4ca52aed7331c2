"""The tables of results/check.md on ./lab check: how often it finds mistakes, and whether what it says about them is
true."""
from project import CHAPTERS, name_of, read_json, table
from scipy.stats import binomtest
from tables.records import RECORDS

CONDITIONS = {
    "new seeds": "chapters' own shaders, new seeds",
    "variants": "shaders written in another way",
    "correct": "correct shaders",
}
SUBMISSIONS = {"development": "for development", "held_out": "not looked at before"}
LARGE_BIAS, LARGE_NOISE = 0.02, 1.5


class Rate:
    """Counts of trials. `alone` counts those with a single name that fits, `right` those where that is the mistake, `fitting` those where the
    mistake is among the names that fit, `among` those where it is among these or those that may fit, and `told` those with facts
    or names."""

    def __init__(self, trials):
        large = [trial for trial in trials if trial["bias"] >= LARGE_BIAS or trial["noise"] >= LARGE_NOISE]
        self.tried, self.large = len(trials), len(large)
        self.found, self.found_of_large = (sum(trial["verdict"] != "correct" for trial in some) for some in (trials, large))
        alone = [trial for trial in trials if len(trial["named"]) == 1 and trial["fits"]]
        self.alone, self.right = len(alone), sum(trial["named"] == [trial["mistake"]] for trial in alone)
        among = [trial for trial in trials if trial["mistake"] in trial["named"]]
        self.among, self.fitting = len(among), sum(trial["fits"] for trial in among)
        self.told = sum(bool(trial["facts"] or trial["named"]) for trial in trials)


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


def names(trial):
    """The names that a check has told. Submissions that were graded before names could merely be similar have no `fits`."""
    told = ", ".join(trial["named"]) or "-"
    return told if trial.get("fits", True) or not trial["named"] else f"may fit: {told}"


def row(words, rate):
    return [
        words,
        str(rate.tried),
        part(rate.found_of_large, rate.large),
        str(rate.found),
        part(rate.told, rate.found),
        part(rate.fitting, rate.found),
        part(rate.among, rate.found),
        part(rate.right, rate.alone),
    ]


def submission_row(words, submissions):
    """Row for shaders from outside. Whether the report points at the mistake was judged by a person."""
    wrong = [row for row in submissions if not row["is_right"]]
    found = [row for row in wrong if row["verdict"] != "correct"]
    alone = [row for row in found if len(row["named"]) == 1]
    return [
        words,
        part(sum(row["verdict"] != "correct" for row in submissions if row["is_right"]), len(submissions) - len(wrong)),
        part(len(found), len(wrong)),
        part(sum(bool(row["facts"] or row["named"]) for row in found), len(found)),
        part(sum(not row["untrue"] for row in found), len(found)),
        part(sum(bool(row["points"]) for row in found), len(found)),
        part(sum(bool(row["name_is_right"]) for row in alone), len(alone)),
    ]


def submission_table():
    """A table of the shaders written without looking at the catalogue, and a list of what was reported about each."""
    records = {key: RECORDS / f"check/{key}.json" for key in SUBMISSIONS}
    rows, told = [], []
    for key, file in records.items():
        if file.exists():
            submissions = read_json(file)["submissions"]
            rows.append(submission_row(SUBMISSIONS[key], submissions.values()))
            told += [
                [f"{name}, {SUBMISSIONS[key]}", row["mistake"] or "none", row["verdict"], names(row)]
                for name, row in submissions.items()
                if not row["is_right"] or row["verdict"] != "correct"
            ]
    head = [
        "submissions",
        "right ones refused",
        "wrong ones found",
        "not silent",
        "all facts true",
        "pointing at the mistake",
        "a single name is right",
    ]
    text = "\nShaders that others wrote, without a look at the catalogue:\n\n" + table(head, rows)
    return text + "\n" + table(["submission", "mistake", "verdict", "names that fit"], told, left=4)


def confusion_table(record):
    """A table of rates by condition, one by chapter, and a list of missed or misnamed mistakes."""
    head = [
        "tried",
        "large ones found",
        "found",
        "not silent",
        "the mistake is one of the names that fit",
        "or of those that may fit",
        "a single name is right",
    ]
    conditions = rates(record)
    correct = conditions.pop("correct", Rate([]))
    text = f"\nThe check refused correct shaders {part(correct.found, correct.tried)} times.\n\n"
    text += table(["", *head], [row(words, conditions[key]) for key, words in CONDITIONS.items() if key in conditions])
    numbers = {name_of(number): number for number in CHAPTERS}
    chapters = rates(record, lambda key: numbers[key.split("/")[1]] if key.startswith("new seeds") else None)
    text += "\nThe first row for each chapter:\n\n" + table(
        ["chapter", *head], [row(str(chapter), rate) for chapter, rate in sorted(chapters.items())]
    )
    missed = []
    for key, trial in record["trials"].items():
        if trial["mistake"] and trial["named"] != [trial["mistake"]]:
            condition, chapter, *variant, _ = key.split("/")
            place = ", ".join([f"chapter {numbers[chapter]}", *variant])
            effect = f"{100 * trial['bias']:.2g} %, × {trial['noise']:.2g}"
            missed.append([f"{place}, {condition}", trial["mistake"], effect, trial["verdict"], names(trial)])
    head = ["where", "mistake", "change of mean and error", "verdict", "named"]
    return text + "\nNot found, not named alone, or taken for another:\n\n" + table(head, missed, left=5)
