"""Dataclasses whose methods are compiled when they are first used.

`dataclasses.dataclass` writes and compiles up to six methods of each class: half a millisecond for a record of six
fields, and to find the fields alone takes a sixth of that. A conversion imports eighty records and makes half of them.
Here a class takes a twentieth of that time. A method is compiled when it is first used, `__init__` when there are more
than a few records. The classes are dataclasses as any other: `fields`, `replace`, `asdict`, `copy`, `pickle`, `match`
and `inspect.signature` work on them. All annotations of their bodies are texts, and those of fields.
"""

from __future__ import annotations

import dataclasses
import sys
from dataclasses import MISSING, FrozenInstanceError, fields
from functools import cache, partial
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

__all__ = ["dataclass"]

if TYPE_CHECKING:
    from collections.abc import Callable
    from dataclasses import dataclass
else:

    def dataclass(
        *,
        frozen: bool = False,
        slots: bool = False,
        kw_only: bool = False,
        eq: bool = True,
        repr: bool = True,  # noqa: A002 - the argument's name in the standard library
    ) -> Callable[[type], type]:
        """Make a class a dataclass; the arguments mean what they mean in `dataclasses.dataclass`."""
        return lambda kind: _dataclass(kind, frozen=frozen, slots=slots, kw_only=kw_only, eq=eq, has_repr=repr)


_NO_FIELDS = ("ClassVar", "InitVar", "KW_ONLY")
"""Annotations that the standard library takes for something else than a field."""


def _dataclass(kind: type, *, frozen: bool, slots: bool, kw_only: bool, eq: bool, has_repr: bool) -> type:
    body = dict(vars(kind))
    bases = [base for base in kind.__mro__[:0:-1] if "__dataclass_fields__" in vars(base)]
    if any(vars(base)["__dataclass_params__"].frozen != frozen for base in bases):
        raise TypeError("cannot inherit non-frozen dataclass from a frozen one, nor the other way")
    own = {name: _field(name, text, body.get(name, MISSING), kw_only) for name, text in _annotations(body).items()}
    every: dict[str, dataclasses.Field[Any]] = {}
    for base in bases:
        every |= vars(base)["__dataclass_fields__"]
    every |= own
    methods: dict[str, Any] = {"__init__": _LateInit(_init)}
    if has_repr:
        methods["__repr__"] = Late(_repr)
    if frozen:
        methods |= {"__setattr__": _setattr, "__delattr__": _delattr}
        if slots:
            methods |= {"__getstate__": _getstate, "__setstate__": _setstate}
    if eq:
        methods["__eq__"] = Late(_eq)
        methods["__hash__"] = Late(_hash) if frozen else None
    for name in methods:
        if body.get(name) is not None:
            methods[name] = body[name]
    facts = {
        "__qualname__": kind.__qualname__,
        "__doc__": kind.__doc__ or kind.__name__,
        "__match_args__": tuple([name for name, each in every.items() if not each.kw_only]),
        "__dataclass_fields__": every,
        "__dataclass_params__": _parameters(frozen, slots, kw_only, eq, has_repr),
    }
    if slots:
        inherited = {name for base in kind.__mro__[1:] for name in vars(base).get("__slots__", ())}
        facts["__slots__"] = tuple([name for name in every if name not in inherited])
    else:
        facts |= {name: each.default for name, each in own.items() if each.default is not MISSING}
    rest = {name: value for name, value in body.items() if name not in own and name not in _OF_CLASSES}
    return type(kind)(kind.__name__, kind.__bases__, rest | methods | facts)


_OF_CLASSES = ("__dict__", "__weakref__")
"""What Python adds to a class without slots."""


def _annotations(body: dict[str, Any]) -> dict[str, str]:
    """The annotations of fields in the body of a class."""
    found: dict[str, str] = body.get("__annotations__", {})
    for name, text in found.items():
        if not isinstance(text, str) or any(map(text.__contains__, _NO_FIELDS)):
            raise TypeError(f"the annotation of {name} is {text!r}; accepted: the text of a field's type")
    return found


def _field(name: str, text: str, value: object, kw_only: bool) -> dataclasses.Field[Any]:  # noqa: FBT001 - as in `dataclass`
    """A field as the standard library makes it of a name, an annotation and what the body of the class has for it."""
    made: Any = value if isinstance(value, dataclasses.Field) else dataclasses.field(default=value)
    made.name, made.type, made._field_type = name, text, _IS_FIELD  # noqa: SLF001 - it has no other name
    if made.kw_only is MISSING:
        made.kw_only = kw_only
    if type(made.default).__hash__ is None:
        raise ValueError(f"mutable default {type(made.default)} for field {name} is not allowed: use default_factory")
    return made  # type: ignore[no-any-return]


@cache
def _parameters(frozen: bool, slots: bool, kw_only: bool, eq: bool, has_repr: bool) -> Any:  # noqa: ANN401, FBT001 - as in `dataclass`
    """What the standard library and others ask of a dataclass."""
    found: Any = _sample(slots=slots, kw_only=kw_only).__dataclass_params__
    found.init, found.repr, found.eq, found.frozen = True, has_repr, eq, frozen
    return found


def _sample(**how: bool) -> Any:  # noqa: ANN401 - a dataclass
    """A dataclass of one field, as the standard library makes it; with no docstring it would look for a signature."""
    body = {"__doc__": "A sample.", "__annotations__": {"field": object}}
    return dataclasses.dataclass(init=False, repr=False, eq=False, **how)(type("_Sample", (), body))


_IS_FIELD: object = vars(dataclasses)["_FIELD"]
"""What the standard library notes of a field, so that it is no class variable."""
_FEW = 14
"""Records whose fields are filled before an `__init__` is compiled, which takes as long as thirty of them."""


# --- Methods with code of their own ----------------------------------------------------------------------------------


class Late:
    """Stands for a method of a class: compiles it when it is asked for, and puts it into the class."""

    def __init__(self, compiled: Callable[[Any], Callable[..., Any]]) -> None:
        self._compiled = compiled

    def __set_name__(self, kind: type, name: str) -> None:
        self._kind, self._name = kind, name

    def __get__(self, record: object, _kind: type | None = None) -> Any:  # noqa: ANN401 - a function or a method
        function = self._compiled(self._kind)
        function.__qualname__ = f"{self._kind.__qualname__}.{self._name}"
        setattr(self._kind, self._name, function)
        return function if record is None else function.__get__(record)


class _LateInit(Late):
    """An `__init__` that fills the first few records without code of its own: in most commands there are no more."""

    _records = 0
    _fields: tuple[tuple[str, object, Any], ...] = ()  # name, default and factory of each

    def __get__(self, record: object, kind: type | None = None) -> Any:  # noqa: ANN401 - a function or a method
        if record is None or isinstance(record, type) or self._records >= _FEW:  # `inspect` may give a class.
            return super().__get__(record, kind)
        self._records += 1
        return partial(self._fill, record)

    def _fill(self, record: object, /, *given: Any, **named: Any) -> None:  # noqa: ANN401 - the values of the fields
        kind: Any = self._kind
        values = dict(zip(kind.__match_args__, given, strict=False)) | named
        is_once = len(values) == len(given) + len(named)
        self._fields = self._fields or tuple([(each.name, each.default, each.default_factory) for each in fields(kind)])
        ready = []
        for name, default, make in self._fields:
            if name in values:
                ready.append((name, values.pop(name)))
            elif make is not MISSING:
                ready.append((name, make()))
            elif default is not MISSING:
                ready.append((name, default))
        if is_once and not values and len(ready) == len(self._fields):  # None is unknown, and none is missing.
            for name, value in ready:
                object.__setattr__(record, name, value)
            if hasattr(kind, "__post_init__"):
                record.__post_init__()  # type: ignore[attr-defined]
            return
        super().__get__(record)(*given, **named)  # It has the words for what is wrong.


def _init(kind: Any) -> Callable[..., None]:  # noqa: ANN401 - a dataclass
    """The `__init__` of a dataclass, all of whose fields are arguments."""
    every = fields(kind)
    positional, named = [[each for each in every if each.kw_only is wanted] for wanted in (False, True)]
    values: dict[str, Any] = {"_set_field": object.__setattr__, "_made_here": _MADE_HERE}
    lines = []
    for each in every:
        value = each.name
        if each.default_factory is not MISSING:
            values[f"_make_{each.name}"] = each.default_factory
            value = f"_make_{each.name}() if {each.name} is _made_here else {each.name}"
        elif each.default is not MISSING:
            values[f"_default_{each.name}"] = each.default
        is_frozen = kind.__dataclass_params__.frozen
        lines.append(f"_set_field(self, {each.name!r}, {value})" if is_frozen else f"self.{each.name} = {value}")
    if hasattr(kind, "__post_init__"):
        lines.append("self.__post_init__()")
    parameters = ["self", *map(_parameter, positional), *(["*"] if named else []), *map(_parameter, named)]
    function = _function(kind, f"__init__({', '.join(parameters)})", lines or ["pass"], values)
    function.__annotations__ = {each.name: each.type for each in every} | {"return": None}
    return function


class _MadeHere:
    """The default of an argument whose value a factory makes."""

    def __repr__(self) -> str:
        return "<factory>"


_MADE_HERE = _MadeHere()


def _parameter(field: dataclasses.Field[Any]) -> str:
    if field.default_factory is not MISSING:
        return f"{field.name}=_made_here"
    return field.name if field.default is MISSING else f"{field.name}=_default_{field.name}"


def _eq(kind: Any) -> Callable[..., bool]:  # noqa: ANN401 - a dataclass
    values_of = _compared(kind)

    def __eq__(self: object, other: object) -> bool:  # noqa: N807 - a method
        return values_of(self) == values_of(other) if other.__class__ is self.__class__ else NotImplemented

    return __eq__


def _hash(kind: Any) -> Callable[..., int]:  # noqa: ANN401 - a dataclass
    values_of = _compared(kind)

    def __hash__(self: object) -> int:  # noqa: N807 - a method
        return hash(values_of(self))

    return __hash__


def _repr(kind: Any) -> Callable[..., str]:  # noqa: ANN401 - a dataclass
    words = ", ".join(f"{each.name}={{self.{each.name}!r}}" for each in fields(kind) if each.repr)
    line = f'return f"{{self.__class__.__qualname__}}({words})"'
    return recursive_repr()(_function(kind, "__repr__(self)", [line], {}))


def _compared(kind: Any) -> Callable[[Any], tuple[Any, ...]]:  # noqa: ANN401 - a dataclass
    """What takes the values that are compared out of a record."""
    names = [each.name for each in fields(kind) if each.compare]
    if len(names) > 1:
        return attrgetter(*names)  # one name would give no tuple
    return lambda record: tuple([getattr(record, name) for name in names])


def _function(kind: Any, head: str, lines: list[str], values: dict[str, Any]) -> Callable[..., Any]:  # noqa: ANN401 - a dataclass
    """A function that finds the names of the module of a class, and some values besides."""
    text = "\n".join([f"def _of({', '.join(values)}):", f" def {head}:", *(f"  {line}" for line in lines)])
    names: dict[str, Any] = {}
    text += f"\n return {head.partition('(')[0]}"
    exec(text, vars(sys.modules[kind.__module__]), names)  # noqa: S102 - of names of fields, as the standard library does
    return names["_of"](**values)  # type: ignore[no-any-return]


# --- Methods that all classes share ----------------------------------------------------------------------------------


def _setattr(self: Any, name: str, value: object) -> None:  # noqa: ANN401 - a method of any record
    _check_settable(self, name, "assign to")
    object.__setattr__(self, name, value)


def _delattr(self: Any, name: str) -> None:  # noqa: ANN401 - a method of any record
    _check_settable(self, name, "delete")
    object.__delattr__(self, name)


def _check_settable(record: Any, name: str, what: str) -> None:  # noqa: ANN401 - any record
    """A class that extends a record, and is none itself, may have attributes besides."""
    kind = type(record)
    if "__dataclass_fields__" in vars(kind) or name in kind.__dataclass_fields__:
        raise FrozenInstanceError(f"cannot {what} field {name!r}")


def _getstate(self: Any) -> list[Any]:  # noqa: ANN401 - a method of any record
    return [getattr(self, field.name) for field in fields(self)]


def _setstate(self: Any, state: list[Any]) -> None:  # noqa: ANN401 - a method of any record
    for field, value in zip(fields(self), state, strict=True):
        object.__setattr__(self, field.name, value)
