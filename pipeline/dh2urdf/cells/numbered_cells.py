"""Cells that are numbered: their arms are variants, or their placements vary.

A cell depends on its number only, as a variant does: any of them can be made anywhere, in any order, and none is kept.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import prod
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from dh2urdf.cells.cell import PLACES, TRIPLES, ArmCall, Cell, CellCall, Combine, cannot_be, the_arm
from dh2urdf.errors import ConfigError, ManipulatorError, RobotError
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Messages, Problem
from dh2urdf.stages import Rejected
from dh2urdf.variations.binding import LEAST_PROBABILITY, count_problems, grid_points
from dh2urdf.variations.laws import Grid, Normal, Scale
from dh2urdf.variations.sampling import MOST_POINTS
from dh2urdf.variations.variation import Factor, Variants, Variation, drawn_values, numbered

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from dh2urdf.cells.cell import PlacementRule, WantedTables
    from dh2urdf.robot import Origin
    from dh2urdf.source import Mark
    from dh2urdf.variations.laws import DrawnValue

say = Messages(__file__)


@dataclass(frozen=True, slots=True, kw_only=True)
class NumberedCells:
    """What some cells are made of: all that a worker needs to make any of them."""

    call: CellCall
    kinds: dict[str, Manipulator | Variation]  # what arms are, by the names that the run file has for it
    factors: tuple[Factor, ...]  # what varies of placements
    count: int

    @property
    def mark(self) -> Mark | None:
        """Where the cells stand."""
        return self.call.mark

    @property
    def varied(self) -> dict[str, Variation]:
        """The variations of the arms that are variants, by the names of these arms as the run file has them."""
        kinds = {arm.name: self.kinds[arm.of] for arm in self.call.arms if arm.part is None}
        return {name: kind for name in self.call.order if isinstance(kind := kinds.get(name), Variation)}

    def variants(self) -> Variants[NumberedCells]:
        """All the cells."""
        return Variants(variation=self, numbers=range(1, self.count + 1))

    def names(self, numbers: Iterable[int]) -> list[str]:
        """The names of some of the cells: the number behind the name, or those of the variants that are combined."""
        varied = self.varied
        if self.call.combine is Combine.PAIRS or not varied:
            return [f"{self.call.name}_{numbered(number, self.count)}" for number in numbers]
        own = [[numbered(each, varied[arm].count) for arm, each in self._of(number).items()] for number in numbers]
        return ["_".join((self.call.name, *parts)) for parts in own]

    def _of(self, number: int) -> dict[str, int]:
        """The numbers of the variants in one cell, by the names of their arms."""
        varied = self.varied
        if self.call.combine is Combine.PAIRS:
            return dict.fromkeys(varied, number)
        found, rest = {}, number - 1
        for name in reversed(varied):
            rest, index = divmod(rest, varied[name].count)
            found[name] = index + 1
        return {name: found[name] for name in varied}

    def notices(self) -> Iterator[Problem]:
        """What the parts notice, and two arms whose variants are alike in what is drawn."""
        yield from self.call.notices
        first: dict[tuple[object, ...], str] = {}
        for arm, variation in self.varied.items() if self.call.combine is Combine.PAIRS else ():
            if not all(isinstance(factor.law, Grid) for factor in variation.factors):
                other = first.setdefault((variation.seed, variation.sampling, variation.count), arm)
                if other != arm:
                    yield say("variants-alike", self.mark, field="arms", first=other, second=arm)
                    return

    def drawn(self, numbers: Sequence[int]) -> list[dict[str, DrawnValue]]:
        """What is drawn for some of the cells [SI]: ``left/a_2`` of an arm's variant, ``left/x`` of its placement."""
        call, numbers_of = self.call, [self._of(number) for number in numbers]
        drawn: list[dict[str, DrawnValue]] = [{} for _ in numbers]
        for arm, variation in self.varied.items():
            its = variation.drawn([each[arm] for each in numbers_of])
            for cell, values in zip(drawn, its, strict=True):
                cell.update({f"{arm}/{key}": value for key, value in values.items()})
        # Variants are drawn from a seed, too, and placements must not follow them.
        seed = f"{call.name} {call.seed}" if self.varied else call.seed
        placed = drawn_values(self.factors, numbers, count=self.count, seed=seed, sampling=call.sampling)
        return [cell | values for cell, values in zip(drawn, placed, strict=True)]

    def made(self, number: int, drawn: Mapping[str, DrawnValue]) -> Cell:
        """One cell, counted from 1, for which this was drawn.

        Raises:
            RobotError: an arm has values that no arm can have, or two manipulators one name.
        """
        (name,), of = self.names((number,)), self._of(number)
        arms: list[ArmCall] = []
        tables: dict[str, Manipulator] = {}
        problems: list[Problem] = []
        for arm in self.call.arms:
            own = {key.removeprefix(f"{arm.name}/"): drawn[key] for key in drawn if key.startswith(f"{arm.name}/")}
            if arm.part is not None:
                arms.append(replace(arm, placement=_placed(arm.placement, own)))
                continue
            kind = self.kinds[arm.of]
            try:
                table = kind.made(of[arm.name], own) if isinstance(kind, Variation) else kind
            except ManipulatorError as error:
                problems += cannot_be(arm, error.problems)
                continue
            if tables.setdefault(table.name, table) != table:
                mark = arm.of_mark or arm.mark
                problems.append(say("made-of-several", mark, field="of", user=the_arm(arm), name=table.name))
            arms.append(replace(arm, of=table.name, placement=_placed(arm.placement, own)))
        if problems:
            raise RobotError(problems)
        # The cell is one of its own, which nothing varies in.
        call = CellCall(name=name, arms=tuple(arms), notices=self.call.notices, mark=self.call.mark)
        return Cell(call=call, manipulators=tables)


def _placed(placement: Origin, drawn: Mapping[str, DrawnValue]) -> Origin:
    """A placement with what was drawn for it."""
    given = dict(zip(PLACES, (*placement.xyz, *placement.rpy), strict=True))
    if given.keys().isdisjoint(drawn):
        return placement
    x, y, z, roll, pitch, yaw = (float(drawn.get(name, value)) for name, value in given.items())
    return replace(placement, xyz=(x, y, z), rpy=(roll, pitch, yaw))


def made_cells(
    variants: Variants[NumberedCells], drawn: Sequence[Mapping[str, DrawnValue]]
) -> tuple[dict[int, Cell], dict[int, ManipulatorError]]:
    """The cells for which this was drawn, and why there is none, by their places."""
    cells, errors = {}, {}
    for place, (number, values) in enumerate(zip(variants.numbers, drawn, strict=True)):
        try:
            cells[place] = variants.variation.made(number, values)
        except ManipulatorError as error:
            errors[place] = error
    return cells, errors


# --- With tables ------------------------------------------------------------------------------------------------------


def with_tables(
    cells: Sequence[CellCall],
    gathering: WantedTables,
    variations: Mapping[str, Variants[Variation] | Rejected] = MappingProxyType({}),
) -> Iterator[Cell | Variants[NumberedCells] | Rejected]:
    """The cells with what their arms are, once everything has been seen; why not, where one cannot be made.

    Args:
        cells: the cells.
        gathering: has the manipulators of the run that are wanted.
        variations: the variations of the run that have a name of their own, by this name.
    """
    for call in cells:
        kinds: dict[str, Manipulator | Variation] = {}
        problems: list[Problem] = []
        for arm in call.arms:
            if arm.part is not None and (arm.of in variations or gathering.has(arm.of)):
                about = {"field": "of", "found": arm.of, "user": the_arm(arm), "name": arm.of}
                problems.append(say("part-or-manipulator", arm.of_mark or arm.mark, **about))
            if arm.part is not None:
                continue
            match _kind_of(arm, gathering, variations.get(arm.of)):
                case Manipulator() | Variation() as kind:
                    kinds[arm.of] = kind
                case why_not:
                    problems += why_not
        try:
            if problems:
                raise ConfigError(problems)
            is_one = not call.vary and not any(isinstance(kind, Variation) for kind in kinds.values())
            tables = {name: kind for name, kind in kinds.items() if isinstance(kind, Manipulator)}
            yield Cell(call=call, manipulators=tables) if is_one else bind(call, kinds).variants()
        except ConfigError as error:
            yield Rejected(name=call.name, problems=error.problems, mark=call.mark)


def _kind_of(
    arm: ArmCall, gathering: WantedTables, variation: Variants[Variation] | Rejected | None
) -> Manipulator | Variation | tuple[Problem, ...]:
    """What an arm is: a manipulator of the run or a variation; why not, where it can be neither."""
    mark = arm.of_mark or arm.mark
    if variation is None:
        return gathering.table(arm.of, the_arm(arm), mark)
    if gathering.has(arm.of):
        return (say("made-of-either", mark, field="of", found=arm.of, user=the_arm(arm), name=arm.of),)
    # Why a variation cannot be is reported once, with the variation.
    return variation.variation if isinstance(variation, Variants) else tuple(cannot_be(arm, ()))


def bind(call: CellCall, kinds: Mapping[str, Manipulator | Variation]) -> NumberedCells:
    """The numbered cells of some arms, of which at least one is a variation or has a placement that varies.

    Raises:
        ConfigError: the counts of the variants do not go together, or a placement cannot vary so.
    """
    problems: list[Problem] = []
    factors: dict[str, Factor] = {}
    for rule in call.vary:
        for factor in _factors(rule, call, problems):
            if factor.key in factors:
                first = factors[factor.key].mark
                problems.append(say("varied-twice", rule.mark, field=rule.field, key=factor.key, first=first))
            factors.setdefault(factor.key, factor)
    cells = NumberedCells(call=call, kinds=dict(kinds), factors=tuple(factors.values()), count=0)
    problems += _count_problems(cells)
    if problems:
        raise ConfigError(problems)
    counts = [variation.count for variation in cells.varied.values()]
    if call.combine is Combine.ALL and counts:
        return replace(cells, count=prod(counts))
    return replace(cells, count=counts[0] if counts else call.count or grid_points(cells.factors))


def _count_problems(cells: NumberedCells) -> Iterator[Problem]:
    """What is wrong with how many cells there are."""
    call, mark = cells.call, cells.call.count_mark or cells.call.mark
    counts = {arm: variation.count for arm, variation in cells.varied.items()}
    if not counts:
        yield from count_problems(cells.factors, call.count, call.sampling, mark)
        return
    (first, count), *others = counts.items()
    if call.count is not None:
        yield say("cells-of-variants-counted", mark, field="count", arm=first)
    elif call.combine is Combine.ALL:
        if (product := prod(counts.values())) > MOST_POINTS:
            yield say("cells-too-many", mark, field="combine", count=product, most=MOST_POINTS)
    elif unlike := [(arm, other) for arm, other in others if other != count]:
        second, other = unlike[0]
        yield say("variants-unpaired", mark, field="arms", first=first, count=count, second=second, other=other)
    total = prod(counts.values()) if call.combine is Combine.ALL else count
    if total < (points := grid_points(cells.factors)):
        yield say("cells-below-grid", mark, field="vary", count=total, points=points)


def _factors(rule: PlacementRule, call: CellCall, problems: list[Problem]) -> Iterator[Factor]:
    """What a rule varies; adds to the problems why it cannot."""
    placement = next(arm.placement for arm in call.arms if arm.name == rule.arm)
    given = dict(zip(PLACES, (*placement.xyz, *placement.rpy), strict=True))
    names = TRIPLES.get(rule.field, (rule.field,))
    about: dict[str, Any] = {"field": rule.field, "mark": rule.mark}
    if isinstance(rule.law, Scale) and not any(given[name] for name in names):
        problems.append(say("placement-of-0", arm=rule.arm, found="0", **about))
    for name in names:
        nominal = given[name]
        if isinstance(rule.law, Normal) and rule.law.probability(nominal) < LEAST_PROBABILITY:
            problems.append(say("bounds-off-nominal", nominal=nominal, **about))
        yield Factor(key=f"{rule.arm}/{name}", field=name, row=None, law=rule.law, nominal=nominal, mark=rule.mark)
