"""Headers of known tables: words in seven languages, symbols, words around, and units in every form of the page."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from known_words import around, header_words, other_spelling, unit_words

if TYPE_CHECKING:
    import random

LOOSE = ("{}/{}", "{}_{}", "{}, {}", "{} in {}", "{} {}")
"""How a header says a unit without brackets."""


@dataclass(frozen=True)
class Header:
    """A header: the whole of it, what it is without its unit, and the word for the unit."""

    text: str
    stem: str
    unit: str | None = None


def make_header(
    rng: random.Random,
    field: str,
    symbols: tuple[str, ...] | None,
    unit: tuple[str, str] | None,
    language: str = "English",
    *,
    plain: bool = False,
) -> Header:
    """A header of a field.

    Args:
        rng: the source of chance.
        field: the field.
        symbols: symbols in the place of words; None where there are none.
        unit: what the unit measures, and the unit; None where the header says none.
        language: of the words.
        plain: whether the header is the first of the words.
    """
    stem = rng.choice(symbols or _words(field, language)) if not plain else header_words(field)[0]
    if not symbols and not plain:
        stem = _varied(rng, field, stem)
    if unit is None:
        return Header(stem, stem)
    word = rng.choice(unit_words(*unit))
    forms = ["{} [{}]", "{} ({})", "{}[{}]"]
    # A unit of several factors, and the word `in`, cannot stand loose; neither can one behind a symbol.
    if not plain and re.fullmatch("[A-Za-zµ]+", word) and word != "in" and re.fullmatch(r"\w[\w ]+", stem):
        forms += LOOSE
    return Header(rng.choice(forms).format(stem, word), stem, word)


def _words(field: str, language: str) -> list[str]:
    """The words of a language for a field, or the English ones where it has none."""
    found = header_words(field, language) or header_words(field)
    # `#` begins a comment, and r beside sigma is another paper's letter.
    return [word for word in found if word != "#" and (field, word) != ("a", "r")]


def _varied(rng: random.Random, field: str, stem: str) -> str:
    """A header with a word around it, or in another spelling."""
    # A bound of theta is no bound of q where theta is not q itself.
    others = [word for word in around(field) if "theta" not in word]
    if others and len(re.sub(r"\W|_", "", stem)) > 2 and rng.random() < 0.15:
        other = rng.choice(others)
        stem = rng.choice([f"{other} {stem}", f"{stem} {other}"])
    return other_spelling(rng, stem) if rng.random() < 0.2 else stem
