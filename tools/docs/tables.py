"""Fills in pages what follows from the sources: tables, and blocks of code (book/code_blocks.py). The text between the lines
<!-- table: NAME --> and <!-- end of table --> is replaced by that table. What was measured comes from the notebook.
"""
import re

from book.code_blocks import fill
from docs.bug_blocks import bug_block
from docs.shader_table import shader_tables
from material_keywords import keyword_table
from project import ROOT, Parser, UserError
from report.studies import examples

DOCS = ROOT / "docs"
PAGES = [ROOT / "README.md", *sorted(DOCS.rglob("*.md")), *sorted(ROOT.glob("chapters/**/README.md"))]


def filled(text, kind, table_named):
    """A page's text with the tables of this kind that table_named() gives."""
    return re.sub(
        rf"(<!-- {kind}: ([^\n]+?) -->\n).*?(<!-- end of table -->)",
        lambda match: match[1] + table_named(match[2]) + match[3],
        text,
        flags=re.DOTALL,
    )


def write_pages(pages, text_of, is_check, command):
    """Writes the text of each page, which text_of(page, what is there) gives, or only checks that it is there."""
    for page in pages:
        before = page.read_text(encoding="utf-8")
        text = text_of(page, before)
        if text != before and is_check:
            raise UserError(f"{page.relative_to(ROOT)} is not up to date: run `{command}`")
        if text != before:
            page.write_text(text, encoding="utf-8")


def table_named(name):
    tables = {"shader": shader_tables, "keywords of a material": keyword_table, **examples()}
    if name.startswith("bug "):
        return bug_block(name.removeprefix("bug "))
    if name not in tables:
        raise UserError(f"there is no table '{name}': {', '.join(tables)} and bug NAME")
    return tables[name]()


def write_all(is_check=False):
    write_pages(
        PAGES,
        lambda page, text: fill(filled(text, "table", table_named), page.relative_to(ROOT)),
        is_check,
        "python3 tools tables",
    )


def main():
    parser = Parser("python3 tools tables", __doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; say which page is not up to date")
    write_all(parser.parse_args().check)
