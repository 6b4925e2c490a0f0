"""What comments say in words of units and of the convention: `lengths in mm, angles in degrees`, `MDH parameters`.

A phrase that consists of nothing but units and what they measure is a statement like `units: {length: mm}`. Prose that
only mentions a unit is not: where nothing else declares a unit and the table would be read in another one, it is
refused, since one of the two is wrong.
"""

from __future__ import annotations

import re
import unicodedata
from typing import TYPE_CHECKING

from dh2urdf.manipulator import Convention
from dh2urdf.patterns import late_pattern
from dh2urdf.quantities import UNITS, Dimension, Unit, unit_word
from dh2urdf.source import Problem
from dh2urdf_plugins.readers.header.units import KEY_OF
from dh2urdf_plugins.readers.words.fields import convention_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.statements.statements import Statements
    from dh2urdf_plugins.readers.words.comment_lines import Comment

_MEASURES = {
    "length": "length lengths distance distances dimension dimensions translation translations linear länge längen "
    "laenge laengen abmessungen longueur longueurs longitud longitudes lunghezza lunghezze",
    "angle": "angle angles angular rotation rotations winkel ángulo ángulos angulo angulos angolo angoli",
    "mass": "mass masses weight weights massen gewicht gewichte masa masas",
    "inertia": "inertia inertias trägheit trägheiten trägheitsmomente inertie inerties inercia inercias inerzia",
    "effort": "effort efforts torque torques moment momente drehmoment drehmomente couple couples par coppia coppie",
    "velocity": "velocity velocities speed speeds geschwindigkeit geschwindigkeiten vitesse vitesses velocidad "
    "velocidades velocità",
}
_MEASURE_WORDS = {word: key for key, words in _MEASURES.items() for word in words.split()}
_FIELD_WORDS = {"a": "length", "r": "length", "d": "length", "alpha": "angle", "α": "angle"} | {
    "theta": "angle",
    "θ": "angle",
}
_UNIT_WORDS = frozenset(
    "unit units einheit einheiten unité unités unite unites unidad unidades unità unita uom".split()  # noqa: SIM905
)
_FILLERS = frozenset(
    "all the are is in given measured expressed and of with table value values number numbers every both as by for "  # noqa: SIM905
    "alle alles sind ist und werte die der toutes tous les sont en et valeurs todas todos las los están están y "
    "valores tutte tutti le gli i sono e valori everything parameters parameter dh link joint measurement "
    "measurements used using use system here".split()
)
_BREAKS = late_pattern(r"[\s,;:=&()\[\]{}|\u2013\u2014\uff1a\uff0c]+|\.(?=\s|$)|(?<=\s)[-/](?=\s)")
_BETWEEN_UNITS = late_pattern(r"(?<=[^\W\d_°])/(?=[^\W\d_°])|(?<=°)/|/(?=°)")
_INCHES = late_pattern(r"\bin\b(?=\s*(?:[,;/)\]}&]|and\b|$))")
"""The unit, where another word would follow the preposition."""
_MENTION = late_pattern(
    r"(?:(?:\b(?:in|en|unit|units|are|is|are given in|einheit|einheiten|unité|unités)\b|[\[(:=]|^)\s*)"
    r"((?:(?:[^\W\d_]{1,12}|°)(?:\s*(?:,|;|/|&|\band\b|\bund\b|\bet\b|\by\b|\be\b)\s*)?)+)",
    re.IGNORECASE,
)
_IN_MENTION = ("in", "en", "unit", "is", "are", "[", "(", ":", "=")
"""What ASCII prose that mentions a unit has at least one of, if it does not begin with the unit."""
_LETTERS = late_pattern(r"[^\W\d_]+|°")
_OWN_NUMBER = late_pattern(r"(?<![^\W_])[0-9]")
_NO_UNIT = late_pattern(r"\bdegrees?\s+of\s+freedom\b|\brev\.?\s*(?:[a-z]|[0-9.]+)\b", re.IGNORECASE)
"""Where the word of a unit is none: ``6 degrees of freedom``, ``rev. B``."""
_SYSTEM = {Dimension.LENGTH: "m", Dimension.ANGLE: "rad"}

_PROSE_WORD = late_pattern(r"\w+")
_SAYS_CONVENTION = late_pattern(
    r"(?<![a-z])d-?h(?![a-z])|denavit|convention|convenci|convenz|konwenc|notac|notaz|parameters|денавит|параметр|\bдх\b",
    re.IGNORECASE,
)
_CONVENTION_WORDS = late_pattern(
    r"(?:denavit|hartenberg|dh|convention|konvention|convención|convencion|convenzione|notation|the|this|table|is|in|"
    r"uses|using|parameters|parameter|s|of|follows|according|to)"
)
_CONVENTION_STEMS = ("conven", "konven", "notation")
_PROSE = {
    Convention.MODIFIED: (frozenset(("mdh", "craig", "proximal", "khalil")), frozenset(("modified",))),
    Convention.STANDARD: (frozenset(("sdh", "distal", "spong")), frozenset(("standard", "classic", "classical"))),
}
"""Words for the convention in a comment: those that mean nothing else, and those that may."""
_IN_OTHER_LANGUAGES = {
    Convention.MODIFIED: "modifizi modifié modifie modifica zmodyfik değiştiril модифицир 改进 改良 修正 수정".split(),  # noqa: SIM905
    Convention.STANDARD: "estándar standardow klasyczn klasik классич стандартн 标准 標準 표준".split(),  # noqa: SIM905
}
_MOVES = late_pattern(r"(?<![^\W_])(?:rot|trans|tr|r|t|d)[\s_({\\]*([xz])(?![a-z])", re.IGNORECASE)
_OF_MOVES = {"xxzz": Convention.MODIFIED, "zzxx": Convention.STANDARD}
"""The convention of a product by the axes of its moves: ``Rx(α)·Tx(a)·Rz(θ)·Tz(d)``."""
_ALONE = late_pattern(
    r"(?<![\d.,±²³/·*^])(?<![\d.,]\s)(?<![a-zµ])(?:(?P<mm>mm(?![a-z/·*^²³0-9])|мм\b|миллиметр|毫米|公厘|ミリ|밀리|milimet)"
    r"|(?P<cm>cm(?![a-z/·*^²³0-9])|см\b|сантиметр|厘米|公分|センチ|센티)"
    r"|(?P<deg>градус|stopni(?!\w*\s+swobod)|(?<!serbestlik )derece|degr[eé]s\b(?!\s+de\s+libert)"
    r"|(?:grados|graus)(?!\s+de\s+liber)|gradi\b(?!\s+di\s+libert)|(?:(?<=in )|(?<=[\[(]))grad\b"
    r"|(?<=[为為は：:，,])\s*度(?!数)|(?<=각도는)\s*도))",
    re.IGNORECASE,
)
"""Units that are no other words, in any prose: ``wymiary w mm``, ``長さの単位はmm``, ``углы в градусах``."""
_IN_ALONE = ("mm", "cm", "milimet", "stopni", "derece", "degres", "grados", "graus", "grad")
"""What ASCII prose with such a unit has at least one of."""


# --- Phrases that are statements --------------------------------------------------------------------------------------


def units_said(text: str) -> dict[str, str] | None:
    """The units that a phrase declares, by key of `units`; None where it says anything besides.

    ``all lengths in mm, angles in degrees``, ``units [mm, deg]``, ``mm/deg``, ``a and d in mm``.
    """
    if _is_prose(text):
        return None
    words = [word for word in _words(text) if word not in _UNIT_WORDS and word not in _FILLERS]
    said: dict[str, str] = {}
    measured: set[str] = set()
    for word in words:
        if key := _MEASURE_WORDS.get(word) or _FIELD_WORDS.get(word):
            measured.add(key)
            continue
        unit = _unit(word)
        key = KEY_OF.get(unit.dimension) if unit else None
        if unit is None or key is None or said.setdefault(key, unit.symbol) != unit.symbol:
            return None
    one_of_two = len({"a", "d"} & {word.replace("r", "a") for word in words if word in _FIELD_WORDS}) == 1
    return said if said and measured <= said.keys() and not one_of_two else None


def unit_of_measure(key: str, value: str) -> dict[str, str] | None:
    """The unit that a key such as ``length_unit``, ``lengths`` or ``unit of angles`` declares, or None."""
    words = [word for word in _words(key.replace("_", " ").replace("-", " ")) if word not in _FILLERS]
    measures = [word for word in words if word not in _UNIT_WORDS]
    if len(measures) != 1 or measures[0] not in _MEASURE_WORDS:
        return None
    said = units_said(value)
    return said if said and said.keys() == {_MEASURE_WORDS[measures[0]]} else None


def convention_said(text: str) -> Convention | None:
    """The convention that a phrase says and nothing besides: ``modified DH convention``, ``convention is standard``."""
    if not any(stem in text.casefold() for stem in _CONVENTION_STEMS):
        return None
    words = [word for word in _words(text.replace("-", " ").replace("'", " ")) if word]
    if not any(word.startswith(_CONVENTION_STEMS) for word in words):
        return None
    named = {convention_of(word) for word in words if not _CONVENTION_WORDS.fullmatch(word)}
    return named.pop() if len(named) == 1 else None


def _is_prose(text: str) -> bool:
    """Whether a text begins with a plain word that is none of a phrase of units: looked at before any pattern is."""
    first = text.casefold().partition(" ")[0]
    of_units = first in _UNIT_WORDS or first in _FILLERS or first in _MEASURE_WORDS or first in _FIELD_WORDS
    return first.isascii() and first.isalpha() and not of_units and _unit(first) is None


def _words(text: str) -> list[str]:
    plain = unicodedata.normalize("NFC", text).casefold()
    plain = _INCHES.sub("inch", plain) if "in" in plain else plain
    return [word for word in _BREAKS.split(_BETWEEN_UNITS.sub(" ", plain) if "/" in plain else plain) if word]


def _unit(word: str) -> Unit | None:
    """The unit of any dimension that a word stands for."""
    return UNITS.get(unit_word(word))


# --- Prose ------------------------------------------------------------------------------------------------------------


def prose_problems(comment: Comment, statements: Statements, columns: Columns) -> list[Problem]:
    """What a comment says that the table does not: another convention, or a unit.

    Args:
        comment: one that says nothing under a key.
        statements: what the table and the options say.
        columns: its headers.
    """
    return in_other_words(comment, statements, columns.units.values(), lead="# ")


def in_other_words(
    comment: Comment, statements: Statements, units: Iterable[Unit], *, lead: str, behind: bool = False
) -> list[Problem]:
    """What a comment says that the table does not: another convention, or a unit.

    Args:
        comment: one that says nothing under a key.
        statements: what the table and the options say.
        units: units that hold where the comment is, besides those of the statements.
        lead: what a line begins with that declares something.
        behind: whether it is behind a value, of which a number with its unit says no more: ``# 425 mm``.
    """
    if behind and _OWN_NUMBER.search(comment.text):
        return []
    # What explains a value may speak of the other convention.
    stated = None if behind else statements.convention
    problems = _other_convention(comment, stated[0], lead) if stated else []
    return problems + _other_units(comment, [*(unit for unit, _ in statements.stated.values()), *units], lead)


def units_beside(text: str) -> list[Unit]:
    """The units that a line names before its comment: ``a: 425 mm``."""
    return [unit for word in _LETTERS.findall(text) if (unit := _unit(word))]


def convention_in_prose(line: str) -> Convention | None:
    """The convention that a comment speaks of; None where it speaks of none, or of both."""
    plain = line.casefold()
    words = set(_PROSE_WORD.findall(plain))

    def may_mean(convention: Convention, likely: frozenset[str]) -> bool:
        named = words & likely or any(word in plain for word in _IN_OTHER_LANGUAGES[convention])
        return bool(named and (len(words) == 1 or _SAYS_CONVENTION.search(line)))

    spoken = [each for each, (sure, likely) in _PROSE.items() if words & sure or may_mean(each, likely)]
    if not spoken and "x" in plain and "z" in plain:
        return _OF_MOVES.get("".join(_MOVES.findall(line)).lower())
    return spoken[0] if len(spoken) == 1 else None


def _other_convention(comment: Comment, convention: Convention, lead: str) -> list[Problem]:
    spoken = convention_in_prose(comment.text)
    if spoken in (None, convention):
        return []
    return [
        Problem(
            message=f"this comment speaks of the {spoken} convention, and the table is read as {convention}",
            severity="notice",
            mark=comment.whole,
            field="convention",
            found=comment.line,
            suggestion=f"if it means this table, write `{lead}convention: {spoken}`",
        )
    ]


def mentioned_units(text: str) -> list[Unit]:
    """The units of lengths and angles that prose mentions, those behind a number left out: ``0.1 mm``."""
    found: list[Unit] = []
    if text.isascii() and _is_prose(text) and not any(word in text.casefold() for word in (*_IN_MENTION, *_IN_ALONE)):
        return found
    plain = _NO_UNIT.sub("", text) if any(word in text.casefold() for word in ("freedom", "rev")) else text
    for match in _MENTION.finditer(plain):
        for word in _LETTERS.finditer(match[1]):
            unit = _unit(word[0])
            is_rate = match[1][word.end() :].lstrip().startswith("/s")
            if unit is None or unit.dimension not in _SYSTEM or is_rate or word[0].casefold() in _FILLERS:
                break
            found.append(unit)
    if plain.isascii() and not any(unit in plain.casefold() for unit in _IN_ALONE):
        return found
    return found + [UNITS[match.lastgroup] for match in _ALONE.finditer(plain) if match.lastgroup]


def _other_units(comment: Comment, declared: Sequence[Unit], lead: str) -> list[Problem]:
    """What is wrong with units that a comment mentions beside those that hold."""
    problems, elsewhere = [], "units in the headers" if lead else "numbers with their units"
    for unit in dict.fromkeys(mentioned_units(comment.text)):
        others = {other.symbol for other in declared if other.dimension is unit.dimension}
        key, system = KEY_OF[unit.dimension], _SYSTEM[unit.dimension]
        if unit.symbol in (others or {system}):
            continue
        read_in = " and ".join(sorted(others)) if others else f"{system}, since nothing declares a unit"
        problems.append(
            Problem(
                message=f"this comment mentions {unit.symbol}, and {key}s are read in {read_in}",
                severity="notice" if others else "error",
                mark=comment.whole,
                field=f"units.{key}",
                found=comment.line,
                accepted=None
                if others
                else f"`{lead}units: {{{key}: {unit.symbol}}}` if that is the unit of all {key}s, or {elsewhere}",
                suggestion=None
                if others
                else f"if the {key}s are in {system}, declare that too: `{lead}units: {{{key}: {system}}}`",
            )
        )
    return problems
