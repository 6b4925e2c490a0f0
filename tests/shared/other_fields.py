"""Records of stages with one field changed, of the record or of one of its capabilities."""

from dataclasses import fields, replace
from typing import Any

from dh2urdf.plugin_system.records import CAPABILITIES


def with_field(stage: Any, field: str, value: Any) -> Any:
    """The stage with another value in a field; a capability that is missing is added, and None removes one."""
    if field in {each.name for each in fields(stage)}:
        return replace(stage, **{field: value})
    kind = type(stage).__name__.lower()
    capability = next(each for each in CAPABILITIES[kind] if field in getattr(each, "_fields", ()))  # type: ignore[index]
    own = stage.can(capability)
    others = tuple(each for each in stage.capabilities if each is not own)
    if value is None and field == capability._fields[0]:
        return replace(stage, capabilities=others)
    needed = {name: dict for name in capability._fields if name not in capability._field_defaults}
    made = own._replace(**{field: value}) if own else capability(**{**needed, field: value})
    return replace(stage, capabilities=(*others, made))
