"""The search of the book: which entries it has, and how they read."""
import re
from html.entities import html5

FORMULA = re.compile(r"\\[(\[](.*?)\\[)\]]", re.DOTALL)  # as Arithmatex writes it
FRACTION = re.compile(r"\\frac *\{([^{}]*)\} *\{([^{}]*)\}")
COMMAND = re.compile(r"\\([A-Za-z]+|.)")
# What TeX writes differently than HTML names it, and functions, which keep their names. Other commands only change the look.
SYMBOLS = {"cdot": "·", "cdots": "…", "dots": "…", "ldots": "…", "sqrt": "√", "varphi": "φ", "thinspace": " ", "qquad": " "} | {
    name: name for name in ("bmod", "cos", "ln", "log", "max", "min", "sin", "tan")
}
CHAPTER_BOOST = 4  # whoever looks for a term wants the chapter that explains it


def plain_formula(tex):
    """A formula as plain text: α for \\alpha."""
    while (shorter := FRACTION.sub(r"(\1)/(\2)", tex)) != tex:
        tex = shorter
    text = COMMAND.sub(lambda command: SYMBOLS.get(command[1], html5.get(f"{command[1]};", "")), tex)
    return " ".join(text.replace("{", "").replace("}", "").split())


def entries(found, sources, named):
    """The entries that MkDocs has found, without those of the sources, and {address: (title, text)} of others."""
    kept = [entry for entry in found if entry["location"].partition("#")[0] not in sources]
    for entry in kept + [{"location": location, "title": title, "text": text} for location, (title, text) in named.items()]:
        plain = {key: FORMULA.sub(lambda formula: plain_formula(formula[1]), entry[key]) for key in ("title", "text")}
        yield entry | plain | {"boost": CHAPTER_BOOST if entry["location"].startswith("chapters/") else 1}
