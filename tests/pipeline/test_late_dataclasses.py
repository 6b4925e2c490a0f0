"""Dataclasses whose methods are compiled when they are first used, against those of the standard library."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
import sys
from dataclasses import FrozenInstanceError, asdict, field, fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any, Generic, TypeVar, get_type_hints

import pytest
from outcomes import outcome
from pydantic import TypeAdapter, ValidationError

from dh2urdf import late_dataclasses

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")

METHODS = ("__init__", "__eq__", "__hash__", "__repr__")
HOWS = {
    "a record": {"frozen": True, "slots": True, "kw_only": True},
    "with a dict": {"frozen": True},
    "changeable": {"slots": True},
    "without eq": {"frozen": True, "slots": True, "eq": False},
    "without repr": {"frozen": True, "slots": True, "kw_only": True, "repr": False},
}


def arm(dataclass: Callable[..., Any], how: dict[str, bool]) -> Any:
    """A class made by one of the two decorators, as the module's `Arm`: so it can be pickled."""

    class Arm(Generic[T]):
        """An arm."""

        name: str
        reach: float = 1.5
        axes: list[int] = field(default_factory=list)
        note: T | None = field(default=None, compare=False, repr=False, metadata={"help": "a note"})
        parent: Arm[T] | None = None

        def __post_init__(self) -> None:
            if self.reach < 0:
                raise ValueError("reach")

    Arm.__qualname__ = "Arm"
    made = dataclass(**how)(Arm)
    setattr(sys.modules[__name__], "Arm", made)  # noqa: B010 - no type checker should look for it
    return made


def facts(kind: Any) -> dict[str, Any]:
    """What can be seen of a class and of its records."""
    one = kind(name="ur5", axes=[1, 2])
    same, other = kind(name="ur5", axes=[1, 2], note="x"), kind(name="ur5", reach=2.0, axes=[1, 2])
    nested = kind(name="child", parent=one)
    calls: dict[str, Callable[[], Any]] = {
        "signature": lambda: str(inspect.signature(kind)),
        "hints of init": lambda: {
            n: str(t).replace(f"{__name__}.", "") for n, t in get_type_hints(kind.__init__).items()
        },
        "name of init": lambda: kind.__init__.__qualname__,
        "no argument": kind,
        "unknown argument": lambda: kind(name="a", nothing=1),
        "twice": lambda: kind("a", name="b"),
        "too many": lambda: kind(*range(9)),
        "by place": lambda: repr(kind("a", 2.0)) if "object at" not in repr(one) else kind("a", 2.0).reach,
        "post init": lambda: kind(name="a", reach=-1.0),
        "repr": lambda: repr(nested).partition(" at 0x")[0],
        "eq": lambda: (one == same, one == other, one == "ur5", one != same),
        "hash": lambda: hash(kind(name="a", axes=())) == hash(kind(name="a", axes=(), note="x")),
        "is hashable": lambda: kind.__hash__ is not None,
        "set": lambda: setattr(one, "reach", 3.0) or one.reach,
        "set another": lambda: type(outcome(lambda: setattr(one, "colour", 3.0))),
        "delete": lambda: delattr(copy.copy(one), "reach"),
        "a fresh list each": lambda: kind(name="a").axes is kind(name="a").axes,
        "replaced": lambda: asdict(replace(nested, name="b")),
        "copied": lambda: asdict(copy.deepcopy(nested)),
        "pickled": lambda: asdict(pickle.loads(pickle.dumps(nested))),  # noqa: S301 - our own record
        "match": lambda: kind.__match_args__,
        "parameters": lambda: repr(kind.__dataclass_params__),
        "slots": lambda: vars(kind).get("__slots__"),
        "doc": lambda: kind.__doc__,
        "fields": lambda: [(e.name, e.type, e.default, e.kw_only, dict(e.metadata)) for e in fields(kind)],
        "checked by pydantic": lambda: TypeAdapter(kind).validate_python({"name": "a", "reach": "2"}).reach,
        "refused by pydantic": lambda: TypeAdapter(kind).validate_python({"name": 1}) and None,
    }
    seen = {what: outcome(call) for what, call in calls.items()}
    refused = seen.pop("refused by pydantic")
    assert refused[0] is ValidationError
    return seen


@pytest.mark.parametrize("how", HOWS.values(), ids=HOWS)
def test_it_is_the_dataclass_of_the_standard_library(how: dict[str, bool]) -> None:
    """Signature, comparison, text, errors, copies, pickles and what pydantic makes of it are the same."""
    expected = facts(arm(dataclasses.dataclass, how))
    late = arm(late_dataclasses.dataclass, how)
    assert facts(late) == expected
    for number in range(20):  # The first records, and those of the compiled method.
        assert asdict(late(name="a")) == {"name": "a", "reach": 1.5, "axes": [], "note": None, "parent": None}, number
    assert facts(late) == expected


def test_a_method_is_compiled_when_it_is_first_used() -> None:
    """A class of a few records has no `__init__` of its own; one that nobody compares or prints has no such methods."""
    kind = arm(late_dataclasses.dataclass, HOWS["a record"])

    def compiled() -> set[str]:
        return {name for name, method in vars(kind).items() if name in METHODS and inspect.isfunction(method)}

    assert repr(kind(name="a", axes=[1])) == "Arm(name='a', reach=1.5, axes=[1], parent=None)"
    assert compiled() == {"__repr__"}
    assert kind(name="a") == kind(name="a")
    assert compiled() == {"__repr__", "__eq__"}
    records = [kind(name="a") for _ in range(20)]
    assert compiled() == {"__repr__", "__eq__", "__init__"}
    assert len(set(map(repr, records))) == 1


def test_what_a_class_defines_itself_is_kept() -> None:
    """Methods of the class win, as they do in the standard library; a class without a docstring has its name."""

    def made(dataclass: Callable[..., Any]) -> Any:
        @dataclass(frozen=True, slots=True)
        class Own:  # noqa: PLW1641 - the decorator makes the method
            value: int

            def __eq__(self, other: object) -> bool:
                return isinstance(other, type(self))

            def __repr__(self) -> str:
                return "own"

        return Own

    for kind in (made(dataclasses.dataclass), made(late_dataclasses.dataclass)):
        assert kind(1) == kind(2)
        assert repr(kind(1)) == "own"
        assert hash(kind(1)) == hash(kind(1)) != hash(kind(2))
    assert made(late_dataclasses.dataclass).__doc__ == "Own"


def test_a_class_that_extends_one() -> None:
    """Its fields come after those of the first; it must be frozen if the first is, and a plain one may have attributes."""

    @late_dataclasses.dataclass(frozen=True, slots=True, kw_only=True)
    class First:
        a: int = 1

    @late_dataclasses.dataclass(frozen=True, slots=True, kw_only=True)
    class Second(First):
        b: int = 2

    class Plain(First):
        pass

    assert str(inspect.signature(Second)) == "(*, a: 'int' = 1, b: 'int' = 2) -> None"
    assert repr(Second(b=3)).endswith("Second(a=1, b=3)")
    assert First() != Second()
    assert is_dataclass(Second)
    plain: Any = Plain()
    plain.colour = "red"
    assert plain.colour == "red"
    with pytest.raises(FrozenInstanceError, match="cannot assign to field 'a'"):
        plain.a = 2
    with pytest.raises(TypeError, match="cannot inherit non-frozen"):
        late_dataclasses.dataclass(slots=True)(type("Third", (First,), {}))


@pytest.mark.parametrize("slots", [True, False])
def test_defaults_that_records_would_share_are_refused(*, slots: bool) -> None:
    """As the standard library does: a list of one record would be that of all of them."""
    for dataclass in (dataclasses.dataclass, late_dataclasses.dataclass):
        with pytest.raises(ValueError, match=r"mutable default <class 'list'> for field axes is not allowed"):
            dataclass(slots=slots)(type("Arm", (), {"__annotations__": {"axes": "list[int]"}, "axes": [1]}))


@pytest.mark.parametrize("annotation", ["ClassVar[int]", "InitVar[int]", "KW_ONLY", int])
def test_what_is_no_field_is_refused(annotation: object) -> None:
    """Variables of the class and the like are for the standard library, and so are annotations that are evaluated."""
    with pytest.raises(TypeError, match="the annotation of reach is"):
        late_dataclasses.dataclass(slots=True)(type("Arm", (), {"__annotations__": {"reach": annotation}}))
