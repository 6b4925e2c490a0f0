"""What a table says of all of its rows, as texts: name, convention, units, base, tool and defaults."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.table_text import yaml_word
from dh2urdf_plugins.readers.fields import convention_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from dh2urdf.documents import Node

_LENGTHS = ("m", "cm", "mm", "µm")
_ANGLES = ("rad", "deg")


def statements_of(statements: Mapping[str, Node], *, default_name: str) -> dict[str, str] | None:
    """The texts of a table's statements by attribute of `TableText`; None where one has a form that has no such text.

    Args:
        statements: the statements by key.
        default_name: the manipulator's name where none of them says it.
    """
    name, convention = statements.get("name"), statements.get("convention")
    said = {"name": (name and name.text) or default_name}
    if convention is not None:
        word = convention_of(convention.text or "")
        said["convention"] = str(word) if word else convention.text or ""
    for key in ("base", "tool", "defaults"):
        if key in statements:
            said[key] = flow_text(statements[key])
    if (units := statements.get("units")) is not None:
        nodes = units.value.values() if isinstance(units.value, dict) else ()
        words = [node.text or "" for node in nodes] or (units.text or "").replace(",", " ").split()
        found = units_of(words)
        if found is None:
            return None
        said |= found
    return said


def units_of(words: Iterable[str]) -> dict[str, str] | None:
    """Units by attribute of `TableText`; None where they are not at most one of lengths and one of angles."""
    found: dict[str, str] = {}
    for word in words:
        key = "length_unit" if word in _LENGTHS else "angle_unit" if word in _ANGLES else None
        if key is None or found.setdefault(key, word) != word:
            return None
    return found


def flow_text(node: Node) -> str:
    """A value of YAML in one line."""
    parts: list[str] = []
    waiting: list[Node | str] = [node]
    while waiting:
        item = waiting.pop()
        if isinstance(item, str):
            parts.append(item)
        elif isinstance(item.value, dict):
            inner: list[Node | str] = ["{"]
            for index, (key, value) in enumerate(item.value.items()):
                inner += [f"{', ' if index else ''}{yaml_word(key)}: ", value]
            waiting += reversed([*inner, "}"])
        elif isinstance(item.value, list):
            inner = ["["]
            for index, value in enumerate(item.value):
                inner += [*([", "] if index else []), value]
            waiting += reversed([*inner, "]"])
        else:
            parts.append(item.text or "" if item.value is None else yaml_word(item.text or ""))
    return "".join(parts)
