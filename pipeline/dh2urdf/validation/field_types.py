"""The values that a field of some type accepts, and what it makes of them.

A type is that of an annotation: a number, a word, a truth value, an enum, a record, a sequence of these, a transform.
"""

from __future__ import annotations

import math
import operator
import sys
from collections.abc import Iterable, Mapping, Set as AbstractSet
from dataclasses import is_dataclass
from enum import Enum
from functools import cache, reduce
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Any, get_args, get_origin, get_type_hints

from dh2urdf.rotations import IDENTITY, RigidTransform, nearest_rotation
from dh2urdf.source import did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    Take = Callable[[Any], Any]

NEARLY_ORTHONORMAL = 1e-6
"""Deviation from a rotation that single precision and printing leave; the nearest rotation is kept then."""
EXACTLY_ORTHONORMAL = 1e-12
"""Deviation from a rotation that is rounding; the matrix is kept as it is then."""
_NUMBER = "one finite number in SI units (m, rad, kg, s)"


class RefusedError(Exception):
    """A value that a field does not accept.

    Attributes:
        message: what it is, as a sentence.
        found: the value as text.
        accepted: what the field accepts.
        suggestion: what to do.
        inner: the part of the field that is meant, such as ``[2]`` or ``.lower``.
        is_type: whether its type is wrong, not its value.
    """

    def __init__(
        self,
        message: str,
        found: object,
        accepted: str,
        *,
        suggestion: str | None = None,
        inner: str = "",
        is_type: bool = True,
    ) -> None:
        self.message, self.found, self.accepted, self.suggestion = message, _text(found), accepted, suggestion
        self.inner, self.is_type = inner, is_type
        super().__init__(message)

    def inside(self, part: str) -> RefusedError:
        """The same of a field that has this part."""
        self.inner = part + self.inner
        return self


# --- Types


def settled(hint: Any, *, exact: bool) -> Iterator[type]:  # noqa: ANN401 - a type
    """The types whose values a field keeps without a look at them."""
    if isinstance(hint, UnionType):
        for part in get_args(hint):
            yield from settled(part, exact=exact)
    elif isinstance(hint, type) and hint is not RigidTransform and not (exact and (hint is float or numbers_of(hint))):
        yield hint


@cache
def hints_of(kind: Any) -> dict[str, Any]:  # noqa: ANN401 - a dataclass
    """The types of the fields of a record, as `typing.get_type_hints` has them.

    Here all annotations of a class are compiled at once, in a third of the time.
    """
    hints: dict[str, Any] = {}
    for base in reversed(kind.__mro__):
        texts = vars(base).get("__annotations__")
        if not texts:
            continue
        if not all(isinstance(text, str) for text in texts.values()):
            return get_type_hints(kind)
        code = f"({''.join(f'{text}, ' for text in texts.values())})"
        hints.update(zip(texts, eval(code, vars(sys.modules[base.__module__])), strict=True))  # noqa: S307 - our own code
    return hints


@cache
def numbers_of(kind: Any) -> tuple[str, ...]:  # noqa: ANN401 - any type
    """The fields of a record that holds numbers only; none of any other."""
    is_record: bool = is_dataclass(kind)
    hints = hints_of(kind) if is_record else {}
    return tuple(hints) if all(float in (hint, *get_args(hint)) for hint in hints.values()) else ()


def take_of(hint: Any, *, exact: bool) -> Take:  # noqa: ANN401 - a type
    """What a field of an annotated type accepts."""
    arguments = get_args(hint)
    if NoneType in arguments:
        others = [argument for argument in arguments if argument is not NoneType]
        return _optional(take_of(reduce(operator.or_, others), exact=exact))
    if get_origin(hint) is tuple:
        each = take_of(arguments[0], exact=exact)
        return _many(each, arguments[0]) if arguments[-1] is Ellipsis else _several(each, len(arguments))
    if isinstance(hint, type) and issubclass(hint, Enum):
        return _choice(hint)
    simple: dict[Any, Take] = {int: _whole, str: _word, bool: _truth, RigidTransform: _transform}
    simple[float] = _finite if exact else _number_or_column
    return simple[hint] if hint in simple else _record(hint, exact=exact)


def _optional(take: Take) -> Take:
    return lambda value: None if value is None else take(value)


# --- Numbers and words


def _finite(value: Any) -> float:  # noqa: ANN401 - whatever is given
    number = value if type(value) is float else number_of(value)
    if not math.isfinite(number):
        raise RefusedError(f"{number} is not a finite number", value, _NUMBER, is_type=False)
    return number


def _number_or_column(value: Any) -> Any:  # noqa: ANN401 - a float or an array
    return value if type(value) is float or _is_column(value) else number_of(value)


def _is_column(value: Any) -> bool:  # noqa: ANN401 - whatever is given
    """Whether a value is a number for each of many arms, as `dh2urdf.columns` makes them."""
    return type(value).__name__ == "ndarray" and value.ndim == 1 and value.dtype == float


def number_of(value: Any) -> float:  # noqa: ANN401 - whatever is given
    """The float that one number of any type is; it keeps its value as far as a float can hold it."""
    suggestion = None
    if isinstance(value, (str, bytes, bytearray)):
        suggestion = (
            "write the number without quotes; `dh2urdf.Manipulator.from_dh` reads texts as the cells of a table"
        )
    # numpy turns truth values, moments and complex numbers into floats too.
    elif not isinstance(value, bool) and _kind(value) in "iufO" and not (_shape(value) or hasattr(value, "mask")):
        try:
            return float(value)
        except OverflowError:
            raise RefusedError("the number is too large for a float", value, _NUMBER, is_type=False) from None
        except (TypeError, ValueError, ArithmeticError):
            pass  # The refusal below says what it is.
    raise RefusedError(_is_a(value), value, _NUMBER, suggestion=suggestion)


def _kind(value: Any) -> str:  # noqa: ANN401 - whatever is given
    """The letter of numpy for what an array or a scalar holds; O for other objects."""
    return str(getattr(getattr(value, "dtype", None), "kind", "O"))


def _shape(value: Any) -> tuple[int, ...]:  # noqa: ANN401 - whatever is given
    """The shape of an array, whichever library made it; () for a single number."""
    return tuple(getattr(value, "shape", ()))


def _whole(value: Any) -> int:  # noqa: ANN401 - whatever is given
    if type(value) is int:
        return value
    number = _finite(value)
    if number != int(number):
        raise RefusedError(f"{_text(value)} is not a whole number", value, "a whole number", is_type=False)
    return int(number)


def _word(value: Any) -> str:  # noqa: ANN401 - whatever is given
    if type(value) is str:
        return value
    if isinstance(value, str) and not isinstance(value, Enum):
        return str.__str__(value)
    raise RefusedError(_is_a(value), value, "text (str)")


def _truth(value: Any) -> bool:  # noqa: ANN401 - whatever is given
    if isinstance(value, bool):
        return value
    if _kind(value) == "b" and not _shape(value):
        return bool(value)
    raise RefusedError(_is_a(value), value, "True or False")


def _choice(kind: type[Enum]) -> Take:
    words = {member.value: member for member in kind}
    *others, last = words
    accepted = f"{', '.join(others)} or {last}, as text or as a dh2urdf.{kind.__name__}"

    def take(value: Any) -> Enum:  # noqa: ANN401 - whatever is given
        if type(value) is kind:
            return value
        if not isinstance(value, str) or isinstance(value, Enum):
            raise RefusedError(_is_a(value), value, accepted)
        word = value.strip().lower()
        if word not in words:
            near = did_you_mean(value, words)
            raise RefusedError(f"{shown(value)} is no {kind.__name__}", value, accepted, suggestion=near, is_type=False)
        return words[word]

    return take


# --- Records and sequences


def _record(kind: Any, *, exact: bool) -> Take:  # noqa: ANN401 - a dataclass, or a union of some
    name = " or ".join(part.__name__ for part in get_args(kind) or (kind,))
    numbers = numbers_of(kind) if exact else ()

    def take(value: Any) -> Any:  # noqa: ANN401 - whatever is given
        if not isinstance(value, kind):
            raise RefusedError(_is_a(value), value, f"a {name}")
        for field in numbers:
            if getattr(value, field) is not None:
                _part(value, field, _finite)
        return value

    return take


def _several(each: Take, count: int) -> Take:
    accepted = f"{count} values in a list, a tuple or an array of shape ({count},)"
    floats = (float,) * count

    def take(value: Any) -> tuple[Any, ...]:  # noqa: ANN401 - whatever is given
        if type(value) is tuple and tuple(map(type, value)) == floats and math.isfinite(sum(value)):
            return value
        items = _items(value, accepted)
        if len(items) != count:
            raise RefusedError(f"the number of values is {len(items)}", value, accepted, is_type=False)
        return _each(each, items)

    return take


def _many(each: Take, kind: type) -> Take:
    def take(value: Any) -> tuple[Any, ...]:  # noqa: ANN401 - whatever is given
        if type(value) is tuple and set(map(type, value)) <= {kind}:
            return value
        return _each(each, _items(value, f"records of type {kind.__name__}, in a list or a tuple"))

    return take


def _items(value: Any, accepted: str) -> tuple[Any, ...]:  # noqa: ANN401 - whatever is given
    """The items of a value that has them in an order."""
    if type(value) is tuple:
        return value
    unordered = isinstance(value, (str, bytes, bytearray, Mapping, AbstractSet)) or not isinstance(value, Iterable)
    if unordered or (hasattr(value, "shape") and not _shape(value)) or hasattr(value, "mask"):
        raise RefusedError(_is_a(value), value, accepted)
    return tuple(value)


def _each(take: Take, items: tuple[Any, ...]) -> tuple[Any, ...]:
    taken = []
    for item in items:
        try:
            taken.append(take(item))
        except RefusedError as refused:
            raise refused.inside(f"[{len(taken)}]") from None
    return items if all(map(operator.is_, taken, items)) else tuple(taken)


def _transform(value: Any) -> RigidTransform:  # noqa: ANN401 - whatever is given
    """A rigid transform, or the one that a homogeneous 4x4 matrix is."""
    is_identity = value is IDENTITY
    if is_identity:
        return IDENTITY
    if isinstance(value, RigidTransform):
        elements = _part(value, "rotation", lambda rotation: _matrix(rotation, 3))
        translation = _part(value, "translation", _several(_finite, 3))
    else:
        matrix = _matrix(value, 4)
        if matrix[12:] != (0.0, 0.0, 0.0, 1.0):
            message = f"the last row of the matrix is {list(matrix[12:])}"
            raise RefusedError(message, value, "0, 0, 0, 1 in the last row", is_type=False)
        elements, translation = (*matrix[0:3], *matrix[4:7], *matrix[8:11]), matrix[3:12:4]
    rotation, deviation = nearest_rotation(elements)
    if not deviation <= NEARLY_ORTHONORMAL:
        message = f"the matrix is no rotation: |RᵀR − 1| is {deviation:.3g}, so that it stretches, skews or mirrors"
        raise RefusedError(message, value, "axes of length 1, square to each other and right-handed", is_type=False)
    taken = RigidTransform(elements if deviation <= EXACTLY_ORTHONORMAL else rotation, translation)
    kept: RigidTransform = (
        value if all(map(operator.is_, taken, value)) and isinstance(value, RigidTransform) else taken
    )
    return kept


def _part(value: Any, name: str, take: Take) -> Any:  # noqa: ANN401 - a part of a record
    try:
        return take(getattr(value, name))
    except RefusedError as refused:
        raise refused.inside(f".{name}") from None


def _matrix(value: Any, side: int) -> tuple[float, ...]:  # noqa: ANN401 - whatever is given
    """The elements of a square matrix row by row, which may be given so."""
    accepted = f"a matrix of shape ({side}, {side}), row by row"
    items = _items(value, accepted)
    if len(items) == side:
        rows = [_items(row, accepted) for row in items]
        items = tuple([element for row in rows if len(row) == side for element in row])
    if len(items) != side * side:
        raise RefusedError("the matrix has another shape", value, accepted, is_type=False)
    return _each(_finite, items)


# --- Words of messages


def _is_a(value: Any) -> str:  # noqa: ANN401 - whatever is given
    kind, shape = type(value), _shape(value)
    name = kind.__name__ if kind.__module__ == "builtins" else f"{kind.__module__.partition('.')[0]}.{kind.__name__}"
    return f"{_text(value)} is of type {name}" + (f" and shape {shape}" if shape else "")


def _text(value: object) -> str:
    try:
        return shown(repr(value))[1:-1]
    except Exception as error:  # noqa: BLE001 - a stranger's __repr__ may raise anything
        return f"an object whose repr raises {type(error).__name__}"
