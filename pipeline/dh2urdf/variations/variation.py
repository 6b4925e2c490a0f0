"""Variations: from one manipulator many, each drawn by its number alone.

A variation is a table and its factors, as the design of experiments calls what is varied: one field of one joint, and
the law of its values. Variant `number` depends on the seed, the count and its number only, so any of them can be made
anywhere, in any order, and none has to be kept.
"""

from __future__ import annotations

from dataclasses import dataclass, field as attribute, replace
from math import isfinite
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar

from dh2urdf.columns import (
    COM,
    DYNAMICS,
    INERTIA,
    LIMITS,
    ROW_FIELDS,
    ManipulatorColumns,
    RowField,
    in_columns,
    row_places,
)
from dh2urdf.errors import ManipulatorError, RecordError
from dh2urdf.fields import replace_unchecked
from dh2urdf.kinematics.mass import scaled
from dh2urdf.manipulator import DHRow, JointType, Limits, Manipulator
from dh2urdf.quantities.units import Dimension
from dh2urdf.rotations import is_column
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf.variations.drawn_links import LENGTHS, torn_links
from dh2urdf.variations.laws import DrawnValue, Grid, Law, draw_many, ends
from dh2urdf.variations.sampling import Sampling, points, regrouped

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

say = Messages(__file__)

TYPE = "type"
AXES = "axes"
ALL = "all"
GEOMETRY = ("a", "d", "alpha", "theta")


FIELDS = {
    **{name: field for name, field in ROW_FIELDS.items() if name not in {*COM, *INERTIA}},
    TYPE: RowField(None),
    AXES: RowField(None),
}
"""What can be varied, by the names that the project has for it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """What a run file wants varied."""

    field: str
    law: Law  # how its values are drawn
    # of which joints, by their numbers from 1 or by their names; None for all that have the field
    joints: tuple[int | str, ...] | None = None
    units: tuple[Dimension, ...] = ()  # what the units measure that its values name
    mark: Mark | None = attribute(default=None, compare=False)
    joint_marks: tuple[Mark, ...] = attribute(default=(), compare=False)  # where each joint is named


@dataclass(frozen=True, slots=True, kw_only=True)
class VariationCall:
    """A variation as a run file asks for it."""

    name: str  # what the names of its variants begin with
    of: str  # name of the manipulator of the run that is varied
    vary: tuple[Rule, ...]
    count: int | None = None  # how many variants; None for as many as its grids have points
    seed: int = 0  # which of all samples
    sampling: Sampling = Sampling.RANDOM  # how the sample spreads
    mark: Mark | None = attribute(default=None, compare=False)
    of_mark: Mark | None = attribute(default=None, compare=False)  # where its manipulator is named
    count_mark: Mark | None = attribute(default=None, compare=False)  # where its count stands


@dataclass(frozen=True, slots=True, kw_only=True)
class Factor:
    """One field of one joint that varies."""

    key: str  # what reports call it, such as ``a_2``
    field: str
    row: int | None  # index of the joint's row; None where the field is the whole arm's
    law: Law  # how its values are drawn
    nominal: float | None = None  # the value of the table; None where it has none, or none that is a number
    mark: Mark | None = attribute(default=None, compare=False)  # the place in the run file


@dataclass(frozen=True, slots=True, kw_only=True)
class Variation:
    """A table and what varies in it: all that a worker needs to make any of its variants."""

    name: str  # what the names of its variants begin with
    nominal: Manipulator
    factors: tuple[Factor, ...]  # what varies, in the order of the run file and then of the rows
    count: int
    seed: int = 0  # which of all samples
    sampling: Sampling = Sampling.RANDOM  # how the sample spreads
    mark: Mark | None = attribute(default=None, compare=False)

    @property
    def has_many_forms(self) -> bool:
        """Whether its tables differ in more than their numbers."""
        return any(factor.field in (TYPE, AXES) for factor in self.factors)

    def variants(self) -> Variants[Variation]:
        """All its variants."""
        return Variants(variation=self, numbers=range(1, self.count + 1))

    def names(self, numbers: Iterable[int]) -> list[str]:
        """The names of some of its variants: its own and their numbers, with as many digits as the last one's."""
        return [f"{self.name}_{numbered(number, self.count)}" for number in numbers]

    def drawn(self, numbers: Sequence[int]) -> list[dict[str, DrawnValue]]:
        """What is drawn for some of its variants, by their numbers: the values of factors by their keys [SI].

        Grids go by the number, the last one fastest; the others by the sample. Of axes that a variant lacks, and of
        limits that its joints lack, there are none.
        """
        drawn = drawn_values(self.factors, numbers, count=self.count, seed=self.seed, sampling=self.sampling)
        return [self._possible(values) for values in drawn] if self.has_many_forms else drawn

    def _possible(self, values: dict[str, DrawnValue]) -> dict[str, DrawnValue]:
        """The values of axes that a variant has, and of fields that the drawn types of its joints have."""
        axes, rows = values.get(AXES), self.nominal.rows
        last = len(first_axes(rows, int(axes)) if axes else rows)
        found: dict[str, DrawnValue] = {}
        for factor in self.factors:
            if factor.row is not None:
                kind = JointType(str(values.get(f"{TYPE}_{factor.row + 1}", rows[factor.row].type)))
                if factor.row >= last or kind not in FIELDS[factor.field].types:
                    continue
            found[factor.key] = values[factor.key]
        return found

    def notices(self) -> Iterator[Problem]:
        """A notice where links do not follow the lengths that are drawn, by the farthest of these."""
        rows = list(self.nominal.rows)
        for factor in self.factors:
            if factor.row is not None and factor.field in LENGTHS and factor.nominal is not None:
                nominal = factor.nominal
                farthest = max(ends(factor.law, nominal), key=lambda value: abs(value - nominal))
                rows[factor.row] = changed(rows[factor.row], {factor.field: farthest})
        after = replace_unchecked(self.nominal, rows=tuple(rows))
        yield from torn_links(self.nominal, after, f"the variation {shown(self.name)} changes", self.mark)

    def made(self, number: int, drawn: Mapping[str, DrawnValue]) -> Manipulator:
        """The table of one variant, counted from 1, for which this was drawn.

        Raises:
            ManipulatorError: no arm has these values.
        """
        nominal, (name,) = self.nominal, self.names((number,))
        rows = list(first_axes(nominal.rows, int(drawn[AXES])) if AXES in drawn else nominal.rows)
        problems: list[Problem] = []
        changes = self.changes(drawn)
        try:
            for index, factors in changes.items():
                rows[index] = changed(rows[index], {field: drawn[factor.key] for field, factor in factors.items()})
                problems += _row_problems(rows[index], factors)
            notices = (*nominal.notices, *drawn_notices(changes, rows))
            made = replace(nominal, name=name, rows=tuple(rows), notices=notices)
        except RecordError as error:  # a follower that is fixed now, or whose leader is
            problems += error.problems
        if problems:
            raise ManipulatorError([problem.about(robot=name) for problem in problems])
        return made

    def changes(self, drawn: Collection[str]) -> dict[int, dict[str, Factor]]:
        """The factors of some keys by the indices of their rows, and by their fields."""
        changes: dict[int, dict[str, Factor]] = {}
        for factor in self.factors:
            if factor.row is not None and factor.key in drawn:
                changes.setdefault(factor.row, {})[factor.field] = factor
        return changes


def drawn_values(
    factors: Sequence[Factor], numbers: Sequence[int], *, count: int, seed: int | str, sampling: Sampling
) -> list[dict[str, DrawnValue]]:
    """What is drawn for some of `count` variants, by their numbers: the values of factors by their keys [SI].

    Grids go by the number, the last one fastest; the others by the sample.
    """
    if not numbers:
        return []
    columns: dict[str, Sequence[DrawnValue]] = {}
    rest, combinations = [number - 1 for number in numbers], 1
    for factor in reversed(factors):
        if isinstance(factor.law, Grid):
            values, size = factor.law.values, len(factor.law.values)
            columns[factor.key] = [values[number % size] for number in rest]
            rest, combinations = [number // size for number in rest], combinations * size
    indices = [number - 1 for number in numbers]
    if sampling is Sampling.SOBOL:
        indices = [regrouped(index, combinations, count, seed) for index in indices]
    sampled = [(factor, law) for factor in factors if not isinstance(law := factor.law, Grid)]
    if sampled:
        about: Any = {"seed": seed, "count": count, "indices": indices, "dimensions": len(sampled)}
        for (factor, law), u in zip(sampled, points(sampling, **about), strict=True):
            columns[factor.key] = draw_many(law, u, factor.nominal)
    keys = [factor.key for factor in factors]
    rows = zip(*(columns[key] for key in keys), strict=True) if keys else ((),) * len(numbers)
    return [dict(zip(keys, row, strict=True)) for row in rows]


def numbered(number: int, count: int) -> str:
    """The number of one of `count` variants, with as many digits as the last one has."""
    return f"{number:0{len(str(count))}d}"


T_co = TypeVar("T_co", covariant=True)


class DrawnByNumber(Protocol[T_co]):
    """What has variants, each of which is drawn by its number alone."""

    @property
    def mark(self) -> Mark | None:
        """Its place in the run file."""

    def names(self, numbers: Iterable[int]) -> list[str]:
        """The names of some of its variants."""

    def notices(self) -> Iterator[Problem]:
        """What a careful person would want to know of all its variants."""

    def drawn(self, numbers: Sequence[int]) -> list[dict[str, DrawnValue]]:
        """What is drawn for some of its variants [SI]."""

    def made(self, number: int, drawn: Mapping[str, DrawnValue]) -> T_co:
        """One variant, for which this was drawn."""


V = TypeVar("V", bound=DrawnByNumber[Any])


@dataclass(frozen=True, slots=True, kw_only=True)
class Variants(Generic[V]):
    """Variants that follow each other, none of which is made yet."""

    variation: V  # what they are variants of
    numbers: range  # which ones, from 1

    def __len__(self) -> int:
        return len(self.numbers)

    @property
    def names(self) -> list[str]:
        """The name of each."""
        return self.variation.names(self.numbers)

    def part(self, start: int, stop: int) -> Variants[V]:
        """Those from one place to before another one."""
        return Variants(variation=self.variation, numbers=self.numbers[start:stop])

    def tables(self) -> Iterator[Any]:
        """The table of each, or its cell, made when it is asked for.

        Raises:
            ManipulatorError: no arm has the values that are drawn.
        """
        for number in self.numbers:
            yield self.variation.made(number, self.variation.drawn((number,))[0])


# --- Many at once, as columns -----------------------------------------------------------------------------------------


def made_variants(
    variants: Variants[Variation], drawn: Sequence[dict[str, DrawnValue]]
) -> tuple[list[tuple[list[int], ManipulatorColumns]], dict[int, ManipulatorError]]:
    """The tables of variants, for which this was drawn.

    Returns:
        Those that differ in numbers only, each group with the places of its members; and by the place of a variant why
        there is no table: no arm has these values.
    """
    found = variant_columns(variants.variation, variants.names, drawn) if drawn else None
    groups, errors = [found] if found and found[0] else [], {}
    places, tables = [], []
    for place in sorted(set(range(len(drawn))).difference(found[0] if found else ())):
        try:
            tables.append(variants.variation.made(variants.numbers[place], drawn[place]))
            places.append(place)
        except ManipulatorError as error:
            errors[place] = error
    groups += [([places[member] for member in members], columns) for members, columns in in_columns(tables)]
    return groups, errors


def variant_columns(
    variation: Variation, names: Sequence[str], drawn: Sequence[dict[str, DrawnValue]]
) -> tuple[list[int], ManipulatorColumns] | None:
    """The tables of variants that are arms beyond doubt, and the places of these variants.

    None where types or numbers of axes are drawn, so that the tables differ in more than their numbers.
    """
    import numpy as np

    if variation.has_many_forms:
        return None
    nominal, rows, sure = variation.nominal, list(variation.nominal.rows), np.ones(len(drawn), dtype=bool)
    changes = variation.changes(drawn[0])
    for index, factors in changes.items():
        values = {name: np.array([own[factor.key] for own in drawn], dtype=float) for name, factor in factors.items()}
        row = rows[index] = changed(rows[index], values)
        # `_row_problems` reports what is wrong with a value that no arm has.
        for name, numbers in values.items():
            sure &= np.isfinite(numbers) & FIELDS[name].takes(numbers)
        lower, upper = row.limits.lower, row.limits.upper
        if {"lower", "upper"} & values.keys() and lower is not None and upper is not None:
            sure &= np.less_equal(lower, upper)
    notices = (*nominal.notices, *drawn_notices(changes, rows))
    columns = ManipulatorColumns(
        table=replace_unchecked(nominal, name="", rows=tuple(rows), mark=None, notices=notices),
        names=tuple(names),
        marks=(nominal.mark,) * len(drawn),
        lines=(row_places(nominal),) * len(drawn),
    )
    places: list[int] = np.flatnonzero(sure).tolist()
    return places, columns.take(places)


# --- Rows -------------------------------------------------------------------------------------------------------------


def first_axes(rows: Sequence[DHRow], axes: int) -> Sequence[DHRow]:
    """The rows before the next axis: fixed rows behind the last one stay with it, and so do followers."""
    moving = [index for index, row in enumerate(rows) if row.type is not JointType.FIXED and not row.follows]
    return rows[: moving[axes]] if axes < len(moving) else rows


def drawn_notices(changes: Mapping[int, Collection[str]], rows: Sequence[DHRow]) -> Iterator[Problem]:
    """What was drawn is meant: nobody need ask whether an angle should have been a quarter turn, or a length other."""
    if any(name in LENGTHS for names in changes.values() for name in names):
        yield say("lengths-drawn")
    for index, names in changes.items():
        for name in names:
            if FIELDS[name].dimension is Dimension.ANGLE:
                yield say("angle-drawn", joint=rows[index].joint, field=name)


def changed(row: DHRow, values: Mapping[str, Any]) -> DHRow:
    """A row with other values, each a number or, but for types, a column of numbers."""
    if TYPE in values:
        geometry: dict[str, Any] = {name: _number(values[name]) for name in GEOMETRY if name in values}
        row = retyped(replace_unchecked(row, **geometry), JointType(str(values[TYPE])))
        values = {name: value for name, value in values.items() if name != TYPE and name not in geometry}
    limits = {name: _number(values[name]) for name in LIMITS if name in values}
    changes: dict[str, Any] = {name: _number(value) for name, value in values.items() if name not in limits}
    inertia = row.inertia
    if "mass" in changes and row.mass and inertia:
        inertia = scaled(inertia, changes["mass"] / row.mass)
    return replace_unchecked(
        row, **changes, limits=replace(row.limits, **limits) if limits else row.limits, inertia=inertia
    )


def _number(value: Any) -> Any:  # noqa: ANN401 - a number, or a column of numbers
    return value if is_column(value) else float(value)


def retyped(row: DHRow, kind: JointType) -> DHRow:
    """A row whose joint moves in another way; where all joint values are 0, the arm stands as it did.

    Where rad become m or the other way round, or nothing moves any more, the offset goes into theta or d, and limits,
    damping, friction and armature of the other kind of motion are dropped.
    """
    if kind is row.type:
        return row
    if {kind, row.type} <= {JointType.REVOLUTE, JointType.CONTINUOUS}:
        return replace(row, type=kind, limits=replace(row.limits, lower=None, upper=None))
    dropped: dict[str, Any] = dict.fromkeys(DYNAMICS)
    turn, slide = (0.0, row.offset) if row.type is JointType.PRISMATIC else (row.offset, 0.0)
    return replace(
        row,
        type=kind,
        theta=row.theta + turn,
        d=row.d + slide,
        offset=0.0,
        sign=1 if kind is JointType.FIXED else row.sign,
        limits=Limits(),
        **dropped,
    )


def _row_problems(row: DHRow, factors: Mapping[str, Factor]) -> Iterator[Problem]:
    """What is impossible about the drawn values of a row."""

    def drawn(code: str, name: str, value: float, **about: Any) -> Problem:  # noqa: ANN401 - of a message
        return say(code, factors[name].mark, joint=row.joint, field=name, found=f"{value:.12g}", **about)

    for name in factors:
        value, field = getattr(row.limits if name in LIMITS else row, name), FIELDS[name]
        if isinstance(value, float) and (not isfinite(value) or not field.takes(value)):
            accepted = f"a number {field.bound}" if field.bound else "a finite number"
            yield drawn("drawn-impossible", name, value, accepted=accepted)
    bounds = [name for name in ("lower", "upper") if name in factors]
    lower, upper = row.limits.lower, row.limits.upper
    if bounds and lower is not None and upper is not None and lower > upper:
        about = {"lower": lower, "upper": upper, "bounds": " and ".join(bounds)}
        yield drawn("drawn-limits-exchanged", bounds[0], getattr(row.limits, bounds[0]), **about)
