"""What a record of a plugin has to be; those of dh2urdf itself are not checked."""

from __future__ import annotations

import re
from dataclasses import fields, is_dataclass
from typing import Any, get_args

from dh2urdf import stages
from dh2urdf.stages import Compares, Edit, Executor, Kind, Subcommand

RECORDS: dict[Kind, type[Any]] = {kind: getattr(stages, kind.capitalize()) for kind in get_args(Kind)}
CAPABILITIES: dict[Kind, tuple[type[Any], ...]] = {
    kind: get_args(getattr(stages, f"{kind.capitalize()}Capability")) for kind in get_args(Kind)
}
_NAMES = {"command": r"[^\s:=-][^\s:=]*"}  # of anything else: a word without a colon


def type_of(kind: str) -> type[Any]:
    """The type of the records of a kind of stage, or of commands."""
    return Subcommand if kind == "command" else RECORDS[kind]  # type: ignore[index] # it is a kind of stage


def check_record(kind: str, record: Any, source: str) -> None:  # noqa: ANN401 - whatever a plugin gave
    """Raise a TypeError or ValueError where it is no record of the kind that could be asked for by its name."""
    if not isinstance(record, type_of(kind)):
        given = f"{type(record).__name__} {record!r:.60}"
        raise TypeError(f"{source} gave {given}, not a dh2urdf.stages.{type_of(kind).__name__}")
    name, whose = record.name, f"of the {kind} {record.name!r:.60}"
    if not isinstance(name, str) or not name.isprintable() or not re.fullmatch(_NAMES.get(kind, r"[^\s:]+"), name):
        raise ValueError(f"the {kind} {name!r:.60} has no name that could be asked for: one word without a colon")
    for what in ("summary", "function", "behind"):
        text = getattr(record, what, "")
        if not isinstance(text, str) or not text.isprintable():
            raise TypeError(f"the {what} {whose} is {text!r:.60}, not a line of text")
    if isinstance(record, Subcommand):
        if not re.fullmatch(r"[\w.]+:\w+", record.function):
            raise ValueError(f"the function {whose} is {record.function!r:.60}; accepted: module:name")
        return
    _check_fields(record, whose)
    _check_capabilities(record, CAPABILITIES[kind], whose)  # type: ignore[index] # it is a kind of stage


def _check_fields(stage: Any, whose: str) -> None:  # noqa: ANN401 - a record
    """Raise a TypeError or ValueError where options, suffixes or formats are not what they should be."""
    if not (isinstance(stage.options, type) and is_dataclass(stage.options)):
        raise TypeError(f"the options {whose} are {stage.options!r:.60}, not a dataclass")
    for what in ("suffixes", "formats"):
        words = getattr(stage, what, ())
        if not isinstance(words, tuple) or not all(isinstance(word, str) for word in words):
            raise TypeError(f"the {what} {whose} are {words!r:.60}, not a tuple of texts")
    for suffix in getattr(stage, "suffixes", ()):
        if not re.fullmatch(r"\.[^\s/\\]+", suffix) or suffix != suffix.lower():
            raise ValueError(f"a suffix {whose} is {suffix!r:.60}; accepted: lower case, with the dot before it")


def _check_capabilities(stage: Any, known: tuple[type[Any], ...], whose: str) -> None:  # noqa: ANN401 - a record
    """Raise a TypeError or ValueError where fields or capabilities of a record do not go together."""
    given = stage.capabilities
    if not isinstance(given, tuple) or not all(isinstance(each, known) for each in given):
        accepted = ", ".join(each.__name__ for each in known)
        raise TypeError(f"the capabilities {whose} are {given!r:.60}, not a tuple of {accepted}")
    if len({type(each) for each in given}) < len(given):
        raise ValueError(f"the capabilities {whose} have one twice: {given!r:.200}")
    if isinstance(stage, Executor) and (stage.map is None) is (stage.pool is None):
        raise ValueError(f"the executor {stage.name!r} has to give either map or pool")
    if isinstance(stage, Edit) and stage.edit_table is None and stage.edit_robot is None:
        raise ValueError(f"the edit {stage.name!r} has to give edit_table, edit_robot, or both")
    compares = stage.can(Compares)
    if compares and compares.option not in {each.name for each in fields(stage.options)}:
        raise ValueError(f"what is compared {whose} is {compares.option!r:.60}, which is none of its options")
