"""What stages give, held against what `dh2urdf.stages` says: the types in records, and the names of files.

A fault is a TypeError or ValueError, raised where the stage is called, so that it is reported as the stage's own. The
types come from the annotations of the records, so that no field can be forgotten.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import is_dataclass
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from dh2urdf import stages
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.source import listed, shown
from dh2urdf.stages import EmittedFile

T = TypeVar("T")

_LONG = 60  # characters of a value that a message repeats


def a_record(value: T, *kinds: type[Any]) -> T:
    """What a stage gave, which is of one of these kinds.

    Raises:
        TypeError: it is something else, which a third party's stage may well give.
    """
    if not isinstance(value, kinds):
        wanted = " or ".join(_name(kind) if kind.__module__ == "builtins" else _public_name(kind) for kind in kinds)
        raise TypeError(f"it gave {_name(type(value))}, not {wanted}")
    return value


def _public_name(kind: type[Any]) -> str:
    """The name by which a plugin imports a record."""
    is_of_stages = kind.__name__ in stages.__all__ and getattr(stages, kind.__name__) is kind
    module = stages.__name__ if is_of_stages else kind.__module__
    return f"{module}.{kind.__name__}"


def a_whole_record(value: T, *kinds: type[Any]) -> T:
    """What a stage gave, which is of one of these kinds, and so is all that is in it.

    Raises:
        TypeError: something in it has another type than its field says.
    """
    a_record(value, *kinds)
    kind: Any = type(value)
    if misfit := _misfit(value, kind):
        name = kind.__name__
        what = f"{'an' if name[0] in 'AEIO' else 'a'} {name} whose {misfit.path.lstrip('.')}"
        raise TypeError(f"it gave {what} is {misfit.found}, not {misfit.wanted}")
    return value


def items_of(value: Iterable[T] | None, kind: type[Any] | str) -> Iterator[T]:
    """What a stage gives one by one.

    Raises:
        TypeError: it gave nothing of which there can be several.
    """
    if not isinstance(value, (list, tuple)) and (not isinstance(value, Iterable) or isinstance(value, (str, bytes))):
        wanted = kind if isinstance(kind, str) else f"several of {_public_name(kind)}"
        raise TypeError(f"it gave {_name(type(value))}, not {wanted}")
    return iter(value)


def whole_records(value: Iterable[T] | None, kind: type[T]) -> list[T]:
    """Several records that a stage gave.

    Raises:
        TypeError: one of them, or something in it, is something else.
    """
    return [a_whole_record(each, kind) for each in items_of(value, kind)]


def emitted_files(value: Iterable[EmittedFile] | None, stem: str, *, in_folders: bool = False) -> list[EmittedFile]:
    """The files that an emitter gave.

    Args:
        value: what it gave.
        stem: what names of files begin with.
        in_folders: whether the files lie in folders of their own.

    Raises:
        TypeError: one of them is no file, its name is no text, or its content is not bytes.
        ValueError: a name is not that of a file in the output folder itself, or, of an emitter whose files lie in
            folders, in such a folder; or it does not begin with the stem, so that the files of two manipulators may
            have one name; or two have one name, also where only the case differs.
    """
    files = list(items_of(value, EmittedFile))
    for file in files:
        if type(file) is not EmittedFile or type(file.name) is not str or type(file.content) is not bytes:
            a_whole_record(file, EmittedFile)
        parts = file.name.split("/") if in_folders else [file.name]
        if in_folders and len(parts) == 1:
            raise ValueError(f"{shown(file.name)} lies in no folder; accepted: the path of a file in one")
        for part in parts:
            a_plain_name(part)
        if not in_folders and not file.name.casefold().startswith(stem.casefold()):
            raise ValueError(f"{shown(file.name)} does not begin with the stem {shown(stem)} that it was given")
    if len(files) > 1 and len({file.name.casefold() for file in files}) < len(files):
        raise ValueError(f"it gave two files of one name: {listed([shown(file.name) for file in files])}")
    return files


def a_plain_name(name: str) -> str:
    """The name of a file without a folder.

    Raises:
        ValueError: it leads somewhere else, or no file can have it.
    """
    if not name or name in {".", ".."} or "/" in name or "\\" in name or "\0" in name:
        raise ValueError(f"{shown(name)} is not a plain file name; accepted: a name without a folder")
    return name


# --- Types -----------------------------------------------------------------------------------------------------------


_WHOLE = frozenset({str, int, float, bool, bytes, NoneType, object, Literal})
"""What has no parts."""


class _Misfit(NamedTuple):
    """A value that is not of the type of its field.

    Attributes:
        path: where it is: ``.rows[2].a``.
        found: the value and its type.
        wanted: the type of the field.
    """

    path: str
    found: str
    wanted: str


def _misfit(value: Any, hint: Any) -> _Misfit | None:  # noqa: ANN401 - whatever a stage gave, and an annotation
    """The first part of a value that is not of the type of an annotation; None where all are."""
    origin, arguments = _origin_of(hint)
    if origin is Union:
        found = []
        for each in arguments:
            if (misfit := _misfit(value, each)) is None:
                return None
            found.append(misfit)
        # A member whose own parts do not fit says more than that no member fits.
        return next((misfit for misfit in found if misfit.path), _unlike(value, hint))
    if not (value in arguments if origin is Literal else _is_of(value, origin, arguments)):
        return _unlike(value, hint)
    for path, item, each in () if origin in _WHOLE else _parts(value, origin, arguments):
        if misfit := _misfit(item, each):
            return misfit._replace(path=f"{path}{misfit.path}")
    return None


def _parts(value: Any, origin: Any, arguments: tuple[Any, ...]) -> Iterable[tuple[str, Any, Any]]:  # noqa: ANN401 - whatever a stage gave
    """What is in a value: where, the part, and the annotation of its type."""
    if is_dataclass(origin) or hasattr(origin, "_fields"):
        return [(f".{name}", getattr(value, name), each) for name, each in _fields_of(origin)]
    if not arguments:
        return ()
    if origin is tuple and arguments[-1] is not Ellipsis:
        return [(f"[{k}]", item, each) for k, (item, each) in enumerate(zip(value, arguments, strict=True))]
    if issubclass(origin, Mapping):
        keys, values = arguments
        return [part for key in value for part in ((f"[{key!r}]", key, keys), (f"[{key!r}]", value[key], values))]
    return [(f"[{k}]", item, arguments[0]) for k, item in enumerate(value)]


@cache
def _origin_of(hint: Any) -> tuple[Any, tuple[Any, ...]]:  # noqa: ANN401 - an annotation
    """What a value is an instance of, or `Union`, and the annotations of what is in it."""
    origin = get_origin(hint)
    return Union if origin is UnionType else object if hint is Any else origin or hint, get_args(hint)


@cache
def _fields_of(kind: Any) -> tuple[tuple[str, Any], ...]:  # noqa: ANN401 - a dataclass or a tuple with names
    return tuple(get_type_hints(kind).items())


def _is_of(value: Any, kind: Any, arguments: tuple[Any, ...]) -> bool:  # noqa: ANN401 - whatever a stage gave
    if isinstance(value, bool):
        return kind in {bool, object}
    if arguments and (isinstance(value, (str, bytes)) or (kind is tuple and arguments[-1] is not Ellipsis)):
        return isinstance(value, tuple) and kind is tuple and len(value) == len(arguments)
    return isinstance(value, (int, float) if kind is float else kind)


def _unlike(value: Any, hint: Any) -> _Misfit:  # noqa: ANN401 - whatever a stage gave
    try:
        text = repr(value)
    except Exception as error:  # noqa: BLE001 - a stranger's __repr__ may raise anything
        text = f"an object whose repr raises {type(error).__name__}"
    text = text if len(text) <= _LONG else f"{text[: _LONG - 1]}…"
    return _Misfit("", text if value is None else f"{text} ({type(value).__name__})", _name(hint))


def _name(hint: Any) -> str:  # noqa: ANN401 - an annotation
    if hint in (None, NoneType):
        return "None"
    if get_origin(hint) in (UnionType, Union):
        return " or ".join(map(_name, get_args(hint)))
    if get_origin(hint) is Literal:
        return " or ".join(map(repr, get_args(hint)))
    if isinstance(hint, type) and not get_args(hint):
        return hint.__name__
    return str(hint).replace("typing.", "").replace("collections.abc.", "").replace("dh2urdf.", "")
