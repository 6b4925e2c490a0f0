"""What stages return, compared with what `dh2urdf.stages` says: the types of records, and the names of files.

A fault is a TypeError or ValueError, raised where the stage is called, so that it is reported as the stage's own.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, TypeVar

from dh2urdf import stages
from dh2urdf.source import listed, shown
from dh2urdf.stages import EmittedFile

T = TypeVar("T")


def a_record(value: T, *kinds: type[Any]) -> T:
    """What a stage gave, which is of one of these kinds.

    Raises:
        TypeError: it is something else, which a third party's stage may well give.
    """
    if not isinstance(value, kinds):
        raise TypeError(f"it gave {_name(type(value))}, not {' or '.join(map(_name, kinds))}")
    return value


def _name(kind: type[Any]) -> str:
    """The name by which a plugin imports a type."""
    if kind.__module__ == "builtins":
        return kind.__name__.replace("NoneType", "None")
    is_of_stages = kind.__name__ in stages.__all__ and getattr(stages, kind.__name__) is kind
    module = stages.__name__ if is_of_stages else kind.__module__
    return f"{module}.{kind.__name__}"


def items_of(value: Iterable[T] | None, kind: type[Any] | str) -> Iterator[T]:
    """What a stage gives one by one.

    Raises:
        TypeError: it gave nothing of which there can be several.
    """
    if not isinstance(value, (list, tuple)) and (not isinstance(value, Iterable) or isinstance(value, (str, bytes))):
        wanted = kind if isinstance(kind, str) else f"several of {_name(kind)}"
        raise TypeError(f"it gave {_name(type(value))}, not {wanted}")
    return iter(value)


def several_records(value: Iterable[T] | None, kind: type[T]) -> list[T]:
    """Several records that a stage gave.

    Raises:
        TypeError: one of them is something else.
    """
    return [a_record(each, kind) for each in items_of(value, kind)]


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
        a_record(file, EmittedFile)
        for what, kind in (("name", str), ("content", bytes)):
            if not isinstance(value := getattr(file, what), kind):
                found = f"{value!r:.60} ({type(value).__name__})"
                raise TypeError(f"it gave an EmittedFile whose {what} is {found}, not {kind.__name__}")
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
