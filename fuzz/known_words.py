"""The words of tables, as `docs/tables.md` and `docs/tables` list them: the generator writes what is promised there."""

from __future__ import annotations

import re
import unicodedata
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import random

DOCS = Path(__file__).parents[1] / "docs"


@cache
def text_of_tables() -> str:
    """The pages of the documentation about tables."""
    return "\n".join(page.read_text("utf-8") for page in (DOCS / "tables.md", *sorted((DOCS / "tables").glob("*.md"))))


@cache
def documented(table: str) -> tuple[tuple[str, ...], ...]:
    """The rows of a table of the documentation."""
    lines = text_of_tables().partition(f"<!-- table {table} -->\n")[2].splitlines()[2:]
    rows = []
    for line in lines:
        if not line.startswith("|"):
            break
        rows.append(tuple(cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]))
    return tuple(rows)


@cache
def words(table: str, kind: str) -> tuple[str, ...]:
    """The words that the documentation lists for a field, a type or a convention."""
    (found,) = (
        re.findall("`([^`]+)`", row[-1 if table == "conventions" else 1]) for row in documented(table) if row[0] == kind
    )
    return tuple(found)


@cache
def unit_words(dimension: str, unit: str) -> tuple[str, ...]:
    """The words of a unit of a dimension."""
    return tuple(
        word for row in documented("units") if row[:2] == (dimension, unit) for word in re.findall("`([^`]+)`", row[2])
    )


# --- Headers ----------------------------------------------------------------------------------------------------------

LANGUAGES = ("English", "German", "French", "Spanish", "Italian", "Portuguese", "Chinese")
"""The languages of headers."""


@cache
def header_words(field: str, language: str = "English") -> tuple[str, ...]:
    """The headers of a field in a language; of English those that every field has, of others maybe none."""
    if language == "English":
        return words("headers", field)
    column = LANGUAGES.index(language)
    return tuple(word for row in documented("languages") if row[0] == field for word in _quoted(row[column]))


@cache
def around(field: str) -> tuple[str, ...]:
    """The words before or behind a header of a field that change nothing."""
    return tuple(word for row in documented("words around") if row[0] == field for word in _quoted(row[1]))


def _quoted(text: str) -> list[str]:
    return re.findall("`([^`]+)`", text)


def other_spelling(rng: random.Random, word: str) -> str:
    """A word with other letters that mean the same: capitals, `_` for spaces, `ae` for `ä`, or no accents."""
    umlauts = word
    for letter, pair in (("ä", "ae"), ("ö", "oe"), ("ü", "ue")):
        umlauts = umlauts.replace(letter, pair)
    bare = "".join(letter for letter in unicodedata.normalize("NFD", word) if not unicodedata.combining(letter))
    return rng.choice(
        [
            word.upper() if word.isascii() else word,
            word.title() if word.isascii() else word,
            word.replace(" ", "_"),
            word.replace(" ", "-"),
            umlauts if umlauts != word or not word.isascii() else word,
            bare if "°" not in word else word,
        ]
    )


# --- Words of cells ---------------------------------------------------------------------------------------------------

OTHER_TYPES = {"revolute": ("Drehgelenk", "rotoïde"), "prismatic": ("prismatique",), "fixed": ("fijo",)}
"""Types of joints in other languages than English, which the page names in prose."""
OTHER_CONVENTIONS = {"standard": ("estándar",), "modified": ("modifiziert", "modifiée")}
"""Conventions in other languages, which the page names in prose."""


def type_words(kind: str) -> tuple[str, ...]:
    """The words for a type of joint."""
    return words("types", kind) + OTHER_TYPES.get(kind, ())


def convention_words(convention: str) -> tuple[str, ...]:
    """The words for a convention."""
    return words("conventions", convention) + OTHER_CONVENTIONS[convention]


@cache
def flip_words(*, turned: bool) -> tuple[str, ...]:
    """The words for a flip, or for none."""
    text = text_of_tables()
    (found,) = re.findall(r"`flip` turns with\s(.*?), and does not with\s(.*?)\.\s", text, re.DOTALL)
    return tuple(_quoted(found[not turned]))


# --- Symbols ----------------------------------------------------------------------------------------------------------

INDEXED = {
    "a": ("a_i", "aᵢ", "$a_i$", "a(i)", "a_{i}"),
    "alpha": ("alpha_i", "αᵢ", r"$\alpha_i$", "α_{i}"),
    "d": ("d_i", "dᵢ", "$d_{i}$"),
    "theta": ("theta_i", "θᵢ", r"\theta_i"),
}
"""Symbols of geometry with the index of their link."""
PREVIOUS = {
    "a": ("a_{i-1}", "aᵢ₋₁", "a(i-1)", "a_i-1"),
    "alpha": ("alpha_{i-1}", "αᵢ₋₁", "α_{i−1}", "alpha_im1"),
}
"""Symbols of the link before, which only the modified convention has."""
