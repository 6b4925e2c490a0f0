"""Tables as JSON: numbers in SI units under the keys that the reader ``yaml`` knows, and transforms as matrices."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from dh2urdf.rotations import IDENTITY
from dh2urdf.row_fields import INERTIA, LIMITS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.manipulator import DHRow, Inertia, LinkGeometry, Manipulator, MeshShape, Payload
    from dh2urdf.rotations import RigidTransform


def json_file(arms: Sequence[Manipulator]) -> bytes:
    """One table, or several as a list of robots."""
    tables = [_table(arm) for arm in arms]
    document = tables[0] if len(tables) == 1 else {"robots": tables}
    return f"{json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)}\n".encode()


def _table(arm: Manipulator) -> dict[str, Any]:
    base = _said(
        matrix=_matrix(arm.base),
        mass=arm.base_mass,
        geometry=_geometry(arm.base_geometry),
        visual=_mesh(arm.base_visual),
        collision=_mesh(arm.base_collision),
    )
    return _said(
        name=arm.name,
        convention=str(arm.convention),
        units={"length": "m", "angle": "rad"},
        base=base,
        tool=_said(matrix=_matrix(arm.tool)) or None,
        payload=_payload(arm.payload),
        defaults=_said(geometry=_geometry(arm.geometry), density=arm.density) or None,
        visuals=_drawn(arm.visuals),
        collisions=_drawn(arm.collisions),
        joints=[_row(row) for row in arm.rows],
    )


def _row(row: DHRow) -> dict[str, Any]:
    return _said(
        name=row.joint,
        link=row.link,
        type=str(row.type),
        a=row.a,
        alpha=row.alpha,
        d=row.d,
        theta=row.theta,
        offset=row.offset or None,
        sign=row.sign if row.sign != 1 else None,
        limits=_said(**{name: getattr(row.limits, name) for name in LIMITS}) or None,
        mass=row.mass,
        com=row.com,
        inertia=_inertia(row.inertia),
        radius=row.radius,
        damping=row.damping,
        friction=row.friction,
        armature=row.armature,
        visual=_mesh(row.visual),
        collision=_mesh(row.collision),
    )


def _said(**entries: object) -> dict[str, Any]:
    """The entries that say something."""
    return {key: value for key, value in entries.items() if value is not None and value != {}}


def _matrix(transform: RigidTransform) -> list[list[float]] | None:
    if transform == IDENTITY:
        return None
    r, t = transform
    return [[*r[0:3], t[0]], [*r[3:6], t[1]], [*r[6:9], t[2]], [0.0, 0.0, 0.0, 1.0]]


def _inertia(inertia: Inertia | None) -> dict[str, Any] | None:
    return {name: getattr(inertia, name) for name in INERTIA} if inertia else None


def _payload(payload: Payload | None) -> dict[str, Any] | None:
    return _said(mass=payload.mass, com=payload.com, inertia=_inertia(payload.inertia)) if payload else None


def _geometry(geometry: LinkGeometry) -> dict[str, Any] | None:
    return _said(shape=geometry.shape, radius=geometry.radius) or None


def _mesh(shape: MeshShape | None) -> dict[str, Any] | None:
    if shape is None:
        return None
    scale = shape.scale if shape.scale != (1.0, 1.0, 1.0) else None
    return _said(file=shape.file.path, scale=scale, matrix=_matrix(shape.pose))


def _drawn(whether: bool | None) -> str | None:  # noqa: FBT001 - a field of three values
    return None if whether is None else "all" if whether else "none"
