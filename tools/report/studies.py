"""Reads measure.json of each chapter: what figures, tables and reports measure of it.

"picture", "thumbnail": the scenes of its pictures. "convergence_samples": samples of its curve in the plot of all chapters' errors.
"compared_on": references on which the report's record compares it with the chapters before. "studies": on references, or on scenes
without one, cases that vary an option, name -> options.
"figures": pictures made of tiles, see docs/figures.py. "samplers": for ./lab sample, see lesson/sample.py. "examples": tables of
worked examples, with rows of a label, a statement and what is shown of its result. These three have names.
"""
import math

from project import CHAPTERS, CPU_VARIANTS, ROOT, UserError, chapter_named, original, read_json, table
from references.images import find_references
from report.measurement import new_case, report_cases
from report.numbers import short

CPU_SCENES = ["cornell_box", "heart_light", "clear_glass"]
CPU_BACKENDS = {"compute": {"backend": "compute"}, "native, one by one": {"backend": "native", "variables": ["LAB_LANES=0"]},
                "native, lanes": {"backend": "native"}}


def measures():
    """Folder -> content of its measure.json. Copies of a chapter are omitted."""
    found = {}
    for number, folder in CHAPTERS.items():
        file = ROOT / "chapters" / folder / "measure.json"
        if file.is_file() and original(number) == number:
            try:
                found[folder] = read_json(file)
            except ValueError as error:
                raise UserError(f"{file}: not valid JSON: {error}") from None
    return found


def named(key):
    """Name -> (folder, content) for a key with names. The first chapter counts: another one with the same name was copied from
    it."""
    found = {}
    for folder, measure in measures().items():
        for name, content in measure.get(key, {}).items():
            found.setdefault(name, (folder, content))
    return found


def study_cases():
    """The cases of docs/results.md: all chapters on each reference, then the options varied by single chapters."""
    def case(place, name, folder, *options):
        reference = ROOT / f"assets/references/{place}.exr"
        scene = place.rstrip("_0123456789") if reference.is_file() else place
        return new_case(ROOT / f"assets/scenes/{scene}.json", reference if reference.is_file() else None, name, folder, options)

    found = measures()
    places = dict.fromkeys(place for measure in found.values() for place in measure.get("compared_on", []))
    cases = [case(place, f"chapter {int(folder[:2])}", folder) for place in places
             for folder, measure in found.items() if place in measure.get("compared_on", [])]
    return cases + [case(place, name, folder, *options.split()) for folder, measure in found.items() for study in measure.get("studies", [])
                    for place in study["on"] for name, options in study["cases"].items()]


def cpu_cases():
    """Our backends for CPUs and Mitsuba's variants, on a few scenes. The sampler is Mitsuba's best on most scenes."""
    folder, pairs = chapter_named("path_regeneration"), find_references(CPU_SCENES)
    ours = [new_case(scene, reference, name, folder) | how for scene, reference in pairs for name, how in CPU_BACKENDS.items()]
    return ours + report_cases(pairs, [], CPU_VARIANTS, ["multijitter"])


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
