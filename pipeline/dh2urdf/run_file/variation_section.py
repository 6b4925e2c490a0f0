"""The section `variations` of a run file: what is varied, how often, and by which laws."""

from __future__ import annotations

from math import inf, tau
from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf.output.whole_files import safe_stem
from dh2urdf.quantities.quantity import Dimension, QuantityError, evaluate
from dh2urdf.run_file.sections import SectionReader
from dh2urdf.source import Mark, Problem, did_you_mean, shown
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
from dh2urdf.variations.sampling import MOST_POINTS, Sampling
from dh2urdf.variations.variation import ALL, AXES, FIELDS, TYPE, Rule, VariationCall

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.documents.document import Node

KEYS = ("name", "of", "count", "seed", "sampling", "vary")
LAWS = ("choices", "grid", "uniform", "log-uniform", "normal", "scale", "offset")
RULE_KEYS = ("joints", "field", *LAWS)
WORD_LAWS = ("choices", "grid")
SAMPLINGS = tuple(sampling.value for sampling in Sampling)
JOINT_TYPES = tuple(kind.value for kind in JointType)
ACCEPTED_RULE = "a mapping such as {joints: [2, 3], field: a, scale: [0.8, 1.2]}"
MOST_VALUES = 10**4
"""Values of one evenly spaced grid: every chunk of tasks carries them."""
MOST_SEED = 2**64
_BARE_ANGLES = {"alpha": tau, "theta": tau, "offset": tau, "lower": 10 * tau, "upper": 10 * tau}
"""What a number without a unit may be at most where it may be an angle [rad]: beyond, degrees may be meant."""


class VariationsReader(SectionReader):
    """Reads the variations of a run file and gathers what is wrong with them."""

    def read(self, section: Node) -> tuple[VariationCall, ...]:
        """The variations that nothing is wrong with."""
        calls: dict[str, VariationCall] = {}
        for index, node in enumerate(section.value if isinstance(section.value, list) else []):
            call = self._variation(node, f"variations.{index}")
            stem = safe_stem(call.name).casefold() if call else ""
            if call and stem in calls:
                self.say(
                    f"two variations are named {shown(call.name)}, and so would be their variants and files",
                    node,
                    f"variations.{index}.name",
                    found=call.name,
                    accepted="`name: NAME`, another one for each",
                    suggestion=f"the first stands at {calls[stem].mark}",
                )
            elif call:
                calls[stem] = call
        return tuple(calls.values())

    def _variation(self, node: Node, field: str) -> VariationCall | None:
        before = len(self.problems)
        given = self.entries(node, KEYS, field)
        of = self.name(given.get("of"), f"{field}.of")
        if "of" not in given and isinstance(node.value, dict):
            accepted = "`of: NAME`, the name of a manipulator of this run"
            self.say("it is not said what is varied", node, f"{field}.of", accepted=accepted)
        rules = self._rules(node, given.get("vary"), f"{field}.vary")
        count = self._whole(given.get("count"), f"{field}.count", 1, MOST_POINTS)
        if "count" not in given and rules and not any(isinstance(rule.law, Grid) for rule in rules):
            self.say(
                "it is not said how many variants there are",
                node,
                f"{field}.count",
                accepted="`count: NUMBER`; only a grid needs none",
            )
        seed = self._whole(given.get("seed"), f"{field}.seed", 0, MOST_SEED - 1)
        sampling = self._word(given.get("sampling"), f"{field}.sampling", SAMPLINGS, "way of sampling")
        name = self.name(given.get("name"), f"{field}.name")
        if len(self.problems) > before or of is None:
            return None
        return VariationCall(
            name=name or of,
            of=of,
            vary=rules,
            count=count,
            seed=seed or 0,
            sampling=Sampling(sampling or Sampling.RANDOM),
            mark=node.mark,
            of_mark=given["of"].mark,
            count_mark=given["count"].mark if "count" in given else None,
        )

    def _rules(self, node: Node, section: Node | None, field: str) -> tuple[Rule, ...]:
        entries = [] if section is None else section.value if isinstance(section.value, list) else [section]
        if not entries and isinstance(node.value, dict):
            self.say("nothing varies", section or node, field, accepted=f"a list of rules, each {ACCEPTED_RULE}")
        rules = [self._rule(entry, f"{field}.{index}") for index, entry in enumerate(entries)]
        return tuple(rule for rule in rules if rule)

    def _rule(self, node: Node, field: str) -> Rule | None:
        before = len(self.problems)
        given = self.entries(node, RULE_KEYS, field)
        if not isinstance(node.value, dict):
            return None
        if "field" not in given:
            accepted = f"`field: NAME`, one of {', '.join(FIELDS)}"
            self.say("it is not said which field varies", node, f"{field}.field", accepted=accepted)
        what = self._word(given.get("field"), f"{field}.field", list(FIELDS), "field that can be varied")
        joints = self._joints(node, given.get("joints"), what, f"{field}.joints")
        laws = [law for law in LAWS if law in given]
        if len(laws) != 1:
            message = "it is not said how it varies" if not laws else f"it varies in {len(laws)} ways at once"
            self.say(message, node, field, found=", ".join(laws) or None, accepted=f"one of {', '.join(LAWS)}")
        if len(self.problems) > before or what is None:
            return None
        reader = _LawReader(self.problems, what, f"{field}.{laws[0]}")
        law = reader.read(laws[0], given[laws[0]])
        if law is None or len(self.problems) > before:
            return None
        names, marks = joints or (None, ())
        units = tuple(dict.fromkeys(reader.units))
        return Rule(field=what, law=law, joints=names, units=units, mark=node.mark, joint_marks=marks)

    def _joints(
        self, rule: Node, node: Node | None, what: str | None, field: str
    ) -> tuple[tuple[int | str, ...], tuple[Mark, ...]] | None:
        """The joints that are named and where; None for all of them."""
        accepted = "all, a joint's number from 1 or its name, or a list of these"
        if what == AXES:
            if node is not None:
                self.say("the number of axes is the whole arm's, not a joint's", node, field, accepted="no `joints`")
            return None
        if node is None:
            self.say("it is not said whose field varies", rule, field, accepted=f"`joints:` {accepted}")
            return None
        if node.value == ALL and not node.quoted:
            return None
        nodes = node.value if isinstance(node.value, list) else [node]
        joints: list[int | str] = []
        for entry in nodes:
            value = entry.value
            is_number = isinstance(value, int) and not isinstance(value, bool) and value >= 1
            if not is_number and (not isinstance(value, str) or not value):
                self.say(f"{entry.describe()} is no joint", entry, field, accepted=accepted)
            else:
                joints.append(value if isinstance(value, int) else str(value))
        if not nodes:
            self.say("no joint is named", node, field, accepted=accepted)
        return tuple(joints), tuple(entry.mark for entry in nodes)

    def _whole(self, node: Node | None, field: str, least: int, most: int) -> int | None:
        if node is None:
            return None
        if isinstance(node.value, int) and not isinstance(node.value, bool) and least <= node.value <= most:
            return node.value
        self.say(f"this cannot be {node.describe()}", node, field, accepted=f"a whole number from {least} to {most}")
        return None

    def _word(self, node: Node | None, field: str, words: Sequence[str], what: str) -> str | None:
        """One of some words."""
        word = self.name(node, field)
        if node is None or word is None or word in words:
            return word
        near = did_you_mean(word, words)
        self.say(f"{shown(word)} is no {what}", node, field, accepted=", ".join(words), suggestion=near)
        return None


class _LawReader(SectionReader):
    """Reads the law of one field.

    Attributes:
        units: what the units measure that its values name.
    """

    def __init__(self, problems: list[Problem], what: str, field: str) -> None:
        super().__init__(problems)
        self.what = what
        self.field = field
        self.units: list[Dimension] = []

    def read(self, law: str, node: Node) -> Law | None:
        """The law; None where something is wrong with it."""
        if FIELDS[self.what].dimension is None and law not in WORD_LAWS:
            accepted = f"{' or '.join(WORD_LAWS)}, a list of values"
            self.say(f"{self.what} cannot vary by {law}", node, self.field, accepted=accepted)
            return None
        readers: dict[str, Callable[[Node], Law | None]] = {
            "choices": self._choices,
            "grid": self._grid,
            "uniform": lambda node: self._range(node, Uniform),
            "log-uniform": lambda node: self._range(node, LogUniform),
            "normal": self._normal,
            "scale": lambda node: self._relative(node, Scale, Dimension.NUMBER),
            "offset": lambda node: self._relative(node, Offset),
        }
        return readers[law](node)

    # --- Values

    def _choices(self, node: Node) -> Law | None:
        values = self._values(node, "a list of values")
        return Choices(values=values) if values else None

    def _grid(self, node: Node) -> Law | None:
        if isinstance(node.value, dict):
            return self._spaced(node)
        values = self._values(node, "a list of values, or {from: LOW, to: HIGH, points: N}")
        return Grid(values=values) if values else None

    def _values(self, node: Node, accepted: str) -> tuple[DrawnValue, ...]:
        if not isinstance(node.value, list) or not node.value:
            self.say(f"this cannot be {node.describe()}", node, self.field, accepted=accepted)
            return ()
        values = [self._value(entry) for entry in node.value]
        return tuple(value for value in values if value is not None)

    def _value(self, node: Node) -> DrawnValue | None:
        if self.what == TYPE:
            word = self.name(node, self.field)
            if word is not None and word not in JOINT_TYPES:
                near = did_you_mean(word, JOINT_TYPES)
                accepted = ", ".join(JOINT_TYPES)
                self.say(f"{shown(word)} is no type of joint", node, self.field, accepted=accepted, suggestion=near)
            return word
        if self.what == AXES:
            if isinstance(node.value, int) and not isinstance(node.value, bool) and node.value >= 1:
                return node.value
            self.say(f"{node.describe()} is no number of axes", node, self.field, accepted="a whole number from 1 on")
            return None
        return self._positive(node, self._number(node))

    def _spaced(self, node: Node) -> Law | None:
        given = self.entries(node, ("from", "to", "points"), self.field)
        missing = [key for key in ("from", "to", "points") if key not in given]
        if missing or FIELDS[self.what].dimension is None:
            accepted = "a list of values" if not missing else "{from: LOW, to: HIGH, points: N}, or a list of values"
            message = f"this grid has no {missing[0]}" if missing else f"{self.what} has no values in between"
            self.say(message, node, self.field, accepted=accepted)
            return None
        low, high = (self._positive(given[key], self._number(given[key])) for key in ("from", "to"))
        points = given["points"]
        if not (isinstance(points.value, int) and 2 <= points.value <= MOST_VALUES):  # noqa: PLR2004 - both ends
            accepted = f"a whole number from 2 to {MOST_VALUES}"
            self.say(f"the number of points cannot be {points.describe()}", points, self.field, accepted=accepted)
            return None
        return None if low is None or high is None else Grid(values=evenly_spaced(low, high, points.value))

    # --- Ranges

    def _range(self, node: Node, law: type[Uniform | LogUniform]) -> Law | None:
        ends = self._ends(node)
        if ends is None or any(self._positive(node, end) is None for end in ends):
            return None
        if law is LogUniform and ends[0] <= 0.0:
            self.say("orders of magnitude begin above 0", node, self.field, accepted="two numbers greater than 0")
            return None
        return law(low=ends[0], high=ends[1])

    def _relative(self, node: Node, law: type[Scale | Offset], dimension: Dimension | None = None) -> Law | None:
        ends = self._ends(node, dimension)
        return law(low=ends[0], high=ends[1]) if ends else None

    def _ends(self, node: Node, dimension: Dimension | None = None) -> tuple[float, float] | None:
        if not isinstance(node.value, list) or len(node.value) != 2:  # noqa: PLR2004 - a range has two ends
            self.say(f"this cannot be {node.describe()}", node, self.field, accepted="a range: [LOW, HIGH]")
            return None
        low, high = (self._number(end, dimension) for end in node.value)
        if low is None or high is None:
            return None
        if low > high:
            self.say(
                f"the range goes down from {low:.12g} to {high:.12g}",
                node,
                self.field,
                accepted="the lower end first",
                suggestion="are they exchanged?",
            )
            return None
        return low, high

    def _normal(self, node: Node) -> Law | None:
        given = self.entries(node, ("mean", "deviation", "bounds"), self.field)
        missing = [key for key in ("deviation", "bounds") if key not in given]
        if missing and isinstance(node.value, dict):
            accepted = "{deviation: D, bounds: [LOW, HIGH]}, and `mean: M` where it is not the nominal value"
            self.say(f"this normal distribution has no {missing[0]}", node, self.field, accepted=accepted)
        if missing:
            return None
        mean = self._number(given["mean"]) if "mean" in given else None
        deviation = self._number(given["deviation"])
        ends = self._ends(given["bounds"])
        if deviation is not None and deviation <= 0.0:
            self.say(
                "a standard deviation is greater than 0",
                given["deviation"],
                self.field,
                accepted="a number greater than 0",
            )
            return None
        if deviation is None or ends is None or (mean is None and "mean" in given):
            return None
        if any(self._positive(given["bounds"], end) is None for end in ends):
            return None
        law = Normal(mean=mean, deviation=deviation, low=ends[0], high=ends[1])
        if mean is not None and law.probability() < LEAST_PROBABILITY:
            message = "the bounds leave hardly anything of this normal distribution"
            self.say(message, given["bounds"], self.field, accepted="bounds about the mean")
        return law

    # --- Numbers

    def _number(self, node: Node, dimension: Dimension | None = None) -> float | None:
        """A number in SI units; of the field's dimension where none is given."""
        if node.text is None or node.value is None or isinstance(node.value, bool):
            self.say(f"{node.describe()} stands where a number is needed", node, self.field, accepted="a number")
            return None
        what = FIELDS[self.what]
        dimensions = [dimension] if dimension else [each for each in (what.dimension, what.linear) if each]
        wrong: list[QuantityError] = []
        for each in dimensions:
            try:
                quantity = evaluate(node.text, each)
            except QuantityError as error:
                wrong.append(error)
                continue
            if quantity.variable:
                self.say(f"{shown(node.text)} names a joint variable", node, self.field, accepted="a number")
                return None
            if quantity.has_unit:
                self.units.append(each)
            elif dimension is None and abs(quantity.value) > _BARE_ANGLES.get(self.what, inf):
                text = node.text.strip()
                self.say(
                    f"{shown(text)} is more than {_BARE_ANGLES[self.what] / tau:g} turns in rad",
                    node,
                    self.field,
                    accepted="numbers of this size with their unit",
                    suggestion=f"if these are degrees, say so: '{text} deg'",
                )
                return None
            return quantity.value
        self.say(wrong[0].message, node, self.field, accepted=wrong[0].accepted, suggestion=wrong[0].suggestion)
        return None

    def _positive(self, node: Node, number: float | None) -> float | None:
        """A number that the field may have."""
        field = FIELDS[self.what]
        if number is not None and not field.takes(number):
            message = f"{self.what} must be {field.bound}"
            self.say(message, node, self.field, accepted=f"numbers {field.bound}")
            return None
        return number
