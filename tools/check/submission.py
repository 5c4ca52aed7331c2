"""A file that is graded: which of a chapter's shaders it replaces, and which files beside it belong to it."""
import os
import re
import tempfile
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path

from check.expected import DESCRIPTIONS, expected_file
from includes import named_files, shaders_of
from project import CHAPTERS, ROOT, UserError, description, printable, text_of
from report.measurement import relative


class Submission:
    """A file in place of a shader of chapter number `chapter`: of the one that it is most like, or of `shader`."""

    def __init__(self, chapter, file, shader=None):
        self.chapter, self.file = chapter, file
        self.estimator = ROOT / "chapters" / CHAPTERS[chapter] / "path_trace.glsl"
        if shader:
            self.shader = shader

    @property
    def name(self):
        return printable(relative(self.file))

    @cached_property
    def files(self):
        """The shaders that are graded as one, the file last. Those beside a file belong to it if their folder is this chapter, a copy of
        it or a new one: it has a chapter.json, or the file has the name of one of this chapter's shaders. Any other file stands alone.
        """
        file = self.file
        title = description(file.parent.resolve())["title"] if (file.parent / "chapter.json").exists() else None
        others = {says["title"] for number, says in DESCRIPTIONS.items() if expected_file(number).exists()} - {
            DESCRIPTIONS[self.chapter]["title"]
        }
        if title in others or not (title or self.estimator.with_name(file.name).exists()):
            return [file]
        return [*(other for other in sorted(file.parent.glob("*.glsl")) if other.is_file() and other.name != file.name), file]

    @cached_property
    def shader(self):
        """The shader that the file is graded as, in the chapter's folder or included from that of another chapter. It is one of the folder
        whose functions the file all defines, preferably the estimator; or else the one with its name; a new one beside an estimator; or the
        one with most of its functions. Other estimators than the chapter's may have a function or two in common with any."""
        estimator, functions = self.estimator, functions_in(self.file)
        if not text_of(self.file).strip():
            raise UserError(f"{self.name}: is empty")
        folder = [estimator, *sorted(set(estimator.parent.glob("*.glsl")) - {estimator})]
        for shader in folder:
            if functions_in(shader) and functions >= functions_in(shader):
                return shader
        if named := self.shader_named(self.file):
            return named
        if estimator.name in {other.name for other in self.files}:
            return estimator.with_name(self.file.name)
        count, shader = with_most_functions_of(self.file, [*folder, *shaders_of(self.chapter)])
        if "path_trace" in functions and count < 2:
            return estimator
        if not count:
            raise UserError(
                f"{self.name}: defines no function of chapter {self.chapter}'s shaders; name it like the one that it replaces: "
                f"{', '.join(shader.name for shader in folder)}"
            )
        return shader

    def shader_named(self, file):
        """The chapter's shader with the name of one of the files, or None. Where it extends one with the same name of another
        chapter: the one whose functions the file has."""
        return with_most_functions_of(file, [shader for shader in shaders_of(self.chapter) if shader.name == file.name])[1]

    @cached_property
    def options(self):
        """Options with which the chapter's program reads these files instead of its own shaders."""
        own = {self.shader_named(other) or self.estimator.with_name(other.name): other for other in self.files[:-1]}
        places = own | {self.shader: self.file}
        # What the chapter neither has nor may bring is included by these files only, and found beside them.
        named = named_files(self.estimator.parent)
        return [
            word
            for place, source in places.items()
            if place.exists() or place.name in named
            for word in replacement(place, source)
        ]

    def first_todo(self):
        """The first line with a TODO, as (name of the file, number), or (None, None)."""
        found = (
            (printable(relative(file)), number)
            for file in self.files
            for number, line in enumerate(text_of(file).splitlines(), 1)
            if "TODO" in line
        )
        return next(found, (None, None))

    def in_words(self, text):
        """A text in which the file, and those beside it, have names as the user wrote them."""
        folder = f"{Path(os.path.abspath(self.file)).parent.as_posix()}/"
        return text.replace(printable(folder), self.name.removesuffix(printable(self.file.name)))


def functions_in(shader):
    return set(re.findall(r"^\w+ (\w+)\(", text_of(shader), re.MULTILINE))


def with_most_functions_of(file, shaders):
    """Number of functions that the file has in common with one of these, and that shader: the first one of several."""
    counted = [(len(functions_in(file) & functions_in(shader)), shader) for shader in shaders]
    return max(counted, key=lambda pair: pair[0], default=(0, None))


def replacement(shader, file):
    """Options with which a program reads a file instead of a chapter's shader."""
    return ["--shader", f"{shader.parent.name}/{shader.name}={os.path.abspath(file)}"]


@contextmanager
def replaced(shader, text):
    """Options with which a program reads this text instead of a chapter's shader."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / shader.name
        file.write_text(text, encoding="utf-8")
        yield replacement(shader, file)
