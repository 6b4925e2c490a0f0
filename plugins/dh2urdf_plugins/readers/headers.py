"""The headers of a table, whatever its format: which column is which field, in which unit, and what is wrong there."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from dh2urdf.errors import TableError
from dh2urdf.quantities import Dimension, QuantityError, Unit, find_unit
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.fields import FIELDS, REQUIRED, UNHELD_GEOMETRY, Header, misspelt, read_header

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf_plugins.readers.cells import Units

_FEW = 5
_KHALIL = ("sigma", "σ", "gamma", "γ", "mu", "μ", "b")
_MINUS = ("-", "−", "–")


@dataclass(slots=True)
class Columns:
    """What the header says.

    Attributes:
        mark: the place of the header.
        headers: the header of each column, as it is written.
        delimiter: what stands between cells; None where cells are no text of one line.
        fields: the field of each column, or None.
        units: the units that headers declare, by field.
        unheld: columns of geometry that no field holds, with the reason.
        modified: the column whose header means the modified convention.
        meant: fields that misspelt headers probably mean.
        notices: columns that are left out.
        numbers: the columns whose cells are numbers already, or all text.
    """

    mark: Mark
    headers: list[str]
    delimiter: str | None = None
    fields: list[str | None] = field(default_factory=list)
    units: dict[str, Unit] = field(default_factory=dict)
    unheld: dict[int, str] = field(default_factory=dict)
    modified: int | None = None
    meant: list[str] = field(default_factory=list)
    notices: list[Problem] = field(default_factory=list)
    numbers: frozenset[int] = frozenset()

    @property
    def decimal_comma(self) -> bool:
        """Whether a comma may stand for the decimal point."""
        return self.delimiter not in (None, ",")


def name_columns(headers: Sequence[str], marks: Sequence[Mark], mark: Mark, delimiter: str | None = None) -> Columns:
    """What headers say.

    Args:
        headers: the header of each column.
        marks: the place of each.
        mark: the place of all of them.
        delimiter: what stands between cells.

    Raises:
        TableError: everything that is wrong with them.
    """
    columns = Columns(mark, list(headers), delimiter)
    problems: list[Problem] = []
    first: dict[str, int] = {}
    indexed: int | None = None
    for index, (text, place) in enumerate(zip(headers, marks, strict=True)):
        header = read_header(text)
        columns.fields.append(header.field.name if header.field else None)
        if header.field is None:
            _unknown(columns, header, index, place, problems)
            continue
        name = header.field.name
        _measure(columns, header, text, place, problems)
        key = "sign" if name == "flip" else name
        if key in first:
            problems.append(
                Problem(
                    message=f"two columns are {key}: {shown(columns.headers[first[key]])} and {shown(text)} (a "
                    "duplicate)",
                    mark=place,
                    field=name,
                    found=text,
                    accepted="one column for each field",
                )
            )
        first.setdefault(key, index)
        if header.link == "i-1" and name in ("a", "alpha"):
            columns.modified = index
        elif header.link == "i-1":
            problems.append(
                Problem(
                    message=f"{shown(text)}: neither convention takes {name} of the link before",
                    mark=place,
                    field=name,
                    found=text,
                    accepted="a_{i-1} and alpha_{i-1} (the modified convention), with d_i and theta_i",
                )
            )
        elif header.link == "i" and name in ("a", "alpha"):
            indexed = index
    if columns.modified is not None and indexed is not None:
        one, other = columns.headers[columns.modified], columns.headers[indexed]
        problems.append(
            Problem(
                message=f"{shown(one)} is of the link before and {shown(other)} of the link itself: neither convention "
                "mixes them",
                mark=columns.mark,
                field="convention",
                accepted="a_{i-1} and alpha_{i-1} (modified), or a_i and alpha_i (standard)",
            )
        )
    problems += _foreign_r(columns)
    known = {*columns.fields, *columns.meant}
    problems.extend(_missing(name, columns) for name in REQUIRED if name not in known)
    if problems:
        raise TableError(problems)
    return columns


def _unknown(columns: Columns, header: Header, index: int, mark: Mark, problems: list[Problem]) -> None:
    text = columns.headers[index]
    if header.key in UNHELD_GEOMETRY:
        columns.unheld[index] = UNHELD_GEOMETRY[header.key]
    elif (near := misspelt(header.key)) is not None:
        columns.meant.append(near.name)
        problems.append(
            Problem(
                message=f"no column is called {shown(text)}",
                mark=mark,
                field=header.key,
                found=text,
                accepted=_accepted_headers(),
                suggestion=f"did you mean {near.name!r}?",
            )
        )
    elif text:
        message = f"the column {shown(text)} is left out: no field is called so"
        columns.notices.append(
            Problem(message=message, severity="notice", mark=mark, found=text, accepted=_accepted_headers())
        )


def _measure(columns: Columns, header: Header, text: str, mark: Mark, problems: list[Problem]) -> None:
    """Takes the unit of a column of numbers, and refuses a header with a sign."""
    if not (header.field and header.field.dimension):
        return
    name = header.field.name
    if text.startswith(_MINUS):
        problems.append(_negated(text, name, mark))
    _declare_unit(columns, header, name, mark, problems)


def _declare_unit(columns: Columns, header: Header, name: str, mark: Mark, problems: list[Problem]) -> None:
    if header.unit is None:
        return
    field_ = FIELDS[name]
    dimensions = [dimension for dimension in (field_.dimension, field_.linear) if dimension]
    for dimension in dimensions:
        try:
            columns.units[name] = find_unit(header.unit, dimension)
        except QuantityError as error:
            problem = Problem(
                message=error.message,
                mark=mark,
                field=name,
                found=header.unit,
                accepted=error.accepted,
                suggestion=error.suggestion,
            )
        else:
            return
    if dimensions and dimensions != [Dimension.NUMBER]:
        problems.append(problem)


def _missing(name: str, columns: Columns) -> Problem:
    words = ", ".join(FIELDS[name].headers)
    others = [text for text, field_ in zip(columns.headers, columns.fields, strict=True) if text and field_ is None]
    return Problem(
        message=f"there is no column for {name} in the header",
        mark=columns.mark,
        field=name,
        accepted=f"one of the headers {words}; its unit may follow, as in `{name} "
        f"[{'deg' if name == 'alpha' else 'mm'}]`",
        suggestion=f"no field is called {', '.join(map(shown, others[:_FEW]))}" if others else None,
    )


def _negated(text: str, name: str, mark: Mark) -> Problem:
    return Problem(
        message=f"{shown(text)} may be the negative of {name}",
        mark=mark,
        field=name,
        found=text,
        accepted=f"{name}, and its numbers with their signs",
    )


def _foreign_r(columns: Columns) -> list[Problem]:
    """Refuses `r` beside the other letters of Khalil and Kleinfinger, to whom r is what is d here, and d what is a."""
    keys = [read_header(text).key for text in columns.headers]
    letters = [text for text, key in zip(columns.headers, keys, strict=True) if key in _KHALIL]
    if "a" not in columns.fields or "d" not in columns.fields or not letters:
        return []
    index = columns.fields.index("a")
    header = columns.headers[index]
    if not header.casefold().startswith("r"):
        return []
    return [
        Problem(
            message=f"{shown(header)} beside {shown(letters[0])} may be the r of Khalil and Kleinfinger, which is d "
            "here, while their d is a",
            mark=columns.mark,
            field="a",
            found=header,
            accepted="a for the length along x, d for the length along z",
        )
    ]


def _accepted_headers() -> str:
    return ", ".join(FIELDS)


def unit_problems(columns: Columns, declared: Iterable[tuple[Unit, Mark] | None]) -> list[Problem]:
    """What is wrong with headers' units beside the units declared for the whole table."""
    problems = []
    for said in declared:
        for name, unit in columns.units.items():
            if said and unit.dimension is said[0].dimension and unit != said[0]:
                header = columns.headers[columns.fields.index(name)]
                problems.append(
                    Problem(
                        message=f"the header {shown(header)} declares {unit.symbol}, and {said[1]} declares "
                        f"{said[0].symbol}",
                        mark=columns.mark,
                        field=name,
                        found=header,
                        accepted="one unit for a column",
                    )
                )
    return problems


def undeclared_units(columns: Columns, units: Units) -> list[Problem]:
    """Notices of columns without a unit beside columns that have another one than the SI unit."""
    notices = _followers(columns, units)
    for dimension, names, si in ((Dimension.LENGTH, ("a", "d"), "m"), (Dimension.ANGLE, ("alpha", "theta"), "rad")):
        foreign = {columns.units[name].symbol for name in names if name in columns.units} - {si}
        notices += [
            Problem(
                message=f"{name} has no unit and is read in {si}, while another {dimension.plain} is in {min(foreign)}",
                severity="notice",
                mark=columns.mark,
                field=name,
                suggestion=f"declare it: `{name} [{min(foreign)}]`",
            )
            for name in names
            if not units.of(dimension) and foreign and name in columns.fields and name not in columns.units
        ]
    return notices


_GEOMETRY = {Dimension.LENGTH: ("a", "d"), Dimension.ANGLE: ("alpha", "theta")}
_RATES = {Dimension.LENGTH: Dimension.SPEED, Dimension.ANGLE: Dimension.TURN_RATE}


def headers_unit(columns: Columns, dimension: Dimension) -> Unit | None:
    """The unit that the headers of all columns of geometry declare; None where one has none, they differ, or it is SI.

    Offsets, limits, centres of mass and radii without a unit of their own follow it.
    """
    units = [columns.units.get(name) for name in _GEOMETRY[dimension] if name in columns.fields]
    unit = units[0] if units and all(unit == units[0] for unit in units) else None
    return unit if unit and (unit.power or unit.degrees) else None


def _followers(columns: Columns, units: Units) -> list[Problem]:
    """A notice of the columns that follow the unit of others."""
    followed = {
        dimension: unit
        for dimension in _GEOMETRY
        if not units.of(dimension) and (unit := headers_unit(columns, dimension))
    }
    measured = {name: {FIELDS[name].dimension, FIELDS[name].linear} for name in columns.fields if name}
    names = [
        name
        for name, dimensions in measured.items()
        if name not in columns.units and any({dimension, _RATES[dimension]} & dimensions for dimension in followed)
    ]
    if not names:
        return []
    return [
        Problem(
            message=f"no unit is declared for {', '.join(names)}: the units of the geometry hold, "
            f"{' and '.join(unit.symbol for unit in followed.values())}",
            severity="notice",
            mark=columns.mark,
            field=names[0],
            suggestion="declare the unit in each header",
        )
    ]
