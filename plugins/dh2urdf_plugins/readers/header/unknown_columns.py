"""Columns and keys that name no field: those that are refused where they hold anything, and those that are left out."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.quantities import Dimension, QuantityError, evaluate, find_unit, is_unit, is_zero
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf_plugins.readers.header.words import Header, misspelt, read_header, suspected
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT
from dh2urdf_plugins.readers.words.comment_lines import SPREADSHEET_ERROR
from dh2urdf_plugins.readers.words.fields import FIELDS
from dh2urdf_plugins.readers.words.unheld import GEOMETRY, IGNORED, LIKELY, MOVES_BY_ITSELF, NO, is_still, meaning_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.quantities import Quantity
    from dh2urdf_plugins.readers.words.cells import Cell

_WITH_UNIT = r"[+-]?[0-9]+(?:[.,][0-9]+)?\s*([^\s0-9].{0,15})"
_SEVERAL = r"[\[(]*(?:±|\+\s*/?\s*-|[+\-−])?\s*[0-9][0-9.,]*\s*[^\W\d]*[°\s/~〜～…()+\-−.]"
"""How a cell of several numbers begins: with a number, its unit, and what is between numbers."""
_REMARK = r"[\[(][^()\[\]0-9]*[\])]"
_WORD = r"(?:°|[^\W\d_]+)(?:/[^\W\d_]+)?"
_OF_RANGES = frozenset(("to", "bis", "up", "jusqu", "à", "a", "hasta", "fino", "até", "e", "pi", "π", "至", "到"))
_NOUNS = {
    "acceleration": "an acceleration",
    "jerk": "a jerk or the rate of a torque",
    "stiffness": "a stiffness or a play",
    "gear": "of a gear",
}
"""What has no field, as the end of a sentence."""
_NUMBER = r"[+\-−]?[.,]?[0-9]"
_STRAY = r"[^\w\\$]*(.*?[\])}]|.*?\w)(?:[\W_]+\w?[\W_]*|(?<=[\])}])\w)?"
_FACTOR = (
    r"(?i)(.*?\w)\s*[(\[]?\s*(?:(?:[×*·⋅]|(?<![a-z])x)\s*)?"
    r"(?:10\s*(?:\^|\*\*)?\s*[-−⁻+]?[0-9⁰¹²³⁴-⁹]+|1?e[-+]?[0-9]+|(?<=[×x*·⋅ ])10+)\s*[)\]]?"
)
"""A header with a factor: ``Ixx ×10⁻³``, ``Ixx*1e3``."""
_OTHER_ONE = (
    r"(?i)(?:delta|d(?=theta|alpha|θ|α|[ad]$)|[δΔ]"
    r"|calibrated|corrected|identified|measured|actual|true|real|correction(?: of)?)[\s_]*(.+)"
    r"|(.+?)[\s_]+(?:calibrated|corrected|identified|measured|actual|true|real|correction)"
)
"""A parameter beside the nominal one, or its correction: ``Δd``, ``calibrated a``."""
DIFFERENCES = "differences are in a table of their own, as a, alpha, d and theta, which `--calibration` names"
_DIRECTIONS = frozenset(
    "cw ccw clockwise counterclockwise counter-clockwise anticlockwise anti-clockwise reversed inverted -z z- "  # noqa: SIM905
    "rechtsdrehend linksdrehend horario antihorario horaire antihoraire orario antiorario horário invertiert "
    "顺时针 逆时针 正转 反转".split()
)
_AXIS_DOWN = r"[(\[]?\s*(?:-?0(?:\.0*)?[\s,;]+){2}-1(?:\.0*)?\s*[)\]]?"
"""The axis of a joint that turns the other way about z: ``(0, 0, -1)``."""
_FEW_WORDS = 4
_LONGEST_VARIABLE = 40
_AXES_OF_CONTROLLER = r"(?:j|q|θ|theta)_?[0-9]{1,2}"
_OF_CONTROLLER = (
    rf"(?i)\s*[-−–]\s*\(?\s*{_AXES_OF_CONTROLLER}(?:\s*[-+−–]\s*{_AXES_OF_CONTROLLER})?\s*\)?\s*"
    rf"|\s*{_AXES_OF_CONTROLLER}\s*\+\s*{_AXES_OF_CONTROLLER}\s*"
)
"""Joint variables by the names of a controller, turned or coupled: ``-J5``, ``-(J2 + J3)``."""
_OF_ONE_MEANING = frozenset(("alpha", "theta"))
"""Parameters whose names are no other words."""


class Refusal(NamedTuple):
    """Why a column or key that names no field is refused where it holds anything.

    Attributes:
        reason: what it is, as the end of a sentence that begins with its header.
        accepted: what to write in its place.
        field: the field that was probably meant.
        zero: whether it may hold 0.
        counts: whether it may hold the number of the row.
        suggestion: what to do, where that is not to leave it out.
        varies: whether it may hold the joint variable of the row.
    """

    reason: str
    accepted: str
    field: str | None = None
    zero: bool = False
    counts: bool = False
    suggestion: str | None = None
    varies: bool = False


def refusal(text: str, header: Header, what: str = "column") -> Refusal | None:
    """Why a column is refused where it holds anything; None where it may be left out.

    Args:
        text: its header.
        header: what that says; it names no field.
        what: whether it is a column or a key.
    """
    if header.ignored or not text:
        return None
    if meaning := meaning_of(header.key):
        reason, varies = f"is {meaning.reason}, which no {what} holds", header.key == "q"
        return Refusal(reason, meaning.accepted, None, meaning.zero, meaning.counts, meaning.suggestion, varies)
    if geometry := other_geometry(text, what):
        return geometry
    name = suspected(text) or _with_stray_signs(text) or _with_factor(text)
    if name == "limits" and header.unit and not _measures(header.unit, FIELDS["limits"].dimension):
        name = None  # `Max. [°/s]` is a limit of something else, as its unit says
    if name in FIELDS and not (header.field and name in _OF_ONE_MEANING):
        is_angle = name in _OF_ONE_MEANING
        reason = f"seems to be {name}, but no field is called so"
        return Refusal(reason, _headers(str(name)), name, zero=is_angle, varies=is_angle)
    if name in _NOUNS:
        return Refusal(f"seems to be {_NOUNS[name]}, which no {what} holds", "a table without it")
    return _without_words(text, header)


def other_geometry(text: str, what: str) -> Refusal | None:
    """Why a column of a parameter is refused that is not the one which the row has, or not all of it."""
    match = re.fullmatch(_OTHER_ONE, text) if len(text) <= MAX_TEXT else None
    named = read_header(match[1] or match[2]).field if match else None
    if named is None or named.name not in ("a", "alpha", "d", "theta"):
        return None
    return Refusal(
        f"is another {named.name} or a part of it, which no {what} holds", GEOMETRY, zero=True, suggestion=DIFFERENCES
    )


def _with_factor(text: str) -> str | None:
    """The field of a quantity whose header has a factor: ``Ixx ×10⁻³``."""
    match = re.fullmatch(_FACTOR, text)
    named = read_header(match[1].strip()).field if match else None
    return named.name if named and named.dimension else None


def _with_stray_signs(text: str) -> str | None:
    """The field of a quantity whose header has a sign or a letter too many around it: ``theta [deg]"``, ``(d``."""
    match = re.fullmatch(_STRAY, text)
    core = match[1] if match else text
    field = read_header(core).field if core and core != text else None
    return field.name if field and field.dimension else None


def _without_words(text: str, header: Header) -> Refusal | None:
    """Why a column is refused whose words say nothing: it has a unit, or its header is a symbol or an error."""
    if text.startswith("#") and re.fullmatch(SPREADSHEET_ERROR, text):
        return Refusal("is what a spreadsheet writes for an error", "a header above each column of numbers")
    if header.unit and is_unit(header.unit):
        return Refusal(f"has the unit {shown(header.unit)}, but no field is called so", _measured_in(header.unit))
    if len(header.key) == 1 and header.key.isalpha():
        return Refusal("is the symbol of a quantity, but no field is called so", ", ".join(FIELDS), zero=True)
    return None


def refused(
    cell: Cell, header: str, why: Refusal, joint: str | None, *, number: int | None = None, what: str = "column"
) -> Problem | None:
    """What is wrong with a cell of such a column, or a value of such a key; None where it says nothing.

    Args:
        cell: the cell.
        header: the header of its column, or the key.
        why: why that is refused.
        joint: the joint's name, where it is known.
        number: the number of the row, where it is one of a table with columns.
        what: whether it is a column or a key.
    """
    label = re.sub(_REMARK, "", cell.text).rstrip() if cell.text[-1:] in ")]" else cell.text
    counted = why.counts and label.casefold() in (str(number), f"j{number}")
    if not cell.text or counted or (why.zero and (is_zero(cell.text) or label.casefold() in NO)):
        return None
    if why.varies and _is_variable_of(cell.text, number):
        return None
    accepted = why.accepted
    if what == "key":
        accepted = accepted.replace("in this column", "under this key").replace("column", "key")
    return Problem(
        message=f"{shown(header)} {why.reason}, and it is {shown(cell.text)}",
        mark=cell.mark,
        joint=joint,
        field=why.field or header,
        found=cell.text,
        accepted=accepted,
        suggestion=why.suggestion or (None if why.accepted == GEOMETRY else how_to_leave_out(header, what)),
    )


def unread(cell: Cell, header: str, number: int | None) -> Problem | None:
    """What is wrong with a cell of a column that is left out: it says what only a field can hold.

    Args:
        cell: the cell.
        header: the header of its column.
        number: the number of the row; None where every number may be its own.
    """
    joint = f"joint_{number}"
    return (
        _with_unit(cell, header, joint)
        or _turned_direction(cell, header, joint)
        or _passive(cell, header, joint)
        or _with_offset(cell, header, number)
    )


def _variable(text: str) -> Quantity | None:
    """What a cell says that names a joint variable; None for any other cell."""
    if len(text) > _LONGEST_VARIABLE or not any(map(str.isalpha, text)):
        return None
    for dimension in (Dimension.ANGLE, Dimension.LENGTH):
        try:
            quantity = evaluate(text, dimension, decimal_comma=True)
        except QuantityError:
            continue
        return quantity if quantity.variable else None
    return None


def _is_variable_of(text: str, number: int | None) -> bool:
    """Whether a cell is the joint variable of its row, and nothing besides: ``q1`` in the first one."""
    said = _variable(text) if number is not None else None
    if said is None or said.variable is None or said.value or said.sign < 0:
        return False
    return said.variable.row == number and said.variable.kind != "d"


def is_turned_variable(text: str, number: int | None = None) -> bool:
    """Whether a text is the variable of a row, or any, with an offset or a sign: ``q1 - 90``, ``-(J2 + J3)``."""
    if not any(sign in text for sign in "+-−–"):
        return False
    said = _variable(text)
    if said is None or said.variable is None or not (said.value or said.sign < 0):
        return re.fullmatch(_OF_CONTROLLER, text) is not None
    return said.variable.row is not None and said.variable.row == (number or said.variable.row)


def _with_offset(cell: Cell, header: str, number: int | None) -> Problem | None:
    """What is wrong with the joint variable and an offset, or its negative: ``θ1 + 90°``, ``-q2``."""
    if not is_turned_variable(cell.text, number):
        return None
    return Problem(
        message=f"{shown(cell.text)} is a joint variable with an offset or a sign, and no field is called "
        f"{shown(header)}",
        mark=cell.mark,
        joint=f"joint_{number}",
        field="theta",
        found=cell.text,
        accepted="the variable in the column theta, or in d of a joint that slides",
        suggestion=how_to_leave_out(header) if header else None,
    )


def _with_unit(cell: Cell, header: str, joint: str) -> Problem | None:
    """What is wrong with a cell that is a quantity, in a column that is left out."""
    unit = unit_of(cell.text)
    if unit is None:
        return None
    return Problem(
        message=f"{shown(cell.text)} is a quantity, but no field is called {shown(header)}",
        mark=cell.mark,
        joint=joint,
        field=header,
        found=cell.text,
        accepted=_measured_in(unit),
        suggestion=how_to_leave_out(header) if header else "write a header above the column",
    )


def is_direction(text: str) -> bool:
    """Whether a cell is a direction of rotation, and nothing else: ``ccw``, ``reversed``, ``(0, 0, -1)``."""
    return text.casefold() in _DIRECTIONS or ("-1" in text and re.fullmatch(_AXIS_DOWN, text) is not None)


def _passive(cell: Cell, header: str, joint: str) -> Problem | None:
    """What is wrong with a cell of a column that is left out, where it says that the joint does not move by itself."""
    if not is_still(header, cell.text):
        return None
    why = Refusal(f"is {MOVES_BY_ITSELF.reason}, which no column holds", MOVES_BY_ITSELF.accepted)
    return refused(cell, header, why, joint)


def _turned_direction(cell: Cell, header: str, joint: str) -> Problem | None:
    """What is wrong with a direction, in a column that is left out: the joint would turn the other way."""
    if not is_direction(cell.text):
        return None
    return Problem(
        message=f"{shown(cell.text)} seems to be a direction, and no field is called {shown(header)}",
        mark=cell.mark,
        joint=joint,
        field="sign",
        found=cell.text,
        accepted="a column sign with 1 or -1, or a column flip with true or false",
        suggestion=how_to_leave_out(header) if header else None,
    )


def stray_number(text: str, mark: Mark, joint: str) -> Problem:
    """A number in a column without a header, which belongs to the table: it may be any field."""
    return Problem(
        message=f"{shown(text)} is in a column without a header",
        mark=mark,
        joint=joint,
        found=text,
        accepted="a header above each column of numbers, and an empty column between the table and notes",
    )


def is_number(text: str) -> bool:
    """Whether a cell begins as a number does."""
    return bool(re.match(_NUMBER, text))


def unit_of(text: str) -> str | None:
    """The unit of a cell that is a number with a unit, or several: ``±170°``, ``-170° to 170°``, ``340° (370°)``."""
    if text[-1:].isdigit() and " " not in text:  # a number, in most such columns
        return None
    if match := re.fullmatch(_WITH_UNIT, text):
        return match[1] if is_unit(match[1]) else _unit_of_several(text)
    return _unit_of_several(text) if re.match(_SEVERAL, text) else None


def _unit_of_several(text: str) -> str | None:
    """The unit of a cell of several numbers and nothing else but signs, words for a range, and a remark in brackets."""
    words = [word for word in re.findall(_WORD, re.sub(_REMARK, "", text).casefold()) if word not in _OF_RANGES]
    return words[0] if words and all(map(is_unit, words)) else None


def how_to_leave_out(header: str, what: str = "column") -> str:
    """What to do about a column or key that is to be left out."""
    begin = "begin its header" if what == "column" else f"begin the {what}"
    return f"if it is to be left out, {begin} with {IGNORED}: {shown(IGNORED + header)}"


def meant_key(key: str, header: Header, suspect: str | None, keys: Iterable[str]) -> str:
    """What an unknown key of a joint probably means."""
    if header.field and header.unit:
        return f"write the key {header.field.name}, and the unit in the value or in `units`"
    meant = misspelt(header.key)
    if near := meant.name if meant else suspect:
        return f"did you mean {near!r}?"
    near = did_you_mean(key, keys) if len(key) > len("id") else None  # which is no d
    return near or how_to_leave_out(key, "key")


def left_out(headers: Sequence[tuple[int, str]], mark: Mark) -> Problem:
    """The notice of all columns of a table that are left out.

    Args:
        headers: number and header of each, counted from 0.
        mark: the place of the first.
    """
    names = [shown(text) if text else f"{number + 1} (without a header)" for number, text in headers]
    several = len(names) > 1
    return Problem(
        message=f"the column{'s' if several else ''} {', '.join(names)} {'are' if several else 'is'} left out: "
        f"{'no fields are' if several else 'no field is'} called so",
        severity="notice",
        mark=mark,
        found=headers[0][1],
        suggestion="; ".join(dict.fromkeys(filter(None, (LIKELY.get(read_header(text).key) for _, text in headers))))
        or None,
    )


def ignored(headers: Iterable[str], mark: Mark, what: str = "column") -> Problem:
    """The notice of columns or keys that their author wants to be left out."""
    names = [shown(text) for text in headers]
    several = len(names) > 1
    return Problem(
        message=f"the {what}{'s' if several else ''} {', '.join(names)} {'are' if several else 'is'} left out, as the "
        f"{IGNORED} at the beginning asks for",
        severity="notice",
        mark=mark,
    )


def _headers(name: str) -> str:
    words = FIELDS[name].headers
    more = f", {', '.join(words[1:_FEW_WORDS])}" if len(words) > 1 else ""
    return f"a column {name}, if that is meant (other headers of it:{more[1:]})" if more else f"a column {name}"


def _measured_in(unit: str) -> str:
    """The fields that a unit may measure."""
    names = [each.name for each in FIELDS.values() if any(_measures(unit, d) for d in (each.dimension, each.linear))]
    return f"one of the columns {', '.join(names)}" if names else f"one of the columns {', '.join(FIELDS)}"


def _measures(unit: str, dimension: Dimension | None) -> bool:
    try:
        return dimension is not None and find_unit(unit, dimension) is not None
    except QuantityError:
        return False
