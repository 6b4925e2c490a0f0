"""The section `variations` of a run file: what is varied, how often, and by which laws."""

from __future__ import annotations

from math import inf, tau
from typing import TYPE_CHECKING, Any

from dh2urdf.documents.nodes import LARGEST_BARE
from dh2urdf.errors import ConfigError
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.manipulator import JointType
from dh2urdf.output.whole_files import safe_stem
from dh2urdf.quantities.quantity import Dimension, QuantityError, evaluate
from dh2urdf.run_file.validator import Distinct, JsonSchema, Key, Many, Record, Validator, ValueType
from dh2urdf.run_file.value_types import NUMBER, TEXT, as_written, numbers, whole, word
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
ACCEPTED_NORMAL = "{deviation: D, bounds: [LOW, HIGH]}, and `mean: M` where it is not the nominal value"
NO_RULE = ("nothing varies", "a list of rules, each a mapping such as {joints: [2, 3], field: a, scale: [0.8, 1.2]}")
MOST_VALUES = 10**4
"""Values of one evenly spaced grid: every chunk of tasks carries them."""
MOST_SEED = 2**64
_BARE_ANGLES = {"alpha": tau, "theta": tau, "offset": tau, "lower": 10 * tau, "upper": 10 * tau}
"""What a number without a unit may be at most where it may be an angle [rad]: beyond, degrees may be meant."""
_BARE = {**dict.fromkeys(("a", "d", "radius"), LARGEST_BARE["length"]), **_BARE_ANGLES}


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
        self.to = Validator()
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
            self.add_problem(f"this cannot be {node.describe()}", node, accepted=accepted)
            return ()
        values = [self._value(entry) for entry in node.value]
        return tuple(value for value in values if value is not None)

    def _value(self, node: Node) -> DrawnValue | None:
        if self.what == TYPE:
            word = TEXT.read(node, self.field, self.to)
            if word is not None and word not in JOINT_TYPES:
                near = did_you_mean(word, JOINT_TYPES)
                accepted = ", ".join(JOINT_TYPES)
                self.add_problem(f"{shown(word)} is no type of joint", node, accepted=accepted, suggestion=near)
            return word
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
        if (given := SPACED.read(node, self.field, self.to)) is None:
            return None
        low, high = [self._positive(given[key], self._number(given[key])) for key in ("from", "to")]
        return None if low is None or high is None else Grid(values=evenly_spaced(low, high, given["points"]))

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
            self.add_problem(f"this cannot be {node.describe()}", node, accepted="a range: [LOW, HIGH]")
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
        if (given := NORMAL.read(node, self.field, self.to)) is None:
            return None
        mean = self._number(given["mean"]) if "mean" in given else None
        deviation = self._number(given["deviation"])
        ends = self._ends(given["bounds"])
        if deviation is not None and deviation <= 0.0:
            self.add_problem(
                "a standard deviation is greater than 0", given["deviation"], accepted="a number greater than 0"
            )
            return None
        if deviation is None or ends is None or (mean is None and "mean" in given):
            return None
        if any(self._positive(given["bounds"], end) is None for end in ends):
            return None
        law = Normal(mean=mean, deviation=deviation, low=ends[0], high=ends[1])
        if mean is not None and law.probability() < LEAST_PROBABILITY:
            message = "the bounds leave hardly anything of this normal distribution"
            self.add_problem(message, given["bounds"], accepted="bounds about the mean")
        return law

    # --- Numbers

    def _number(self, node: Node, dimension: Dimension | None = None) -> float | None:
        """A number in SI units; of the field's dimension where none is given."""
        if node.text is None or node.value is None or isinstance(node.value, bool):
            self.add_problem(f"{node.describe()} stands where a number is needed", node, accepted="a number")
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
                self.add_problem(f"{shown(node.text)} names a joint variable", node, accepted="a number")
                return None
            if quantity.has_unit:
                self.units.append(each)
            elif dimension is None and abs(quantity.value) > _BARE.get(self.what, inf):
                text = node.text.strip()
                if self.what in _BARE_ANGLES:
                    message = f"{shown(text)} is more than {_BARE_ANGLES[self.what] / tau:g} turns in rad"
                    near = f"if these are degrees, say so: '{text} deg'"
                else:
                    message = f"{shown(text)} is more than {_BARE[self.what]:g} m"
                    near = f"if these are mm, say so: '{text} mm'; '{text} m' is read as such"
                self.add_problem(message, node, accepted="numbers of this size with their unit", suggestion=near)
                return None
            return quantity.value
        self.add_problem(wrong[0].message, node, accepted=wrong[0].accepted, suggestion=wrong[0].suggestion)
        return None

    def _positive(self, node: Node, number: float | None) -> float | None:
        """A number that the field may have."""
        field = FIELDS[self.what]
        if number is not None and not field.takes(number):
            message = f"{self.what} must be {field.bound}"
            self.add_problem(message, node, accepted=f"numbers {field.bound}")
            return None
        return number


# --- What the section may have ----------------------------------------------------------------------------------------


class ChosenJoints(NamedTuple):
    """Joints by their numbers from 1 or their names, and where each is named; no names stand for all joints."""

    names: tuple[int | str, ...] | None = None
    marks: tuple[Mark, ...] = ()


def _joints(node: Node, field: str, to: Validator) -> ChosenJoints:
    if node.value == ALL and not node.quoted:
        return ChosenJoints()
    nodes = node.value if isinstance(node.value, list) else [node]
    joints: list[int | str] = []
    for entry in nodes:
        value = entry.value
        is_number = isinstance(value, int) and not isinstance(value, bool) and value >= 1
        if not is_number and (not isinstance(value, str) or not value):
            to.add_problem(f"{entry.describe()} is no joint", entry, field, accepted=ACCEPTED_JOINTS)
        else:
            joints.append(value if isinstance(value, int) else str(value))
    if not nodes:
        to.add_problem("no joint is named", node, field, accepted=ACCEPTED_JOINTS)
    return ChosenJoints(tuple(joints), tuple(entry.mark for entry in nodes))


_NUMBER, _PAIR = as_written(NUMBER), as_written(numbers(2))
_SPACING: dict[str, ValueType[Any]] = {"from": _NUMBER, "to": _NUMBER, "points": whole(2, MOST_VALUES)}
_VALUES: JsonSchema = {"type": "array", "items": NUMBER, "minItems": 1}
SPACED: Record[dict[str, Any]] = Record(
    lambda **given: given,
    {
        key: Key(kind, missing=(f"this grid has no {key}", f"{SPACING}, or a list of values"))
        for key, kind in _SPACING.items()
    },
)
NORMAL: Record[dict[str, Node]] = Record(
    lambda **given: given,
    {"mean": Key(_NUMBER)}
    | {
        key: Key(kind, missing=(f"this normal distribution has no {key}", ACCEPTED_NORMAL))
        for key, kind in {"deviation": _NUMBER, "bounds": _PAIR}.items()
    },
)
_LAW_KEYS = {
    "choices": Key(as_written(_VALUES), "one of these, all equally likely"),
    "grid": Key(
        ValueType(lambda node, *_: node, lambda catalog: {"anyOf": [_VALUES, SPACED.schema(catalog)]}),
        "each of these, with each of all other grids",
    ),
    "uniform": Key(_PAIR, "any value of this range"),
    "log-uniform": Key(_PAIR, "any value of this range, all orders of magnitude equally likely"),
    "normal": Key(
        ValueType(lambda node, *_: node, NORMAL.schema),
        "a normal distribution, about the nominal value unless it has a mean, cut at its bounds",
    ),
    "scale": Key(_PAIR, "the nominal value times a factor of this range"),
    "offset": Key(_PAIR, "the nominal value plus a number of this range"),
}
"""How values are drawn. What a law accepts depends on the field, so that a rule reads it when its field is known."""
LAWS = tuple(_LAW_KEYS)


def _rule(field: str, joints: ChosenJoints | None = None, *, mark: Mark, **laws: Node) -> Rule:
    if field == AXES and joints is not None:
        message = "the number of axes is the whole arm's, not a joint's"
        raise ConfigError(Problem(message=message, field="joints", accepted="no `joints`"))
    problems = []
    if field != AXES and joints is None:
        message = "it is not said whose field varies"
        problems.append(Problem(message=message, field="joints", mark=mark, accepted=f"`joints:` {ACCEPTED_JOINTS}"))
    if len(laws) != 1:
        message = "it is not said how it varies" if not laws else f"it varies in {len(laws)} ways at once"
        accepted = f"one of {', '.join(LAWS)}"
        problems.append(Problem(message=message, found=", ".join(laws) or None, accepted=accepted))
    if problems:
        raise ConfigError(problems)
    ((name, node),) = laws.items()
    reader = _LawReader(field, name)
    law = reader.read(name, node)
    if law is None or reader.to.problems:
        raise ConfigError(reader.to.problems)
    names, marks = joints or ChosenJoints()
    return Rule(
        field=field, law=law, joints=names, units=tuple(dict.fromkeys(reader.units)), mark=mark, joint_marks=marks
    )


def _variation(
    name: str = "",
    count: int | None = None,
    seed: int = 0,
    sampling: str = Sampling.RANDOM,
    **given: Any,  # noqa: ANN401 - as it is declared
) -> VariationCall:
    if count is None and not any(isinstance(rule.law, Grid) for rule in given["vary"]):
        message, accepted = "it is not said how many variants there are", "`count: NUMBER`; only a grid needs none"
        raise ConfigError(Problem(message=message, field="count", mark=given["mark"], accepted=accepted))
    return VariationCall(name=name or given["of"], count=count, seed=seed, sampling=Sampling(sampling), **given)


_JOINT = {"type": ["integer", "string"], "minimum": 1, "minLength": 1}
RULE = Record(
    _rule,
    {
        "joints": Key(
            ValueType(_joints, {"anyOf": [_JOINT, {"type": "array", "items": _JOINT, "minItems": 1}]}),
            "of which joints: all, numbers from 1, or names; the number of axes has none",
        ),
        "field": Key(
            word(*FIELDS),
            "what varies",
            missing=("it is not said which field varies", f"`field: NAME`, one of {', '.join(FIELDS)}"),
        ),
        **_LAW_KEYS,
    },
    marks={"mark": ("",)},
    also={
        "oneOf": [{"required": [law]} for law in LAWS],
        "if": {"properties": {"field": {"const": AXES}}, "required": ["field"]},
        "then": {"properties": {"joints": False}},
        "else": {"required": ["joints"]},
    },
)
VARIATIONS = Many(
    Record(
        _variation,
        {
            "name": Key(TEXT, "what the names of the variants begin with; that of the manipulator by default"),
            "of": Key(
                TEXT,
                "the manipulator of this run that is varied",
                missing=("it is not said what is varied", "`of: NAME`, the name of a manipulator of this run"),
            ),
            "count": Key(whole(1, MOST_POINTS), "how many variants; the points of its grids by default"),
            "seed": Key(whole(0, MOST_SEED - 1), "which of all samples"),
            "sampling": Key(word(*Sampling), "how the sample spreads"),
            "vary": Key(Many(RULE, empty=NO_RULE), "what varies", missing=NO_RULE),
        },
        marks={"mark": ("",), "of_mark": ("of",), "count_mark": ("count",)},
    ),
    distinct=Distinct(
        "name",
        "two variations are named {}, and so would be their variants and files",
        "`name: NAME`, another one for each",
        key=lambda name: safe_stem(name).casefold(),
    ),
)
