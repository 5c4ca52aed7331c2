"""Digests of what a record measured: the renderer with its tree and shaders, and each chapter. A record keeps them as "measured", so
that pages can tell which numbers are older than the sources.

Comments and blanks do not count, and neither do chapters that a record does not name: none of these changes a number.
"""
import json
import re
from datetime import datetime

from includes import shaders_of
from project import CHAPTERS, commit, rendered_description
from report.sources import digest, files_of

# What determines a picture and how long it takes; window, messages and image formats do not.
RENDERER = ["shaders", "common/film", "common/gpu", "common/rendering", "common/scene", "common/tracing"]
NATIVE = ["common/native"]  # concerns only records that name this backend


def measured(text):
    """{"renderer": digest, name: digest} for the chapters that the text of a record names, and for native if it does."""
    parts = {"renderer": RENDERER} | ({"native": NATIVE} if "native" in text else {})
    named = {folder[3:]: number for number, folder in CHAPTERS.items() if re.search(rf"(?<![a-z]){folder[3:]}(?![a-z])", text)}
    return {part: digest(files_of(folders)) for part, folders in parts.items()} | {
        name: digest(shaders_of(number), rendered_description(CHAPTERS[number])) for name, number in named.items()
    }


def stamped(record):
    """A record with a digest of what it measured, and with date and commit if it has none."""
    told = record.setdefault("environment", {}) if "environment" in record else record
    told.setdefault("commit", commit())
    told.setdefault("date", datetime.now().astimezone().strftime("%Y-%m-%d %H:%M"))
    return record | {"measured": measured(json.dumps(record))}


def changed_since(record):
    """What has changed since a record was measured: names as in measured(), or None if the record does not say what it
    measured."""
    then = record.get("measured")
    if then is None:
        return None
    now = measured(" ".join(then))
    return [name for name in then if now.get(name) != then[name]]
