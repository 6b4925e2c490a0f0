"""What the fields of a record accept: whatever surely is a number, a word or a sequence of the field's type.

Records are made by readers, by plugins and by you. A field of type float accepts everything that is one number
(`numpy.float32`, `Fraction`, `Decimal`, an array of shape ()), and keeps a float; a field of an enum accepts its values
as text; a field of three numbers accepts any sequence of three. Everything else is a `RecordError` that names the
record and the field. The types come from the annotations of the dataclass, so that no field can be forgotten.
"""

from __future__ import annotations

import operator
from collections import deque
from dataclasses import MISSING, fields, is_dataclass
from functools import cache
from itertools import islice, repeat
from typing import (
    TYPE_CHECKING,
    Any,
    NoReturn,
    ParamSpec,
    TypeVar,
    cast,
)

from dh2urdf.elementwise import is_column
from dh2urdf.errors import RecordTypeError, RecordValueError
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.source import Mark, Problem
from dh2urdf.validation.field_types import RefusedError, hints_of, number_of, settled, take_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    Take = Callable[[Any], Any]

P = ParamSpec("P")
T = TypeVar("T")


def take_fields(record: Any) -> None:  # noqa: ANN401 - any dataclass
    """Bring the fields of a frozen record to their types: the `__post_init__` of its class.

    A number may also be a column of `dh2urdf.columns`, and what is not finite is left to the checks of the finished
    robot.

    Raises:
        RecordError: a field does not accept its value; every such field is named.
    """
    kind: Any = type(record)
    _take(record, _fields_of(kind))


def take_exact_fields(record: Any) -> None:  # noqa: ANN401 - any dataclass
    """As `take_fields`, for records that people make: every number must be a single finite one.

    Raises:
        RecordError: a field does not accept its value; every such field is named.
    """
    kind: Any = type(record)
    _take(record, _exact_fields_of(kind))


def _take(record: object, known: _Fields) -> None:
    values = known.get(record)
    kinds = tuple(map(type, values))
    doubtful = known.doubtful.get(kinds)
    if doubtful is None:
        doubtful = known.doubtful[kinds] = tuple(
            [each for each in known.fields if kinds[each.number] not in each.settled]
        )
    found: list[tuple[str, RefusedError]] = []
    for name, number, take, _ in doubtful:
        try:
            taken = take(values[number])
        except RefusedError as refused:
            found.append((name, refused))
        else:
            if taken is not values[number]:
                object.__setattr__(record, name, taken)
    if found:
        kind = RecordTypeError if any(refused.is_type for _, refused in found) else RecordValueError
        raise kind(_problem(record, name, refused) for name, refused in found)


def refuse(
    record: object, field: str, message: str, *, found: object, accepted: str, suggestion: str | None = None
) -> NoReturn:
    """Refuse a record whose fields contradict each other or the arm that they are to describe.

    Raises:
        RecordValueError: always.
    """
    refused = RefusedError(message, found, accepted, suggestion=suggestion)
    raise RecordValueError(_problem(record, field, refused))


def replace_unchecked(record: T, **changes: Any) -> T:  # noqa: ANN401 - whatever the fields are to hold
    """`dataclasses.replace` for this package's own use: the changes are taken as they are, columns of numbers too."""
    kind: Any = type(record)
    made: T = object.__new__(kind)
    for name in _names_of(kind):
        object.__setattr__(made, name, changes[name] if name in changes else getattr(record, name))
    return made


def many_unchecked(model: T, count: int, **changes: Iterable[Any]) -> list[T]:
    """Many records like another one, as `replace_unchecked` makes one.

    They are filled field by field and not record by record, which takes a fifth of the time.

    Args:
        model: what they are like.
        count: how many.
        changes: of some fields the value in each.
    """
    kind: Any = type(model)
    made: list[Any] = list(map(object.__new__, repeat(kind, count)))
    for name in _names_of(kind):
        values = changes[name] if name in changes else repeat(getattr(model, name))
        deque(map(getattr(kind, name).__set__, made, values), maxlen=0)
    return made


def members_of(record: Any, members: Sequence[int]) -> dict[str, list[Any]]:  # noqa: ANN401 - any record
    """The fields of a record that hold columns of `dh2urdf.columns`, with the value of each for some members."""
    kind: Any = type(record)
    found = {name: _entries(getattr(record, name), members) for name in _names_of(kind)}
    return {name: entries for name, entries in found.items() if entries is not None}


def _entries(value: Any, members: Sequence[int]) -> list[Any] | None:  # noqa: ANN401 - whatever a field holds
    """A value for each of some members; None where there is no column in it."""
    if is_column(value):
        numbers: list[float] = value[members].tolist()
        return numbers
    if isinstance(value, tuple):
        parts = [_entries(item, members) for item in value]
        if all(part is None for part in parts):
            return None
        columns = [repeat(item) if part is None else part for item, part in zip(value, parts, strict=True)]
        entries = list(islice(zip(*columns, strict=False), len(members)))
        return [type(value)(*entry) for entry in entries] if hasattr(value, "_fields") else entries
    if is_dataclass(value) and (changed := members_of(value, members)):
        return many_unchecked(value, len(members), **changed)
    return None


def unchecked(kind: Callable[P, T]) -> Callable[P, T]:
    """The constructor of a record for this package's own use: its values are kept as they are.

    The caller has made the values itself, of numbers that were checked. A robot has more than a hundred records,
    and their checks would take a third of the time that it takes to make them.
    """
    record: Any = kind
    defaults = {field.name: field.default for field in fields(record) if field.default is not MISSING}
    slots = [(name, getattr(record, name).__set__) for name in _names_of(record)]
    new = object.__new__

    def make(**values: Any) -> Any:  # noqa: ANN401 - any record
        made = new(record)
        values = defaults | values
        for name, fill in slots:
            fill(made, values[name])
        return made

    return cast("Callable[P, T]", make)


def as_number(value: Any) -> float:  # noqa: ANN401 - whatever is given
    """The float that one number of any type is.

    Raises:
        RecordTypeError: it is none.
    """
    try:
        return number_of(value)
    except RefusedError as refused:
        problem = Problem(message=refused.message, found=refused.found, accepted=refused.accepted)
        raise RecordTypeError(problem) from None


@cache
def _names_of(kind: type) -> tuple[str, ...]:
    return tuple(field.name for field in fields(kind))


def _problem(record: Any, name: str, refused: RefusedError) -> Problem:  # noqa: ANN401 - any dataclass
    joint, robot = getattr(record, "joint", None), getattr(record, "name", None)
    return Problem(
        message=refused.message,
        mark=mark
        if isinstance(mark := getattr(record, "mark", None), Mark)
        else Mark(file=f"{type(record).__name__}()"),
        robot=robot if isinstance(robot, str) else None,
        joint=joint if isinstance(joint, str) else None,
        field=name + refused.inner,
        found=refused.found,
        accepted=refused.accepted,
        suggestion=refused.suggestion,
    )


# --- The fields of a class -------------------------------------------------------------------------------------------


class _RecordField(NamedTuple):
    """A field of a record.

    Attributes:
        name: its name.
        number: its place among the fields, from 0.
        take: what it makes of a value.
        settled: the types of values that it keeps as they are.
    """

    name: str
    number: int
    take: Take
    settled: frozenset[type]


class _Fields(NamedTuple):
    """The fields of a class.

    Attributes:
        get: their values in a record.
        fields: all of them.
        doubtful: by the types of all values, those whose values have to be looked at: the types do not settle them.
    """

    get: Callable[[Any], tuple[Any, ...]]
    fields: tuple[_RecordField, ...]
    doubtful: dict[tuple[type, ...], tuple[_RecordField, ...]]


@cache
def _fields_of(kind: type, *, exact: bool = False) -> _Fields:
    hints, names = hints_of(kind), _names_of(kind)
    get = operator.attrgetter(*names)
    made = []
    for number, name in enumerate(names):
        take = take_of(hints[name], exact=exact)
        made.append(_RecordField(name, number, take, frozenset(settled(hints[name], exact=exact))))
    return _Fields(get if len(names) > 1 else lambda record: (get(record),), tuple(made), {})


@cache
def _exact_fields_of(kind: type) -> _Fields:
    return _fields_of(kind, exact=True)
