"""Joint vectors as people give them, by position or by the names of the joints, as one array for each joint.

A joint vector that is not surely meant is a `RecordError`: another number of values, an unknown or a missing name,
text, truth values, and numbers that are not finite, which are named with their joint.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import RecordTypeError, RecordValueError
from dh2urdf.source import Mark, Messages, did_you_mean, listed, shown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Values = NDArray[np.float64]

say = Messages(__file__)


class JointNames(NamedTuple):
    """The joints that a joint vector may speak of."""

    wanted: tuple[str, ...]  # the joints that have an entry of the vector, in order
    # the joints whose values are asked for, in order; the others of `wanted` are fixed, and their entry is 0
    moving: tuple[str, ...]
    known: tuple[str, ...] = ()  # further joints, which may be named although they are not asked for
    whose: str = "the arm"  # what has the joints, for messages: ``manipulator 'ur5'``
    function: str = "fk()"  # what was called, for messages: ``Manipulator.fk()``

    def refused(self, code: str, kind: type[Any] = RecordValueError, **about: Any) -> Exception:  # noqa: ANN401 - of a message
        """The error that refuses a joint vector."""
        error: Exception = kind(say(code, Mark(file=self.function), field="q", whose=self.whose, **about))
        return error


def joint_values(q: Any, names: JointNames) -> tuple[list[Any], tuple[int, ...]]:  # noqa: ANN401 - whatever is given
    """The values of each of the joints `names.moving` [rad or m], and the shape (...) that all of them have.

    Joint vectors are of shape (..., n); or there is by the name of a joint a number or an array: in a mapping, a
    DataFrame, a Series or a structured array. Of joint vectors of shape () the values are floats.

    Raises:
        RecordTypeError: something is no number.
        RecordValueError: the number of values, a name or a value is wrong.
    """
    import numpy as np

    named = _by_name(q)
    values = _by_position(_numbers(q, names, None), names) if named is None else _named(named, names)
    try:
        shape = np.broadcast_shapes(*(value.shape for value in values.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {value.shape}" for name, value in values.items())
        raise names.refused("values-of-other-shapes", shapes=shapes) from None
    for name, value in values.items():
        if not (finite := np.isfinite(value)).all():
            place = tuple(int(index) for index in np.argwhere(~finite)[0])
            index = f" at index {list(place)}" if place else ""
            raise names.refused("joint-value-infinite", joint=name, value=float(value[place]), index=index)
        if name in names.wanted and name not in names.moving and value.any():
            raise names.refused("joint-fixed", joint=name, value=float(value[value != 0].flat[0]))
    if not shape:  # Of floats the kinematics are exact at quarter turns.
        return [float(values[name]) for name in names.moving], shape
    return [np.broadcast_to(values[name], shape) for name in names.moving], shape


def _by_name(q: Any) -> dict[Any, Any] | None:  # noqa: ANN401 - whatever is given
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


def _by_position(vectors: Values, names: JointNames) -> dict[str, Values]:
    if vectors.ndim == 0:
        raise names.refused("not-a-joint-vector", found=str(vectors))
    if vectors.shape[-1] != len(names.wanted):
        kind = "moving joints" if names.wanted == names.moving else "joints"
        shape = f" (the array has the shape {vectors.shape})" if vectors.ndim > 1 else ""
        about = {"count": len(names.wanted), "entries": vectors.shape[-1], "names": _listed(names.wanted)}
        raise names.refused("entries-not-joints", kind_of_joints=kind, shape=shape, **about)
    return {name: vectors[..., index] for index, name in enumerate(names.wanted)}


def _named(named: Mapping[Any, Any], names: JointNames) -> dict[str, Values]:
    allowed = (*names.wanted, *names.known)
    for name in named:
        if name not in allowed:
            near = did_you_mean(str(name), allowed)
            raise names.refused("joint-unknown", found=str(name), names=_listed(allowed), suggestion=near)
    # The value of a fixed joint is known.
    if missing := [name for name in names.moving if name not in named]:
        raise names.refused("joint-value-missing", missing=_listed(missing), names=_listed(names.moving))
    return {name: _numbers(value, names, name) for name, value in named.items()}


def _numbers(value: Any, names: JointNames, name: str | None) -> Values:  # noqa: ANN401 - whatever is given
    """Numbers of any type as an array of floats; numpy would take texts and truth values for numbers too."""
    import numpy as np

    what = f"the value of the joint {shown(name)}" if name else "the joint vector"
    try:
        array = np.asarray(value)
        items = np.asarray(value, dtype=object).flat
    except ValueError:
        raise names.refused("rows-of-other-lengths", joint=name, what=what) from None
    odd = next((item for item in items if item is None or isinstance(item, (bool, str, bytes))), array)
    kind = f"values of type {array.dtype}" if odd is array else f"{odd!r}, of type {type(odd).__name__}"
    if np.ma.is_masked(value):
        raise names.refused("values-masked", RecordTypeError, joint=name, what=what)
    if odd is array and array.dtype.kind in "iufO":
        with suppress(TypeError, ValueError, ArithmeticError):
            return np.asarray(array, dtype=float)
    raise names.refused("values-no-numbers", RecordTypeError, joint=name, what=what, held=kind)


def _listed(names: tuple[str, ...] | list[str]) -> str:
    return listed(names, 12) or "none"
