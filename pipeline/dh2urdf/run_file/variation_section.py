"""The section `variations` of a run file: what is varied, how often, and by which laws."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING, Any, TypeGuard

from dh2urdf.documents.measures import MOST_TURNS, measured
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import JointType
from dh2urdf.output.whole_files import safe_stem
from dh2urdf.quantities import Dimension, QuantityError, evaluate
from dh2urdf.run_file.reading import Reading
from dh2urdf.run_file.sections import LAWS, NormalSection, SpacedSection, VariationSection
from dh2urdf.source import Messages, Problem, did_you_mean
from dh2urdf.variations import laws
from dh2urdf.variations.binding import LEAST_PROBABILITY
from dh2urdf.variations.variation import ALL, AXES, FIELDS, TYPE, Rule, VariationCall

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.columns import RowField
    from dh2urdf.documents.document import Node

say = Messages(__file__)

WORD_LAWS = ("choices", "grid")
_RANGES: dict[str, type[laws.Uniform | laws.LogUniform | laws.Scale | laws.Offset]] = {
    "uniform": laws.Uniform,
    "log-uniform": laws.LogUniform,
    "scale": laws.Scale,
    "offset": laws.Offset,
}
JOINT_TYPES = tuple(kind.value for kind in JointType)
ACCEPTED_JOINTS = "all, a joint's number from 1 or its name, or a list of these"
SPACING = "{from: LOW, to: HIGH, points: N}"


class _LawReader:
    """Reads the law of one field; the first value that is wrong is a `ConfigError`.

    `units` are what the units measure that its values name.
    """

    def __init__(self, what: str, field: str, about: RowField) -> None:
        self._what, self._field, self._about = what, field, about
        self.units: list[Dimension] = []

    def _wrong(self, code: str, node: Node, **values: Any) -> ConfigError:  # noqa: ANN401 - of a message
        about = {"field": self._field, "found": node.text, "whose": "a run file", "kind": node.describe()}
        return ConfigError(say(code, node.mark, **about, **values))

    def read(self, law: str, node: Node) -> laws.Law:
        """The law."""
        spaced = law == "grid" and isinstance(node.value, dict)
        if self._about.dimension is None and (spaced or law not in WORD_LAWS):
            raise self._wrong("law-not-of-words", node, what=self._what, law=law, laws=" or ".join(WORD_LAWS))
        if kind := _RANGES.get(law):
            bounded = kind in (laws.Uniform, laws.LogUniform)
            low, high = self._ends(node, Dimension.NUMBER if kind is laws.Scale else None, bounded=bounded)
            if kind is laws.LogUniform and low <= 0.0:
                raise self._wrong("log-uniform-below-0", node)
            return kind(low=low, high=high)
        if law == "normal" or spaced:
            section: type[SpacedSection | NormalSection] = SpacedSection if spaced else NormalSection
            given = (to := Reading()).record(section, node, self._field)
            if given is None:
                raise ConfigError(to.problems)
            if isinstance(given, NormalSection):
                return self._normal(node)
            low, high = (self._check(end, self._number(end)) for end in map(node.entry, ("from", "to")) if end)
            return laws.Grid(values=laws.evenly_spaced(low, high, given.points))
        if not isinstance(node.value, list) or not node.value:
            accepted = f"a list of values{f', or {SPACING}' if law == 'grid' else ''}"
            raise self._wrong("value-of-other-kind", node, accepted=accepted)
        values = tuple([self._value(entry) for entry in node.value])
        return laws.Grid(values=values) if law == "grid" else laws.Choices(values=values)

    def _value(self, node: Node) -> laws.DrawnValue:
        if self._what == TYPE:
            if node.text not in JOINT_TYPES:
                near = did_you_mean(node.text or "", JOINT_TYPES)
                raise self._wrong("joint-type-unknown", node, types=JOINT_TYPES, suggestion=near)
            return str(node.text)
        if self._what == AXES:
            if not _is_number(node.value):
                raise self._wrong("axes-no-number", node)
            return node.value
        return self._check(node, self._number(node))

    def _ends(self, node: Node, dimension: Dimension | None = None, *, bounded: bool = True) -> tuple[float, float]:
        if not isinstance(node.value, list) or len(node.value) != 2:  # noqa: PLR2004 - a range has two ends
            raise self._wrong("value-of-other-kind", node, accepted="a range: [LOW, HIGH]")
        low, high = (self._number(end, dimension) for end in node.value)
        if low > high:
            raise self._wrong("range-goes-down", node, low=low, high=high)
        for end in (low, high) if bounded else ():
            self._check(node, end)
        return low, high

    def _normal(self, node: Node) -> laws.Law:
        mean_node, width_node, bounds = (node.entry(key) for key in ("mean", "deviation", "bounds"))
        mean = self._number(mean_node) if mean_node else None
        deviation, (low, high) = self._number(width_node or node), self._ends(bounds or node)
        if deviation <= 0.0:
            raise self._wrong("deviation-not-above-0", width_node or node)
        law = laws.Normal(mean=mean, deviation=deviation, low=low, high=high)
        if mean is not None and law.probability() < LEAST_PROBABILITY:
            raise self._wrong("bounds-leave-nothing", bounds or node)
        return law

    def _number(self, node: Node, dimension: Dimension | None = None) -> float:
        """A number in SI units; of the field's dimension where none is given."""
        may_be = [dimension] if dimension else [each for each in (self._about.dimension, self._about.linear) if each]
        each = next((each for each in may_be if _is_of(node, each)), may_be[0])
        try:
            number = measured(node, each, turns=MOST_TURNS if self._what in {"lower", "upper"} else 1)
        except QuantityError as error:
            about = {"accepted": error.accepted, "suggestion": error.suggestion}
            raise self._wrong("quantity-refused", node, reason=error.message, **about) from None
        if evaluate(node.text or "", each).has_unit:
            self.units.append(each)
        return number

    def _check(self, node: Node, number: float) -> float:
        """A number that the field may have."""
        if not self._about.takes(number):
            raise self._wrong("value-out-of-bounds", node, what=self._what, bound=self._about.bound)
        return number


def _is_of(node: Node, dimension: Dimension) -> bool:
    """Whether a number has no unit, or one of a dimension."""
    with suppress(QuantityError):
        return node.text is not None and bool(evaluate(node.text, dimension))
    return False


# --- What the section says --------------------------------------------------------------------------------------------


def read_variations(entries: Iterable[tuple[Node, str]], to: Reading) -> tuple[VariationCall, ...]:
    """The variations, each in its node at its place."""
    return to.distinct(
        to.entries(entries, VariationSection, _variation), lambda call: safe_stem(call.name).casefold(), "variations"
    )


def _variation(given: VariationSection, node: Node, field: str, to: Reading) -> VariationCall | None:
    rules = []
    for index, entry in enumerate(node.entries("vary")):
        with to.noting(entry, f"{field}.vary.{index}"):
            rules.append(_rule(given.vary[index].field, entry))
    has_grid = any(isinstance(each.law, laws.Grid) for each in rules)
    if len(rules) == len(given.vary) and given.count is None and not has_grid:
        to.note("variants-uncounted", node, f"{field}.count")
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
    """A rule whose keys are known, of a field."""
    joints = node.entry("joints")
    problems: list[Problem] = []
    if field == AXES and joints is not None:
        problems.append(say("axes-of-a-joint", field="joints"))
    elif field != AXES and joints is None:
        problems.append(say("vary-without-joints", field="joints", mark=node.mark, accepted=ACCEPTED_JOINTS))
    if problems:
        raise ConfigError([*problems, *_law_problems(node)])
    named = None if joints is None or (joints.value == ALL and not joints.quoted) else _named_joints(joints)
    law, units = read_law(field, FIELDS[field], node)
    return Rule(
        field=field,
        law=law,
        joints=None if named is None else tuple(each.value for each in named),  # type: ignore[misc]  # as checked
        units=units,
        mark=node.mark,
        joint_marks=tuple(each.mark for each in named or ()),
    )


def read_law(field: str, about: RowField, node: Node) -> tuple[laws.Law, tuple[Dimension, ...]]:
    """The law of a field by which a rule varies it, and what the units measure that its values name.

    Raises:
        ConfigError: there is none, or there are several, or one of its values is wrong.
    """
    if problems := [*_law_problems(node)]:
        raise ConfigError(problems)
    name, values = next((name, values) for name in LAWS if (values := node.entry(name)))
    reader = _LawReader(field, name, about)
    return reader.read(name, values), tuple(dict.fromkeys(reader.units))


def _law_problems(node: Node) -> Iterator[Problem]:
    """A rule has one law."""
    names = [name for name in LAWS if node.entry(name)]
    if len(names) != 1:
        code = "vary-two-ways" if names else "vary-no-way"
        yield say(code, found=", ".join(names) or None, count=len(names), laws=list(LAWS))


def _named_joints(node: Node) -> list[Node]:
    """Joints by their numbers from 1 or their names."""
    nodes: list[Node] = node.value if isinstance(node.value, list) else [node]
    wrong = [each for each in nodes if not (_is_number(each.value) or (isinstance(each.value, str) and each.value))]
    if wrong or not nodes:
        code = "joint-wrong" if nodes else "no-joint-named"
        raise ConfigError(
            say(code, each.mark, field="joints", kind=each.describe(), accepted=ACCEPTED_JOINTS)
            for each in wrong or [node]
        )
    return nodes


def _is_number(value: object) -> TypeGuard[int]:
    return type(value) is int and value >= 1
