"""The words of `vocabulary.toml`: what headers, cells and comments of tables mean.

No word is in code. The file is read when the first word is asked for that no name of the project is: a table with
the headers `joint, type, a, alpha, d` never needs it.
"""

from __future__ import annotations

import re
import tomllib
import unicodedata
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.columns import COM, INERTIA, ROW_FIELDS, RowField
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.quantities import Dimension
from dh2urdf.source import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterable

# --- How words are compared -------------------------------------------------------------------------------------------

_SPACES = "\t\n\v\f\r\x1c\x1d\x1e\x1f \x85\xa0\u1680\u2028\u2029\u202f\u205f\u3000"
_SEPARATORS = f"{_SPACES}_.*{{}}'’-"
_DOTS = {
    f"{letter}{dots}": f"{letter}{word}" for letter in "qθτ" for dots, word in (("\u0307", "dot"), ("\u0308", "ddot"))
}
_LETTERS = str.maketrans({"α": "alpha", "θ": "theta", "σ": "sigma", "β": "beta", "γ": "gamma", "φ": "phi", "τ": "tau"})
_LETTERS |= str.maketrans({"ω": "omega", "μ": "mu", "ı": "i", "ё": "е", "№": "no"})
_WITHOUT_DOTS = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue"})
_KEY = _LETTERS | dict.fromkeys((*map(ord, _SEPARATORS), *range(0x2000, 0x200B), *range(0x300, 0x370)))
"""Without separators, among them all white space, and without accents."""


def key_of(plain: str) -> str:
    """A word without separators and accents, by which words are compared; its case is the caller's matter."""
    if plain.isascii() and plain.isalpha():
        return plain
    if not plain.isascii():
        plain = unicodedata.normalize("NFD", plain)
        for dotted, word in _DOTS.items():
            plain = plain.replace(dotted, word)
    return plain.translate(_KEY)


def keys_of(word: str) -> set[str]:
    """The keys by which a word of the vocabulary is known: with ``ä`` written as ``a`` or as ``ae``."""
    word = word.casefold()
    twin = word if word.isascii() else word.translate(_WITHOUT_DOTS)
    return {key_of(word), key_of(twin)}


@cache
def vocabulary() -> dict[str, Any]:
    """The file, as TOML."""
    with Path(__file__).with_name("vocabulary.toml").open("rb") as file:
        return tomllib.load(file)


def said_of(section: str, name: str) -> str:
    """The text of the vocabulary that messages repeat as it is: ``said_of("accepted", "placement")``."""
    return str(vocabulary()[section][name])


def words_in(text: str) -> tuple[str, ...]:
    """The words of a line of the vocabulary."""
    return tuple(" ".join(text.split()).split(", ")) if text else ()


@cache
def keys_in(section: str, name: str) -> frozenset[str]:
    """The keys of the words of one line: ``keys_in("sentences", "length")``."""
    return frozenset(key for word in words_in(vocabulary()[section].get(name, "")) for key in keys_of(word))


@cache
def any_of(section: str, name: str) -> str:
    """A pattern of the words of one line, as they are written."""
    return "|".join(map(re.escape, words_in(vocabulary()[section][name])))


@cache
def words_for(section: str) -> dict[str, str]:
    """The words of a section in all languages, with what each means: ``hinge`` of `types` is ``revolute``."""
    lines = ((kind, line) for kind, entry in vocabulary()[section].items() for line in entry.values())
    return {word: kind for kind, line in lines for word in words_in(line)}


@cache
def _keys_for(section: str) -> dict[str, str]:
    return {key: kind for word, kind in words_for(section).items() for key in keys_of(word)}


# --- Fields -----------------------------------------------------------------------------------------------------------

_AXES = dict.fromkeys(COM, "com_*") | dict.fromkeys(INERTIA, "i*")
"""The fields of one axis, and the section that has the words of all of them."""


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a row, or several fields that share a cell."""

    name: str
    dimension: Dimension | None = None  # what it measures; None for words
    linear: Dimension | None = None  # what it measures in the row of a prismatic joint, where that is something else
    parts: tuple[str, ...] = ()  # the fields that a cell of it holds, where it is several

    def measures(self, *, slides: bool = False) -> Dimension:
        """What its numbers measure, in the rows of joints that turn or slide."""
        return (self.linear if slides else None) or self.dimension or Dimension.NUMBER

    @property
    def columns(self) -> tuple[str, ...]:
        """The fields that a column of it gives: itself, or those that share its cells."""
        return self.parts or (self.name,)

    @property
    def _section(self) -> dict[str, str]:
        fields: dict[str, dict[str, str]] = vocabulary()["fields"]
        return fields.get(self.name) or fields.get(_AXES.get(self.name, ""), {"en": self.name})

    @property
    def languages(self) -> dict[str, tuple[str, ...]]:
        """What tables call it, by language; `*` stands for the axes of a coordinate or a moment of inertia."""
        found = {key: words_in(line) for key, line in self._section.items() if key != "around"}
        if self.name not in _AXES:
            return found
        axes = self.name.removeprefix("com_").removeprefix("i")
        numbered = (axes.translate(str.maketrans("xyz", "123")),) if len(axes) > 1 else ()
        forms = dict.fromkeys((axes, axes[::-1], *numbered))
        return {key: tuple(word.replace("*", form) for word in words for form in forms) for key, words in found.items()}

    @property
    def headers(self) -> tuple[str, ...]:
        """What tables call it in English words and symbols."""
        return tuple(dict.fromkeys((*self.languages["en"], *((self.name,) if self.name in _AXES else ()))))

    @property
    def words(self) -> tuple[str, ...]:
        """All of its headers, in every language."""
        return (*self.headers, *(word for key, words in self.languages.items() if key != "en" for word in words))

    @property
    def around(self) -> tuple[str, ...]:
        """Words that may stand before or behind its headers and say nothing new: ``max`` of ``max speed``."""
        return words_in(self._section.get("around", ""))


_NAMES = (
    *("robot", "convention", "index", "joint", "link", "type", "a", "alpha", "d", "theta", "offset", "beta", "gamma"),
    *(
        "b",
        "sign",
        "flip",
        "limits",
        "lower",
        "upper",
        "velocity",
        "effort",
        "acceleration",
        "jerk",
        "mass",
        "com",
        *COM,
        "inertia",
        *INERTIA,
    ),
    *("radius", "damping", "friction", "armature", "follows"),
)
_NUMBERS = {"sign": RowField(Dimension.NUMBER), "b": RowField(Dimension.LENGTH), **ROW_FIELDS}
_NUMBERS |= dict.fromkeys(("beta", "gamma"), RowField(Dimension.ANGLE))
_PARTS = {"limits": ("lower", "upper"), "com": COM, "inertia": INERTIA}
_NUMBERS |= {name: ROW_FIELDS[parts[0]] for name, parts in _PARTS.items()}
FIELDS = {
    name: Field(name, number.dimension, number.linear, _PARTS.get(name, ()))
    for name in dict.fromkeys((*_NAMES, *ROW_FIELDS))
    for number in [_NUMBERS.get(name, RowField(None))]
}
"""The fields of a table, in the order of the documentation."""
GROUPS = {name: each for name, each in FIELDS.items() if each.parts}
"""Fields whose cells hold several others."""


@cache
def header_fields() -> dict[str, Field]:
    """The field of each header in every language, by the header's key."""
    return {key: each for each in FIELDS.values() for word in each.words for key in keys_of(word)}


# --- Headers that are no field ----------------------------------------------------------------------------------------

IGNORED = "_"
"""What the header of a column begins with that its author wants to be left out."""


class Refusal(NamedTuple):
    """Why a column that names no field is refused where it holds a value."""

    reason: str
    accepted: str  # what to write in its place
    any_text: bool = True  # whether texts are refused, too: no field holds what it is
    counts: bool = False  # whether it may hold the number of the row
    if_no: bool = False  # whether only a no says anything: that a joint is not `active`


@cache
def _unheld() -> dict[str, Refusal]:
    held = {key for name in FIELDS for key in keys_of(name)}
    found: dict[str, Refusal] = {}
    for entry in vocabulary()["unheld"]:
        marks = {name: value for name, value in entry.items() if name in Refusal._fields}
        instead = " ".join(entry.get("write", said_of("accepted", "unheld")).split())
        meaning = Refusal(entry["is"].strip(), instead, **marks)
        found |= {key: meaning for word in words_in(entry["words"]) for key in keys_of(word) if key not in held}
    return found


def unheld(key: str) -> Refusal | None:
    """What a header means that no field holds, by its key: ``passive?`` and ``isfixed`` are known, too."""
    asked = key.strip("?")
    return _unheld().get(asked) or _unheld().get(asked.removeprefix("is"))


# --- Words in cells ---------------------------------------------------------------------------------------------------

_TYPES = {form: kind for kind in JointType for form in (kind.value, kind.value[0])}
_CONVENTIONS = {kind.value: kind for kind in Convention}
_LONGEST_NAME = 60


@lru_cache(maxsize=1024)
def joint_type(text: str) -> JointType | None:
    """The joint type that a word means."""
    key = key_of(text.strip().casefold())
    if key in _TYPES or not any(map(str.isalpha, key)):
        return _TYPES.get(key)
    bare = next((key.removesuffix(noun) for noun in keys_in("around", "types") if key.endswith(noun)), key)
    kind = _keys_for("types").get(bare)
    return JointType(kind) if kind else None


def type_advice(text: str) -> str | None:
    """What to do about a word that is no type of joint."""
    if text.strip() in ("0", "1", "2"):
        return "0 and 1 have two meanings: write R and P, or call the column sigma, where 0 turns and 1 slides"
    return did_you_mean(text, [word for word in words_for("types") if len(word) > 1])


def convention_of(text: str) -> Convention | None:
    """The convention that a word means, or several that mean the same: ``modified DH (Craig)``."""
    key = key_of(text.strip().casefold())
    if key in _CONVENTIONS:
        return _CONVENTIONS[key]
    known, both = _keys_for("conventions"), keys_in("around", "conventions")
    bare = next((key.removesuffix(word) for word in keys_in("around", "after_convention") if key.endswith(word)), key)
    words = re.findall(r"[^\W_]+", text.casefold())
    meant = {known.get(word) for word in map(key_of, words) if word not in both}
    named = known.get(key) or known.get(bare) or (meant.pop() if len(meant) == 1 else None)
    return Convention(named) if named else None


def flip_of(text: str) -> bool | None:
    """The truth value that a word means."""
    word = text.strip().casefold()
    return next((flag == "true" for flag, line in vocabulary()["flips"].items() if word in words_in(line)), None)


def is_no_joint(name: str) -> bool:
    """Whether a row is by its whole name none of a joint: ``total``, ``tool frame``."""
    if len(name) > _LONGEST_NAME:
        return False
    key, words = key_of(name.strip().casefold()).replace(":", ""), keys_in("rows", "no_joints")
    beside = ("", *keys_in("rows", "beside"))
    return any(key.removesuffix(word) in words or key.removeprefix(word) in words for word in beside)


# --- Slips of the pen -------------------------------------------------------------------------------------------------

_LONG = 7
"""Letters of a key that two slips do not make another word."""


def one_slip(left: str, right: str) -> bool:
    """Whether two words differ by one letter more, less, other, or by two neighbours exchanged."""
    if left == right or abs(len(left) - len(right)) > 1:
        return False
    start = next((k for k, (x, y) in enumerate(zip(left, right, strict=False)) if x != y), min(len(left), len(right)))
    rest, other = left[start:], right[start:]
    exchanged = rest[:2] == other[1::-1] and rest[2:] == other[2:]
    return exchanged or rest[1:] == other[1:] or rest[1:] == other or rest == other[1:]


def near(word: str, words: Iterable[str]) -> str | None:
    """The first of some words that a word misses by one slip, or by two where it is long."""
    for known in words:
        shorter = (word[:k] + word[k + 1 :] for k in range(len(word) if len(known) >= _LONG else 0))
        if one_slip(word, known) or any(one_slip(each, known) for each in shorter):
            return known
    return None
