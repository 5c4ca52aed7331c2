"""Digests of sources: what is measured, kept or drawn by them is older than they are if its digest is another one."""
import hashlib
import re

from project import ROOT, text_of

COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
SUFFIXES = {".h", ".cpp", ".glsl", ".comp", ".rgen", ".rchit", ".rmiss"}


def code(text):
    """A source without its comments and the way it is laid out."""
    return " ".join(COMMENT.sub(" ", text).split())


def files_of(folders):
    """All files in these folders but their pages."""
    return [path for folder in folders for path in (ROOT / folder).rglob("*") if path.suffix != ".md" and path.is_file()]


def digest(files, text=""):
    """Digest of a text, and of these files and their names, wherever the project lies. Of sources only the code counts."""
    found = hashlib.sha256(text.encode())
    for path in sorted(set(files)):
        content = code(text_of(path)).encode() if path.suffix in SUFFIXES else path.read_bytes()
        name = path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else path.name
        found.update(name.encode() + b"\n" + content + b"\n")
    return found.hexdigest()[:12]
