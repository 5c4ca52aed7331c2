"""Packs programs, shaders, scenes, pages and tools for machines without a compiler: output/path_tracing_lab-SYSTEM.

windows: a .zip to unpack and run on Windows 10 or 11, built here. linux: a .tar.xz for this machine's distribution.
release: both, the book, checksums and the changes, in output/release. The same sources make the same archive.
"""
import hashlib
import io
import lzma
import os
import re
import shutil
import tarfile
import tempfile
import zipfile
from fnmatch import fnmatchcase
from pathlib import Path

from book import build as book
from package import windows_programs
from project import BINARIES, CHAPTERS, KNOWLEDGE, ROOT, Parser, UserError, run_to_end

HERE = Path(__file__).parent
NAME = "path_tracing_lab"
FOLDERS = ["assets", "chapters", "docs", KNOWLEDGE.relative_to(ROOT).as_posix(), "shaders", "tools"]
FILES = ["CHANGELOG.md", "LICENSE", "README.md"]
# Solutions and other material for teachers, and what needs the sources.
LEFT_OUT = [
    "tools/book/*",
    "tools/course/*",
    "tools/docs/*",
    "tools/package/*",
    "chapters/*/mistakes.json",
    "chapters/*/solutions/*",
    "*/__pycache__/*",
]
DATE = 1980, 1, 1, 0, 0, 0  # for all files: the same sources make the same archive
BOOK = ROOT / "output/book"


def tree_files(tree):
    """Path in the archive -> bytes, of the files that are the same on all systems."""
    files = {}
    for path in [*(path for folder in FOLDERS for path in (tree / folder).rglob("*")), *(tree / name for name in FILES)]:
        name = path.relative_to(tree).as_posix()
        if path.is_file() and not any(fnmatchcase(name, pattern) for pattern in LEFT_OUT):
            files[name] = path.read_bytes()
    if tree == ROOT and BOOK.exists():
        files |= {f"book/{path.relative_to(BOOK).as_posix()}": path.read_bytes() for path in BOOK.rglob("*") if path.is_file()}
    return files


def windows_files(chapters):
    windows_programs.build([*chapters, *windows_programs.OTHERS])
    # Windows' command interpreter needs CR LF.
    files = {"lab.cmd": (HERE / "lab.cmd").read_bytes().replace(b"\n", b"\r\n")}
    return files | {
        f"build/bin/{name}.exe": (windows_programs.PROGRAMS / f"{name}.exe").read_bytes()
        for name in [*chapters, *windows_programs.OTHERS]
    }


def linux_files(chapters):
    """The programs, and libraries that a system without a compiler may lack."""
    files, libraries = {"lab": (ROOT / "lab").read_bytes()}, {}
    for name in [*chapters, *windows_programs.OTHERS]:
        files[f"build/bin/{name}"] = stripped(BINARIES / name)
        for line in run_to_end(["ldd", BINARIES / name], f"Packing {name}").splitlines():
            library, _, place = line.strip().partition(" => ")
            if place and library.split(".so")[0] not in ("libc", "libm", "libdl", "libpthread", "libgcc_s", "libstdc++"):
                libraries[f"build/lib/{library}"] = Path(place.split()[0])
    return files | {name: place.read_bytes() for name, place in libraries.items()}


def stripped(program):
    """A program stripped of its symbols."""
    with tempfile.NamedTemporaryFile() as copy:
        run_to_end(["strip", "-o", copy.name, program], f"Packing {program}")
        return Path(copy.name).read_bytes()


def is_program(name):
    return name == "lab" or name.startswith("build/bin/")


def write_zip(archive, folder, files):
    with zipfile.ZipFile(archive, "w") as stream:
        for name in sorted(files):
            entry = zipfile.ZipInfo(f"{folder}/{name}", DATE)
            entry.external_attr = (0o755 if is_program(name) else 0o644) << 16
            entry.create_system = 3  # Unix, so that the permissions below apply
            stream.writestr(entry, files[name], zipfile.ZIP_DEFLATED)


def write_tar(archive, folder, files):
    # Chapters' programs differ little: with a large dictionary, xz stores their common parts once.
    filters = [{"id": lzma.FILTER_LZMA2, "preset": 2, "dict_size": 1 << 26}]
    with lzma.open(archive, "wb", filters=filters) as compressed, tarfile.open(fileobj=compressed, mode="w") as stream:
        for name in sorted(files):
            entry = tarfile.TarInfo(f"{folder}/{name}")
            entry.size, entry.mode = len(files[name]), 0o755 if is_program(name) else 0o644
            stream.addfile(entry, io.BytesIO(files[name]))


SYSTEMS = {"windows": (windows_files, write_zip, ".zip"), "linux": (linux_files, write_tar, ".tar.xz")}


def pack(system, archive, tree=ROOT):
    """Writes an archive of a tree of the lab, the whole one or a handout; it is either complete or absent."""
    system_files, write, _ = SYSTEMS[system]
    chapters = [name for name in CHAPTERS.values() if (tree / "chapters" / name).exists()]
    files = tree_files(tree) | system_files(chapters)
    archive.parent.mkdir(parents=True, exist_ok=True)
    unfinished = archive.with_name(archive.name + ".unfinished")
    write(unfinished, archive.name.removesuffix(SYSTEMS[system][2]), files)
    os.replace(unfinished, archive)
    print(f"{archive}: {archive.stat().st_size / 1e6:.1f} MB, {len(chapters)} chapters")


def version():
    return re.search(r"^project\(.* VERSION ([\d.]+) ", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"), re.MULTILINE)[1]


def changes(number):
    """What CHANGELOG.md says about a version."""
    sections = re.split(r"^## (.*)\n", (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    found = dict(zip(sections[1::2], sections[2::2]))
    if number not in found:
        raise UserError(f"CHANGELOG.md has no heading '## {number}', which is the version in CMakeLists.txt")
    return found[number].strip() + "\n"


def release(folder):
    """All files of a release; the archives contain the book."""
    number = version()
    notes = changes(number)
    book.build(BOOK, is_teacher=False)
    shutil.rmtree(folder, ignore_errors=True)
    for system in SYSTEMS:
        pack(system, folder / f"{NAME}-{number}-{system}{SYSTEMS[system][2]}")
    files = {path.relative_to(BOOK).as_posix(): path.read_bytes() for path in BOOK.rglob("*") if path.is_file()}
    write_zip(folder / f"{NAME}-{number}-book.zip", f"{NAME}-{number}-book", files)
    sums = "".join(f"{hashlib.sha256(file.read_bytes()).hexdigest()}  {file.name}\n" for file in sorted(folder.iterdir()))
    (folder / "SHA256SUMS").write_text(sums, encoding="utf-8")
    (folder / "notes.md").write_text(notes, encoding="utf-8")
    print(f"{folder}: version {number}\n{sums}", end="")


def main():
    parser = Parser("./lab package", __doc__)
    parser.add_argument("system", choices=[*SYSTEMS, "release"])
    system = parser.parse_args().system
    if system == "release":
        return release(ROOT / "output/release")
    pack(system, ROOT / "output" / f"{NAME}-{system}{SYSTEMS[system][2]}")
