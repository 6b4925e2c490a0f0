"""Named tuples whose `__new__` is compiled when the first one is made.

`typing.NamedTuple` checks every annotation and compiles code for each class: 0.1 to 0.2 ms. A conversion imports forty
such classes, and makes tuples of half of them. Here a class takes a fifth of that time. The classes are named tuples as
any other: `_fields`, `_replace`, `_asdict`, `copy`, `pickle`, `match`, `inspect.signature` and pydantic work with them.
"""

from __future__ import annotations

import sys
from _collections import _tuplegetter  # type: ignore[import-not-found] # `collections` has it so: a property takes longer
from typing import TYPE_CHECKING, Any

from dh2urdf.late_dataclasses import Late

__all__ = ["NamedTuple"]

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import NamedTuple
else:

    class _Maker(type):
        """Turns the body of a class into a named tuple; the class that it makes is one of `type`."""

        def __new__(cls, name: str, bases: tuple[type, ...], own: dict[str, Any]) -> type:
            return _named_tuple(name, own) if bases else super().__new__(cls, name, bases, own)

    class NamedTuple(metaclass=_Maker):
        """The base of a named tuple; its fields are the annotations in the body."""


def _named_tuple(name: str, own: dict[str, Any]) -> type:
    fields = tuple(own.setdefault("__annotations__", {}))
    defaults = {field: own[field] for field in fields if field in own}
    getters = {field: _tuplegetter(number, f"Alias for field number {number}") for number, field in enumerate(fields)}
    about = {"__slots__": (), "__match_args__": fields, "_fields": fields, "_field_defaults": defaults}
    return type(name, (tuple,), _SHARED | {"__new__": Late(_new)} | own | getters | about)


def _new(kind: Any) -> Callable[..., Any]:  # noqa: ANN401 - a named tuple
    """The `__new__` of a class, as `collections.namedtuple` writes it."""
    names = ", ".join(kind._fields)
    code = f"lambda _cls, {names}: _tuple_new(_cls, ({names},))" if names else "lambda _cls: _tuple_new(_cls, ())"
    function = eval(code, {"_tuple_new": tuple.__new__, "__name__": kind.__module__})  # noqa: S307 - of names of fields
    function.__name__, function.__annotations__ = "__new__", kind.__annotations__
    function.__defaults__ = tuple(kind._field_defaults.values())
    return function  # type: ignore[no-any-return]


# --- Methods that all classes share ----------------------------------------------------------------------------------


def _make(cls: Any, iterable: Iterable[Any]) -> Any:  # noqa: ANN401 - of any named tuple
    """Make a tuple of the values of all fields."""
    made = tuple.__new__(cls, iterable)
    if len(made) != len(cls._fields):
        raise TypeError(f"Expected {len(cls._fields)} arguments, got {len(made)}")
    return made


def _replace(self: Any, /, **changes: Any) -> Any:  # noqa: ANN401 - of any named tuple
    """Make a tuple with other values of some fields."""
    made = self._make(map(changes.pop, self._fields, self))
    if changes:
        wrong = TypeError if sys.version_info >= (3, 13) else ValueError
        raise wrong(f"Got unexpected field names: {list(changes)!r}")
    return made


def _asdict(self: Any) -> dict[str, Any]:  # noqa: ANN401 - of any named tuple
    """The values by their fields."""
    return dict(zip(self._fields, self, strict=True))


def _repr(self: Any) -> str:  # noqa: ANN401 - of any named tuple
    words = ", ".join(f"{field}={value!r}" for field, value in zip(self._fields, self, strict=True))
    return f"{self.__class__.__name__}({words})"


def _newargs(self: Any) -> tuple[Any, ...]:  # noqa: ANN401 - of any named tuple
    return tuple(self)


_SHARED = {
    "_make": classmethod(_make),
    "_replace": _replace,
    "_asdict": _asdict,
    "__repr__": _repr,
    "__getnewargs__": _newargs,
}
