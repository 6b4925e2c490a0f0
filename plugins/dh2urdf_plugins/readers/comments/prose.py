"""Prose of comments: it declares nothing, and may speak of another unit or convention than the table has.

Where nothing else declares a unit and the table would be read in another one than the prose mentions, it is refused,
since one of the two is wrong.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.manipulator import Convention
from dh2urdf.quantities import UNITS, Dimension, Unit
from dh2urdf.source import Problem
from dh2urdf_plugins.readers.comments.phrases import FILLERS, declared, unit_called
from dh2urdf_plugins.readers.header.units import KEY_OF, SI
from dh2urdf_plugins.readers.words.cells import rate_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.source import Mark
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.statements.statements import Statements
    from dh2urdf_plugins.readers.words.comment_lines import Comment

_MENTION = (
    r"(?i)(?:(?:\b(?:in|en|unit|units|is|are|einheit|einheiten|unité|unités)\b|[\[(:=,;|\u2013\u2014]|(?<="
    r"\s)-(?=\s)|^)\s*"
    r"|(?<![^\W_])(?:a|d|r|alpha|theta|α|θ|lengths?|angles?)(?:_?i)?\s*/\s*)(?:\b(?:in|is|are|given|expressed)\s+){0,3}"
    r"(?=((?:(?:[^\W\d_]{1,12}|°)(?:\s*(?:,|;|/|&|\band\b|\bund\b|\bet\b|\by\b|\be\b)\s*)?){1,8}))"
)
"""What units are behind, as in ``angles are in deg``, ``UR5 (mm, deg)`` and ``a/mm``, and the words there."""
_LETTERS = r"[^\W\d_]+|°"
_TO_SPACES = {code: " " for code in range(128) if not chr(code).isalpha()}
"""Every ASCII character that is no letter: a table for `str.translate`."""
_OWN_NUMBER = r"(?<![^\W_])[0-9]"
_NO_UNIT = r"(?i)\bdegrees?\s+of\s+freedom\b|\brev\.?\s*(?:[a-z]|[0-9.]+)\b|\bturns?\s+(?!and\b|per\b)[a-z]"
"""Where the word of a unit is none: ``6 degrees of freedom``, ``rev. B``, ``turns the other way``."""
_RATE = r"(?i)\s*(?:/|per\b)\s*(s|sec|seconds?|min|minutes?)\b(\s?(?:\^|\*|²|/|squared))?"
"""What makes a speed of a length or an angle before it, ``deg/s``, ``mm per second``, or an acceleration."""
_SYSTEM = {dimension: SI[dimension] for dimension in (Dimension.LENGTH, Dimension.ANGLE)}
_IN_COLUMNS = {
    Dimension.TURN_RATE: ("velocity", "velocities"),
    Dimension.SPEED: ("velocity", "velocities"),
    Dimension.MASS: ("mass", "masses"),
    Dimension.TORQUE: ("effort", "efforts"),
}
"""Quantities whose unit matters where a table has a column of them: its field, and what messages call them."""

_PROSE_WORD = r"\w+"
_SAYS_CONVENTION = (
    r"(?i)(?<![a-z])d-?h(?![a-z])|denavit|[ck]onvention|convenci|convenz|konwenc|notac|notaz|parameters|де"
    r"навит|параметр|\bдх\b"
)
_PROSE = {
    Convention.MODIFIED: (frozenset(("mdh", "craig", "proximal", "khalil")), frozenset(("modified", "mod"))),
    Convention.STANDARD: (frozenset(("sdh", "distal", "spong")), frozenset(("standard", "classic", "classical"))),
}
"""Words for the convention in a comment: those that mean nothing else, and those that may."""
_IN_OTHER_LANGUAGES = {
    Convention.MODIFIED: "modifizi modifié modifie modifica zmodyfik değiştiril модифицир 改进 改良 修正 수정".split(),  # noqa: SIM905
    Convention.STANDARD: (
        "estándar standardow klassisch classique clásic klasyczn klasik классич стандартн 标准 標準 표준".split()  # noqa: SIM905
    ),
}
_NEGATIONS = frozenset(("not", "non", "no", "unlike", "nicht", "kein", "keine", "pas"))
_BEFORE_DENIED = frozenset("the a an any in using with by to der die das in la le el".split())  # noqa: SIM905
"""Words between a negation and what is denied."""
_MOVES = r"(?i)(?<![^\W_])(?:rot|trans|tr|r|t|d)[\s_({\\]*([xz])(?![a-z])"
_PREVIOUS = r"(?i)(?<![^\W_])(?:a|alpha|α)[\s_({]{0,3}i\s?[-−]\s?1"
"""Parameters of the link before: ``a_{i-1}``."""
_OF_MOVES = {"xxzz": Convention.MODIFIED, "zzxx": Convention.STANDARD}
"""The convention of a product by the axes of its moves: ``Rx(α)·Tx(a)·Rz(θ)·Tz(d)``."""
_ALONE = (
    r"(?i)(?<![\d.,±²³/·*^])(?<!\d\s)(?<!\d[.,]\s)(?<!kg[\s-])(?<!kgf[\s-])(?<!\bn[\s-])(?<![a-zµ])"
    r"(?:(?P<mm>mm(?![a-z/·*^²³0-9])|мм\b|миллиметр|毫米|公厘|ミリ|밀리|milimet)"
    r"|(?P<cm>cm(?![a-z/·*^²³0-9])|см\b|сантиметр|厘米|公分|センチ|센티)"
    r"|(?P<deg>градус|stopni(?!\w*\s+swobod)|(?<!serbestlik )derece|degr[eé]s\b(?!\s+de\s+libert)"
    r"|(?:grados|graus)(?!\s+de\s+liber)|gradi\b(?!\s+di\s+libert)|(?:(?<=in )|(?<=[\[(]))grad\b"
    r"|(?<=[为為は：:，,])\s*度(?!数)|(?<=각도는)\s*도)"
    r"|(?P<inch>(?<![^\W_])imperial(?= units?\b| system\b)))"
)
"""Units that are no other words, in any prose: ``wymiary w mm``, ``長さの単位はmm``, ``углы в градусах``."""
_IN_ALONE = ("mm", "cm", "milimet", "stopni", "derece", "degres", "grados", "graus", "grad", "imperial")
"""What ASCII prose with such a unit has at least one of."""


def prose_problems(comment: Comment, statements: Statements, columns: Columns) -> list[Problem]:
    """What a comment says that the table does not: another convention, or a unit.

    Args:
        comment: one that says nothing under a key.
        statements: what the table and the options say.
        columns: its headers.
    """
    by_row = "convention" in columns.fields
    return in_other_words(
        comment,
        statements,
        columns.units.values(),
        lead="# ",
        by_row=by_row,
        fields=frozenset(filter(None, columns.fields)),
    )


def in_other_words(
    comment: Comment,
    statements: Statements,
    units: Iterable[Unit],
    *,
    lead: str,
    behind: bool = False,
    by_row: bool = False,
    fields: frozenset[str] | None = None,
) -> list[Problem]:
    """What a comment says that the table does not: another convention, or a unit.

    Args:
        comment: one that says nothing under a key.
        statements: what the table and the options say.
        units: units that hold where the comment is, besides those of the statements.
        lead: what a line begins with that declares something.
        behind: whether it is behind a value, of which a number with its unit says no more: ``# 425 mm``.
        by_row: whether each row has its convention.
        fields: those that the table has columns of; None where any joint may have any.
    """
    if behind and re.search(_OWN_NUMBER, comment.text):
        return []
    # What explains a value may speak of the other convention.
    problems = [] if behind else _other_convention(comment, statements.convention, lead, by_row=by_row)
    held = [*(unit for unit, _ in statements.stated.values()), *units]
    return problems + _other_units(comment, held, lead, fields)


def units_beside(text: str) -> list[Unit]:
    """The units that a line names before its comment: ``a: 425 mm``."""
    return [unit for word in re.findall(_LETTERS, text) if (unit := unit_called(word))]


def convention_in_prose(line: str) -> Convention | None:
    """The convention that a comment speaks of; None where it speaks of none, or of both.

    Prose that denies one, as ``not modified DH`` does, speaks of the other.
    """
    plain = line.casefold()
    words = re.findall(_PROSE_WORD, plain)
    denied = [] if _NEGATIONS.isdisjoint(words) else _denied(words)
    said = [word for place, word in enumerate(words) if place not in denied]

    def spoken_in(some: list[str]) -> list[Convention]:
        return [
            each
            for each, (sure, likely) in _PROSE.items()
            if not sure.isdisjoint(some)
            or (
                (
                    not likely.isdisjoint(some)
                    or any(stem in word for stem in _IN_OTHER_LANGUAGES[each] for word in some)
                )
                and (len(set(words)) == 1 or re.search(_SAYS_CONVENTION, line))
            )
        ]

    spoken = spoken_in(said)
    if not spoken and (others := spoken_in([words[place] for place in denied])):
        spoken = [each for each in _PROSE if each not in others]
    if not spoken and "1" in plain and re.search(_PREVIOUS, line):
        return Convention.MODIFIED
    if not spoken and "x" in plain and "z" in plain:
        return _OF_MOVES.get("".join(re.findall(_MOVES, line)).lower())
    return spoken[0] if len(spoken) == 1 else None


def _denied(words: list[str]) -> list[int]:
    """The places of the words right behind a negation, articles aside."""
    found = []
    for place in (place for place, word in enumerate(words) if word in _NEGATIONS):
        behind = next((k for k in range(place + 1, len(words)) if words[k] not in _BEFORE_DENIED), None)
        found += [] if behind is None else [behind]
    return found


def _other_convention(
    comment: Comment, stated: tuple[Convention, Mark] | None, lead: str, *, by_row: bool
) -> list[Problem]:
    spoken = convention_in_prose(comment.text)
    if spoken is None or (stated is None and by_row) or (stated and stated[0] is spoken):
        return []
    read_as = f"the table is read as {stated[0]}" if stated else "nothing declares one"
    return [
        Problem(
            message=f"this comment speaks of the {spoken} convention, and {read_as}",
            severity="notice" if stated else "error",
            mark=comment.whole,
            field="convention",
            found=comment.line,
            suggestion=f"if it means this table, write `{lead}convention: {spoken}`",
        )
    ]


def mentioned_units(text: str) -> list[Unit]:
    """The units of lengths and angles that a comment mentions, those behind a number left out: ``0.1 mm``."""
    said = declared(text).get("units")
    found = [unit for word in re.findall(_LETTERS, said) if (unit := _measured(word))] if said else []
    plain = re.sub(_NO_UNIT, "", text) if any(word in text.casefold() for word in ("freedom", "rev", "turn")) else text
    has_unit = not plain.isascii() or any(map(_measured, plain.translate(_TO_SPACES).split()))
    for match in re.finditer(_MENTION, plain) if has_unit else ():
        for word in re.finditer(_LETTERS, match[1]):
            unit = _measured(word[0])
            if unit is None or word[0].casefold() in FILLERS:
                break
            if (rate := re.match(_RATE, plain[match.start(1) + word.end() :])) and unit.dimension in _SYSTEM:
                speed = unit_called(f"{word[0]}/{'min' if rate[1].startswith('m') else 's'}")
                found += [speed] if speed and not rate[2] else []
                break
            found.append(unit)
    if plain.isascii() and not any(unit in plain.casefold() for unit in _IN_ALONE):
        return found
    return found + [UNITS[match.lastgroup] for match in re.finditer(_ALONE, plain) if match.lastgroup]


def _measured(word: str) -> Unit | None:
    """The unit that a word stands for, of a length, an angle or what a column may hold."""
    unit = unit_called(word)
    return unit if unit and (unit.dimension in _SYSTEM or unit.dimension in _IN_COLUMNS) else None


def _other_units(comment: Comment, held: Sequence[Unit], lead: str, fields: frozenset[str] | None) -> list[Problem]:
    """What is wrong with units that a comment mentions beside those that hold."""
    problems, elsewhere = [], "units in the headers" if lead else "numbers with their units"
    held = [*held, *(rate_of(unit) for unit in held if unit.dimension in _SYSTEM)]
    for unit in dict.fromkeys(mentioned_units(comment.text)):
        others = {other.symbol for other in held if other.dimension is unit.dimension}
        key, system = KEY_OF[unit.dimension], SI[unit.dimension]
        field, what = _IN_COLUMNS.get(unit.dimension, ("", f"{key}s"))
        if field and fields is not None and field not in fields:
            continue
        if unit.symbol in (others or {system}):
            continue
        read_in = " and ".join(sorted(others)) if others else f"{system}, since nothing declares a unit"
        problems.append(
            Problem(
                message=f"this comment mentions {unit.symbol}, and {what} are read in {read_in}",
                severity="notice" if others else "error",
                mark=comment.whole,
                field=f"units.{key}",
                found=comment.line,
                accepted=None
                if others
                else f"`{lead}units: {{{key}: {unit.symbol}}}` if that is the unit of all {what}, or {elsewhere}",
                suggestion=None
                if others
                else f"if the {what} are in {system}, declare that too: `{lead}units: {{{key}: {system}}}`",
            )
        )
    return problems
