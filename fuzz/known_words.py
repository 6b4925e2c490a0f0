"""The words of tables, as `docs/tables.md` and `docs/tables` list them: the generator writes what is promised there."""

from __future__ import annotations

import re
import tomllib
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
def vocabulary() -> dict[str, dict[str, dict[str, str]]]:
    """The words of which the documentation is made."""
    path = Path(__file__).parents[1] / "plugins" / "dh2urdf_plugins" / "readers" / "words" / "vocabulary.toml"
    return tomllib.loads(path.read_text("utf-8"))


def _listed(text: str) -> tuple[str, ...]:
    return tuple(" ".join(text.split()).split(", ")) if text else ()


def words(table: str, kind: str) -> tuple[str, ...]:
    """The words of the vocabulary for a type or a convention."""
    return tuple(word for line in vocabulary()[table][kind].values() for word in _listed(line))


@cache
def unit_words(dimension: str, unit: str) -> tuple[str, ...]:
    """The words of a unit of a dimension."""
    return tuple(
        word for row in documented("units") if row[:2] == (dimension, unit) for word in re.findall("`([^`]+)`", row[2])
    )


# --- Headers ----------------------------------------------------------------------------------------------------------

LANGUAGES = ("English", "German", "French", "Spanish", "Italian", "Portuguese", "Chinese")
"""The languages of headers."""
_CODES = dict(zip(LANGUAGES, ("en", "de", "fr", "es", "it", "pt", "zh"), strict=True))


@cache
def header_words(field: str, language: str = "English") -> tuple[str, ...]:
    """The headers of a field in a language; of English those that every field has, of others maybe none."""
    lines, axes = _section(field)
    found = tuple(word.replace("*", axes) for word in _listed(lines.get(_CODES[language], "")))
    return (field, *found) if language == "English" and field not in found else found


@cache
def around(field: str) -> tuple[str, ...]:
    """The words before or behind a header of a field that change nothing."""
    return _listed(_section(field)[0].get("around", ""))


def _section(field: str) -> tuple[dict[str, str], str]:
    """The lines of a field, and the axes in its name."""
    axes = field.removeprefix("com_").removeprefix("i")
    fields = vocabulary()["fields"]
    return fields.get(field) or fields.get("com_*" if field.startswith("com_") else "i*", {}), axes


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


def type_words(kind: str) -> tuple[str, ...]:
    """The words for a type of joint."""
    return words("types", kind)


def convention_words(convention: str) -> tuple[str, ...]:
    """The words for a convention."""
    return words("conventions", convention)


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
