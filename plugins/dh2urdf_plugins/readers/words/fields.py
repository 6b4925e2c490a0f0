"""The words of `vocabulary.toml`: what headers, cells and comments of tables mean.

No word is in code. The file is read when the first word is asked for that no name of the project is: a table with
the headers `joint, type, a, alpha, d` never needs it.
"""

from __future__ import annotations

import tomllib
import unicodedata
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.manipulator import Convention, JointType
from dh2urdf.quantities import Dimension
from dh2urdf.row_fields import COM, INERTIA, ROW_FIELDS, RowField
from dh2urdf.source import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterable

# --- How words are compared -------------------------------------------------------------------------------------------

_SPACES = "\t\n\v\f\r\x1c\x1d\x1e\x1f \x85\xa0\u1680\u2028\u2029\u202f\u205f\u3000"
_SEPARATORS = f"{_SPACES}_.*{{}}'’-"
_DOT_WORDS = {"\u0307": "dot", "\u0308": "ddot"}
_DOTS = {f"{letter}{dots}": f"{letter}{word}" for letter in "qθτ" for dots, word in _DOT_WORDS.items()}
_GREEK = str.maketrans({"α": "alpha", "θ": "theta", "σ": "sigma", "β": "beta", "γ": "gamma", "φ": "phi", "τ": "tau"})
_GREEK |= str.maketrans({"ω": "omega", "μ": "mu", "ı": "i", "ё": "е", "№": "no"})  # with letters of other alphabets
_WITHOUT_DOTS = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue"})
_KEY = _GREEK | dict.fromkeys((*map(ord, _SEPARATORS), *range(0x2000, 0x200B), *range(0x300, 0x370)))
"""Without separators, among them all white space, and without accents."""


def key_of(plain: str) -> str:
    """A word without separators and accents, by which words are compared; its case is the caller's matter."""
    if plain.isascii():
        if plain.isalpha():
            return plain
    else:
        plain = unicodedata.normalize("NFD", plain)
        if not _DOT_WORDS.keys().isdisjoint(plain):
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


def words_in(text: str) -> tuple[str, ...]:
    """The words of a line of the vocabulary."""
    return tuple(" ".join(text.split()).split(", ")) if text else ()


@cache
def keys_in(section: str, name: str) -> frozenset[str]:
    """The keys of the words of one line: ``keys_in("sentences", "length")``."""
    return frozenset(key for word in words_in(vocabulary()[section].get(name, "")) for key in keys_of(word))


# --- Fields -----------------------------------------------------------------------------------------------------------

_AXES = dict.fromkeys(COM, "com_*") | dict.fromkeys(INERTIA, "i*")
"""The fields of one axis, and the section that has the words of all of them."""


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a row, or several fields that share a cell.

    Attributes:
        name: what the project calls it.
        dimension: what it measures; None for words.
        linear: what it measures in the row of a prismatic joint, where that is something else.
        parts: the fields that a cell of it holds, where it is several.
    """

    name: str
    dimension: Dimension | None = None
    linear: Dimension | None = None
    parts: tuple[str, ...] = ()

    @property
    def languages(self) -> dict[str, tuple[str, ...]]:
        """What tables call it, by language."""
        fields, axes = vocabulary()["fields"], self.name.removeprefix("com_").removeprefix("i")
        section = fields.get(self.name) or fields.get(_AXES.get(self.name, ""), {"en": self.name})
        forms = (axes, axes[::-1], axes.translate(str.maketrans("xyz", "123"))) if "i" in self.name[:1] else (axes,)
        found = {}
        for language, words in section.items():
            if language != "around":
                each = [word.replace("*", form) for word in words_in(words) for form in forms if "*" in word]
                found[language] = tuple(dict.fromkeys(each)) if self.name in _AXES else words_in(words)
        return found

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
        fields = vocabulary()["fields"]
        return words_in(fields.get(_AXES.get(self.name, self.name), {}).get("around", ""))


_NAMES = (
    *("robot", "convention", "index", "joint", "link", "type", "a", "alpha", "d", "theta", "offset", "beta", "gamma"),
    *("b", "sign", "flip", "limits", "lower", "upper", "velocity", "effort", "mass", "com", *COM, "inertia", *INERTIA),
    *("radius", "damping", "friction", "armature"),
)
_PARTS = {"limits": ("lower", "upper"), "com": COM, "inertia": INERTIA}
_OTHERS = {"sign": RowField(Dimension.NUMBER), "b": RowField(Dimension.LENGTH)}
_OTHERS |= dict.fromkeys(("beta", "gamma"), RowField(Dimension.ANGLE))


def _field(name: str) -> Field:
    parts = _PARTS.get(name, ())
    number = ROW_FIELDS.get(parts[0] if parts else name) or _OTHERS.get(name, RowField(None))
    return Field(name, number.dimension, number.linear, parts)


FIELDS = {name: _field(name) for name in dict.fromkeys((*_NAMES, *ROW_FIELDS))}
"""The fields of a table, in the order of the documentation."""
GROUPS = {name: each for name, each in FIELDS.items() if each.parts}
"""Fields whose cells hold several others."""


@cache
def header_fields() -> dict[str, Field]:
    """The field of each header in every language, by the header's key."""
    return {key: each for each in FIELDS.values() for word in each.words for key in keys_of(word)}


# --- Words in cells ---------------------------------------------------------------------------------------------------

ACCEPTED_TYPES = "revolute, rotational or R; prismatic, linear or P; continuous; fixed"
ACCEPTED_CONVENTIONS = (
    "standard (classic, distal, Paul, Spong) for A = Rz(theta) Tz(d) Tx(a) Rx(alpha); "
    "modified (Craig, proximal) for A = Rx(alpha) Tx(a) Rz(theta) Tz(d)"
)
ACCEPTED_FLIPS = "true or false"
_TYPES = {form: kind for kind in JointType for form in (kind.value, kind.value[0])}
_CONVENTIONS = {kind.value: kind for kind in Convention}


@cache
def type_words() -> dict[str, JointType]:
    """The words for types of joints, with the type of each."""
    return {
        word: JointType(kind)
        for kind, lines in vocabulary()["types"].items()
        for line in lines.values()
        for word in words_in(line)
    }


@cache
def convention_words() -> dict[str, Convention]:
    """The words for conventions, with the convention of each."""
    return {
        word: Convention(kind)
        for kind, lines in vocabulary()["conventions"].items()
        for line in lines.values()
        for word in words_in(line)
    }


@cache
def _type_keys() -> dict[str, JointType]:
    return {key: kind for word, kind in type_words().items() for key in keys_of(word)}


@cache
def _convention_keys() -> dict[str, Convention]:
    return {key: kind for word, kind in convention_words().items() for key in keys_of(word)}


@lru_cache(maxsize=1024)
def joint_type(text: str) -> JointType | None:
    """The joint type that a word means."""
    key = key_of(text.strip().casefold())
    if key in _TYPES or not any(map(str.isalpha, key)):
        return _TYPES.get(key)
    nouns = keys_in("around", "types")
    return _type_keys().get(next((key.removesuffix(noun) for noun in nouns if key.endswith(noun) and key != noun), key))


def type_advice(text: str) -> str | None:
    """What to do about a word that is no type of joint."""
    if text.strip() in ("0", "1", "2"):
        return "0 and 1 have two meanings: write R and P, or call the column sigma, where 0 turns and 1 slides"
    return did_you_mean(text, [word for word in type_words() if len(word) > 1])


def convention_of(text: str) -> Convention | None:
    """The convention that a word means, or several that mean the same: ``modified DH (Craig)``."""
    key = key_of(text.strip().casefold())
    if key in _CONVENTIONS:
        return _CONVENTIONS[key]
    known, both = _convention_keys(), keys_in("around", "conventions")
    behind = keys_in("around", "after_convention")
    bare = next((key.removesuffix(word) for word in behind if key.endswith(word)), key)
    if key in known or bare in known:
        return known.get(key, known.get(bare))
    words = "".join(letter if letter.isalnum() else " " for letter in text.casefold()).split()
    named = {known.get(word) for word in map(key_of, words) if word not in both}
    return named.pop() if len(named) == 1 else None


def flip_of(text: str) -> bool | None:
    """The truth value that a word means."""
    word = text.strip().casefold()
    flips = vocabulary()["flips"]
    return next((name == "true" for name in ("true", "false") if word in words_in(flips[name])), None)


def is_no_joint(name: str) -> bool:
    """Whether a row is by its whole name none of a joint: ``total``, ``tool frame``."""
    if len(name) > _LONGEST_NAME:
        return False
    key, words = key_of(name.strip().casefold()).translate(_JOINERS), keys_in("rows", "no_joints")
    beside = keys_in("rows", "beside")
    return key in words or any(key.removesuffix(word) in words or key.removeprefix(word) in words for word in beside)


_LONGEST_NAME = 60
_JOINERS = dict.fromkeys(map(ord, ":"))


# --- Headers that are no field ----------------------------------------------------------------------------------------

IGNORED = "_"
"""What the header of a column begins with that its author wants to be left out."""
GEOMETRY = "0 in this column, or a table of a, alpha, d and theta (or offset) without it"


class Unheld(NamedTuple):
    """What a header means that no field holds.

    Attributes:
        reason: what it is.
        accepted: what to write in its place.
        counts: whether it may hold the number of the row.
        if_no: whether only a no says anything: that a joint is not ``active``.
        any_text: whether a text says anything, too, and not numbers alone.
    """

    reason: str
    accepted: str = GEOMETRY
    counts: bool = False
    if_no: bool = False
    any_text: bool = True


@cache
def _unheld() -> dict[str, Unheld]:
    held = {key for name in FIELDS for key in keys_of(name)}
    return {
        key: Unheld(
            each["is"].strip(),
            " ".join(each.get("write", GEOMETRY).split()),
            each.get("counts", False),
            each.get("if_no", False),
            each.get("any_text", True),
        )
        for each in vocabulary()["unheld"]
        for word in words_in(each["words"])
        for key in keys_of(word)
        if key not in held
    }


def unheld(key: str) -> Unheld | None:
    """What a header means that no field holds, by its key: ``passive?`` and ``isfixed`` are known, too."""
    asked = key.strip("?")
    return _unheld().get(asked) or _unheld().get(asked.removeprefix("is"))


def spellings(field: Field) -> list[str]:
    """The headers of a field as a schema has them: each as it is written, and with ``ae`` for ``ä``."""
    return [form for word in field.words for form in sorted({word, *keys_of(word)}, key=lambda form: form != word)]


def parts_of(field: Field) -> tuple[str, ...]:
    """The fields that a column of a field gives: itself, or those that share its cells."""
    return field.parts or (field.name,)


def one_slip(left: str, right: str) -> bool:
    """Whether two words differ by one letter more, less, other, or by two neighbours exchanged."""
    if left == right or abs(len(left) - len(right)) > 1:
        return False
    start = next((k for k, (x, y) in enumerate(zip(left, right, strict=False)) if x != y), min(len(left), len(right)))
    rest, other = left[start:], right[start:]
    return (
        rest[1:] == other[1:]
        or rest[1:] == other
        or rest == other[1:]
        or (rest[:2] == other[1::-1] and rest[2:] == other[2:])
    )


def near(word: str, words: Iterable[str]) -> str | None:
    """The first of some words that a word misses by one slip, or by two where it is long."""
    for known in words:
        if one_slip(word, known):
            return known
        if len(known) >= _LONG and any(one_slip(word[:k] + word[k + 1 :], known) for k in range(len(word))):
            return known
    return None


_LONG = 7
"""Letters of a key that two slips do not make another word."""
