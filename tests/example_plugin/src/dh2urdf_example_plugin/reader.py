"""The reader `dh-toml`: one DH table as TOML, a ``[[joint]]`` for each row."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.documents import decoded, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, DHRow, JointType, Limits, Manipulator
from dh2urdf.quantities import Dimension, QuantityError, accepted_forms, evaluate
from dh2urdf.source import Mark, Problem, did_you_mean
from dh2urdf.stages import Reader

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SUFFIX = ".dh.toml"
TABLE_FIELDS = ("name", "convention", "joint")
FIELDS = ("name", "type", "a", "alpha", "d", "theta", "offset", "lower", "upper")


@dataclass(frozen=True, slots=True, kw_only=True)
class TomlOptions:
    """What a table does not say itself."""

    convention: Literal["standard", "modified"] | None = field(
        default=None, metadata={"help": "the convention of a table that does not say it"}
    )


def read(path: Path, options: TomlOptions) -> Iterator[Manipulator]:
    """The manipulator of a TOML table.

    Raises:
        TableError: the file is not TOML, or something in it cannot be read; all problems are reported at once.
    """
    mark = Mark(file=str(path))
    try:
        table = tomllib.loads(decoded(read_bytes(path, TableError), str(path), TableError))
    except tomllib.TOMLDecodeError as error:
        raise TableError(Problem(message=f"this is not TOML: {error}", mark=mark)) from error
    problems = [
        Problem(message=f"{name!r} is nothing that a table says", accepted=", ".join(TABLE_FIELDS))
        for name in table
        if name not in TABLE_FIELDS
    ]
    convention = str(table.get("convention", options.convention))
    if convention not in tuple(Convention):
        said = f"{convention!r} is no convention" if "convention" in table else "the table does not say its convention"
        problems.append(Problem(message=said, field="convention", accepted=" or ".join(Convention)))
    rows = tuple(_Row(number, entry, problems).dh_row() for number, entry in enumerate(table.get("joint", []), start=1))
    if not rows:
        problems.append(Problem(message="the table has no rows", accepted="a [[joint]] for each row"))
    if problems:
        raise TableError(problem.about(mark=mark) for problem in problems)
    name = str(table.get("name", path.name.removesuffix(SUFFIX)))
    yield Manipulator(name=name, convention=Convention(convention), rows=rows, mark=mark)


class _Row:
    """One ``[[joint]]`` of a table; what is wrong with it is added to the problems."""

    def __init__(self, number: int, entry: dict[str, Any], problems: list[Problem]) -> None:
        self.number, self.entry, self.problems = number, entry, problems
        self.joint = str(entry.get("name", f"joint_{number}"))

    def dh_row(self) -> DHRow:
        """The row in SI units."""
        for name in self.entry:
            if name not in FIELDS:
                self.refuse(name, "no field has this name", ", ".join(FIELDS), did_you_mean(name, FIELDS))
        kind = str(self.entry.get("type", "revolute"))
        if kind not in tuple(JointType):
            self.refuse("type", f"{kind!r} is no joint type", ", ".join(JointType), did_you_mean(kind, JointType))
            kind = "revolute"
        travel = Dimension.LENGTH if kind == JointType.PRISMATIC else Dimension.ANGLE
        return DHRow(
            joint=self.joint,
            link=f"link_{self.number}",
            type=JointType(kind),
            a=self.required("a", Dimension.LENGTH),
            alpha=self.required("alpha", Dimension.ANGLE),
            d=self.required("d", Dimension.LENGTH),
            theta=self.quantity("theta", Dimension.ANGLE) or 0.0,
            offset=self.quantity("offset", travel) or 0.0,
            limits=Limits(lower=self.quantity("lower", travel), upper=self.quantity("upper", travel)),
        )

    def required(self, name: str, dimension: Dimension) -> float:
        if name not in self.entry:
            self.refuse(name, "this field is missing", "a number, 0 included")
        return self.quantity(name, dimension) or 0.0

    def quantity(self, name: str, dimension: Dimension) -> float | None:
        if name not in self.entry:
            return None
        try:
            found = evaluate(str(self.entry[name]), dimension)  # 'pi/2', '90°' and '387 mm' as well as numbers
        except QuantityError as error:
            self.refuse(name, error.message, error.accepted, error.suggestion)
            return None
        if found.variable:
            self.refuse(name, "the joint variable is not written in this format", accepted_forms(dimension))
        return found.value

    def refuse(self, name: str, message: str, accepted: str, suggestion: str | None = None) -> None:
        self.problems.append(
            Problem(
                message=message,
                joint=self.joint,
                field=name,
                found=str(self.entry[name]) if name in self.entry else None,
                accepted=accepted,
                suggestion=suggestion,
            )
        )


READER = Reader(
    name="dh-toml",
    summary="DH tables in TOML, a [[joint]] for each row",
    read=read,
    options=TomlOptions,
    suffixes=(SUFFIX,),
)
