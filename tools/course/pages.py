"""The pages of a student's tree: without the solution of its exercise, code of later chapters, and anything that needs the
tests."""
import re
from itertools import takewhile

from book.code_blocks import BLOCK
from project import text_of

FENCED = re.compile(r"^ *```\w+\n.*?^ *```$", re.DOTALL | re.MULTILINE)
LINK = re.compile(r"(?<!!)\[(`[^`]+`|[^\[\]]+)\]\(([^()\s]+)\)")
PIECE = re.compile(r"`([^` \n]+( [^` \n]+){2,})`")  # of code, at least three words
NAME = re.compile(r"`\w+(\(\))?`")  # on its own it gives nothing away
SHADERS = {".glsl", ".comp", ".rgen", ".rchit", ".rmiss", ".h"}
TODO_LINE = "// TODO"
FOLDED = re.compile(r"<details><summary>[^\n]*\n\n(.*?)\n</details>\n", re.DOTALL)


def hide_lines(block, secret):
    """A block of code with TODO in place of secret lines."""
    lines = []
    for line in block.split("\n"):
        if line.strip() not in secret:
            lines.append(line)
        elif not lines[-1].endswith(TODO_LINE):
            lines.append(line[: len(line) - len(line.lstrip())] + TODO_LINE)
    return "\n".join(lines)


def source_of(target):
    """What represents code of a file that is left out."""
    chapter = re.search(r"\b(\d\d)_", target)
    return f"code of chapter {int(chapter[1])}" if chapter else "code of a later chapter"


def end_before_secrets(text, secret):
    """A page without the numbered sections from the first one on whose code contains a secret."""
    sections = re.split(r"^(?=## )", text, flags=re.MULTILINE)
    kept = list(takewhile(lambda section: secret.isdisjoint(map(str.strip, section.splitlines())), sections))
    others = [section for section in sections[len(kept) :] if not re.match(r"## \d", section)]
    return text if len(kept) == len(sections) else "".join([*kept, "The next steps are your exercise.\n\n", *others])


def leave_out_commands(text, missing):
    """A page without the sentences in which the regular expression `missing` finds a command."""
    paragraphs = text.split("\n\n")
    for i, paragraph in enumerate(paragraphs):
        if re.search(missing, paragraph):
            first, *others = re.split(r"((?<=[.!?])\s+)", paragraph)
            sentences = [("", first), *zip(others[::2], others[1::2])]
            paragraphs[i] = "".join(gap + sentence for gap, sentence in sentences if not re.search(missing, sentence)).lstrip()
    return "\n\n".join(paragraphs)


def clean_pages(folder, solution):
    """Cleans all pages of the tree, which is otherwise in its final state."""
    shaders = "\n".join(text_of(shader) for shader in folder.rglob("*.glsl"))
    secret = {line.strip() for line in solution.splitlines()} - set(map(str.strip, shaders.splitlines()))
    needs_tests = re.search(r"^needs_tests='(.*)'$", (folder / "lab").read_text(encoding="utf-8"), re.MULTILINE)[1]
    first_steps = folder / "docs/first_steps.md"
    first_steps.write_text(end_before_secrets(first_steps.read_text(encoding="utf-8"), secret), encoding="utf-8")
    for page in folder.rglob("*.md"):

        def shown(link):
            text, target = link.groups()
            file = page.parent / target.split("#")[0]
            is_quotation = file.suffix in SHADERS and text.startswith("`") and not NAME.fullmatch(text)
            if "://" in target or file.exists():
                is_gone = is_quotation and text[1:-1].replace("\\|", "|") not in text_of(file)
                return f"[TODO]({target})" if is_gone else link[0]
            return source_of(target) if is_quotation else text

        text = page.read_text(encoding="utf-8")
        text = BLOCK.sub(
            lambda block: f"{block['fence']}{block['lines']}```"
            if (folder / block["file"]).exists()
            else f"({source_of(block['file'])})",
            text,
        )
        text = FENCED.sub(lambda block: hide_lines(block[0], secret), text)
        text = FOLDED.sub(lambda block: block[1] if TODO_LINE in block[0] else block[0], text)  # it is no solution any more
        text = LINK.sub(shown, text)
        text = PIECE.sub(lambda piece: "TODO" if piece[1] in solution and piece[1] not in shaders else piece[0], text)
        # An exercise is done when the check says so.
        text = re.sub(r"Done\s+when all tests named [^,]* pass,\s+and\s+(?=`\./lab check)", "Done when ", text)
        page.write_text(leave_out_commands(text, rf"\./lab\s+({needs_tests})\b"), encoding="utf-8")
