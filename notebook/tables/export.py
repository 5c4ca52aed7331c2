"""Exports from the records what README.md, docs/ and the chapters show: do it once a release.

The text between the lines <!-- measured: NAME --> and <!-- end of table --> is replaced by that table, and plots are drawn into
docs/pictures. The pages say which commit was measured. Where a renderer is newer than its record, ./lab notebook ages tells.
"""
import os

from docs.tables import DOCS, PAGES, filled, write_pages
from project import ROOT, Parser, UserError, read_json
from tables.best_table import best_table
from tables.chapter_tables import backend_table, chapter_tables, expected_table, headline_table, page_table
from tables.confusion_table import confusion_table, submission_table
from tables.cost_tables import feature_table, growth_tables
from tables.cpu_table import cpu_table
from tables.facet_tables import furnace_table, sampling_table
from tables.lens_table import lens_table
from tables.derivative_table import derivative_table
from tables.filter_table import filter_table, network_table
from tables.light_path_table import light_path_table
from tables.light_table import light_table
from tables.media_table import media_table
from tables.numerics import case_table, device_tables
from tables.peer_table import peer_table
from tables.records import NOTEBOOK, RECORDS, load_records, record_table, when
from tables.renderer_table import renderer_table
from tables.result_plots import PLOTS, is_fresh, short_device, write_plot

RESULTS = NOTEBOOK / "results"
COMMAND = "./lab notebook export"
# Tables of results/DEVICE.md: from records/FOLDER/DEVICE.json.
DEVICE_TABLES = {
    "chapters": ("chapters", chapter_tables),
    "backends": ("backends", backend_table),
    "peers": ("peers", peer_table),
    "cpu": ("cpu", cpu_table),
    "renderers": ("renderers", renderer_table),
    "features": ("cost", feature_table),
    "growth": ("cost", growth_tables),
}
# Shown wherever times on such a device are compared.
NO_RAY_TRACING_CORES = """
> **An NVIDIA H200 has no ray tracing cores.** There the driver, our BVH and Mitsuba's OptiX all trace rays in software. GPUs with such
> cores trace rays several times faster in hardware, and Mitsuba gains from that as well. No ratio measured here holds for them.

"""
OWN_TABLES = {
    "expected": expected_table,
    "headline": headline_table,
    "hard cases": case_table,
    "device arithmetic": device_tables,
    "best chapters": best_table,
    "submissions": submission_table,
    "facet sampling": sampling_table,
    "furnace": furnace_table,
    "lens points": lens_table,
    "light choices": light_table,
    "light paths": light_path_table,
    "derivatives": derivative_table,
    "filters": filter_table,
    "network": network_table,
    "media strategies": media_table,
    "check": lambda: confusion_table(read_json(RECORDS / "check/confusion.json")),
    "no ray tracing cores": lambda: NO_RAY_TRACING_CORES,
}


def device_table(name, stem):
    """A table on a device's page."""
    folder, text_of = DEVICE_TABLES[name]
    file = RECORDS / folder / f"{stem}.json"
    return "\n" + text_of(read_json(file)) if file.is_file() else "\nNot measured on this device.\n"


def measured_table(name, page):
    """The text of a table: its own, or the first device's with its explanation."""
    if name in OWN_TABLES:
        return OWN_TABLES[name]()
    if name == "records":
        return record_table(page)
    if name in DEVICE_TABLES and page.parent == RESULTS:
        return device_table(name, page.stem)
    results = os.path.relpath(DOCS / "results.md", page.parent)
    first = load_records("chapters")[0]
    return (
        f"Measured on {short_device(first['environment']['device'])}, {when(first)}; [what the columns mean]({results}#what-the-numbers-mean), "
        f"[other devices]({results}#all-numbers).\n\n{page_table(name, first)}\n"
    )


def write_plots(is_check):
    for name in PLOTS:
        file = DOCS / f"pictures/{name}.svg"
        if not is_fresh(file, name):
            if is_check:
                raise UserError(f"{file.relative_to(ROOT)} does not show the records: run `{COMMAND}`")
            write_plot(file, name)


def main():
    parser = Parser(COMMAND, __doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; say which page is not up to date")
    is_check = parser.parse_args().check
    write_pages(
        [*PAGES, *sorted(RESULTS.glob("*.md"))],
        lambda page, text: filled(text, "measured", lambda name: measured_table(name, page)),
        is_check,
        COMMAND,
    )
    write_plots(is_check)
