"""Columns and keys that name no field: those with numbers are refused, and those of text are left out."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.quantities import Dimension, QuantityError, evaluate, find_unit, is_unit, is_zero
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf_plugins.readers.header.words import Header, misspelt
from dh2urdf_plugins.readers.words.fields import FIELDS, IGNORED, flip_of, keys_in, unheld

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.quantities import Quantity
    from dh2urdf_plugins.readers.words.cells import Cell

_TOKENS = r"(?P<number>(?:[0-9]+(?:[.,][0-9]+)*|[.,][0-9]+)(?:[eE][-+]?[0-9]+(?![0-9.]))?)|(?P<word>[^\W\d_]+|°)|\S"
_BETWEEN = frozenset("+-−–—±~〜～…/()[],;*·^²³.:%'\"")
"""Signs that stand between numbers, and around them."""
_DATE = r"\s*(?:[0-9]{4}-[0-9]{1,2}-[0-9]{1,2}|[0-9]{1,2}[./][0-9]{1,2}[./][0-9]{4})\b"
_LONGEST_VARIABLE = 40


class Refusal(NamedTuple):
    """Why a column or key that names no field is refused where it holds a value.

    Attributes:
        reason: what it is, as the end of a sentence that begins with its header.
        accepted: what to write in its place.
        any_text: whether texts are refused, too: no field holds what it is.
        counts: whether it may hold the number of the row.
        if_no: whether only a no says anything.
    """

    reason: str
    accepted: str
    any_text: bool = False
    counts: bool = False
    if_no: bool = False


def refusal(text: str, header: Header, what: str = "column") -> Refusal:
    """Why a column is refused where it holds a value.

    Args:
        text: its header.
        header: what that says; it names no field.
        what: whether it is a column or a key.
    """
    if meaning := unheld(header.key):
        accepted = meaning.accepted.replace("column", what) if what == "key" else meaning.accepted
        reason = f"is {meaning.reason}, which no {what} holds"
        return Refusal(reason, accepted, any_text=meaning.any_text, counts=meaning.counts, if_no=meaning.if_no)
    names = [name for name, field in FIELDS.items() if header.unit and _measures(header.unit, name)]
    near = misspelt(header.key) if header.key else None
    likely = f"did you mean {near.name!r}?" if near else did_you_mean(text, FIELDS) if len(text) > len("id") else None
    accepted = f"one of the {what}s {', '.join(names or FIELDS)}" + (f"; {likely}" if likely else "")
    return Refusal("is no field" if text else "has no header", accepted)


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
    text = cell.text.strip()
    is_no = flip_of(text) is False or is_zero(text)
    if not text or is_no != why.if_no or (why.counts and re.match(rf"(?i)j?{number}\b", text)):
        return None
    if not why.any_text and (not is_value(text) or _is_variable_of(text, number)):
        return None
    return Problem(
        message=f"{what} {shown(header)} {why.reason}, and it is {shown(cell.text)}",
        mark=cell.mark,
        joint=joint,
        field=header,
        found=cell.text,
        accepted=why.accepted,
        suggestion=how_to_leave_out(header, what),
    )


def is_value(text: str) -> bool:
    """Whether a cell is a number, several, a quantity, or a joint variable, and no text with a number in it."""
    if re.match(_DATE, text):
        return False
    seen = False
    for match in re.finditer(_TOKENS, text):
        if match.lastgroup == "number":
            seen = True
        elif match.lastgroup == "word":
            word = match[0].casefold()
            if not (seen and is_unit(match[0])) and word not in keys_in("rows", "ranges"):
                return _is_variable(text)
        elif match[0] not in _BETWEEN:
            return _is_variable(text)
    return seen or _is_variable(text)


def _is_variable_of(text: str, number: int | None) -> bool:
    """Whether a cell is the joint variable of its row, and nothing besides: ``q1`` in the first one."""
    said = _expression(text)
    variable = said.variable if said and not said.value and said.sign > 0 else None
    return variable is not None and variable.row == number and variable.kind != "d"


def _is_variable(text: str) -> bool:
    """Whether a cell names a joint variable, or is an expression such as ``pi/2``."""
    if len(text) > _LONGEST_VARIABLE or not any(letter.isdigit() or letter == "π" for letter in text):
        return text.strip().casefold() in ("pi", "-pi", "π", "-π")
    return _expression(text) is not None


def _expression(text: str) -> Quantity | None:
    """The angle or the length that a cell says; None where it says none."""
    for dimension in (Dimension.ANGLE, Dimension.LENGTH):
        with suppress(QuantityError):
            return evaluate(text, dimension, decimal_comma=True)
    return None


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
    return bool(re.match(r"[+\-−]?[.,]?[0-9]", text))


def how_to_leave_out(header: str, what: str = "column") -> str:
    """What to do about a column or key that is to be left out."""
    start = "start its header" if what == "column" else f"start the {what}"
    return f"to ignore this {what}, {start} with `{IGNORED}`: {shown(IGNORED + header)}"


def left_out(headers: Sequence[tuple[int, str]], mark: Mark) -> Problem:
    """The notice of all columns of a table that are left out.

    Args:
        headers: number and header of each, counted from 0.
        mark: the place of the first.
    """
    names = [shown(text) if text else f"{number + 1} (without a header)" for number, text in headers]
    one = len(names) == 1
    return Problem(
        message=f"the column{'' if one else 's'} {', '.join(names)} {'is' if one else 'are'} left out: "
        f"{'no field is' if one else 'no fields are'} called so",
        severity="notice",
        mark=mark,
        found=headers[0][1],
    )


def ignored(headers: Iterable[str], mark: Mark, what: str = "column") -> Problem:
    """The notice of columns or keys that their author wants to be left out."""
    names = [shown(text) for text in headers]
    one = len(names) == 1
    return Problem(
        message=f"the {what}{'' if one else 's'} {', '.join(names)} {'is' if one else 'are'} left out, as the "
        f"{IGNORED} at the beginning asks for",
        severity="notice",
        mark=mark,
    )


def _measures(unit: str, name: str) -> bool:
    for dimension in filter(None, (FIELDS[name].dimension, FIELDS[name].linear)):
        try:
            find_unit(unit, dimension)
        except QuantityError:
            continue
        return True
    return False
