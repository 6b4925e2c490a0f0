"""The section `variations` of a run file: what is varied, how often, and by which laws."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from dh2urdf.documents.measures import measured
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import JointType
from dh2urdf.output.whole_files import safe_stem
from dh2urdf.quantities.quantity import Dimension, QuantityError, evaluate
from dh2urdf.run_file.reading import Reading
from dh2urdf.run_file.sections import LAWS, NormalSection, SpacedSection, VariationSection
from dh2urdf.source import Mark, Problem, did_you_mean
from dh2urdf.variations.binding import LEAST_PROBABILITY
from dh2urdf.variations.laws import (
    Choices,
    DrawnValue,
    Grid,
    Law,
    LogUniform,
    Normal,
    Offset,
    Scale,
    Uniform,
    evenly_spaced,
)
from dh2urdf.variations.variation import ALL, AXES, FIELDS, TYPE, Rule, VariationCall

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.documents.document import Node

WORD_LAWS = ("choices", "grid")
_RANGES: dict[str, type[Uniform | LogUniform | Scale | Offset]] = {
    "uniform": Uniform,
    "log-uniform": LogUniform,
    "scale": Scale,
    "offset": Offset,
}
JOINT_TYPES = tuple(kind.value for kind in JointType)
ACCEPTED_JOINTS = "all, a joint's number from 1 or its name, or a list of these"
SPACING = "{from: LOW, to: HIGH, points: N}"
MOST_TURNS = 10
"""What a limit of a joint may be at most without a unit where it may be an angle: beyond, degrees may be meant."""


class _LawReader:
    """Reads the law of one field.

    Attributes:
        what: the field.
        field: the law, by which problems name it.
        to: gets the problems.
        units: what the units measure that its values name.
    """

    def __init__(self, what: str, field: str) -> None:
        self.what = what
        self.field = field
        self.to = Reading()
        self.units: list[Dimension] = []

    def add_problem(self, message: str, node: Node, accepted: str | None = None, suggestion: str | None = None) -> None:
        """Note a problem of the law."""
        self.to.add_problem(message, node, self.field, accepted=accepted, suggestion=suggestion)

    def read(self, law: str, node: Node) -> Law | None:
        """The law; None where something is wrong with it."""
        if FIELDS[self.what].dimension is None and law not in WORD_LAWS:
            accepted = f"{' or '.join(WORD_LAWS)}, a list of values"
            self.add_problem(f"{self.what} cannot vary by {law}", node, accepted=accepted)
            return None
        if law in _RANGES:
            return self._range(node, _RANGES[law])
        return {"choices": self._choices, "grid": self._grid, "normal": self._normal}[law](node)

    # --- Values

    def _choices(self, node: Node) -> Law | None:
        values = self._values(node, "a list of values")
        return Choices(values=values) if values else None

    def _grid(self, node: Node) -> Law | None:
        if isinstance(node.value, dict):
            return self._spaced(node)
        values = self._values(node, f"a list of values, or {SPACING}")
        return Grid(values=values) if values else None

    def _values(self, node: Node, accepted: str) -> tuple[DrawnValue, ...]:
        if not isinstance(node.value, list) or not node.value:
            self.add_problem(f"a run file cannot take {node.describe()} here", node, accepted=accepted)
            return ()
        values = [self._value(entry) for entry in node.value]
        return tuple(value for value in values if value is not None)

    def _value(self, node: Node) -> DrawnValue | None:
        if self.what == TYPE:
            if node.text in JOINT_TYPES:
                return node.text
            near, accepted = did_you_mean(node.text or "", JOINT_TYPES), ", ".join(JOINT_TYPES)
            self.add_problem(f"{node.describe()} is no type of joint", node, accepted=accepted, suggestion=near)
            return None
        if self.what == AXES:
            if isinstance(node.value, int) and not isinstance(node.value, bool) and node.value >= 1:
                return node.value
            self.add_problem(f"{node.describe()} is no number of axes", node, accepted="a whole number from 1 on")
            return None
        return self._positive(node, self._number(node))

    def _spaced(self, node: Node) -> Law | None:
        if FIELDS[self.what].dimension is None:
            self.add_problem(f"{self.what} has no values in between", node, accepted="a list of values")
            return None
        if (given := self.to.record(SpacedSection, node, self.field)) is None:
            return None
        low, high = (
            self._positive(end, self._number(end)) for end in (node.entry("from") or node, node.entry("to") or node)
        )
        return None if low is None or high is None else Grid(values=evenly_spaced(low, high, given.points))

    # --- Ranges

    def _range(self, node: Node, law: type[Uniform | LogUniform | Scale | Offset]) -> Law | None:
        ends = self._ends(node, Dimension.NUMBER if law is Scale else None)
        is_absolute = law in (Uniform, LogUniform)
        if ends is None or (is_absolute and any(self._positive(node, end) is None for end in ends)):
            return None
        if law is LogUniform and ends[0] <= 0.0:
            self.add_problem("orders of magnitude begin above 0", node, accepted="two numbers greater than 0")
            return None
        return law(low=ends[0], high=ends[1])

    def _ends(self, node: Node, dimension: Dimension | None = None) -> tuple[float, float] | None:
        if not isinstance(node.value, list) or len(node.value) != 2:  # noqa: PLR2004 - a range has two ends
            self.add_problem(f"a run file cannot take {node.describe()} here", node, accepted="a range: [LOW, HIGH]")
            return None
        low, high = (self._number(end, dimension) for end in node.value)
        if low is None or high is None:
            return None
        if low > high:
            message = f"the range goes down from {low:.12g} to {high:.12g}"
            self.add_problem(message, node, accepted="the lower end first", suggestion="are they exchanged?")
            return None
        return low, high

    def _normal(self, node: Node) -> Law | None:
        if self.to.record(NormalSection, node, self.field) is None:
            return None
        mean_node, deviation_node, bounds = (node.entry(key) or node for key in ("mean", "deviation", "bounds"))
        mean = None if mean_node is node else self._number(mean_node)
        deviation, ends = self._number(deviation_node), self._ends(bounds)
        if deviation is not None and deviation <= 0.0:
            message = "a standard deviation is greater than 0"
            self.add_problem(message, deviation_node, accepted="a number greater than 0")
        if ends is not None:
            for end in ends:
                self._positive(bounds, end)
        if deviation is None or ends is None or self.to.problems:
            return None
        law = Normal(mean=mean, deviation=deviation, low=ends[0], high=ends[1])
        if mean is not None and law.probability() < LEAST_PROBABILITY:
            message = "the bounds leave hardly anything of this normal distribution"
            self.add_problem(message, bounds, accepted="bounds about the mean")
        return law

    # --- Numbers

    def _number(self, node: Node, dimension: Dimension | None = None) -> float | None:
        """A number in SI units; of the field's dimension where none is given."""
        field = FIELDS[self.what]
        may_be = [dimension] if dimension else [each for each in (field.dimension, field.linear) if each]
        each = next((each for each in may_be if _is_of(node, each)), may_be[0])
        try:
            number = measured(node, each, turns=MOST_TURNS if self.what in {"lower", "upper"} else 1)
        except QuantityError as error:
            self.add_problem(error.message, node, accepted=error.accepted, suggestion=error.suggestion)
            return None
        if evaluate(node.text or "", each).has_unit:
            self.units.append(each)
        return number

    def _positive(self, node: Node, number: float | None) -> float | None:
        """A number that the field may have."""
        field = FIELDS[self.what]
        if number is not None and not field.takes(number):
            message = f"{self.what} must be {field.bound}"
            self.add_problem(message, node, accepted=f"numbers {field.bound}")
            return None
        return number


def _is_of(node: Node, dimension: Dimension) -> bool:
    """Whether a number has no unit, or one of a dimension."""
    with suppress(QuantityError):
        return node.text is not None and bool(evaluate(node.text, dimension))
    return False


# --- What the section says --------------------------------------------------------------------------------------------


def read_variations(entries: Iterable[tuple[Node, str]], to: Reading) -> tuple[VariationCall, ...]:
    """The variations, each in its node at its place."""
    found = []
    for node, field in entries:
        given = to.record(VariationSection, node, field)
        call = _variation(given, node, field, to) if given else None
        if call:
            found.append((call, safe_stem(call.name).casefold(), node, field))
    message = "two variations are named {}, and so would be their variants and files"
    return to.distinct(found, message, "`name: NAME`, another one for each")


def _variation(given: VariationSection, node: Node, field: str, to: Reading) -> VariationCall | None:
    before = len(to.problems)
    rules = []
    for index, entry in enumerate(node.entries("vary")):
        with to.noting(entry, f"{field}.vary.{index}"):
            rules.append(_rule(given.vary[index].field, entry))
    if len(to.problems) == before and given.count is None and not any(isinstance(rule.law, Grid) for rule in rules):
        message, accepted = "it is not said how many variants there are", "`count: NUMBER`; only a grid needs none"
        to.add_problem(message, node, f"{field}.count", accepted=accepted)
    if len(to.problems) > before:
        return None
    count = node.entry("count")
    return VariationCall(
        name=given.name or given.of,
        of=given.of,
        count=given.count,
        seed=given.seed,
        sampling=given.sampling,
        vary=tuple(rules),
        mark=node.mark,
        of_mark=(node.entry("of") or node).mark,
        count_mark=count.mark if count else None,
    )


def _rule(field: str, node: Node) -> Rule:
    """A rule whose keys are known, of a field.

    Raises:
        ConfigError: it has no joints, not one law, or values that the field cannot have.
    """
    joints = node.entry("joints")
    laws = [(name, values) for name in LAWS if (values := node.entry(name))]
    if field == AXES and joints is not None:
        message = "the number of axes is the whole arm's, not a joint's"
        raise ConfigError(Problem(message=message, field="joints", accepted="no `joints`"))
    problems = []
    if field != AXES and joints is None:
        message = "it is not said whose field varies"
        problems.append(
            Problem(message=message, field="joints", mark=node.mark, accepted=f"`joints:` {ACCEPTED_JOINTS}")
        )
    if len(laws) != 1:
        message = "it is not said how it varies" if not laws else f"it varies in {len(laws)} ways at once"
        found = ", ".join(name for name, _ in laws) or None
        problems.append(Problem(message=message, found=found, accepted=f"one of {', '.join(LAWS)}"))
    if problems:
        raise ConfigError(problems)
    names, marks = _joints(joints) if joints else (None, ())
    ((name, values),) = laws
    reader = _LawReader(field, name)
    law = reader.read(name, values)
    if law is None or reader.to.problems:
        raise ConfigError(reader.to.problems)
    units = tuple(dict.fromkeys(reader.units))
    return Rule(field=field, law=law, joints=names, units=units, mark=node.mark, joint_marks=marks)


def _joints(node: Node) -> tuple[tuple[int | str, ...] | None, tuple[Mark, ...]]:
    """Joints by their numbers from 1 or their names, and where each is named; None stands for all joints.

    Raises:
        ConfigError: something in their place is no joint.
    """
    if node.value == ALL and not node.quoted:
        return None, ()
    nodes = node.value if isinstance(node.value, list) else [node]
    joints: list[int | str] = []
    problems = []
    for entry in nodes:
        value = entry.value
        is_number = isinstance(value, int) and not isinstance(value, bool) and value >= 1
        if is_number or (isinstance(value, str) and value):
            joints.append(value)  # type: ignore[arg-type]  # one of the two
        else:
            message = f"{entry.describe()} is no joint"
            problems.append(Problem(message=message, mark=entry.mark, field="joints", accepted=ACCEPTED_JOINTS))
    if not nodes:
        problems.append(Problem(message="no joint is named", field="joints", accepted=ACCEPTED_JOINTS))
    if problems:
        raise ConfigError(problems)
    return tuple(joints), tuple(entry.mark for entry in nodes)
