"""What the text of a header says: which field, in which unit, of which link.

Typesetting is taken off first, then units, then what is beside the name: an index, a remark, a second name for the
same. What is left is looked up in the vocabulary.
"""

from __future__ import annotations

import re
from functools import cache, lru_cache
from typing import NamedTuple

from dh2urdf.quantities import UNITS, Dimension, composed, is_unit, plain_text, unit_word
from dh2urdf_plugins.readers.words.fields import (
    FIELDS,
    IGNORED,
    Field,
    any_of,
    header_fields,
    key_of,
    keys_in,
    keys_of,
    one_slip,
    unheld,
)

_FORMS = tuple(
    (re.compile(pattern), to)
    for pattern, to in (
        (r"(?<=q)⁻|(?<=q)₋", " min"),  # as the Robotics Toolbox prints limits
        (r"(?<=q)⁺", " max"),
        ("⍺", "α"),  # the α of APL is a toolbox's
        (r"(?<=[qθ])[\W_]*[ijk][\W_]+(?=(?:min|max|lower|upper)\b)", " "),  # `q_{i,max}`
        (r"(?<=[\u3040-\u30ff\u4e00-\u9fff\uac00-\ud7a3])(?=[a-zA-Zα-ωΑ-Ω])", " "),  # `连杆长度a`
    )
)
_FOOTNOTE = r"(?<=[^\W\d_])\s*[¹²³⁰⁴-⁹†‡§]+(?=\s*(?:[\[({]|$))|(?<=[\])}])\s*[¹²³⁰⁴-⁹†‡§*]+$"
_BRACKETED = r"(.*\S)\s*[\[({<]([^\[\](){}<>]*)[\])}>]"
_INDEX = r"(.+?)([\s_\[{(]*)([ijkn])\s*((?:[-+]\s*[0-9a-z]|m1)?)[\]})* ]*"
_TWO_NAMES = r"(.+?)[\s_.:-]+([^\s_.:-]+(?:_[ijkn](?:-1)?)?)"
_SYMBOLS = frozenset(("a", "r", "alpha", "d", "theta", "b", "beta", "gamma", "sigma", "mu", "q"))
"""Keys of symbols, which have their index right behind them: ``ai``."""
_LARGEST = dict.fromkeys((Dimension.TURN_RATE, Dimension.SPEED), "velocity")
_LARGEST |= dict.fromkeys((Dimension.TURN_ACCELERATION, Dimension.ACCELERATION), "acceleration")
_LARGEST |= dict.fromkeys((Dimension.TURN_JERK, Dimension.JERK), "jerk")
_LARGEST |= dict.fromkeys((Dimension.TORQUE, Dimension.FORCE), "effort")
"""The fields whose largest value a header such as ``max [Nm]`` gives, by what its unit measures."""
_LONGEST, _LONGEST_KEY, _LONGEST_UNIT = 300, 60, 24
"""Characters of a header that may name a field, of the words of one, and of a unit behind them."""
_SURE, _LONG, SHORTEST_CORE = 4, 5, 3
"""Letters of a name and of another word that a slip does not change, and of what is left without words around it."""


class Header(NamedTuple):
    """What a header says."""

    field: Field | None  # None where no field is called so
    key: str  # without its unit, and without case, separators and accents
    unit: str | None = None
    link: str | None = None  # `i`, `i-1` for a parameter of the link before, or another index
    ignored: bool = False  # whether its author wants the column to be left out

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
        return Header(None, key_of(text.casefold()))
    header = _read(text)
    without = text if header.is_known else re.sub(_FOOTNOTE, "", text)  # `d¹`, which is no d1
    return other if without != text and (other := _read(without)).is_known else header


def _read(text: str) -> Header:
    plain = text if text.isalpha() else plain_text(text)  # a column `variable` is no q
    for pattern, to in _FORMS:
        plain = pattern.sub(to, plain)
    plain = composed(plain).replace("−", "-").strip()
    if (header := _named(plain)).is_known:
        return header
    brackets: list[str] = []
    while match := re.fullmatch(_BRACKETED, plain):
        plain = match[1].rstrip(" /")  # `α/(°)`, as ISO 80000 writes a unit with a sign in it
        brackets.insert(0, match[2].strip())
    header = _with_loose_unit(plain)
    units = [header.unit] if header.unit else []
    others: list[str] = []
    for inner in brackets:
        if is_unit(inner):
            units.append(inner)
        elif beside := _beside(plain, inner, header):
            header, plain = beside, f"{plain} {inner}" if beside.field is not header.field else plain
        elif header.field and header.field.dimension and inner:
            others.append(inner)  # in brackets behind a quantity is its unit
    units = units or others[-1:]
    if header.field and not header.field.dimension:
        return Header(None, header.key, units[-1]) if units else header  # `I [kg·m²]` is no index
    several = len({UNITS.get(unit_word(unit)) for unit in units}) > 1
    measured = UNITS.get(unit_word(units[-1])) if units else None
    if measured and not several and header.field and header.field.name in ("upper", "limits"):
        header = header._replace(field=FIELDS[_LARGEST.get(measured.dimension, header.field.name)])
    return header._replace(unit=(" and ".join(units) if several else units[-1]) if units else None)


def _with_loose_unit(plain: str) -> Header:
    """A name with a unit behind a comma, a slash, a blank or a `_`: ``d/mm``, ``velocity_deg_per_s``."""
    header = _named(plain)
    if header.is_known:
        return header
    between = re.compile(rf"\s*[/|:;,]\s*|\s+(?:{any_of('headers', 'before_unit')})\s+|[\s_-]+|(?=°)")
    for match in between.finditer(plain, max(0, len(plain) - _LONGEST_UNIT)):
        front, tail = plain[: match.start()], plain[match.end() :]
        code = tail.replace("_per_", "/")
        forms = [form for form in (tail, code.replace("_", "/"), code.replace("_", "·")) if form and " " not in form]
        # A unit that is none here, as in `α in Grad`, is refused with what to write.
        unit = next((form for form in forms if is_unit(form, others=True)), "")
        # What stands loose behind a name is its unit only if it is one: `com x` and `comment` are no units.
        if unit and (named := _named(front)).is_known and (named.field is None or named.field.dimension):
            return named._replace(unit=unit)
    return header


def _beside(front: str, inner: str, header: Header) -> Header | None:
    """A header with a form, an index, a remark or a second name in brackets behind it; else None."""
    whole = _named(f"{front} {inner}")
    if whole.field:
        return whole._replace(unit=header.unit)
    symbol = _named(inner)
    if symbol.field and _is_loose(front, symbol.field):
        return symbol  # `joint offset (d_i)`
    if header.field is None:
        return None
    said = key_of(re.sub(r"[\W_]+", "", inner.casefold()))
    is_remark = said in keys_in("headers", "forms" if header.field.parts else "remarks")
    return header if is_remark or symbol.field is header.field or _is_loose(inner, header.field) else None


def _is_loose(words: str, field: Field) -> bool:
    """Whether words name no field of their own that a symbol beside them could not be: the d of ``joint offset d``."""
    return key_of(words.strip(" ,:(").casefold()) in keys_in("loose", field.name)


@lru_cache(maxsize=8192)
def _named(plain: str) -> Header:
    """What a name says: a word of the vocabulary, with an index or without, or two words for the same field."""
    key = key_of(plain.casefold())
    header = Header(field_of(key), key)
    if header.is_known:
        return header
    if match := re.fullmatch(_INDEX, plain):
        name, gap, letter, more = match.groups()
        key = key_of(name.casefold())
        indexed = Header(field_of(key), key, link="i" + more.replace(" ", "").replace("m", "-"))
        if indexed.is_known and (key in _SYMBOLS or (gap and letter != "n" and not more.strip("-1m"))):
            return indexed
    match = re.fullmatch(_TWO_NAMES, plain) if len(plain) <= _LONGEST_KEY else None
    if match and (last := _named(match[2])).field:  # `twist α`, `link length a_i`
        same = _is_loose(match[1], last.field) or field_of(key_of(match[1].casefold())) is last.field
        return last if same else header
    return header


# --- Words around a header, and slips of the pen ----------------------------------------------------------------------


@lru_cache(maxsize=1024)
def field_of(key: str) -> Field | None:
    """The field that a key means, also with words around it that say nothing new: ``maxjointspeed``."""
    found = FIELDS.get(key) or header_fields().get(key)
    if found or unheld(key):
        return found
    fields = header_fields()
    return next((each for each in FIELDS.values() if each in map(fields.get, _cores(key, each.name))), None)


@cache
def _around(name: str) -> tuple[str, ...]:
    return tuple({key for word in FIELDS[name].around for key in keys_of(word)})


@lru_cache(maxsize=4096)
def _cores(key: str, name: str) -> frozenset[str]:
    """A key, and what is left of it without some of the words that may stand around the headers of a field."""
    around = _around(name)
    if len(key) > _LONGEST_KEY or not (key.startswith(around) or key.endswith(around)):
        return frozenset((key,))
    rests = {rest for word in around for rest in (key.removeprefix(word), key.removesuffix(word)) if rest != key}
    least = [rest for rest in rests if len(rest) >= (SHORTEST_CORE if rest.isascii() else 1)]
    return frozenset((key,)).union(*(_cores(rest, name) for rest in least if rest not in keys_in("slips", "none")))


@lru_cache(maxsize=1024)
def misspelt(key: str) -> Field | None:
    """The field that a word misses by one slip, or with all its letters, as `tetha` does; also ``joint sgn``."""
    if key in keys_in("slips", "none") or len(key) > _LONGEST_KEY:  # or it means something else
        return None
    written = {name: _cores(key, name) | {key.removesuffix("i")} for name in FIELDS}  # `tehta_i`
    for word, field in header_fields().items():
        least, letters = _SURE if word == field.name else _LONG, sorted(word)
        for each in written[field.name] if len(word) >= least else ():
            is_shuffled = len(word) > _SURE and each[:1] == word[:1] and each != word and sorted(each) == letters
            if is_shuffled or one_slip(each, word):
                return field
    return None
