"""How a child process sends what a function returned or raised: as data of a declared type, or as a pickle.

A file of unknown origin may take its reader over, and unpickling what that reader sends would run its code in the
parent. So whatever reads such files answers with `Data`: JSON, which is bounded and validated against the declared
type. `Pickled` is for processes that have the rights of this one and run code of this installation: the workers of a
run, and the contract tests.
"""

from __future__ import annotations

import builtins
import pickle
from functools import cache
from typing import Any, Generic, NamedTuple, TypeVar

from dh2urdf import errors
from dh2urdf.errors import InputError, ManipulatorError
from dh2urdf.source import Problem, shown

T = TypeVar("T")

MOST_VALUES = 2**22
"""Values in an answer, at most: each takes memory when the answer is parsed, however short it is."""

_KNOWN = {
    kind.__name__: kind
    for module in (builtins, errors)
    for kind in vars(module).values()
    if isinstance(kind, type) and issubclass(kind, Exception)
}
"""The exceptions that `Data` sends as what they are, by their names."""


class AnswerError(ValueError):
    """What a child sent is not what it should have sent."""


class _Raised(NamedTuple):
    """An exception: its class, one of `_KNOWN`; what the class is called with; of an ImportError, the module; notes."""

    kind: str
    given: tuple[bool | int | float | str | tuple[str, ...] | tuple[Problem, ...] | None, ...]
    name: str | None = None
    notes: tuple[str, ...] = ()


class Data(Generic[T]):
    """JSON of a declared type: numbers arrive bit for bit, an exception in its own class or as a `RuntimeError`.

    Args:
        returns: the type of what the function returns; arrays in `Any` arrive as lists.
    """

    def __init__(self, returns: Any = Any) -> None:  # noqa: ANN401 - an annotation
        self.returns = returns

    def prepare(self) -> None:
        """Import what sending needs: a child may import nothing once it is behind the fence."""
        _adapter(Any).dump_json(({"": [0.5, 1, None, True, b""]},))
        _adapter(self.returns)
        self.pack_error(ValueError(""))

    def pack(self, value: T) -> bytes:
        """Return what is sent for a value.

        Raises:
            TypeError: something in it is no data.
        """
        try:
            return _packed(self.returns, value)
        except ValueError as error:
            raise TypeError(f"what it returned cannot be sent as data: {error}") from error

    def unpack(self, sent: bytes) -> T:
        """Return the value.

        Raises:
            AnswerError: it is not JSON, has another form, or is made of too many values.
        """
        value: T = _unpacked(self.returns, sent)
        return value

    def pack_error(self, error: BaseException) -> bytes:
        """Return what is sent for an exception.

        An error of dh2urdf that a plugin has derived is sent as the class that it derives from; what is no data, or
        cannot be made again, as a `RuntimeError` that describes it.
        """
        try:
            kind: type[BaseException] = type(error)
            if _KNOWN.get(kind.__name__) is not kind and isinstance(error, (InputError, ManipulatorError)):
                kind = next(base for base in kind.__mro__ if base.__module__ == errors.__name__)
                error = kind(error.problems, error.notices)
            if _KNOWN.get(kind.__name__) is not kind:
                raise TypeError(kind)
            given: Any = error.__reduce__()[1]
            name = error.name if isinstance(error, ImportError) else None
            sent = _packed(_Raised, _Raised(kind.__name__, given, name, tuple(getattr(error, "__notes__", ()))))
            self.unpack_error(sent)
        except Exception:  # noqa: BLE001 - the exception's own code runs here
            text = f"{type(error).__name__}: {error}".encode("utf-8", "backslashreplace").decode()
            sent = _packed(_Raised, _Raised("RuntimeError", (text,)))
        return sent

    def unpack_error(self, sent: bytes) -> Exception:
        """Return the exception.

        Raises:
            AnswerError: as `unpack`, or no known exception is described.
        """
        raised: _Raised = _unpacked(_Raised, sent)
        try:
            error: Exception = _KNOWN[raised.kind](*raised.given)
        except Exception as unusable:
            raise AnswerError(f"no exception is {shown(raised.kind)} of {shown(str(raised.given))}") from unusable
        if raised.name is not None and isinstance(error, ImportError):
            error.name = raised.name
        for note in raised.notes:
            error.add_note(note)
        return error


@cache
def _adapter(kind: Any) -> Any:  # noqa: ANN401 - the form of an annotation
    """Return what writes and validates JSON of a type; in a tuple, since a record by itself takes no configuration."""
    from pydantic import ConfigDict, TypeAdapter

    form = ConfigDict(strict=True, ser_json_bytes="base64", val_json_bytes="base64", ser_json_inf_nan="constants")
    return TypeAdapter(tuple[kind], config=form)


def _packed(kind: Any, value: Any) -> bytes:  # noqa: ANN401 - of any kind
    sent: bytes = _adapter(kind).dump_json((value,), warnings=False)
    return sent


def _unpacked(kind: Any, sent: bytes) -> Any:  # noqa: ANN401 - of any kind
    if (count := sum(map(sent.count, (b",", b"[", b"{")))) > MOST_VALUES:
        raise AnswerError(f"it has {count} values, more than {MOST_VALUES}")
    try:
        (value,) = _adapter(kind).validate_json(sent)
    except ValueError as error:
        told = error.errors(include_url=False, include_context=False)[0]["msg"] if hasattr(error, "errors") else error
        raise AnswerError(str(told)) from None
    return value


class Pickled(Generic[T]):
    """Pickles of any value that can be pickled: for processes that do nothing that this one would not do."""

    def prepare(self) -> None:
        """Nothing is needed."""

    def pack(self, value: Any) -> bytes:  # noqa: ANN401 - what the function returned
        """Return what is sent for a value."""
        return pickle.dumps(value)

    def unpack(self, sent: bytes) -> Any:  # noqa: ANN401 - what the function returned
        """Return the value, or the exception."""
        return pickle.loads(sent)  # noqa: S301 - our own worker sent it, see above

    def pack_error(self, error: BaseException) -> bytes:
        """Return what is sent for an exception; where it does not survive the way, a `RuntimeError` describes it."""
        try:
            sent = pickle.dumps(error)
            pickle.loads(sent)  # noqa: S301 - made in the line before
        except Exception:  # noqa: BLE001 - the exception's own code runs here
            return pickle.dumps(RuntimeError(f"{type(error).__name__}: {error}"))
        return sent

    unpack_error = unpack


PICKLED: Pickled[Any] = Pickled()
"""The encoding of workers and of stages under test: they have the rights of this process, and return anything."""
