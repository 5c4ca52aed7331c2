"""Converts the repository's pages for MkDocs: links and lists."""
import os
import re
from pathlib import Path

from book import live
from project import ROOT

PICTURES = {".jpg", ".png", ".svg", ".gif", ".webp"}
LANGUAGES = {
    ".h": "cpp",
    ".cpp": "cpp",
    ".glsl": "glsl",
    ".comp": "glsl",
    ".rgen": "glsl",
    ".rchit": "glsl",
    ".rmiss": "glsl",
    ".py": "python",
    ".json": "json",
    "": "bash",
}
LARGEST_SOURCE = 100_000  # bytes; larger files are data
CODE = r"```.*?```|`[^`\n]+`|(?<=\n\n) {4}[^\n]*"
LINK = re.compile(rf"({CODE})|(?<!!)\[((?:`[^`\n]*`|[^\[\]`]|!\[[^\[\]]*\]\([^()]*\))*)\]\(([^()\s]+)\)", re.DOTALL)
PICTURE = re.compile(r"!\[[^\[\]]*\]\(([^()\s]+)\)|<img [^<>]*src=\"([^\"]+)\"")
FUNCTION_ROW = re.compile(r"^\| (`\w+ (\w+)\([^`]*`) \| (.*?) \|", re.MULTILINE)  # of a table: declaration, name, explanation
ITEM = re.compile(r"(\d+\.|[-*]) +(?=\S)")


class Page:
    """A page of the book. `path` is relative to the project."""

    def __init__(self, path, is_included):
        """is_included(path) tells whether a page with this path may be linked."""
        self.path, self.is_included = Path(path), is_included
        self.linked = []  # pages and sources
        text = (ROOT / path).read_text(encoding="utf-8")
        self.frames = live.frames_of(text, self.path)  # {chapter: scenes}
        text = live.with_frames(text, self.path)
        text = re.sub(r"<!-- .*? -->\n?|^\[!\[.*\]\(\.\./\.\./actions/.*\n", "", text, flags=re.MULTILINE)  # no badges
        text = text.replace("<details>", '<details markdown="1">')  # or MkDocs would leave its text unformatted
        self.pictures = [self.resolve(first or second) for first, second in PICTURE.findall(text) if "://" not in first + second]
        self.functions = {}  # of its tables: name and explanation
        self.text = with_lists(FUNCTION_ROW.sub(self.function, LINK.sub(self.link, text)))

    def resolve(self, target):
        return Path(os.path.normpath(self.path.parent / target))

    def link(self, match):
        """A link to a page or to a source, which becomes a page; any other link becomes plain text."""
        code, text, target = match.groups()
        name, hash_sign, anchor = (target or "").partition("#")
        if code or not name or "://" in target:
            return match[0]
        path = self.resolve(name)
        if (ROOT / path / "README.md").is_file():
            path, name = path / "README.md", f"{name.rstrip('/')}/README.md"
        if path.suffix in PICTURES:
            self.pictures.append(path)
            return match[0]
        if not (is_source(path) if path.suffix != ".md" else self.is_included(path)):
            return text
        self.linked.append(path)
        return f"[{text}]({name}{'' if path.suffix == '.md' else '.md'}{hash_sign}{anchor})"

    def function(self, match):
        """A row of a table that explains a function, as the target of a link. Only the first of functions with the same name is one."""
        code, name, explanation = match.groups()
        if name in self.functions:
            return match[0]
        self.functions[name] = explanation
        return f'| <span id="{name}">{code}</span> | {explanation} |'


def is_source(path):
    """Whether this is a text file worth reading. MkDocs omits hidden files."""
    file = ROOT / path
    if any(part.startswith(".") for part in path.parts):
        return False
    if not file.is_file() or not file.resolve().is_relative_to(ROOT) or file.stat().st_size > LARGEST_SOURCE:
        return False
    return b"\0" not in file.read_bytes()


def source_page(path):
    """A source as a page."""
    text = (ROOT / path).read_text(encoding="utf-8")
    language = LANGUAGES.get(path.suffix, "text")
    return f"---\nhide: [toc]\n---\n# {path.name}\n\n`{path}`\n\n~~~~~{language}\n{text}~~~~~\n"


def with_lists(text):
    """Indents the content of list items by four spaces, and inserts an empty line before a list and after an item of several
    paragraphs. MkDocs needs both, GitHub neither."""
    lines, width, is_code, has_paragraphs, before = [], 0, False, False, ""
    for line in text.split("\n"):
        is_code ^= line.lstrip().startswith("```")
        indent = len(line) - len(line.lstrip(" "))
        item = None if is_code else ITEM.match(line)
        if item:
            if before.strip() and (not width or has_paragraphs):
                lines.append("")
            width, has_paragraphs = item.end(), False
        elif width and line.strip() and indent < 2 and (not before.strip() or line.startswith(("#", "|", "```"))):
            width = 0
        elif width and indent >= 2:
            has_paragraphs |= not before.strip()
            inner = line[min(width, indent) :]
            if ITEM.match(inner) and not is_code and before.strip() and not ITEM.match(before.strip()):
                lines.append("")
            line = "    " + inner
        lines.append(line)
        before = line
    return "\n".join(lines)
