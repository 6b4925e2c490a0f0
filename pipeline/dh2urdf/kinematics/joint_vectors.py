"""Joint vectors as people give them, by position or by the names of the joints, as one array for each joint.

A joint vector that is not surely meant is a `RecordError`: another number of values, an unknown or a missing name,
text, truth values, and numbers that are not finite, which are named with their joint.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import RecordTypeError, RecordValueError
from dh2urdf.source import Mark, Problem, did_you_mean, listed, shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    Values = NDArray[np.float64]


class JointNames(NamedTuple):
    """The joints that a joint vector may speak of.

    Attributes:
        wanted: the joints that have an entry of the vector, in order.
        moving: the joints whose values are asked for, in order; the others of `wanted` are fixed, and their entry is 0.
        known: further joints, which may be named although they are not asked for.
        fixed: joints that have no value at all.
        whose: what has the joints, for messages: ``manipulator 'ur5'``.
        function: what was called, for messages: ``Manipulator.fk()``.
    """

    wanted: tuple[str, ...]
    moving: tuple[str, ...]
    known: tuple[str, ...] = ()
    fixed: tuple[str, ...] = ()
    whose: str = "the arm"
    function: str = "fk()"


def joint_values(q: Any, names: JointNames) -> tuple[list[Any], tuple[int, ...]]:  # noqa: ANN401 - whatever is given
    """The values of each moving joint [rad or m], and the shape that all of them have.

    Args:
        q: joint vectors of shape (..., n); or by the names of the joints a number or an array for each, as a mapping, a
            DataFrame, a Series or a structured array.
        names: the joints.

    Returns:
        For each of the joints `names.moving` an array of shape (...), or a float where that is (); and that shape.

    Raises:
        RecordTypeError: something is no number.
        RecordValueError: the number of values, a name or a value is wrong.
    """
    import numpy as np

    named = _by_name(q)
    if named is None:
        vectors = _numbers(q, names, None)
        if vectors.ndim == 0:
            raise _refused(names, "a single number is no joint vector", found=q, accepted="[q], even of one joint")
        if vectors.shape[-1] != len(names.wanted):
            kind = "moving joints" if names.wanted == names.moving else "joints"
            message = f"{names.whose} has {len(names.wanted)} {kind}, the joint vector has {vectors.shape[-1]} entries"
            message += f" (the array has the shape {vectors.shape})" if vectors.ndim > 1 else ""
            accepted = f"{len(names.wanted)} values in the last axis: {_listed(names.wanted)}"
            raise _refused(names, message, accepted=accepted)
        values = {name: vectors[..., index] for index, name in enumerate(names.wanted)}
        shape = vectors.shape[:-1]
    else:
        _check_names(named, names)
        values = {name: _numbers(value, names, name) for name, value in named.items()}
        try:
            shape = np.broadcast_shapes(*(value.shape for value in values.values()))
        except ValueError:
            shapes = ", ".join(f"{name} {value.shape}" for name, value in values.items())
            message = f"the values have shapes that do not go together: {shapes}"
            raise _refused(names, message, accepted="one shape") from None
    for name, value in values.items():
        if not (finite := np.isfinite(value)).all():
            place = tuple(int(index) for index in np.argwhere(~finite)[0])
            where = f" at index {list(place)}" if place else ""
            message = f"the value of the joint {shown(name)} is {float(value[place])}{where}"
            raise _refused(names, message, joint=name, accepted="a finite number in rad or m")
        if name in names.wanted and name not in names.moving and value.any():
            message = f"the joint {shown(name)} is fixed, and its value is {float(value[value != 0].flat[0])}"
            raise _refused(names, message, joint=name, accepted="0")
    if not shape:  # Of floats the kinematics are exact at quarter turns.
        return [float(values[name]) for name in names.moving], shape
    return [np.broadcast_to(values[name], shape) for name in names.moving], shape


def _by_name(q: Any) -> dict[str, Any] | None:  # noqa: ANN401 - whatever is given
    """The values by the names of the joints; None where they are given by position."""
    if isinstance(q, Mapping):
        return dict(q)
    if fields := getattr(getattr(q, "dtype", None), "names", None):  # a structured array
        return {name: q[name] for name in fields}
    # A DataFrame or a Series of pandas has labels; where these are words, their order is not that of the joints.
    labels = getattr(q, "columns", getattr(q, "index", None))
    if labels is None or callable(labels) or not any(isinstance(label, str) for label in labels):
        return None
    return dict(q.items())


def _check_names(named: Mapping[Any, Any], names: JointNames) -> None:
    allowed = (*names.wanted, *names.known)
    for name in named:
        if name not in allowed:
            near = did_you_mean(name, allowed) if isinstance(name, str) else None
            message = f"{names.whose} has no joint {shown(str(name))}"
            if name in names.fixed:
                message = f"the joint {shown(name)} is fixed and has no value"
            raise _refused(names, message, found=name, accepted=_listed(allowed), suggestion=near)
    # The value of a fixed joint is known.
    if missing := [name for name in names.moving if name not in named]:
        message = f"there is no value of the joint{'s' if len(missing) > 1 else ''} {_listed(missing)}"
        raise _refused(names, message, accepted=f"a value for each of {_listed(names.moving)}")


def _numbers(value: Any, names: JointNames, name: str | None) -> Values:  # noqa: ANN401 - whatever is given
    """Numbers of any type as an array of floats."""
    import numpy as np

    what = f"the value of the joint {shown(name)}" if name else "the joint vector"
    if np.ma.is_masked(value):
        accepted = "a number in every entry"
        raise _refused(names, f"{what} has masked entries", joint=name, accepted=accepted, is_type=True)
    try:
        array = np.asarray(value)
    except ValueError:
        message, accepted = f"{what} has rows of different lengths", "an array of shape (..., n)"
        raise _refused(names, message, joint=name, accepted=accepted) from None
    items = array.flat if array.dtype.kind == "O" else _items(value)
    odd = [item for item in items if item is None or isinstance(item, (bool, str, bytes))]
    if not odd and array.dtype.kind in "iufO":
        with suppress(TypeError, ValueError, ArithmeticError):  # The refusal below says what it is.
            return np.asarray(array, dtype=float)
    found = f"{odd[0]!r}, of type {type(odd[0]).__name__}" if odd else f"values of type {array.dtype}"
    message = f"{what} is not made of numbers: it holds {found}"
    raise _refused(names, message, joint=name, accepted="numbers", is_type=True)


def _items(value: Any) -> Sequence[Any]:  # noqa: ANN401 - whatever is given
    """The items that numpy would turn into numbers of one type, without a word."""
    if isinstance(value, (list, tuple)):
        return value if not value or not isinstance(value[0], (list, tuple)) else value[0]
    return (value,) if isinstance(value, (bool, str, bytes)) else ()


def _listed(names: Sequence[str]) -> str:
    return listed(names, 12) or "none"


def _refused(
    names: JointNames,
    message: str,
    *,
    accepted: str,
    joint: str | None = None,
    found: object = None,
    suggestion: str | None = None,
    is_type: bool = False,
) -> RecordTypeError | RecordValueError:
    problem = Problem(
        message=message,
        mark=Mark(file=names.function),
        joint=joint,
        field="q",
        found=None if found is None else str(found),
        accepted=accepted,
        suggestion=suggestion,
    )
    return (RecordTypeError if is_type else RecordValueError)(problem)
