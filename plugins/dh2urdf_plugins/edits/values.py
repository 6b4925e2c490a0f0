"""The edit ``values``: other numbers in the cells of a table.

A cell gets a value, is multiplied by a factor (``*1.4``) or has something added (``+20 mm``, ``+-5 deg``): the first
character decides. A mere minus is the sign of a value, as in a table.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, TypeAlias

from dh2urdf.errors import ConfigError, EditError
from dh2urdf.plugin_system import WrittenNumber
from dh2urdf.rotations import agreed
from dh2urdf.source import Messages, did_you_mean
from dh2urdf.stages import Edit, EditsInColumns
from dh2urdf_plugins.options import mapping

if TYPE_CHECKING:
    from dh2urdf.columns import RowField
    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.rotations import Number

say = Messages(__file__)

Cell: TypeAlias = Annotated[str, WrittenNumber("a value such as 250 mm, a factor such as '*1.4', or +20 mm to add it")]


@dataclass(frozen=True, slots=True, kw_only=True)
class ValuesOptions:
    """What the cells of a table become."""

    joints: dict[str, dict[str, Cell]] = mapping(
        "cells of the row of this joint, such as {a: 250 mm, alpha: +-5 deg, upper: '*1.4'}; any number of joints",
        others="JOINT",
    )

    def __post_init__(self) -> None:
        cells, problems = _cells(), []
        for joint, name in ((joint, name) for joint, own in self.joints.items() for name in own):
            if name not in cells:
                about: dict[str, Any] = {"cells": tuple(cells), "suggestion": did_you_mean(name, cells)}
                problems.append(say("cell-unknown", field=f"{joint}.{name}", found=name, **about))
        if problems:
            raise ConfigError(problems)


def _cells() -> dict[str, RowField]:
    """The cells that are one number each, by their names."""
    from dh2urdf.columns import COM, INERTIA, ROW_FIELDS

    return {name: field for name, field in ROW_FIELDS.items() if name not in {*COM, *INERTIA}}


def edit_table(manipulator: Manipulator, options: ValuesOptions) -> Manipulator:
    """The manipulator with other numbers in its rows. A row's inertia goes with its mass."""
    from dh2urdf.fields import replace_unchecked

    names = [row.joint for row in manipulator.rows]
    problems = []
    for name in options.joints:
        if name not in names:
            near = did_you_mean(name, names)
            problems.append(say("edit-row-unknown", field="edits", found=name, names=names, suggestion=near))
    rows = []
    for row in manipulator.rows:
        values = {}
        for cell, text in options.joints.get(row.joint, {}).items():
            try:
                values[cell] = _number(row, cell, text)
            except EditError as error:
                problems += error.problems
        new = _changed(row, values)
        lower, upper = new.limits.lower, new.limits.upper
        if lower is not None and upper is not None and not agreed(lower <= upper):
            problems.append(say("cells-cross", joint=row.joint, field="lower", lower=lower, upper=upper))
        rows.append(new)
    if problems:
        raise EditError(problem.about(robot=manipulator.name, mark=manipulator.mark) for problem in problems)
    notices = manipulator.notices
    if not any(options.joints.values()):
        notices = (*notices, say("edit-changes-nothing", field="edits", edit="values", what="cell"))
    return replace_unchecked(manipulator, rows=tuple(rows), notices=notices)


def _changed(row: DHRow, values: dict[str, Number]) -> DHRow:
    """A row with other numbers in some of its cells."""
    from dh2urdf.columns import LIMITS
    from dh2urdf.fields import replace_unchecked
    from dh2urdf_plugins.edits.masses import weighing

    limits = {name: values.pop(name) for name in LIMITS if name in values}
    if "mass" in values:
        row = weighing(row, values.pop("mass"))
    return replace_unchecked(row, **values, limits=replace_unchecked(row.limits, **limits))


def _number(row: DHRow, cell: str, text: str) -> Number:
    """The new number of a cell [SI].

    Raises:
        EditError: the joint has no such cell or nothing in it that could be changed, or the text is no number for it.
    """
    from dh2urdf.columns import LIMITS
    from dh2urdf.documents import MOST_TURNS, Node, measured
    from dh2urdf.quantities import Dimension, QuantityError

    about: dict[str, Any] = {"joint": row.joint, "field": cell, "found": text}
    field = _cells()[cell]
    if row.type not in field.types:
        raise EditError(say("cell-not-of-type", **about, cell=cell, type=row.type, types=sorted(field.types)))
    old = getattr(row.limits if cell in LIMITS else row, cell)
    how, word = (text.strip()[:1], text.strip()[1:]) if text.strip()[:1] in {"*", "+"} else ("", text)
    if how and old is None:
        raise EditError(say("cell-empty", **about, cell=cell, example=word.strip()))
    dimension = Dimension.NUMBER if how == "*" else field.of(row.type) or Dimension.NUMBER
    try:
        number = measured(Node(word, "", 0, 0, word), dimension, MOST_TURNS if cell in {"lower", "upper"} else 1)
    except QuantityError as error:
        wrong: dict[str, Any] = {"reason": error.message, "accepted": error.accepted, "suggestion": error.suggestion}
        raise EditError(say("cell-refused", **about, **wrong)) from None
    new = old * number if how == "*" else old + number if how == "+" else number
    if not (agreed(abs(new) < math.inf) and agreed(field.takes(new))):
        raise EditError(
            say("cell-out-of-bounds", **about, cell=cell, new=new, bound=field.bound or "that a double can hold")
        )
    return new


EDIT = Edit(
    name="values",
    summary="other numbers in cells of the table: a value, a factor, or what is added",
    options=ValuesOptions,
    edit_table=edit_table,
    capabilities=(EditsInColumns(),),
)
