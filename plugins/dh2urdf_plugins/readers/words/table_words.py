"""What a table declares about all of its rows, as texts: name, convention, units, base, tool, payload and defaults."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.quantities import Dimension
from dh2urdf.row_fields import ROW_FIELDS
from dh2urdf.table_text import ANGLE_UNITS, LENGTH_UNITS
from dh2urdf.table_text.texts import yaml_word
from dh2urdf_plugins.readers.words.fields import convention_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from dh2urdf.documents import Node
    from dh2urdf.table_text import TableText

_LENGTHS = (*LENGTH_UNITS, "µm")
_CHOSEN = ("length", "angle")
"""Keys of `units` that a `TableText` has a choice of."""
_WITHOUT_CHOICE = {"inertia": "kg·m²", "effort": "[Nm, N]", "damping": "[N·m·s/rad, N·s/m]"}
_MEASURED = {
    word: tuple(name for name, field in ROW_FIELDS.items() if field.dimension is dimension)
    for word, dimension in (
        ("inertia", Dimension.INERTIA),
        ("effort", Dimension.TORQUE),
        ("damping", Dimension.DAMPING),
    )
}
"""What a `TableText` has in SI units, whatever its lengths are in: units by key, and fields that have them."""


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
    for key in ("base", "tool", "payload", "defaults", "visuals", "collisions"):
        if key in statements:
            said[key] = flow_text(statements[key])
    if (units := statements.get("units")) is not None:
        entries = units.value if isinstance(units.value, dict) else {}
        if any(flow_text(node) != _WITHOUT_CHOICE.get(key) for key, node in entries.items() if key not in _CHOSEN):
            return None
        words = [entries[key].text or "" for key in _CHOSEN if key in entries] if entries else []
        found = units_of(words or (units.text or "").replace(",", " ").split())
        if found is None:
            return None
        said |= found
    return said


def units_of(words: Iterable[str]) -> dict[str, str] | None:
    """Units by attribute of `TableText`; None where they are not at most one of lengths and one of angles."""
    found: dict[str, str] = {}
    for word in words:
        key = "length_unit" if word in _LENGTHS else "angle_unit" if word in ANGLE_UNITS else None
        if key is None or found.setdefault(key, word) != word:
            return None
    return found


def units_text(table: TableText) -> str:
    """What a table declares about its units, as a mapping of YAML: its own choice, and units of other numbers."""
    said = {"length": table.length_unit, "angle": table.angle_unit}
    if (table.length_unit, table.angle_unit) != ("m", "rad"):
        used = table.columns()
        said |= {key: _WITHOUT_CHOICE[key] for key, fields in _MEASURED.items() if {*fields}.intersection(used)}
    return f"{{{', '.join(f'{key}: {unit}' for key, unit in said.items())}}}"


def flow_text(node: Node) -> str:
    """A value of YAML in one line."""
    if isinstance(node.value, dict):
        return "{" + ", ".join(f"{yaml_word(key)}: {flow_text(value)}" for key, value in node.value.items()) + "}"
    if isinstance(node.value, list):
        return f"[{', '.join(map(flow_text, node.value))}]"
    return node.text or "" if node.value is None else yaml_word(node.text or "")
