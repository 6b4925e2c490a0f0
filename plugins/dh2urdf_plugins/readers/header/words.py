"""What the text of a header says: which field, in which unit, of which link."""

from __future__ import annotations

import re
from functools import cache, lru_cache
from typing import NamedTuple

from dh2urdf.quantities import UNITS, Dimension, composed, is_unit, unit_word
from dh2urdf_plugins.readers.words.fields import (
    FIELDS,
    IGNORED,
    Field,
    header_fields,
    key_of,
    keys_in,
    keys_of,
    one_slip,
    unheld,
)

_SYMBOLS = ("a", "r", "alpha", "α", "d", "theta", "θ", "b", "beta", "β", "gamma", "γ", "sigma", "σ", "mu", "μ", "q")
_BEFORE = r"\s*(-\s*1|m1)?\s*[\]})*]*"
_INDEX = rf"({'|'.join(_SYMBOLS)})[\s_]*[\[{{(]*[\s]*[ijkn]{_BEFORE}"
_INDEX_BEHIND = rf"(.+?)(?:[\s_]+[\[{{(]*|[\[{{(]+)\s*[ijk]{_BEFORE}"  # `effort [N]` has a unit
_INDEXED_BOUND = r"(q|theta|θ)[\W_]*(?:[ijk][\W_]*(min|max|lower|upper)|(min|max|lower|upper)[\W_]+[ijk])\W*"
_SIGNED = {"q-": "q min", "q+": "q max"}
"""How the Robotics Toolbox prints limits: ``q⁻``, ``q⁺``."""
_LARGEST = dict.fromkeys((Dimension.TURN_RATE, Dimension.SPEED), "velocity")
_LARGEST |= dict.fromkeys((Dimension.TORQUE, Dimension.FORCE), "effort")
"""The fields whose largest value a header such as ``max [Nm]`` gives, by what its unit measures."""
_BEHIND, _CLOSING = "]})* ", ("]", ")", "}", ">")
_OTHER_LINK = r"[a-z]{0,3}\s*[-+]+\s*[a-z0-9]{0,3}|[ijkn][ijkn0-9]{1,2}"
_PREFIX = r"(?:dh|denavit\W?hartenberg)(?:\W*param(?:eter)?s?)?[\s_.:-]+(.+)"
_AFTER_CHINESE = r"(?<=[\u3040-\u30ff\u4e00-\u9fff\uac00-\ud7a3])(?=[a-zA-Zα-ωΑ-Ω])"
_LATEX = r"\\(?:mathrm|mathit|mathbf|text|rm)(?![a-z])|[\\$`]"
_FOOTNOTE = r"(?<=[^\W\d_])\s*[¹²³⁰⁴-⁹†‡§]+(?=\s*[\[({]|$)|(?<=[\])}])\s*[¹²³⁰⁴-⁹†‡§*]+$"
_BRACKETED = r"(.*[^\s])\s*[\[({<]([^\[\](){}<>]*)[\])}>]"
_LOOSE_UNIT = (
    r"(.+?)(?:\s*[/|:;]\s*|\s*,\s*|\s+(?:in|en|em|w|в)\s+|[\s_-]+|(?=°))"
    r"([^\s_/,°-]+(?:/(?:s|sec|min|с|сек|мин|秒|分|초))?|°(?:/(?:s|sec|min|с|сек|秒))?)"
)
_ENDS_OF_CODE = ("s", "sec", "second", "min", "m2")
_UNIT_OF_CODE = r"(.+?)[_\s](?:(deg|rad|rev|mm|cm|m)[_\s](?:per[_\s])?(s|sec|second|min)|(kg)[_\s](m2|mm2|cm2))"
"""A unit of two words as the variables of programs have it: ``velocity_deg_per_s``, ``ixx_kg_m2``."""
_REMARKS = ("dh", "variable", "var", "var.")
"""What brackets behind a parameter add: that it is the joint variable, say."""
_FORMS = frozenset(("xyz", "3x3", "minmax", "lowerupper", "matrix", "vector"))
"""What brackets say about the form of a cell that holds several fields."""
_WORDS_AT_END = frozenset(("in", "m", "n", "g", "s"))
"""Units that end headers in prose, too."""
_LONGEST = 300
_SURE, _LONG, SHORTEST_CORE = 4, 5, 3


class Header(NamedTuple):
    """What a header says.

    Attributes:
        field: the field that it names; None where no field is called so.
        key: the header without its unit, and without case, separators and accents.
        unit: the unit that it names.
        link: ``i``, or ``i-1`` for a parameter of the link before, as the modified convention has them.
        ignored: whether its author wants the column to be left out.
    """

    field: Field | None
    key: str
    unit: str | None = None
    link: str | None = None
    ignored: bool = False

    @property
    def is_known(self) -> bool:
        """Whether its words are those of a field, or such as no field holds."""
        return self.field is not None or unheld(self.key) is not None


@lru_cache(maxsize=8192)  # The headers of one table: it is asked for each of them several times.
def read_header(text: str) -> Header:
    """What a header says: ``a``, ``alpha_{i-1}``, ``Link length [mm]``, ``d/mm``, ``theta (deg)``, ``aᵢ₋₁``."""
    if text.startswith(IGNORED):
        return Header(None, "", ignored=True)
    text = " ".join(text.split())
    if len(text) > _LONGEST:  # no name of a field, and too long for patterns that look for one
        return Header(None, key_of(text))
    header = _as_written(text)
    if header.is_known or (text.isascii() and text[-1:] != "*") or not re.search(_FOOTNOTE, text):
        return header
    without = _as_written(re.sub(_FOOTNOTE, "", text))  # `d¹`, which is no d1
    return without if without.is_known else header


def _as_written(text: str) -> Header:
    """What a header says, with its unit as it is written: Nm is another unit than nm."""
    written = composed(text)
    ascii_only = written.isascii()
    written = re.sub(_LATEX, "", written).replace("−", "-").replace("⍺", "α").strip()  # the α of APL is a toolbox's
    written = written if ascii_only else re.sub(_AFTER_CHINESE, " ", written)
    plain = written.casefold()
    header = _read(plain)
    if header.field and header.unit and header.field.name in ("upper", "limits"):
        measured = UNITS.get(unit_word(header.unit))
        name = _LARGEST.get(measured.dimension) if measured else None
        header = header._replace(field=FIELDS[name]) if name else header
    start = plain.rfind(header.unit) if header.unit and len(plain) == len(written) else -1
    return header if start < 0 else header._replace(unit=written[start : start + len(header.unit or "")])


def _read(plain: str) -> Header:
    header = _of_code(plain) or _named(plain)
    if header.is_known:
        return header
    if plain.endswith(_CLOSING) and (match := re.fullmatch(_BRACKETED, plain)):
        found = _with_brackets(match[1], match[2].strip())
        if found.unit or found.is_known:
            return found
        header = found
    # What stands loose behind a name is its unit only if it is one: `com x` and `comment` are no units.
    # The unit of a field may also be one that is none here, as in `α in Grad`: it is refused with what to write.
    match = re.fullmatch(_LOOSE_UNIT, plain)
    if match and is_unit(match[2], others=True):
        front = _named(match[1].strip())
        if front.field:
            return front._replace(unit=match[2].strip()) if front.field.dimension else header
        if front.key and is_unit(match[2]):
            both = _twice(match[1].strip()) or front  # `link length a_i/mm`
            return both._replace(unit=None if match[2] in _WORDS_AT_END and not both.is_known else match[2])
    return _twice(plain) or header


def _of_code(plain: str) -> Header | None:
    """A header whose unit has two words, as the variables of programs have it."""
    match = re.fullmatch(_UNIT_OF_CODE, plain) if plain.endswith(_ENDS_OF_CODE) else None
    front = _named(match[1]) if match else None
    if not (match and front and front.field and front.field.dimension):
        return None
    return front._replace(unit=f"{match[2]}/{match[3]}" if match[2] else f"{match[4]}·{match[5]}")


def _with_brackets(front_text: str, inner: str) -> Header:
    """A header with brackets at its end: a unit, a form, or more words for the same."""
    if (joined := inner.replace(" ", "")) in ("rad", "deg"):
        inner = joined  # `α [r a d ]`, as PDFs have it
    front = _read(front_text.rstrip(" /"))  # `α/(°)`, as ISO 80000 writes a unit with a sign in it
    name = front.field
    if is_unit(inner) and name and not name.dimension:
        return Header(None, front.key, unit=inner)  # `I [kg·m²]` is no index
    if is_unit(inner) or (name and name.dimension and not inner):
        return front._replace(unit=_last_unit(front.unit, inner))
    whole = _named(f"{front_text} {inner}")
    if whole.field:
        return whole
    if (symbol := _named(inner)).field and _is_loose(front_text, symbol.field):
        return symbol  # `joint offset (d_i)`
    said = key_of(re.sub(r"[\W_]+", "", inner))
    if name is None or not name.dimension or inner in _REMARKS or (name.parts and said in _FORMS):
        return front
    # `link length (a)`; anything else in the brackets of a quantity should be its unit.
    return front if symbol.field is name or _is_loose(inner, name) else front._replace(unit=inner)


def _last_unit(before: str | None, unit: str) -> str:
    """The unit in the last brackets; with the words before it, which make it none, where these are no remark."""
    if not before or not unit:
        return unit
    if is_unit(before):
        return unit if UNITS[unit_word(before)] == UNITS[unit_word(unit)] else f"{before} and {unit}"
    return before if re.fullmatch(_OTHER_LINK, before) else unit  # `d (along z) [mm]`


def _twice(plain: str) -> Header | None:
    """A header that names its field in words and by its symbol: ``twist α``, ``link length a_i``."""
    front, _, symbol = plain.rpartition(" ")
    last = _named(symbol)
    if not front or not last.field:
        return None
    return last if _named(front.strip(" ,:")).field is last.field or _is_loose(front, last.field) else None


def _is_loose(words: str, field: Field) -> bool:
    """Whether words name no field of their own that a symbol beside them could not be: the d of ``joint offset d``."""
    return key_of(words.strip(" ,:(")) in keys_in("loose", field.name)


def _named(plain: str) -> Header:
    if plain.startswith(_SYMBOLS) and (match := re.fullmatch(_INDEX, plain)):
        key = key_of(match[1])
        return Header(_exact(key), key, link="i-1" if match[2] else "i")
    if plain in _SIGNED:
        plain = _SIGNED[plain]
    elif plain.startswith(("q", "theta", "θ")) and (match := re.fullmatch(_INDEXED_BOUND, plain)):
        plain = f"{match[1]} {match[2] or match[3]}"  # `q_{i,max}`
    header = Header(field_of(key_of(plain)), key_of(plain))
    if header.is_known:
        return header
    if plain.rstrip(_BEHIND).endswith(("i", "j", "k", "1")) and (match := re.fullmatch(_INDEX_BEHIND, plain)):
        indexed = Header(field_of(key_of(match[1])), key_of(match[1]), link="i-1" if match[2] else "i")
        if indexed.is_known:
            return indexed
    if plain.startswith(("dh", "denavit")) and (match := re.fullmatch(_PREFIX, plain)):
        inner = _named(match[1])
        if inner.field and inner.field.name in ("a", "alpha", "d", "theta"):
            return inner
    return header


def bounds_theta(header: Header) -> bool:
    """Whether a header of limits calls them bounds of theta: ``theta_min``."""
    return header.field is not None and header.field.name in ("lower", "upper", "limits") and "theta" in header.key


# --- Words around a header --------------------------------------------------------------------------------------------


@cache
def _around(name: str) -> tuple[str, ...]:
    """The keys of the words that may stand around the headers of a field."""
    return tuple({key for word in FIELDS[name].around for key in keys_of(word)})


def _exact(key: str) -> Field | None:
    """The field one of whose headers has a key."""
    return FIELDS.get(key) or header_fields().get(key)


@lru_cache(maxsize=1024)
def field_of(key: str) -> Field | None:
    """The field that a key means, also with words around it that say nothing new: ``maxjointspeed``."""
    if (found := _exact(key)) or unheld(key) or len(key) > _LONGEST:
        return found
    return next((each for each in FIELDS.values() if _around(each.name) and _has_core(key, each.name)), None)


@lru_cache(maxsize=4096)
def _has_core(key: str, name: str) -> bool:
    """Whether a key without some of the words around is a header of a field."""
    if (found := header_fields().get(key)) is not None:
        return found.name == name
    return any(_has_core(rest, name) for rest in _cores(key, name))


def _cores(key: str, name: str) -> list[str]:
    """What is left of a key without one of the words around a field."""
    around = _around(name) if len(key) <= _LONGEST else ()
    rests = {rest for word in around for rest in (key.removeprefix(word), key.removesuffix(word))}
    shortest = {rest: 1 if not rest.isascii() else SHORTEST_CORE for rest in rests}
    return [rest for rest, least in shortest.items() if least <= len(rest) < len(key) and not _is_other_word(rest)]


def _is_other_word(key: str) -> bool:
    return key in keys_in("slips", "none")


@lru_cache(maxsize=1024)
def misspelt(key: str) -> Field | None:
    """The field that a word of four letters or more misses by one slip, or with all its letters, as `tetha` does.

    Also with words around it that say nothing new: ``joint sgn``.
    """
    if _is_other_word(key):
        return None
    written = (key, key.removesuffix("i"))  # `tehta_i`
    all_keys = {name: (*written, *_cores(key, name)) for name in FIELDS}
    for word, field in header_fields().items():
        sure = _SURE if word == field.name else _LONG
        if len(word) >= sure and any(one_slip(each, word) or _is_shuffled(each, word) for each in all_keys[field.name]):
            return field
    return None


def _is_shuffled(key: str, word: str) -> bool:
    """Whether a longer word has the letters of another, the first one in its place."""
    return len(word) > _SURE and key[:1] == word[:1] and key != word and sorted(key) == sorted(word)
