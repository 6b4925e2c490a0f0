"""Values of a YAML document that know their place in the file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from math import tau
from typing import Any, TypeAlias

from dh2urdf.errors import ConfigError, InputError
from dh2urdf.source import Mark, Messages, Problem, shown

say = Messages(__file__)

MAX_DIGITS = 400
"""Digits of a whole number: more than the largest double has."""
LARGEST_BARE = {"angle": tau, "length": 10.0}
"""What measures more than this needs its unit: degrees or mm may be meant [rad, m]."""

NodeValue: TypeAlias = "dict[str, Node] | list[Node] | str | int | float | bool | None"


@dataclass(slots=True)
class Node:
    """A value of a document and the place where it stands.

    It is never changed once it is made; that it is not declared frozen, and makes its marks when asked, halves the
    time and the memory of a large table.

    Attributes:
        value: the value as the YAML 1.2 core schema has it.
        file: the file it is in.
        line: where the value starts, from 1; 0 for a value without a place.
        column: where the value starts, from 1; 0 for a value without a place.
        text: what a scalar says, before it became a number or a truth value; None for a mapping or a list.
        quoted: whether a scalar is in quotes or is a block of text, so that it can only be a string.
        key_places: line and column of each key of a mapping.
        place: the place of a value that is in a cell, as the file's format names it; see `Mark.place`.
    """

    value: NodeValue
    file: str
    line: int
    column: int
    text: str | None = None
    quoted: bool = False
    key_places: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    place: str | None = None

    @property
    def mark(self) -> Mark:
        """Where the value starts."""
        return Mark(file=self.file, line=self.line or None, column=self.column or None, place=self.place)

    def key_mark(self, key: str) -> Mark:
        """Where a key of the mapping stands; where it stands nowhere, its value's place."""
        if key in self.key_places:
            line, column = self.key_places[key]
            return Mark(file=self.file, line=line, column=column, place=self.place)
        if isinstance(self.value, dict) and key in self.value:
            return self.value[key].mark
        return self.mark

    def entry(self, key: str) -> Node | None:
        """The value of a key; None where this is no mapping or has no such key."""
        return self.value.get(key) if isinstance(self.value, dict) else None

    def entries(self, key: str) -> list[Node]:
        """The entries of a list that is the value of a key; none where there is no such list."""
        found = self.entry(key)
        return found.value if found and isinstance(found.value, list) else []

    def plain(self) -> Any:  # noqa: ANN401 - any value that YAML can hold
        """The value as plain dictionaries, lists and scalars; its depth is at most `MAX_DEPTH`."""
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value

    def describe(self) -> str:
        """What kind of value this is, in words: ``the number 3``, ``a list``, ``nothing``."""
        match self.value:
            case dict():
                return "a mapping"
            case list():
                return f"a list of {len(self.value)}" if self.value else "an empty list"
            case None:
                return "an empty value"
            case bool():
                return f"the truth value {self.text}"
            case int() | float():
                return f"the number {shown(self.text or '')[1:-1]}"
            case _:
                return f"the text {shown(self.value)}"


@dataclass(frozen=True, slots=True)
class Item:
    """One entry of a long list, and what is wrong with it as YAML.

    Attributes:
        node: the entry.
        problems: duplicate keys and the like; the entry cannot be trusted where there are any.
    """

    node: Node
    problems: tuple[Problem, ...] = ()


def expect_mapping(node: Node, what: str, error: type[InputError] = ConfigError) -> dict[str, Node]:
    """The entries of a mapping.

    Args:
        node: what should be a mapping.
        what: what it is, for the message: ``a run file``.
        error: the type of the error raised.

    Raises:
        InputError: of the type given, where it is anything else.
    """
    if isinstance(node.value, dict):
        return node.value
    raise error(say("not-a-mapping", node.mark, found=node.text, what=what, kind=node.describe()))


# YAML 1.2.2, section 10.3.2, the tag resolution of the core schema.
_CONSTANTS = (
    dict.fromkeys(("", "~", "null", "Null", "NULL"))
    | dict.fromkeys(("true", "True", "TRUE"), True)
    | dict.fromkeys(("false", "False", "FALSE"), False)
    | {sign + inf: float(sign + "inf") for sign in ("", "+", "-") for inf in (".inf", ".Inf", ".INF")}
    | dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan"))
)
_INT = r"[-+]?[0-9]+"
_OCTAL_OR_HEXADECIMAL = r"0o[0-7]+|0x[0-9a-fA-F]+"
_FLOAT = r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"


@lru_cache(maxsize=4096)
def core_value(text: str) -> str | float | bool | None:
    """The value of an unquoted scalar."""
    if text in _CONSTANTS:
        return _CONSTANTS[text]
    if text[0] not in "+-.0123456789":
        return text
    if re.fullmatch(_INT, text) and len(text) <= MAX_DIGITS:
        return int(text)
    if re.fullmatch(_FLOAT, text):
        return float(text)
    if re.fullmatch(_OCTAL_OR_HEXADECIMAL, text):
        return int(text, 0)
    return text
