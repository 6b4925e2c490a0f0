"""What the text of a header says: which field, in which unit, of which link; or what it seems to be."""

from __future__ import annotations

import re
from functools import cache, lru_cache
from typing import NamedTuple

from dh2urdf.quantities import UNITS, Dimension, composed, is_unit, unit_word
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS, Field, header_fields
from dh2urdf_plugins.readers.words.unheld import IGNORED, PROSE, SUSPECTS, UNHELD
from dh2urdf_plugins.readers.words.word_keys import key_of, keys_of

_INDEXED = ("a", "r", "alpha", "α", "d", "theta", "θ", "b", "beta", "β", "gamma", "γ", "sigma", "σ", "mu", "μ", "q")
_BEFORE = r"\s*(-\s*1|m1)?\s*[\]})*]*"
_INDEX = rf"({'|'.join(_INDEXED)})[\s_]*[\[{{(]*[\s]*[ijkn]{_BEFORE}"
_INDEX_BEHIND = rf"(.+?)(?:[\s_]+[\[{{(]*|[\[{{(]+)\s*[ijk]{_BEFORE}"  # `effort [N]` has a unit
_INDEXED_BOUND = r"(q|theta|θ)[\W_]*(?:[ijk][\W_]*(min|max|lower|upper)|(min|max|lower|upper)[\W_]+[ijk])\W*"
_SIGNED = {"q-": "q min", "q+": "q max"}
"""How the Robotics Toolbox prints limits: ``q⁻``, ``q⁺``."""
_LARGEST = dict.fromkeys((Dimension.TURN_RATE, Dimension.SPEED), "velocity")
_LARGEST |= dict.fromkeys((Dimension.TORQUE, Dimension.FORCE), "effort")
"""The fields whose largest value a header without a word for it gives, by what its unit measures."""
_ANGLES = "angle, rotation, winkel, ángulo, angolo, ângulo, kąt, угол, açı, 角, 角度, 각도"
_LOOSE = {
    "a": "distance, displacement",
    "d": "offset, joint offset, distance, displacement, joint displacement, height, versatz, abstand, décalage, "
    "desplazamiento, spostamento, przesunięcie, odsunięcie, オフセット, 距離, 오프셋, 거리, 偏移, 距离",
    "theta": f"{_ANGLES}, joint rotation, joint variable, rotation angle",
    "alpha": f"{_ANGLES}, link angle",
}
"""Words for a length or an angle of any kind, by the fields whose symbol may be beside them."""
_LETTERS, _BEHIND = frozenset("ijkn"), "]})* "
_CLOSING = ("]", ")", "}", ">")
_OTHER_LINK = r"[a-z]{0,3}\s*[-+]+\s*[a-z0-9]{0,3}|[ijkn][ijkn0-9]{1,2}"
_PREFIX = r"(?:dh|denavit\W?hartenberg)(?:\W*param(?:eter)?s?)?[\s_.:-]+(.+)"
_AFTER_CHINESE = r"(?<=[\u3040-\u30ff\u4e00-\u9fff\uac00-\ud7a3])(?=[a-zA-Zα-ωΑ-Ω])"
_LATEX = r"\\(?:mathrm|mathit|mathbf|text|rm)(?![a-z])|[\\$]"
_FOOTNOTE = r"(?<=[^\W\d_])\s*[¹²³⁰⁴-⁹†‡§]+(?=\s*[\[({]|$)|(?<=[\])}])\s*[¹²³⁰⁴-⁹†‡§*]+$"
_BRACKETED = r"(.*[^\s])\s*[\[({<]([^\[\](){}<>]*)[\])}>]"
_LOOSE_UNIT = (
    r"(.+?)(?:\s*[/|:;]\s*|\s*,\s*|\s+(?:in|en|em|в)\s+|[\s_-]+|(?=°))"
    r"([^\s_/,°-]+(?:/(?:s|sec|min|с|сек|мин|秒|分|초))?|°(?:/(?:s|sec|min|с|сек|秒))?)"
)
_ENDS_OF_CODE = ("s", "sec", "second", "min", "m2")
_UNIT_OF_CODE = r"(.+?)[_\s](?:(deg|rad|rev|mm|cm|m)[_\s](?:per[_\s])?(s|sec|second|min)|(kg)[_\s](m2|mm2|cm2))"
"""A unit of two words as the variables of programs have it: ``velocity_deg_per_s``, ``ixx_kg_m2``."""
_REMARKS = ("dh", "variable", "var", "var.")
"""What brackets behind a parameter add: that it is the joint variable, say."""
_FORMS = frozenset(("xyz", "3x3", "minmax", "lowerupper", "matrix", "vector"))
"""What brackets declare about the form of a cell that holds several fields."""
_WORDS_AT_END = frozenset(("in", "m", "n", "g", "s"))
"""Units that end headers in prose, too: a column is not refused for them."""
_LONGEST = 300
_SURE = 4
_LONG = 5
SHORTEST_CORE = 3
_OTHER_WORDS = frozenset(
    (
        "power",
        "tower",
        "height",
        "eight",
        "orange",
        "point",
        "gravel",
        "fraction",
        "fiction",
        "mode",
        "modal",
        "forge",
        "signal",
        "final",
        "cursor",
        "sumber",
    )
)
"""Words that miss a header by one letter and mean something else."""


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


@lru_cache(maxsize=8192)  # The headers of one table: it is asked for each of them several times.
def read_header(text: str) -> Header:
    """What a header says: ``a``, ``alpha_{i-1}``, ``Link length [mm]``, ``d/mm``, ``theta (deg)``, ``aᵢ₋₁``."""
    if text.startswith(IGNORED):
        return Header(None, "", ignored=True)
    text = " ".join(text.split())
    if len(text) > _LONGEST:  # no name of a field, and too long for patterns that look for one
        return Header(None, key_of(text))
    header = _as_written(text)
    if header.field or header.key in UNHELD or (text.isascii() and text[-1:] != "*") or not re.search(_FOOTNOTE, text):
        return header
    without = _as_written(re.sub(_FOOTNOTE, "", text))  # `d¹`, which is no d1
    return without if without.field or without.key in UNHELD else header


def _as_written(text: str) -> Header:
    """What a header says, with its unit as it is written: Nm is another unit than nm."""
    written = _written(text)
    plain = written.casefold()
    header = _read(plain)
    if header.field and header.unit and header.field.name in ("upper", "limits"):
        header = header._replace(field=_largest(header.field, header.unit))
    if not header.unit or len(plain) != len(written):
        return header
    start = plain.rfind(header.unit)
    if start < 0:
        return header
    return header._replace(unit=written[start : start + len(header.unit)])


def _largest(field: Field, unit: str) -> Field:
    """What a header such as ``max`` is about, which its unit shows: ``max [°/s]`` is a speed, ``max [Nm]`` a torque."""
    measured = UNITS.get(unit_word(unit))
    return FIELDS[_LARGEST.get(measured.dimension, field.name)] if measured else field


def _written(text: str) -> str:
    written = composed(text)
    plain = re.sub(_LATEX, "", written) if "\\" in written or "$" in written else written
    plain = plain.replace("−", "-").replace("⍺", "α").strip()  # the α of APL, as the Robotics Toolbox prints it
    return plain if written.isascii() else re.sub(_AFTER_CHINESE, " ", plain)


def _read(plain: str) -> Header:
    header = _of_code(plain) or _named(plain)
    if header.field or header.key in UNHELD or len(plain) > _LONGEST:
        return header
    if plain.endswith(_CLOSING) and (match := re.fullmatch(_BRACKETED, plain)):
        found = _with_brackets(match[1], match[2].strip())
        if found.field or found.unit or found.key in UNHELD:
            return found
        header = found
    match = re.fullmatch(_LOOSE_UNIT, plain)
    # What stands loose behind a name is its unit only if it is one: `com x` and `comment` are no units.
    # The unit of a field may also be one that is none here, as in `α in Grad`: it is refused with what to write.
    if (
        match
        and is_unit(match[2], others=True)
        and (front := _named(match[1].strip())).key
        and (front.field or is_unit(match[2]))
    ):
        if front.field or front.key in UNHELD:
            return front._replace(unit=match[2].strip()) if not front.field or front.field.dimension else header
        if both := _twice(match[1].strip()):
            return both._replace(unit=match[2].strip())  # `link length a_i/mm`
        return header._replace(key=front.key, unit=None if match[2] in _WORDS_AT_END else match[2])
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
    return front if _named(inner).field is name else front._replace(unit=inner)


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
    return key_of(words.strip(" ,:(")) in {
        key for word in _LOOSE.get(field.name, "").split(", ") for key in keys_of(word)
    }


def _named(plain: str) -> Header:
    if plain.startswith(_INDEXED) and not _LETTERS.isdisjoint(plain) and (match := re.fullmatch(_INDEX, plain)):
        key = key_of(match[1])
        return Header(_exact(key), key, link="i-1" if match[2] else "i")
    if plain in _SIGNED:
        plain = _SIGNED[plain]
    elif plain.startswith(("q", "theta", "θ")) and (match := re.fullmatch(_INDEXED_BOUND, plain)):
        plain = f"{match[1]} {match[2] or match[3]}"  # `q_{i,max}`
    key = key_of(plain)
    if (found := field_of(key)) or key in UNHELD:
        return Header(found, key)
    if plain.rstrip(_BEHIND).endswith(("i", "j", "k", "1")) and (match := re.fullmatch(_INDEX_BEHIND, plain)):
        base = key_of(match[1])
        if (found := field_of(base)) or base in UNHELD:
            return Header(found, base, link="i-1" if match[2] else "i")
    if plain.startswith(("dh", "denavit")) and (match := re.fullmatch(_PREFIX, plain)):
        inner = _named(match[1])
        if inner.field and inner.field.name in ("a", "alpha", "d", "theta"):
            return inner
    return Header(None, key)


def bounds_theta(header: Header) -> bool:
    """Whether a header of limits calls them bounds of theta: ``theta_min``."""
    return header.field is not None and header.field.name in ("lower", "upper", "limits") and "theta" in header.key


# --- Words around a header --------------------------------------------------------------------------------------------


@cache
def _around(name: str) -> tuple[str, ...]:
    """The keys of the words that may stand around the headers of a field."""
    return tuple({key for word in FIELDS[name].around for key in keys_of(word)}) if name in FIELDS else ()


def _exact(key: str) -> Field | None:
    """The field one of whose headers has a key."""
    if key in FIELDS:
        return FIELDS[key]  # no word of the lists is needed
    return None if key in UNHELD else header_fields().get(key)


@lru_cache(maxsize=1024)
def field_of(key: str) -> Field | None:
    """The field that a key means, also with words around it that say nothing new: ``maxjointspeed``."""
    if (found := _exact(key)) or key in UNHELD or len(key) > _LONGEST:
        return found
    return next((each for each in FIELDS.values() if each.around and _has_core(key, each.name)), None)


@lru_cache(maxsize=4096)
def _has_core(key: str, name: str) -> bool:
    """Whether a key without some of the words around is a header of a field."""
    if (found := header_fields().get(key)) is not None:
        return found.name == name
    if not key.startswith(_around(name)) and not key.endswith(_around(name)):
        return False
    return any(_has_core(rest, name) for rest in _cores(key, name))


# --- What is probably meant -------------------------------------------------------------------------------------------


@lru_cache(maxsize=1024)
def misspelt(key: str) -> Field | None:
    """The field that a word of four letters or more misses by one slip, or with all its letters, as `tetha` does.

    Also with words around it that say nothing new: ``joint sgn``.
    """
    if key in _OTHER_WORDS:
        return None
    written = (key, key.removesuffix("i"))  # `tehta_i`
    all_keys = {name: (*written, *_cores(key, name)) for name in FIELDS}
    for word, field in header_fields().items():
        keys = all_keys.get(field.name, written)
        sure = _SURE if word == field.name else _LONG
        if len(word) >= sure and any(one_slip(key, word) or _is_shuffled(key, word) for key in keys):
            return field
    return None


def _cores(key: str, name: str) -> list[str]:
    """What is left of a key without one of the words around a field."""
    around = _around(name) if len(key) <= _LONGEST else ()
    rests = {rest for word in around for rest in (key.removeprefix(word), key.removesuffix(word))}
    return [
        rest
        for rest in rests
        if (1 if not rest.isascii() else SHORTEST_CORE) <= len(rest) < len(key) and rest not in _OTHER_WORDS
    ]


def _is_shuffled(key: str, word: str) -> bool:
    """Whether a longer word has the letters of another, the first one in its place."""
    return len(word) > _SURE and key[:1] == word[:1] and key != word and sorted(key) == sorted(word)


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


_TOKEN = r"[^\W\d_]+"  # noqa: S105 - of a header
_HUMP = r"(?<=[a-z])(?=[A-Z])"
_PROSE = {key for word in PROSE.split(", ") for key in keys_of(word)}


@cache
def _suspects() -> dict[str, re.Pattern[str]]:
    """The patterns of the words that headers of fields have, which are needed where a header names none."""
    return {name: _pattern(words) for name, words in SUSPECTS.items()}


def _pattern(words: str) -> re.Pattern[str]:
    forms = (re.escape(key).replace(r"\*", ".*") for word in words.split(", ") for key in _starred(word))
    return re.compile("|".join(forms))


def _starred(word: str) -> set[str]:
    before, after = "*" * word.startswith("*"), "*" * word.endswith("*")
    return {f"{before}{key}{after}" for key in keys_of(word.strip("*"))}


@lru_cache(maxsize=1024)
def suspected(text: str) -> str | None:
    """What the words of a header look like that names no field: the name of a field, or of what has none."""
    tokens = [key_of(token) for token in re.findall(_TOKEN, _written(re.sub(_HUMP, " ", text)).casefold())]
    if not tokens or not _PROSE.isdisjoint(tokens):
        return None
    return next((name for name, pattern in _suspects().items() if any(map(pattern.fullmatch, tokens))), None)


def spellings(field: Field) -> list[str]:
    """The headers of a field as a schema has them: each as it is written, and with ``ae`` for ``ä``."""
    return [form for word in field.words for form in sorted({word, *keys_of(word)}, key=lambda form: form != word)]


def parts_of(field: Field) -> tuple[str, ...]:
    """The fields that a column of a field gives: itself, or those that share its cells."""
    return GROUPS[field.name].parts if field.name in GROUPS else (field.name,)
