"""How stages declare their options."""

from __future__ import annotations

from dataclasses import field
from typing import Any, TypeVar

T = TypeVar("T")


def option(text: str, default: T, **more: object) -> T:
    """A field of an options dataclass: what it is for, its default, and what else the host takes from its metadata.

    That is what a number `measures`, which may then have a unit; and the `flag` of the commands, such as ``FILE``,
    whether it is `repeatable`, and which `commands` alone have it.
    """
    return field(default=default, metadata={"help": text, **more})


def mapping(text: str, **more: object) -> Any:  # noqa: ANN401 - a dictionary, as `dataclasses.field`
    """A field that is a mapping by names of the arm, empty by default.

    With a word for `others` in the metadata, such as ``JOINT``, it holds all keys that are no other option.
    """
    return field(default_factory=dict, hash=False, metadata={"help": text, **more})
