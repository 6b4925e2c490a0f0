"""What was understood of a table: every value in SI units, as it was typed, and where; as plain data."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, Literal

from dh2urdf._version import __version__
from dh2urdf.kinematics.chain import forward_kinematics, joint_variables
from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf.provenance import Trace
from dh2urdf.report.answers.conversions import BASE, filled_in
from dh2urdf.report.axes import axes_entry
from dh2urdf.rotations import norm
from dh2urdf.row_fields import COM, INERTIA, LIMITS, NUMBERS, ROW_FIELDS, SI_UNITS

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.manipulator import DHRow
    from dh2urdf.provenance import Said
    from dh2urdf.results import (
        BriefEntry,
        Detail,
        DistanceEntry,
        FieldEntry,
        InfoReport,
        MassEntry,
        Placement,
    )
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Mark, Problem
    from dh2urdf.stages import Rejected

SCHEMA: Final = "dh2urdf-info/1"
"""Name and version of the form of what `dh2urdf info --json` prints."""
CELL: Final = "cell"
DEFAULT: Final = "default"
COMPUTED: Final = "computed"
READ: Final = "read"
"""Where a value comes from: a cell of the table, a default, or the transform, which computes what is left open; or a
reader that does not say what it read where, as most of plugins."""

_OPTIONAL = tuple(name for name in NUMBERS if name not in {"a", "alpha", "d", "theta", "offset", "mass"})
_STATED = ("geometry", "density", "base_mass", "base_geometry", "payload", "visuals", "collisions")


def unit_of(field: str, kind: JointType) -> str:
    """The SI unit of a field in the row of a joint; empty for words and plain numbers."""
    dimension = ROW_FIELDS[field].of(kind) if field in ROW_FIELDS else None
    return SI_UNITS.get(dimension, "") if dimension else ""


def info_report(
    source: str, arms: Sequence[BriefEntry], detail: Detail | None, exit_status: Literal[0, 1]
) -> InfoReport:
    """What `dh2urdf info --json` prints.

    Args:
        source: the table.
        arms: every manipulator of it, as `brief` gives it.
        detail: the one that is meant, as `details` gives it; None where none of several is.
        exit_status: the status with which the command ends.
    """
    return {
        "schema": SCHEMA,
        "version": __version__,
        "exit_status": exit_status,
        "source": source,
        "manipulators": list(arms),
        "detail": detail,
    }


def brief(item: Manipulator | Rejected) -> BriefEntry:
    """A manipulator of a table, in short."""
    place = _place(item.mark)
    if isinstance(item, Manipulator):
        return {
            "name": item.name,
            "place": place,
            "convention": item.convention.value,
            "joints": len(item.rows),
            "moving": len(item.moving_rows),
            "notices": [notice.as_json() for notice in item.notices],
            "errors": [],
        }
    return {
        "name": item.name,
        "place": place,
        "convention": None,
        "joints": None,
        "moving": None,
        "notices": [notice.as_json() for notice in item.notices],
        "errors": [problem.as_json() for problem in item.problems],
    }


def details(
    manipulator: Manipulator, trace: Trace | None, robot: Robot | None, errors: Sequence[Problem] = ()
) -> Detail:
    """All that was understood of a manipulator.

    Args:
        manipulator: the manipulator.
        trace: what its cells say; None where its reader does not know it.
        robot: the robot that the default transform makes of it; None where it makes none.
        errors: why there is no robot.
    """
    joints = {joint.name: joint for joint in robot.joints} if robot else {}
    unsaid: Literal["default", "read"] = READ if trace is None else DEFAULT
    trace = trace or Trace()
    said = [*trace.rows, *([{}] * (len(manipulator.rows) - len(trace.rows)))]
    notices = (*manipulator.notices, *(robot.notices if robot else ()))
    return {
        "name": manipulator.name,
        "place": _place(manipulator.mark),
        "convention": {"value": manipulator.convention.value, "place": _said_at(trace, "convention")},
        "base": _placement(manipulator.base, _said_at(trace, "base"), unsaid),
        "tool": _placement(manipulator.tool, _said_at(trace, "tool"), unsaid),
        "units": [
            {"of": key.partition(".")[2], "unit": said.text or "", "place": _place(said.mark)}
            for key, said in trace.table.items()
            if key.startswith("units.")
        ],
        "stated": {key: {"value": value, "place": _said_at(trace, key)} for key, value in _stated(manipulator).items()},
        "joints": [
            {
                "name": row.joint,
                "link": row.link,
                "type": row.type.value,
                "place": _place(row.mark),
                "fields": [
                    {**entry, "from": unsaid} if entry["from"] == DEFAULT else entry
                    for entry in _fields(row, cells, joints.get(row.joint), _mass_of(row, robot))
                ],
            }
            for row, cells in zip(manipulator.rows, said, strict=True)
        ],
        "pose_at_zero": _matrix(forward_kinematics(manipulator, [0.0] * len(manipulator.moving_rows))),
        "largest_distance": largest_distance(manipulator, joints),
        "axes": axes_entry(manipulator),
        "mass": _mass(manipulator, robot),
        "notices": [notice.as_json() for notice in notices],
        "errors": [error.as_json() for error in errors],
    }


# --- Rows -------------------------------------------------------------------------------------------------------------


def _fields(row: DHRow, cells: Mapping[str, Said], joint: Joint | None, mass: float | None) -> Iterator[FieldEntry]:
    """Every field of a row that has a value, in the order of the page of tables."""
    for name in ("joint", "link", "type"):
        yield _field(row, name, str(getattr(row, name)), cells)
    for name in ("a", "alpha", "d", "theta"):
        yield _field(row, name, getattr(row, name), cells)
    if row.type is not JointType.FIXED:
        yield from _fields_of_motion(row, cells, joint)
    yield from _filled(row, "mass", row.mass, mass, cells)
    body = [
        *zip(COM, row.com or (), strict=False),
        *((name, getattr(row.inertia, name, None)) for name in INERTIA),
        *((name, getattr(row, name)) for name in _OPTIONAL),
    ]
    for name, value in body:
        if value is not None:
            yield _field(row, name, value, cells)
    for name in ("visual", "collision"):
        if (shape := getattr(row, name)) is not None:
            yield {**_field(row, name, shape.file.path, cells, origin=CELL), "place": _place(shape.mark)}


def _fields_of_motion(row: DHRow, cells: Mapping[str, Said], joint: Joint | None) -> Iterator[FieldEntry]:
    """Offset, sign and limits of a row that moves; offset and sign may be written as ``q2 + pi/2`` or ``-q2``."""
    home = cells.get("d" if row.type is JointType.PRISMATIC else "theta")
    offset = cells.get("offset") or (home if row.offset else None)
    yield _field(row, "offset", row.offset, cells, offset)
    turned = cells.get("sign") or cells.get("flip") or (home if row.sign < 0 else None)
    yield _field(row, "sign", row.sign, cells, turned)
    for name in LIMITS:
        filled = getattr(joint.limits, name) if joint else None
        yield from _filled(row, name, getattr(row.limits, name), filled, cells)


def _filled(
    row: DHRow, name: str, value: float | None, computed: float | None, cells: Mapping[str, Said]
) -> Iterator[FieldEntry]:
    """A value of the table, or the one that the transform has filled in; nothing where there is neither."""
    if value is not None:
        yield _field(row, name, value, cells)
    elif computed is not None:
        yield _field(row, name, computed, {}, origin=COMPUTED)


def _field(
    row: DHRow,
    name: str,
    value: float | str,
    cells: Mapping[str, Said],
    said: Said | None = None,
    *,
    origin: Literal["cell", "default", "computed"] | None = None,
) -> FieldEntry:
    said = said or cells.get(name)
    return {
        "field": name,
        "value": value,
        "unit": unit_of(name, row.type),
        "from": origin or (CELL if said else DEFAULT),
        "typed": said.text if said else None,
        "read_in": said.unit or (unit_of(name, row.type) if said.unit == "" else None) if said else None,
        "place": _place(said.mark) if said else None,
    }


def _mass_of(row: DHRow, robot: Robot | None) -> float | None:
    links = robot.links if robot else ()
    return next((link.inertial.mass for link in links if link.name == row.link and link.inertial), None)


# --- The whole arm ----------------------------------------------------------------------------------------------------


def largest_distance(manipulator: Manipulator, joints: Mapping[str, Joint]) -> DistanceEntry:
    """A bound of the distance of tool0 from the origin of the first DH frame, at whatever joint values.

    The origin of a DH frame is √(a² + d²) from the one before, whatever theta and alpha are; the bound is the sum of
    these distances and of the tool's. No joint vector within the limits leads further; whether one leads as far is
    another question.

    Args:
        manipulator: the table.
        joints: the joints of its robot, whose limits replace those that the table leaves open.
    """
    sum_of = norm(manipulator.tool.translation)
    open_ends = []
    for row in manipulator.rows:
        ends: tuple[float | None, float | None] = (0.0, 0.0)
        if row.type is JointType.PRISMATIC:
            limits = joints[row.joint].limits if row.joint in joints else row.limits
            ends = (
                row.limits.lower if row.limits.lower is not None else limits.lower,
                row.limits.upper if row.limits.upper is not None else limits.upper,
            )
        if None in ends:
            open_ends.append(row.joint)
            continue
        sum_of += max(math.hypot(row.a, joint_variables(row, q)[1]) for q in ends)
    return {
        "bound": None if open_ends else sum_of,
        "unit": "m",
        "of": "tool0 from the origin of the first DH frame",
        "without_limits": open_ends,
    }


def _mass(manipulator: Manipulator, robot: Robot | None) -> MassEntry:
    computed = list(filled_in(manipulator, robot).get("masses", ())) if robot else []
    return {
        "total": robot.mass if robot else None,
        "unit": "kg",
        "computed": ["base" if name == BASE else name for name in computed],
    }


def _stated(manipulator: Manipulator) -> dict[str, Any]:
    """What else the table declares about the whole arm, by key."""
    from dataclasses import asdict, is_dataclass

    found = {}
    for name in _STATED:
        value = getattr(manipulator, name, None)
        if is_dataclass(value) and not isinstance(value, type):
            value = {key: entry for key, entry in asdict(value).items() if entry is not None}
        if value not in (None, {}):
            found[name] = value
    return found


def _placement(transform: RigidTransform, place: str | None, unsaid: Literal["default", "read"]) -> Placement:
    return {
        "xyz": list(transform.translation),
        "rpy": list(transform.rpy),
        "from": unsaid if place is None else CELL,
        "place": place,
    }


def _matrix(transform: RigidTransform) -> list[list[float]]:
    rotation, translation = transform.rotation, transform.translation
    rows = [[*rotation[3 * i : 3 * i + 3], translation[i]] for i in range(3)]
    return [*rows, [0.0, 0.0, 0.0, 1.0]]


def _said_at(trace: Trace, key: str) -> str | None:
    said = trace.table.get(key)
    return _place(said.mark) if said else None


def _place(mark: Mark | None) -> str | None:
    return str(mark) if mark else None
