"""Columns that name no field: those with numbers, units or joint variables are refused, and those of text left out."""

from __future__ import annotations

import re
from contextlib import suppress
from typing import TYPE_CHECKING

from dh2urdf.quantities import Dimension, QuantityError, evaluate, find_unit, is_unit, is_zero
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, shown
from dh2urdf_plugins.readers.header.words import Header, misspelt
from dh2urdf_plugins.readers.words.fields import FIELDS, IGNORED, Refusal, flip_of, keys_in, unheld

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.quantities import Quantity
    from dh2urdf_plugins.readers.words.cells import Cell

say = Messages(__file__)

_NUMBER = r"(?:[0-9]+(?:[.,][0-9]+)*|[.,][0-9]+)(?:[eE][-+]?[0-9]+(?![0-9.]))?"
_BETWEEN = frozenset("+-−–—±~〜～…/()[],;*·^²³.:%'\"")
"""Signs that stand between numbers, and around them."""
_DATE = r"\s*(?:[0-9]{4}-[0-9]{1,2}-[0-9]{1,2}|[0-9]{1,2}[./][0-9]{1,2}[./][0-9]{4})\b"
_LONGEST_VARIABLE = 40


def refusal(text: str, header: Header) -> Refusal:
    """Why a column is refused where it holds a value.

    Args:
        text: its header.
        header: what that says; it names no field.
    """
    if meaning := unheld(header.key):
        return meaning._replace(reason=f"is {meaning.reason}, which no column holds")
    names = [name for name in FIELDS if header.unit and _measures(header.unit, name)]
    near = misspelt(header.key) if header.key else None
    likely = f"did you mean {near.name!r}?" if near else did_you_mean(text, FIELDS) if len(text) > len("id") else None
    accepted = f"one of the columns {', '.join(names or FIELDS)}" + (f"; {likely}" if likely else "")
    return Refusal("is no field" if text else "has no header", accepted, any_text=False)


def refused(cell: Cell, header: str, why: Refusal, joint: str | None, *, number: int | None = None) -> Problem | None:
    """What is wrong with a cell of such a column; None where it says nothing.

    Args:
        cell: the cell.
        header: the header of its column.
        why: why that is refused.
        joint: the joint's name, where it is known.
        number: the number of the row.
    """
    text = cell.text.strip()
    is_no = flip_of(text) is False or is_zero(text)
    if not text or is_no != why.if_no or (why.counts and re.match(rf"(?i)j?{number}\b", text)):
        return None
    if not why.any_text and (not is_value(text) or _is_variable_of(text, number)):
        return None
    about = {"reason": why.reason, "accepted": why.accepted, "ignoring": IGNORED + header}
    return say("unknown-column", cell.mark, joint=joint, field=header, found=cell.text, **about)


def is_value(text: str) -> bool:
    """Whether a cell is a number, several, a quantity, or a joint variable, and no text with a number in it."""
    if re.match(_DATE, text):
        return False
    others = re.findall(r"[^\W\d_]+|\S", re.sub(_NUMBER, " ", text)) if re.search("[0-9]", text) else [text]
    if all(word in _BETWEEN or is_unit(word) or word.casefold() in keys_in("rows", "ranges") for word in others):
        return any(map(str.isdigit, text))
    return _expression(text) is not None


def _is_variable_of(text: str, number: int | None) -> bool:
    """Whether a cell is the joint variable of its row, and nothing besides: ``q1`` in the first one."""
    said = _expression(text)
    variable = said.variable if said and not said.value and said.sign > 0 else None
    return variable is not None and variable.row == number and variable.kind != "d"


def _expression(text: str) -> Quantity | None:
    """The angle or the length that a cell says, or the numbered joint variable; None where it says none."""
    if len(text) <= _LONGEST_VARIABLE and re.search(r"[0-9π]|(?i:^\s*-?pi\s*$)", text):
        for dimension in (Dimension.ANGLE, Dimension.LENGTH):
            with suppress(QuantityError):
                return evaluate(text, dimension, decimal_comma=True)
    return None


def stray_number(text: str, mark: Mark, joint: str) -> Problem:
    """A number in a column without a header, which belongs to the table: it may be any field."""
    return say("stray-number", mark, joint=joint, found=text)


def is_number(text: str) -> bool:
    """Whether a cell begins as a number does."""
    return bool(re.match(r"[+\-−]?[.,]?[0-9]", text))


def left_out(headers: Sequence[tuple[int, str]], mark: Mark) -> Problem:
    """The notice of all columns of a table that are left out.

    Args:
        headers: number and header of each, counted from 0.
        mark: the place of the first.
    """
    names = [shown(text) if text else f"{number + 1} (without a header)" for number, text in headers]
    return say("column-left-out" if len(names) == 1 else "columns-left-out", mark, found=headers[0][1], names=names)


def ignored(headers: Iterable[str], mark: Mark) -> Problem:
    """The notice of columns that their author wants to be left out."""
    names = [shown(text) for text in headers]
    return say("column-ignored" if len(names) == 1 else "columns-ignored", mark, names=names)


def _measures(unit: str, name: str) -> bool:
    for dimension in filter(None, (FIELDS[name].dimension, FIELDS[name].linear)):
        with suppress(QuantityError):
            return find_unit(unit, dimension) is not None
    return False
