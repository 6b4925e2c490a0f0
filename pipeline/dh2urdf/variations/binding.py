"""Puts a variation of a run file and its table together: whose joints it names, whose values it scales."""

from __future__ import annotations

from math import prod
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import DHRow, JointType, Manipulator
from dh2urdf.row_fields import LIMITS
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.variations.laws import Choices, Grid, Normal, Scale, is_relative
from dh2urdf.variations.sampling import MOST_POINTS, SOBOL_DIMENSIONS, Sampling
from dh2urdf.variations.variation import ALL, AXES, FIELDS, TYPE, Factor, Rule, Variation, VariationCall

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

LEAST_PROBABILITY = 1e-6
"""What the bounds of a normal distribution must leave of it: it would hardly be one, and has lost its digits."""


def bind(call: VariationCall, nominal: Manipulator) -> Variation:
    """The variation of a table.

    Args:
        call: the variation as the run file asks for it.
        nominal: the table.

    Raises:
        ConfigError: the table has no such joint or value, or the count is not possible; all are reported at once.
    """
    return _Binder(call, nominal).variation()


class _Binder:
    """Finds the factors of a variation, and gathers what is wrong with them."""

    def __init__(self, call: VariationCall, nominal: Manipulator) -> None:
        self.call = call
        self.rows = nominal.rows
        self.nominal = nominal
        self.problems: list[Problem] = []

    def variation(self) -> Variation:
        """The variation; `bind` says what it raises."""
        self.types = self._types()
        factors: dict[str, Factor] = {}
        for rule in self.call.vary:
            for factor in self._factors(rule):
                if factor.key in factors:
                    at = factors[factor.key].mark
                    self._add_problem(rule, f"{factor.key} is varied twice", suggestion=f"it is varied first at {at}")
                factors.setdefault(factor.key, factor)
        count = 0 if self.problems else self._count(tuple(factors.values()))
        if self.problems:
            raise ConfigError(self.problems)
        return Variation(
            name=self.call.name,
            nominal=self.nominal,
            factors=tuple(factors.values()),
            count=count,
            seed=self.call.seed,
            sampling=self.call.sampling,
            mark=self.call.mark,
        )

    def _add_problem(self, rule: Rule, message: str, *, mark: Mark | None = None, **about: Any) -> None:  # noqa: ANN401 - of a problem
        self.problems.append(Problem(message=message, mark=mark or rule.mark, field=rule.field, **about))

    # --- Joints

    def _types(self) -> list[tuple[JointType, ...]]:
        """The types that the joint of each row may get."""
        types: list[tuple[JointType, ...]] = [(row.type,) for row in self.rows]
        for rule in self.call.vary:
            if rule.field == TYPE and isinstance(rule.law, Choices | Grid):
                for index in self._indices(rule, quiet=True):
                    types[index] = tuple(JointType(str(word)) for word in rule.law.values)
        return types

    def _indices(self, rule: Rule, *, quiet: bool = False) -> list[int]:
        """The rows of the joints that a rule names, as it names them."""
        names = [row.joint for row in self.rows]
        # In quotes, or from a program, `all` is a joint's name where a joint has it.
        if rule.joints is None or (rule.joints == (ALL,) and ALL not in names):
            return [index for index in range(len(self.rows)) if self._has(index, rule.field)]
        indices = []
        for joint, mark in zip(rule.joints, rule.joint_marks or (rule.mark,) * len(rule.joints), strict=True):
            if isinstance(joint, int) and joint <= len(names):
                indices.append(joint - 1)
            elif joint in names:
                indices.append(names.index(str(joint)))
            elif not quiet:
                self._add_problem(
                    rule,
                    f"the table of {shown(self.nominal.name)} has no joint {shown(str(joint))}",
                    mark=mark,
                    found=str(joint),
                    accepted=f"all, a number from 1 to {len(names)}, or a name: {', '.join(names[:20])}",
                    suggestion=did_you_mean(str(joint), names) if isinstance(joint, str) else None,
                )
        return indices

    def _has(self, index: int, name: str) -> bool:
        """Whether the joint of a row has a field, of whichever type it may be."""
        return name == TYPE or not FIELDS[name].types.isdisjoint(self.types[index])

    # --- Factors

    def _factors(self, rule: Rule) -> Iterator[Factor]:
        if rule.field == AXES:
            have = len(self.nominal.moving_rows)
            for value in rule.law.values if isinstance(rule.law, Choices | Grid) else ():
                if float(value) > have:
                    message = f"the table of {shown(self.nominal.name)} has {have} axes, and {value} are asked for"
                    accepted = f"1 to {have}: rows are left out, not added"
                    self._add_problem(rule, message, found=str(value), accepted=accepted)
            yield Factor(key=AXES, field=AXES, row=None, law=rule.law, mark=rule.mark)
            return
        nominals: list[tuple[int, float | None]] = []
        for index in self._indices(rule):
            row = self.rows[index]
            value = getattr(row.limits if rule.field in LIMITS else row, rule.field)
            nominals.append((index, float(value) if isinstance(value, int | float) else None))
        if rule.joints is None and not nominals:
            self._add_problem(rule, f"no joint of {shown(self.nominal.name)} has {rule.field}")
        is_named = rule.joints not in (None, (ALL,))  # a rule for all joints may be for many arms
        if isinstance(rule.law, Scale) and is_named and nominals and all(nominal == 0 for _, nominal in nominals):
            self._add_problem(
                rule,
                f"{rule.field} in the table is 0, and so is every multiple of it: nothing varies",
                joint=self.rows[nominals[0][0]].joint if len(nominals) == 1 else None,
                found="0",
                accepted=f"joints with another {rule.field}, or values of their own such as offset: [LOW, HIGH]",
                suggestion="joints count from 1, fixed ones too",
            )
            return
        for index, nominal in nominals:
            before = len(self.problems)
            self._check(rule, index, self.rows[index], nominal)
            if len(self.problems) == before:
                key = f"{rule.field}_{index + 1}"
                yield Factor(key=key, field=rule.field, row=index, law=rule.law, nominal=nominal, mark=rule.mark)

    def _check(self, rule: Rule, index: int, row: DHRow, nominal: float | None) -> None:
        """What a joint cannot have, and values that do not fit it."""
        what, types = FIELDS[rule.field], self.types[index]
        if not self._has(index, rule.field):
            message = f"a {types[0]} joint has no {rule.field}"
            self._add_problem(
                rule, message, joint=row.joint, accepted=f"joints of the types {', '.join(sorted(what.types))}"
            )
            return
        fitting = [kind for kind in types if kind in what.types]
        for kind in fitting:
            for unit in rule.units:
                if unit is not what.of(kind):
                    message = f"{rule.field} of a {kind} joint is {what.of(kind)}, and the values here are {unit}"
                    self._add_problem(rule, message, joint=row.joint, suggestion="name the joints that are meant")
                    return
        if not is_relative(rule.law):
            return
        nominal_kind = {JointType.CONTINUOUS: JointType.REVOLUTE}.get(row.type, row.type)
        kinds = {{JointType.CONTINUOUS: JointType.REVOLUTE}.get(kind, kind) for kind in fitting}
        if (what.linear or rule.field in LIMITS) and kinds != {nominal_kind}:
            self._add_problem(
                rule,
                f"the type of the joint is drawn too, and {rule.field} of the table holds for a {row.type} joint only",
                joint=row.joint,
                accepted="values of their own in place of such that start from the nominal one",
            )
        elif nominal is None:
            self._add_problem(
                rule,
                f"the table gives no {rule.field}, and the values here start from it",
                joint=row.joint,
                accepted=f"{rule.field} in the table, or values of their own such as uniform: [LOW, HIGH]",
            )
        elif isinstance(rule.law, Normal) and rule.law.probability(nominal) < LEAST_PROBABILITY:
            self._add_problem(
                rule,
                f"the bounds leave hardly anything of a normal distribution about the nominal {nominal:.12g}",
                joint=row.joint,
                accepted="bounds about the mean, or a mean of its own",
            )

    # --- How many

    def _count(self, factors: Sequence[Factor]) -> int:
        grids = [factor.law.values for factor in factors if isinstance(factor.law, Grid)]
        points = prod(len(values) for values in grids)
        drawn = len(factors) - len(grids)
        count = points if self.call.count is None else self.call.count
        if self.call.sampling is Sampling.SOBOL and drawn > SOBOL_DIMENSIONS:
            self._of_call(f"{drawn} values are drawn, and Sobol sequences have {SOBOL_DIMENSIONS} dimensions")
        elif count > MOST_POINTS:
            self._of_call(f"the grids have {points} points", f"at most {MOST_POINTS}, or a `count` of them")
        elif count > points and not drawn:
            message = f"the grids have {points} points, and a count of {count} would repeat them"
            self._of_call(message, f"at most {points}, or no count")
        return count

    def _of_call(self, message: str, accepted: str | None = None) -> None:
        mark = self.call.count_mark or self.call.mark
        self.problems.append(Problem(message=message, mark=mark, field="count", accepted=accepted))
