"""The keywords of a material, as common/scene/material_keywords.h lists them."""
import re
from typing import NamedTuple

from project import ROOT, table

SOURCE = ROOT / "common/scene/material_keywords.h"
ROW = re.compile(r'^ *\{"(\w+)", (\d), (\w+), "([^"]*)", "([^"]*)"(.*?)\},$', re.MULTILINE | re.DOTALL)


class Keyword(NamedTuple):
    """`count` numbers follow it, if any. `member` is where a material keeps them as they are, or ""."""

    name: str
    count: int
    largest: str
    meaning: str
    if_missing: str
    member: str
    default: float
    is_albedo: bool
    is_lobe: bool


def keyword(row):
    *columns, rest = row
    member, default = (re.search(pattern, rest) for pattern in (r"&Material::(\w+)", r"\.default_number = ([\d.]+)"))
    return Keyword(
        columns[0],
        int(columns[1]),
        *columns[2:],
        member[1] if member else "",
        float(default[1]) if default else 0.0,
        "is_albedo = true" in rest,
        ".feature" in rest,
    )


KEYWORDS = [keyword(match.groups()) for match in ROW.finditer(SOURCE.read_text(encoding="utf-8"))]


def keyword_table():
    rows = [(f"`{keyword.name}`", keyword.meaning, keyword.if_missing) for keyword in KEYWORDS]
    return table(["keyword", "meaning", "if it is missing"], rows, 3)
