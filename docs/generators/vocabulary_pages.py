"""The words of tables, from `vocabulary.toml`: what headers, cells and comments of each language mean."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf_plugins.readers.words.fields import FIELDS, vocabulary, words_in
from pieces import code, table

if TYPE_CHECKING:
    from collections.abc import Iterable


def _codes(words: Iterable[str]) -> str:
    return " ".join(map(code, words))


def headers() -> str:
    """The headers of each field in English, and the words that may stand around them."""
    rows = ([name, _codes(field.headers), _codes(field.around)] for name, field in FIELDS.items())
    return table(("field", "headers", "words around them"), rows)


def languages() -> str:
    """The headers of each field in the other languages."""
    names = {key: name for key, name in vocabulary()["languages"].items() if key != "en"}
    known = {name: field.languages for name, field in FIELDS.items()}
    rows = ([name, *(_codes(words.get(key, ())) for key in names)] for name, words in known.items() if len(words) > 1)
    return table(("field", *names.values()), rows)


def unheld() -> str:
    """Headers that no field holds, with what to write in their place."""
    entries = vocabulary()["unheld"]
    rows = (
        [_codes(words_in(each["words"])), each["is"].strip(), " ".join(each.get("write", "").split())]
        for each in entries
    )
    return table(("header", "is", "write"), rows)


def words(section: str) -> str:
    """The words for types, or for conventions."""
    lines = {name: each.values() for name, each in vocabulary()[section].items()}
    rows = ([name, _codes(word for line in each for word in words_in(line))] for name, each in lines.items())
    return table((section.removesuffix("s"), "words"), rows)


def keys() -> str:
    """What the keys of comments are called besides."""
    rows = ([name, _codes(words_in(line))] for name, line in vocabulary()["declarations"].items())
    return table(("key", "also"), rows)


def no_joints() -> str:
    """Names of rows that are no joints."""
    return _codes(words_in(vocabulary()["rows"]["no_joints"]))
