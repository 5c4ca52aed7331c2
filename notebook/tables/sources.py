"""Digests of what a record measured: the renderer with its tree and shaders, and each chapter. A record keeps them as "measured", so
that pages can tell which numbers are older than the sources.

Comments and blanks do not count, and neither do chapters that a record does not name: none of these changes a number.
"""
import hashlib
import re

from project import CHAPTERS, ROOT, rendered_description, shaders_of, text_of

# What determines a picture and how long it takes; window, messages and image formats do not.
RENDERER = ["shaders", "common/film", "common/gpu", "common/rendering", "common/scene", "common/tracing"]
NATIVE = ["common/native"]  # concerns only records that name this backend
COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)


def code(text):
    """A source without its comments and the way it is laid out."""
    return " ".join(COMMENT.sub(" ", text).split())


def digest(files, text=""):
    """Digest of a text, and of the code in these files and their names, wherever the project lies."""
    found = hashlib.sha256(text.encode())
    for path in sorted(set(files)):
        found.update(f"{path.relative_to(ROOT).as_posix()}\n{code(text_of(path))}\n".encode())
    return found.hexdigest()[:12]


def sources(folders):
    """All files in these folders but their pages."""
    return [path for folder in folders for path in (ROOT / folder).rglob("*") if path.suffix != ".md" and path.is_file()]


def measured(text):
    """{"renderer": digest, name: digest} for the chapters that the text of a record names, and for native if it does."""
    parts = {"renderer": RENDERER} | ({"native": NATIVE} if "native" in text else {})
    named = {folder[3:]: number for number, folder in CHAPTERS.items() if re.search(rf"(?<![a-z]){folder[3:]}(?![a-z])", text)}
    return {part: digest(sources(folders)) for part, folders in parts.items()} | {
        name: digest(shaders_of(number), rendered_description(CHAPTERS[number])) for name, number in named.items()}


def changed_since(record):
    """What has changed since a record was measured: names as in measured(), or None if the record does not say what it
    measured."""
    then = record.get("measured")
    if then is None:
        return None
    now = measured(" ".join(then))
    return [name for name in then if now.get(name) != then[name]]
