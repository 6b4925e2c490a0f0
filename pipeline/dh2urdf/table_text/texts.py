"""The numbers of a manipulator as the texts of a table: the shortest that read back to the same numbers."""

from __future__ import annotations

import math
import os
import re
from itertools import product
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import COM, INERTIA, LIMITS, NUMBERS, ROW_FIELDS
from dh2urdf.manipulator import JointType
from dh2urdf.quantities.number_text import format_number, number_in
from dh2urdf.quantities.units import RATES, UNITS, Dimension, Unit, unit_word
from dh2urdf.rotations import NEARLY_UPRIGHT, RigidTransform, Vec3, turned_over
from dh2urdf.table_text import FIELDS, MESHES

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from dh2urdf.manipulator import DHRow, Follower, LinkGeometry, Manipulator, MeshShape, Payload
    from dh2urdf.table_text import TableText

_FOLLOWING = (Dimension.LENGTH, Dimension.ANGLE, *RATES)
"""What the units of lengths and angles hold for."""
_DOUBTED = 4 * math.pi
"""Bounds above it [rad] are written with their unit: without one, they may be degrees."""
_YAW_PLACES = 12
"""How many places of roll and yaw are tried near a pitch of ±π/2."""


def table_text(
    manipulator: Manipulator, length_unit: str = "m", angle_unit: str = "rad", *, folder: Path | None = None
) -> TableText:
    """The texts of a manipulator: the shortest that read back to the same numbers.

    Args:
        manipulator: the arm.
        length_unit: the unit to write lengths in.
        angle_unit: the unit to write angles in.
        folder: that of the file that the table is for, from which the paths of its meshes lead; they are as the
            manipulator has them where it is None, or shares no folder with a mesh but the root of all.
    """
    from dh2urdf.table_text import TableText

    length, angle = UNITS[length_unit], UNITS[angle_unit]
    # A column of links has a name in every row.
    has_links = any(row.link != f"link_{number}" for number, row in enumerate(manipulator.rows, start=1))
    others = _meshes(manipulator, length, angle, folder, "base_")
    of_base: dict[str, Any] = {"mass": manipulator.base_mass, "geometry": manipulator.base_geometry, "others": others}
    return TableText(
        name=manipulator.name,
        convention=str(manipulator.convention),
        length_unit=length_unit,
        angle_unit=angle_unit,
        base=transform_text(manipulator.base, length, angle, **of_base),
        tool=transform_text(manipulator.tool, length, angle),
        payload=_flow(_payload(manipulator.payload, length)),
        defaults=_flow({"geometry": _geometry(manipulator.geometry, length), "density": manipulator.density}),
        visuals=_drawn(manipulator.visuals),
        collisions=_drawn(manipulator.collisions),
        rows=tuple(
            _row_text(row, length, angle, link=row.link if has_links else "") | _meshes(row, length, angle, folder)
            for row in manipulator.rows
        ),
    )


def transform_text(
    transform: RigidTransform,
    length: Unit,
    angle: Unit,
    *,
    mass: float | None = None,
    geometry: LinkGeometry | None = None,
    others: Mapping[str, str] | None = None,
) -> str:
    """A rigid transform as YAML in one line, as tables have it; empty where there is nothing to say.

    Args:
        transform: the transform.
        length: the unit of lengths.
        angle: the unit of angles.
        mass: mass of the base's body [kg].
        geometry: shape of the base's body.
        others: further entries of the mapping, as YAML by key.
    """
    body = {"mass": mass, "geometry": _geometry(geometry, length), **(others or {})}
    xyz = transform.translation
    shorter = (
        (float(f"{roll:.{digits}g}"), float(f"{pitch:.{digits}g}"), float(f"{yaw:.{digits}g}"))
        for digits, (roll, pitch, yaw) in product((9, 12, 17, 14, 15, 16), _same_rpy(transform.rpy))
    )
    rpy = next((angles for angles in shorter if RigidTransform.from_xyz_rpy(xyz, angles) == transform), None)
    if rpy is None:  # No angles that were tried make the transform to the last bit.
        (r, _), last = transform, ["0", "0", "0", "1"]
        rows = [[*r[3 * row : 3 * row + 3], number_in(xyz[row], length)] for row in range(3)]
        return _flow({"matrix": [*rows, last], **body} if _flow(body) else [*rows, last])
    placed = {
        "xyz": [number_in(value, length) for value in xyz] if any(xyz) else None,
        "rpy": [number_in(value, angle) for value in rpy] if any(rpy) else None,
    }
    return _flow(placed | body)


def _flow(value: Any) -> str:  # noqa: ANN401 - mappings and lists of numbers and of texts
    """A value as YAML in one line: of mappings the entries that say something, and texts as they are."""
    if isinstance(value, dict):
        entries = ", ".join(f"{key}: {text}" for key, item in value.items() if (text := _flow(item)))
        return f"{{{entries}}}" if entries else ""
    if isinstance(value, list):
        return f"[{', '.join(map(_flow, value))}]"
    return "" if value is None else value if isinstance(value, str) else format_number(value)


def _same_rpy(rpy: Vec3) -> list[Vec3]:
    """Angles of the same rotation: near a pitch of ±π/2, where roll ∓ yaw counts, those of a shorter yaw come first."""
    if abs(math.cos(rpy[1])) >= NEARLY_UPRIGHT:
        return [rpy]
    found: list[Vec3] = []
    for roll, pitch, yaw in sorted((rpy, turned_over(rpy)), key=lambda angles: abs(angles[2])):
        for other in (0.0, *dict.fromkeys(round(yaw, places) for places in range(_YAW_PLACES)), yaw):
            first = math.remainder(roll + math.copysign(1.0, pitch) * (other - yaw), math.tau)
            found += [(first, pitch, other), (round(first, _YAW_PLACES), pitch, other)]
    return found


def dimension_of(field: str, kind: JointType) -> Dimension | None:
    """What a field measures in the row of a joint, as far as a unit of the table holds for it."""
    dimension = ROW_FIELDS[field].of(kind) if field in ROW_FIELDS else None
    return dimension if dimension in _FOLLOWING else None


def unit_of(dimension: Dimension, length: Unit, angle: Unit) -> Unit:
    """The unit of a dimension that follows the units of lengths and angles."""
    base, per = RATES.get(dimension, (dimension, ""))
    unit = length if base is Dimension.LENGTH else angle
    return UNITS[unit_word(f"{unit.symbol}{per}")] if per else unit


def _row_text(row: DHRow, length: Unit, angle: Unit, *, link: str) -> dict[str, str]:
    texts = {"joint": row.joint, "type": str(row.type)}
    if link:
        texts["link"] = link
    values: dict[str, float | None] = {name: getattr(row, name) for name in NUMBERS}  # None: it says nothing
    values |= {"offset": row.offset or None, "sign": None if row.sign == 1 else row.sign}
    values |= {name: getattr(row.limits, name) for name in LIMITS}
    values |= dict(zip(COM, row.com or (), strict=False))
    values |= {name: getattr(row.inertia, name, None) for name in INERTIA}
    for field, value in values.items():
        if value is not None:
            dimension = dimension_of(field, row.type)
            unit = dimension and unit_of(dimension, length, angle)
            texts[field] = number_in(value, unit) if unit else format_number(value)
            if field in LIMITS and dimension is Dimension.ANGLE and not angle.degrees and abs(value) > _DOUBTED:
                texts[field] += f" {angle.symbol}"
    if row.follows:
        unit = length if row.type is JointType.PRISMATIC else angle
        texts["follows"] = law_text(row.follows, number_in(row.follows.offset, unit))
    if row.type is JointType.FIXED:
        texts = {field: text for field, text in texts.items() if field not in LIMITS}
    return {field: texts[field] for field in FIELDS if field in texts}


def law_text(law: Follower, offset: str) -> str:
    """How a joint follows another one, as tables write it: ``-j2``, ``0.5 * j2 + pi/2``; given the offset's text."""
    factor = {1.0: "", -1.0: "-"}.get(law.multiplier, f"{format_number(law.multiplier)} * ")
    added = f" - {offset[1:]}" if offset.startswith("-") else f" + {offset}"
    return f"{factor}{law.leader}{added if law.offset else ''}"


def _geometry(geometry: LinkGeometry | None, length: Unit) -> dict[str, str | None]:
    if geometry is None:
        return {}
    radius = None if geometry.radius is None else number_in(geometry.radius, length)
    return {"shape": geometry.shape, "radius": radius}


def _payload(payload: Payload | None, length: Unit) -> dict[str, Any]:
    if payload is None:
        return {}
    tensor = {name: getattr(payload.inertia, name, 0.0) for name in INERTIA}
    return {
        "mass": payload.mass,
        "com": [number_in(value, length) for value in payload.com] if any(payload.com) else None,
        "inertia": {  # with its unit: beside lengths in mm, a bare number is refused
            name: f"{format_number(value)} kg·m²"
            for name, value in tensor.items()
            if value or (payload.inertia and name in INERTIA[:3])
        },
    }


def _meshes(
    record: DHRow | Manipulator, length: Unit, angle: Unit, folder: Path | None, prefix: str = ""
) -> dict[str, str]:
    """The meshes of a link or of the base as YAML in one line, by key."""
    found = {}
    for key in MESHES:
        shape: MeshShape | None = getattr(record, prefix + key)
        if shape is not None:
            path, scale = shape.file.path, [*shape.scale]
            if folder is not None and os.path.commonpath([path, folder.absolute()]) != os.sep:
                path = os.path.relpath(path, folder)
            entries = {"file": yaml_word(path)} | ({} if scale == [1.0, 1.0, 1.0] else {"scale": _flow(scale)})
            found[key] = transform_text(shape.pose, length, angle, others=entries)
    return found


def _drawn(whether: bool | None) -> str:  # noqa: FBT001 - a field of three values
    return "" if whether is None else "all" if whether else "none"


_PLAIN_WORD = r"[A-Za-z0-9_.π°√][A-Za-z0-9_.+*/()π°√ -]*(?<! )|-[A-Za-z0-9_.(π√][A-Za-z0-9_.+*/()π°√ -]*(?<! )"
_OTHER_THAN_TEXT = r"(?i)~|null|true|false|\.(inf|nan)"


def yaml_word(text: str) -> str:
    """A text as a scalar of YAML, bare where that is the same: ``pi/2``, ``-425 mm``, ``"a: b"``."""
    if re.fullmatch(_PLAIN_WORD, text) and not re.fullmatch(_OTHER_THAN_TEXT, text):
        return text
    import json

    return json.dumps(text, ensure_ascii=False)
