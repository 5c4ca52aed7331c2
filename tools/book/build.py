"""Builds the book, a site of all pages that opens from the disk: output/book/index.html. It needs no server and loads nothing
from elsewhere. Copies of chapters are not in it.
"""
import json
import re
import shutil
import tempfile
import time
from pathlib import Path

from book import live, search
from book.pages import Page, source_page
from lesson import show
from project import CHAPTERS, ROOT, Parser, UserError, course, read_json, run_program, show_progress

HERE = Path(__file__).parent
KATEX = Path("/usr/share/javascript/katex")  # from Debian's libjs-katex
STEPS = 3  # whose progress is shown
SEARCH_INDEX, SEARCH_SCRIPT = "search/search_index.json", "search/search_index.js"
SECTIONS = {  # of the navigation; missing pages are left out
    "Chapters": [f"chapters/{CHAPTERS[number]}/README.md" for number in course()],
    "The lecture": ["docs/slides.md", "docs/bugs.md"],
    "Explore": ["docs/browser.md", "docs/does_it_run_here.md", "docs/window.md", "docs/debugging.md", "docs/scenes.md"],
    "How it works": [
        "docs/vulkan.md",
        "docs/backends.md",
        "common/README.md",
        "docs/extending.md",
        "docs/numerics.md",
        "docs/cluster.md",
        "CHANGELOG.md",
    ],
    "Results": ["docs/results.md", "docs/measuring.md"],
    "For teachers": ["docs/teaching.md", "docs/grading/README.md", "docs/installing.md"],
}
START = ["README.md", "docs/first_steps.md", "docs/shader.md"]
SOLUTIONS = [f"chapters/{CHAPTERS[number]}/solutions/README.md" for number in course()]  # for teachers only


def title_of(path):
    """The first heading of a page, "1 Uniform sampling" for "Chapter 1: Uniform sampling"."""
    heading = re.search(r"^# (.*)$", (ROOT / path).read_text(encoding="utf-8"), re.MULTILINE)
    return re.sub(r"^Chapter (\d+): ", r"\1 ", heading[1] if heading else Path(path).stem)


def navigation(is_teacher):
    """[title, paths] of each section; the first has no title. Pages of docs/ in no section precede those for teachers."""
    sections = {"": START} | {title: list(paths) for title, paths in SECTIONS.items()}
    known = {path for paths in sections.values() for path in paths}
    others = [str(path.relative_to(ROOT)) for path in sorted((ROOT / "docs").glob("*.md"))]
    sections["How it works"] += [path for path in others if path not in known]
    if is_teacher:
        sections["For teachers"] += SOLUTIONS
    return [(title, [path for path in paths if (ROOT / path).is_file()]) for title, paths in sections.items()]


def write(folder, path, text):
    (folder / path).parent.mkdir(parents=True, exist_ok=True)
    (folder / path).write_text(text, encoding="utf-8")


def whole_estimator(path):
    """What a chapter's page shows if it is unfolded; nothing for other pages."""
    number = next((number for number, name in CHAPTERS.items() if path == Path(f"chapters/{name}/README.md")), None)
    return (
        ""
        if number is None
        else (
            '\n<details markdown="1">\n<summary>The whole path tracer of this chapter</summary>\n\n'
            f"```glsl\n{show.listing(number)}```\n\n</details>\n"
        )
    )


def collect(folder, sections, is_teacher):
    """Writes the pages, the files they link to, their pictures, and what their live frames need, at the paths they have in the project. Returns the pages,
    the names of the sources on the site, and what is to be found by name: {address: (name, explanation)}."""

    def is_included(path):
        return (ROOT / path).is_file() and (is_teacher or "solutions" not in Path(path).parts)

    waiting, done, named, frames = [Path(path) for _, paths in sections for path in paths], set(), {}, {}
    while waiting:
        path = waiting.pop()
        if path in done:
            continue
        done.add(path)
        if path.suffix != ".md":
            write(folder, f"{path}.md", source_page(path))
            continue
        page = Page(path, is_included)
        write(folder, path, page.text + whole_estimator(path))
        waiting += page.linked
        for chapter, scenes in page.frames.items():
            frames[chapter] = list(dict.fromkeys(frames.get(chapter, []) + scenes))
        named |= {f"{path.with_suffix('.html')}#{name}": (name, text) for name, text in page.functions.items()}
        for picture in page.pictures:
            if not (ROOT / picture).is_file():
                raise UserError(f"{path}: there is no picture {picture}")
            (folder / picture).parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / picture, folder / picture)
    if frames:
        live.write(folder / "live", frames)
    return sorted(path for path in done if path.suffix == ".md"), {f"{path}.html" for path in done if path.suffix != ".md"}, named


def write_settings(file, folder, sections):
    """Writes MkDocs' settings, with the folder's pages and their order."""
    nav = []
    for title, paths in sections:
        entries = [{"Start" if path == START[0] else title_of(path): path} for path in paths]
        nav += [{title: entries}] if title and entries else entries
    text = (HERE / "mkdocs.yml").read_text(encoding="utf-8").replace("theme:\n", f"theme:\n  custom_dir: {HERE / 'theme'}\n")
    settings = {"docs_dir": str(folder / "docs"), "site_dir": str(folder / "site"), "nav": nav}
    file.write_text(text + "".join(f"{key}: {json.dumps(value)}\n" for key, value in settings.items()), encoding="utf-8")


def finish(site, sources, named):
    """Turns the search index into a script, which pages on disk may load, and removes files that only servers need. Version 8 of
    the theme (Debian 12) looks for the index in __search, later ones in __index."""
    index = read_json(site / SEARCH_INDEX)
    index["docs"] = list(search.entries(index["docs"], sources, named))
    write(
        site,
        SEARCH_SCRIPT,
        f"var __index = {json.dumps(index)}, __search = {{index: Promise.resolve(__index), transform: requireAllOfFew}};\n",
    )
    for unused in (SEARCH_INDEX, "404.html", "sitemap.xml", "sitemap.xml.gz"):
        (site / unused).unlink(missing_ok=True)


def build(output, is_teacher):
    """Writes the site and returns its pages."""
    if output.exists() and not (output / SEARCH_SCRIPT).exists():
        raise UserError(f"{output} exists and is no book: choose another folder")
    sections, started = navigation(is_teacher), time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        pages, sources, named = collect(folder / "docs", sections, is_teacher)
        show_progress(f"{len(pages)} pages and {len(sources)} sources read", 1, STEPS, started)
        (folder / "docs/katex/fonts").mkdir(parents=True)
        for file in [KATEX / "katex.min.js", KATEX / "katex.min.css", *KATEX.glob("fonts/*.woff2")]:
            shutil.copy(file, folder / "docs/katex" / file.relative_to(KATEX))
        write_settings(folder / "mkdocs.yml", folder, sections)
        process = run_program(["mkdocs", "build", "--strict", "--config-file", folder / "mkdocs.yml"])
        if process.returncode != 0:
            lines = re.sub(r"\x1b\[\d*m", "", process.stderr).splitlines()
            raise UserError("mkdocs:\n" + "\n".join(line for line in lines if re.search("WARNING|[Ee]rror", line)))
        show_progress("site written", 2, STEPS, started)
        finish(folder / "site", sources, named)
        shutil.rmtree(output, ignore_errors=True)
        shutil.copytree(folder / "site", output)
    show_progress("search added", STEPS, STEPS, started)
    return pages


def main():
    parser = Parser("./lab book", __doc__)
    parser.add_argument("--teacher", action="store_true", help="with the solutions of the exercises")
    parser.add_argument("--output", type=Path, default=ROOT / "output/book", metavar="FOLDER", help="default: output/book")
    options = parser.parse_args()
    if not (KATEX / "katex.min.js").is_file() or not shutil.which("mkdocs"):
        raise UserError("mkdocs and KaTeX are needed: install mkdocs-material, python3-pymdownx and libjs-katex")
    pages = build(options.output, options.teacher)
    print(f"{options.output / 'index.html'}: {len(pages)} pages")
