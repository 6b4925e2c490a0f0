"""Named tuples whose `__new__` is compiled when the first one is made, against those of the standard library."""

from __future__ import annotations

import copy
import inspect
import pickle
import re
import sys
import typing
from typing import TYPE_CHECKING, Any, get_type_hints

from outcomes import outcome
from pydantic import TypeAdapter, ValidationError

from dh2urdf import late_tuples

if TYPE_CHECKING:
    from collections.abc import Callable


def joint(base: Any) -> Any:
    """A class with one of the two bases, as the module's `Joint`: so it can be pickled."""

    class Joint(base):
        """A joint."""

        name: str
        reach: float = 1.5
        parent: Joint | None = None

        @property
        def is_long(self) -> bool:
            """Whether it reaches far."""
            return self.reach > 1.0

        def __str__(self) -> str:
            return self.name

    Joint.__qualname__ = "Joint"
    setattr(sys.modules[__name__], "Joint", Joint)  # noqa: B010 - no type checker should look for it
    return Joint


def facts(kind: Any) -> dict[str, Any]:
    """What can be seen of a class and of its tuples."""
    one, same, other = kind("a", parent=kind("b")), kind("a", parent=kind("b")), kind("a", 2.0)
    extended = type("Extended", (kind,), {})
    calls: dict[str, Callable[[], Any]] = {
        "signature": lambda: re.sub(r"ForwardRef\((.*?)\)", r"\1", str(inspect.signature(kind))),
        "hints": lambda: {name: str(hint).replace(f"{__name__}.", "") for name, hint in get_type_hints(kind).items()},
        "no argument": kind,
        "unknown argument": lambda: kind(name="a", nothing=1),
        "too many": lambda: kind(*range(9)),
        "repr": lambda: repr(one),
        "str": lambda: str(one),
        "property": lambda: one.is_long,
        "eq and hash": lambda: (
            one == same,
            one == other,
            hash(one) == hash(same),
            one == ("a", 1.5, ("b", 1.5, None)),
        ),
        "a tuple": lambda: (*one, one[1], len(one), isinstance(one, tuple), kind.__mro__[1:]),
        "fields": lambda: (kind._fields, kind._field_defaults, kind.__match_args__, kind.__slots__),
        "field": lambda: (kind.name.__doc__, type(kind.name)),
        "replaced": lambda: (one._replace(name="c"), type(one._replace(name="c")) is kind),
        "replaced wrongly": lambda: one._replace(nothing=1),
        "made": lambda: kind._make(["a", 2.0, None]),
        "made wrongly": lambda: kind._make(["a"]),
        "as a dict": one._asdict,
        "copied": lambda: (copy.copy(one), copy.deepcopy(one)),
        "pickled": lambda: pickle.loads(pickle.dumps(one)),  # noqa: S301 - our own tuple
        "set": lambda: setattr(one, "name", "b"),
        "set another": lambda: setattr(one, "colour", "b"),
        "extended": lambda: (repr(extended("a")), type(extended("a")) is extended),
        "doc": lambda: (kind.__doc__, kind.__name__, kind.__module__, type(kind)),
        "checked by pydantic": lambda: tuple(TypeAdapter(kind).validate_python(("a", "2"))),
        "refused by pydantic": lambda: TypeAdapter(kind).validate_python(()),
    }
    seen = {what: outcome(call) for what, call in calls.items()}
    assert seen.pop("refused by pydantic")[0] is ValidationError
    return seen


def test_it_is_the_named_tuple_of_the_standard_library() -> None:
    """Fields, arguments, comparison, text, errors, copies, pickles and what pydantic makes of it are the same."""
    expected = facts(joint(typing.NamedTuple))
    late = joint(late_tuples.NamedTuple)
    assert facts(late) == expected
    assert facts(late) == expected  # With the compiled method.


def test_a_method_is_compiled_when_the_first_tuple_is_made() -> None:
    """A class that nobody makes a tuple of compiles nothing."""
    kind = joint(late_tuples.NamedTuple)
    assert not callable(vars(kind)["__new__"])
    kind("a")
    assert callable(vars(kind)["__new__"])
