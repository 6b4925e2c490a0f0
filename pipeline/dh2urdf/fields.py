"""What the fields of records accept, and records that are made without these checks.

Records are made by readers, by plugins and by you. A field of type float accepts everything that is one number
(`numpy.float32`, `Fraction`, `Decimal`, an array of shape ()), and keeps a float; a field of an enum accepts its values
as text; a field of three numbers accepts any sequence of three. Everything else is a `RecordError` that names the
record and the field. The types come from the annotations of the dataclass, so that no field can be forgotten.
"""

from __future__ import annotations

import math
import operator
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Set as AbstractSet
from dataclasses import MISSING, fields, is_dataclass, replace
from enum import Enum
from functools import cache, partial, reduce
from importlib import import_module
from itertools import islice, repeat
from types import NoneType
from typing import TYPE_CHECKING, Any, NoReturn, ParamSpec, TypeVar, cast, get_args, get_origin, get_type_hints

from dh2urdf.errors import RecordTypeError, RecordValueError
from dh2urdf.rotations import IDENTITY, RigidTransform, is_column, nearest_rotation
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import TypeAlias

    Take: TypeAlias = Callable[[Any], Any]

say = Messages(__file__)

WRONG_TYPE = "type-wrong"
"""The code of a value whose type a field does not accept."""

P = ParamSpec("P")
T = TypeVar("T")


def function_of(place: str) -> Callable[..., T]:
    """The function of a higher layer that a method of a record calls, imported when the method is called.

    Args:
        place: its module in the package and its name, such as ``kinematics.pose_arrays.table_pose``.
    """
    module, _, name = place.rpartition(".")
    function: Callable[..., T] = getattr(import_module(f"dh2urdf.{module}"), name)
    return function


NEARLY_ORTHONORMAL = 1e-6
"""Deviation from a rotation that single precision and printing leave; the nearest rotation is kept then."""
EXACTLY_ORTHONORMAL = 1e-12
"""Deviation from a rotation that is rounding; the matrix is kept as it is then."""
_NUMBER = "one finite number in SI units (m, rad, kg, s)"


class Record:
    """A frozen dataclass whose fields are brought to their types when it is made.

    A number may also be a column of `dh2urdf.columns`, and what is not finite is left to the checks of the finished
    robot.

    Raises:
        RecordError: a field does not accept its value; every such field is named.
    """

    __slots__ = ()
    _exact = False

    def __post_init__(self) -> None:
        known: Any = _takes_of
        get, takes, doubtful = known(type(self), exact=self._exact)
        values = get(self)
        kinds = tuple(map(type, values))
        if kinds not in doubtful:  # A robot has a hundred records of a few types: most have no value to look at.
            doubtful[kinds] = [each for each in takes if kinds[each[1]] not in each[2]]
        found: list[tuple[str, RefusedError]] = []
        for name, number, _, take in doubtful[kinds]:
            try:
                taken = take(values[number])
            except RefusedError as refused:
                found.append((name, refused))
            else:
                if taken is not values[number]:
                    object.__setattr__(self, name, taken)
        if found:
            kind = RecordTypeError if any(refused.is_type for _, refused in found) else RecordValueError
            raise kind(_problem(self, name, refused) for name, refused in found)


class ExactRecord(Record):
    """A record that people make: every number must be a single finite one."""

    __slots__ = ()
    _exact = True


def refuse(record: object, field: str, code: str, found: object, **words: Any) -> NoReturn:  # noqa: ANN401 - of a message
    """Refuse a record whose fields contradict each other or the arm that they are to describe.

    Args:
        record: the record.
        field: the field that is named as wrong.
        code: the message; see `dh2urdf.source.Messages`.
        found: the value that was found.
        words: what the message names besides.

    Raises:
        RecordValueError: always.
    """
    raise RecordValueError(_problem(record, field, RefusedError(code, found, **words)))


# --- Records without checks -------------------------------------------------------------------------------------------


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
    defaults, slots, new = {}, [], object.__new__
    for field in fields(record):
        slots.append((field.name, getattr(record, field.name).__set__))
        if field.default is not MISSING:
            defaults[field.name] = field.default

    def make(**values: Any) -> Any:  # noqa: ANN401 - any record
        made = new(record)
        values = defaults | values
        for name, fill in slots:
            fill(made, values[name])
        return made

    return cast("Callable[P, T]", make)


@cache
def _names_of(kind: Any) -> tuple[str, ...]:  # noqa: ANN401 - a dataclass
    return tuple(kind.__dataclass_fields__)


# --- The types of fields ----------------------------------------------------------------------------------------------


class RefusedError(Exception):
    """A value that a field does not accept.

    Attributes:
        problem: what is wrong, without the record and its field.
        inner: the part of the field that is meant, such as ``[2]`` or ``.lower``.
        is_type: whether its type is wrong, not its value.
    """

    def __init__(self, code: str, found: object, **words: Any) -> None:  # noqa: ANN401 - of a message
        self.problem = say(code, found=_text(found), **words)
        self.is_type, self.inner = code == WRONG_TYPE, ""
        super().__init__(self.problem.message)


@cache
def _takes_of(kind: type, *, exact: bool) -> tuple[Take, list[tuple[str, int, list[type], Take]], dict[Any, Any]]:
    """The fields of a class.

    Returns:
        What gets the values of all; the name of each, its number, the types of values that it keeps without a look, and
        what it makes of others; and, by the types of all values, those to look at.
    """
    hints, names = get_type_hints(kind), _names_of(kind)
    get = operator.attrgetter(*names) if len(names) > 1 else lambda record: (getattr(record, names[0]),)
    looked_at = (RigidTransform, float) if exact else (RigidTransform,)
    takes = []
    for number, name in enumerate(names):
        hint = hints[name]
        parts = (get_args(hint) if get_origin(hint) is not tuple else ()) or (hint,)
        types = [each for each in parts if isinstance(each, type) and each not in looked_at]
        kept = [each for each in types if not (exact and _numbers_of(each))]
        takes.append((name, number, kept, _take_of(hint, exact=exact)))
    return get, takes, {}


@cache
def _numbers_of(kind: Any) -> tuple[str, ...]:  # noqa: ANN401 - any type
    """The fields of a record that holds numbers only; none of any other."""
    hints = get_type_hints(kind) if is_dataclass(kind) else {}
    return tuple(hints) if all(float in (hint, *get_args(hint)) for hint in hints.values()) else ()


def _take_of(hint: Any, *, exact: bool) -> Take:  # noqa: ANN401 - a type
    """What a field of an annotated type makes of a value."""
    arguments = get_args(hint)
    if NoneType in arguments:
        take = _take_of(reduce(operator.or_, [part for part in arguments if part is not NoneType]), exact=exact)
        return lambda value: None if value is None else take(value)
    if get_origin(hint) is tuple:
        each = _take_of(arguments[0], exact=exact)
        return partial(_several, each, arguments[0] if arguments[-1] is ... else len(arguments))
    if isinstance(hint, type) and issubclass(hint, Enum):
        return partial(_choice, hint)
    simple: dict[Any, Take] = {int: _whole, str: _word, bool: _truth, RigidTransform: _transform}
    simple[float] = _finite if exact else _number_or_column
    return simple[hint] if hint in simple else partial(_record, hint, _numbers_of(hint) if exact else ())


def as_number(value: Any) -> float:  # noqa: ANN401 - whatever is given
    """The float that one number of any type is; it keeps its value as far as a float can hold it.

    Raises:
        RefusedError: it is none.
    """
    suggestion = None
    if isinstance(value, (str, bytes, bytearray)):
        from_dh = "`dh2urdf.Manipulator.from_dh` reads texts as the cells of a table"
        suggestion = f"write the number without quotes; {from_dh}"
    # numpy turns truth values, moments and complex numbers into floats too.
    elif not isinstance(value, bool) and _kind(value) in "iufO" and not (_shape(value) or hasattr(value, "mask")):
        try:
            return float(value)
        except OverflowError:
            raise RefusedError("number-too-large", value) from None
        except (TypeError, ValueError, ArithmeticError):
            pass  # The refusal below says what it is.
    raise _other_type(value, _NUMBER, suggestion)


def _finite(value: Any) -> float:  # noqa: ANN401 - whatever is given
    number = value if type(value) is float else as_number(value)
    if not math.isfinite(number):
        raise RefusedError("number-infinite", value, number=number)
    return number


def _number_or_column(value: Any) -> Any:  # noqa: ANN401 - a float or an array
    is_many = type(value).__name__ == "ndarray" and value.ndim == 1 and value.dtype == float
    return value if is_many else as_number(value)


def _whole(value: Any) -> int:  # noqa: ANN401 - whatever is given
    number = _finite(value)
    if number != int(number):
        raise RefusedError("number-not-whole", value)
    return int(number)


def _word(value: Any) -> str:  # noqa: ANN401 - whatever is given
    if not isinstance(value, str) or isinstance(value, Enum):
        raise _other_type(value, "text (str)")
    return str.__str__(value)


def _truth(value: Any) -> bool:  # noqa: ANN401 - whatever is given
    if _kind(value) != "b" or _shape(value):
        raise _other_type(value, "True or False")
    return bool(value)


def _choice(kind: type[Enum], value: Any) -> Enum:  # noqa: ANN401 - whatever is given
    words = {member.value: member for member in kind}
    *others, last = words
    accepted = f"{', '.join(others)} or {last}, as text or as a dh2urdf.{kind.__name__}"
    if not isinstance(value, str) or isinstance(value, Enum):
        raise _other_type(value, accepted)
    if (word := value.strip().lower()) in words:
        return words[word]
    near = did_you_mean(value, words)
    raise RefusedError("word-unknown", value, word=value, kind=kind.__name__, accepted=accepted, suggestion=near)


def _record(kind: Any, numbers: tuple[str, ...], value: Any) -> Any:  # noqa: ANN401 - a dataclass, or a union of some
    if not isinstance(value, kind):
        name = " or ".join(part.__name__ for part in get_args(kind) or (kind,))
        raise _other_type(value, f"a {name}")
    for field in numbers:
        if getattr(value, field) is not None:
            _part(value, field, _finite)
    return value


def _several(each: Take, count: int | type, value: Any) -> tuple[Any, ...]:  # noqa: ANN401 - whatever is given
    """So many values in an order, or any number of one type."""
    if isinstance(count, type):
        if type(value) is tuple and set(map(type, value)) <= {count}:
            return value
        return _each(each, _items(value, f"records of type {count.__name__}, in a list or a tuple"))
    if type(value) is tuple and tuple(map(type, value)) == (float,) * count and math.isfinite(sum(value)):
        return value
    accepted = f"{count} values in a list, a tuple or an array of shape ({count},)"
    items = _items(value, accepted)
    if len(items) != count:
        raise RefusedError("count-of-values", value, count=len(items), accepted=accepted)
    return _each(each, items)


def _items(value: Any, accepted: str) -> tuple[Any, ...]:  # noqa: ANN401 - whatever is given
    """The items of a value that has them in an order."""
    unordered = isinstance(value, (str, bytes, bytearray, Mapping, AbstractSet)) or not isinstance(value, Iterable)
    if unordered or (hasattr(value, "shape") and not _shape(value)) or hasattr(value, "mask"):
        raise _other_type(value, accepted)
    return tuple(value)


def _each(take: Take, items: tuple[Any, ...]) -> tuple[Any, ...]:
    taken = []
    for item in items:
        try:
            taken.append(take(item))
        except RefusedError as refused:
            refused.inner = f"[{len(taken)}]{refused.inner}"
            raise
    return items if all(map(operator.is_, taken, items)) else tuple(taken)


def _transform(value: Any) -> RigidTransform:  # noqa: ANN401 - whatever is given
    """A rigid transform, or the one that a homogeneous 4x4 matrix is."""
    is_identity = value is IDENTITY  # not in the condition, where mypy takes it for any value
    if is_identity:
        return IDENTITY
    if isinstance(value, RigidTransform):
        elements = _part(value, "rotation", partial(_matrix, 3))
        translation = _part(value, "translation", partial(_several, _finite, 3))
    else:
        matrix = _matrix(4, value)
        if matrix[12:] != (0.0, 0.0, 0.0, 1.0):
            raise RefusedError("last-row-of-matrix", value, row=f"{[*matrix[12:]]}")
        elements, translation = (*matrix[0:3], *matrix[4:7], *matrix[8:11]), matrix[3:12:4]
    rotation, deviation = nearest_rotation(elements)
    if not deviation <= NEARLY_ORTHONORMAL:
        raise RefusedError("matrix-no-rotation", value, deviation=deviation)
    taken = RigidTransform(elements if deviation <= EXACTLY_ORTHONORMAL else rotation, translation)
    is_kept = isinstance(value, RigidTransform) and all(map(operator.is_, taken, value))
    kept: RigidTransform = value if is_kept else taken
    return kept


def _part(value: Any, name: str, take: Take) -> Any:  # noqa: ANN401 - a part of a record
    try:
        return take(getattr(value, name))
    except RefusedError as refused:
        refused.inner = f".{name}{refused.inner}"
        raise


def _matrix(side: int, value: Any) -> tuple[float, ...]:  # noqa: ANN401 - whatever is given
    """The elements of a square matrix row by row, which may be given so."""
    accepted = f"a matrix of shape ({side}, {side}), row by row"
    items = _items(value, accepted)
    if len(items) == side:
        rows = [_items(row, accepted) for row in items]
        items = tuple([element for row in rows if len(row) == side for element in row])
    if len(items) != side * side:
        raise RefusedError("matrix-of-other-shape", value, accepted=accepted)
    return _each(_finite, items)


# --- Messages ---------------------------------------------------------------------------------------------------------


def _problem(record: Any, name: str, refused: RefusedError) -> Problem:  # noqa: ANN401 - any dataclass
    given = {word: getattr(record, word, None) for word in ("joint", "name", "mark")}
    joint, robot = (word if isinstance(word, str) else None for word in (given["joint"], given["name"]))
    own = Mark(file=f"{type(record).__name__}()")
    mark = given["mark"] if isinstance(given["mark"], Mark) else own
    return replace(refused.problem, mark=mark, robot=robot, joint=joint, field=name + refused.inner)


def _kind(value: Any) -> str:  # noqa: ANN401 - whatever is given
    """The letter of numpy for what a value holds; b for a truth value, O for other objects."""
    return "b" if isinstance(value, bool) else str(getattr(getattr(value, "dtype", None), "kind", "O"))


def _shape(value: Any) -> tuple[int, ...]:  # noqa: ANN401 - whatever is given
    """The shape of an array, whichever library made it; () for a single number."""
    return tuple(getattr(value, "shape", ()))


def _other_type(value: Any, accepted: str, suggestion: str | None = None) -> RefusedError:  # noqa: ANN401 - whatever is given
    kind, shape = type(value), _shape(value)
    name = kind.__name__ if kind.__module__ == "builtins" else f"{kind.__module__.partition('.')[0]}.{kind.__name__}"
    shaped = f" and shape {shape}" if shape else ""
    return RefusedError(WRONG_TYPE, value, type=name, shape=shaped, accepted=accepted, suggestion=suggestion)


def _text(value: object) -> str:
    try:
        return shown(repr(value))[1:-1]
    except Exception as error:  # noqa: BLE001 - a stranger's __repr__ may raise anything
        return f"an object whose repr raises {type(error).__name__}"
