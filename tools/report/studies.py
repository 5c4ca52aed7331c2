"""Reads "measure" in the chapter.json of each chapter: what figures, tables and reports measure of it.

"picture", "thumbnail": the scenes of its pictures. "convergence_samples": samples of its curve in the plot of all chapters' errors.
"compared_on": references on which the report's record compares it with the chapters before. "studies": a list,
in each "on", references or scenes without one, and "cases" that vary an option, name -> options.
"figures": pictures made of tiles, see docs/figures.py; "signed_figures": scenes of those that docs/signed_figures.py makes. "samplers":
for ./lab sample, see lesson/sample.py. "examples": tables of worked examples, with rows of a label, a statement and what is shown of
its result. These four have names.
"""
import math

from project import CHAPTERS, description, original, table
from report.numbers import short


def measures():
    """Folder -> its "measure". Copies of a chapter are omitted."""
    return {folder: description(folder).get("measure", {}) for number, folder in CHAPTERS.items() if original(number) == number}


def named(key):
    """Name -> (folder, content) for a key with names. The first chapter counts: another one with the same name was copied from
    it."""
    found = {}
    for folder, measure in measures().items():
        for name, content in measure.get(key, {}).items():
            found.setdefault(name, (folder, content))
    return found


def example_table(rows):
    """The Markdown table of a worked example."""
    names, cells = dict(vars(math), short=short), []
    for label, statement, shown in rows:
        exec(statement, names)
        cells.append([label, eval(f'f"{shown}"', names)])
    return table(["", "value"], cells)


def examples():
    """Name -> function that makes the table."""
    return {name: lambda rows=rows: example_table(rows) for name, (_, rows) in named("examples").items()}
