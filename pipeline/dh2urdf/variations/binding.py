"""Puts a variation of a run file and its table together: whose joints it names, whose values it scales."""

from __future__ import annotations

from math import prod
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import LIMITS
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import DHRow, JointType, Manipulator
from dh2urdf.source import Mark, Messages, Problem, did_you_mean
from dh2urdf.variations.laws import Choices, Grid, Normal, Scale, is_relative
from dh2urdf.variations.sampling import MOST_POINTS, SOBOL_DIMENSIONS, Sampling
from dh2urdf.variations.variation import ALL, AXES, FIELDS, TYPE, Factor, Rule, Variation, VariationCall

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

say = Messages(__file__)

LEAST_PROBABILITY = 1e-6
"""What the bounds of a normal distribution must leave of it: it would hardly be one, and has lost its digits."""


def bind(call: VariationCall, nominal: Manipulator) -> Variation:
    """The variation of a table.

    Raises:
        ConfigError: the table has no such joint or value, or the count is not possible; all are reported at once.
    """
    binder = _Binder(call, nominal)
    factors: dict[str, Factor] = {}
    for rule in call.vary:
        for factor in binder.factors(rule):
            if factor.key in factors:
                binder.add_problem(rule, "varied-twice", key=factor.key, first=factors[factor.key].mark)
            factors.setdefault(factor.key, factor)
    varied = tuple(factors.values())
    count = 0 if binder.problems else binder.count(varied)
    if binder.problems:
        raise ConfigError(binder.problems)
    name, seed, sampling, mark = call.name, call.seed, call.sampling, call.mark
    return Variation(name=name, nominal=nominal, factors=varied, count=count, seed=seed, sampling=sampling, mark=mark)


class _Binder:
    """Finds the factors of a variation, and gathers what is wrong with them."""

    def __init__(self, call: VariationCall, nominal: Manipulator) -> None:
        self.call = call
        self.rows = nominal.rows
        self.nominal = nominal
        self.problems: list[Problem] = []
        # The types that the joint of each row may get.
        self.types: list[tuple[JointType, ...]] = [(row.type,) for row in self.rows]
        for rule in self.call.vary:
            if rule.field == TYPE and isinstance(rule.law, Choices | Grid):
                for index in self._indices(rule, quiet=True):
                    self.types[index] = tuple(JointType(str(word)) for word in rule.law.values)

    def add_problem(self, rule: Rule, code: str, *, mark: Mark | None = None, **about: Any) -> None:  # noqa: ANN401 - of a message
        self.problems.append(say(code, mark or rule.mark, field=rule.field, **about))

    # --- Joints

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
                near = did_you_mean(str(joint), names) if isinstance(joint, str) else None
                about = {"table": self.nominal.name, "count": len(names), "names": names[:20], "suggestion": near}
                self.add_problem(rule, "varied-joint-unknown", mark=mark, found=str(joint), **about)
        return indices

    def _has(self, index: int, name: str) -> bool:
        """Whether the joint of a row has a field, of whichever type it may be."""
        return name == TYPE or not FIELDS[name].types.isdisjoint(self.types[index])

    # --- Factors

    def factors(self, rule: Rule) -> Iterator[Factor]:
        if rule.field == AXES:
            have = len(self.nominal.actuated_rows)
            for value in rule.law.values if isinstance(rule.law, Choices | Grid) else ():
                if float(value) > have:
                    self.add_problem(rule, "axes-too-many", found=str(value), table=self.nominal.name, have=have)
            yield Factor(key=AXES, field=AXES, row=None, law=rule.law, mark=rule.mark)
            return
        nominals: list[tuple[int, float | None]] = []
        for index in self._indices(rule):
            row = self.rows[index]
            value = getattr(row.limits if rule.field in LIMITS else row, rule.field)
            nominals.append((index, float(value) if isinstance(value, int | float) else None))
        if rule.joints is None and not nominals:
            self.add_problem(rule, "no-joint-has-field", table=self.nominal.name)
        is_named = rule.joints not in (None, (ALL,))  # a rule for all joints may be for many arms
        if isinstance(rule.law, Scale) and is_named and nominals and all(nominal == 0 for _, nominal in nominals):
            joint = self.rows[nominals[0][0]].joint if len(nominals) == 1 else None
            self.add_problem(rule, "multiple-of-0", joint=joint, found="0")
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
            self.add_problem(rule, "type-without-field", joint=row.joint, type=types[0], types=sorted(what.types))
            return
        fitting = [kind for kind in types if kind in what.types]
        for kind in fitting:
            for unit in rule.units:
                if unit is not what.of(kind):
                    about: dict[str, Any] = {"type": kind, "measure": what.of(kind), "given": unit}
                    self.add_problem(rule, "other-measure", joint=row.joint, **about)
                    return
        if not is_relative(rule.law):
            return
        nominal_kind = {JointType.CONTINUOUS: JointType.REVOLUTE}.get(row.type, row.type)
        kinds = {{JointType.CONTINUOUS: JointType.REVOLUTE}.get(kind, kind) for kind in fitting}
        if (what.linear or rule.field in LIMITS) and kinds != {nominal_kind}:
            self.add_problem(rule, "start-of-other-type", joint=row.joint, type=row.type)
        elif nominal is None:
            self.add_problem(rule, "start-missing", joint=row.joint)
        elif isinstance(rule.law, Normal) and rule.law.probability(nominal) < LEAST_PROBABILITY:
            self.add_problem(rule, "bounds-off-nominal", joint=row.joint, nominal=nominal)

    # --- How many

    def count(self, factors: Sequence[Factor]) -> int:
        count = self.call.count
        self.problems += count_problems(factors, count, self.call.sampling, self.call.count_mark or self.call.mark)
        return grid_points(factors) if count is None else count


def grid_points(factors: Sequence[Factor]) -> int:
    """How many points the grids of some factors have, each combined with each."""
    return prod(len(factor.law.values) for factor in factors if isinstance(factor.law, Grid))


def count_problems(
    factors: Sequence[Factor], count: int | None, sampling: Sampling, mark: Mark | None
) -> Iterator[Problem]:
    """What is wrong with a count of variants of some factors; None is as many as their grids have points."""
    points, drawn = grid_points(factors), sum(not isinstance(factor.law, Grid) for factor in factors)
    if sampling is Sampling.SOBOL and drawn > SOBOL_DIMENSIONS:
        yield say("sobol-dimensions", mark, field="count", drawn=drawn, most=SOBOL_DIMENSIONS)
    elif (points if count is None else count) > MOST_POINTS:
        yield say("points-too-many", mark, field="count", points=points, most=MOST_POINTS)
    elif count is not None and count > points and not drawn:
        yield say("points-repeat", mark, field="count", points=points, count=count)
