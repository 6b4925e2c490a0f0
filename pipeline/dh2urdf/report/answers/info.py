"""What was understood of a table: every value in SI units, as it was typed, and where; as plain data."""

from __future__ import annotations

import math
from dataclasses import asdict, is_dataclass
from typing import TYPE_CHECKING, Any, Final, Literal

from dh2urdf._version import __version__
from dh2urdf.kinematics.chain import forward_kinematics, joint_variables
from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf.report.answers.conversions import BASE, filled_in
from dh2urdf.report.manifest import axes_entry
from dh2urdf.rotations import norm
from dh2urdf.row_fields import COM, INERTIA, LIMITS, NUMBERS, ROW_FIELDS, SI_UNITS
from dh2urdf.table_text import Trace

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.manipulator import DHRow
    from dh2urdf.results import BriefEntry, Detail, DistanceEntry, FieldEntry, InfoReport, Placement
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Mark, Problem
    from dh2urdf.stages import Rejected
    from dh2urdf.table_text import Said

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
    arm = item if isinstance(item, Manipulator) else None
    return {
        "name": item.name,
        "place": _place(item.mark),
        "convention": arm.convention.value if arm else None,
        "joints": len(arm.rows) if arm else None,
        "moving": len(arm.moving_rows) if arm else None,
        "notices": [notice.as_json() for notice in item.notices],
        "errors": [problem.as_json() for problem in getattr(item, "problems", ())],
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
    masses = {link.name: link.inertial.mass for link in robot.links if link.inertial} if robot else {}
    unsaid: Literal["default", "read"] = READ if trace is None else DEFAULT
    trace = trace or Trace()
    said = [*trace.rows, *([{}] * (len(manipulator.rows) - len(trace.rows)))]
    place = {key: _place(each.mark) for key, each in trace.table.items()}
    units = {key.partition(".")[2]: each for key, each in trace.table.items() if key.startswith("units.")}
    at_zero = forward_kinematics(manipulator, [0.0] * len(manipulator.moving_rows))
    frame = [[*at_zero.rotation[3 * i : 3 * i + 3], at_zero.translation[i]] for i in range(3)]
    computed = filled_in(manipulator, robot).get("masses", ()) if robot else ()
    return {
        "name": manipulator.name,
        "place": _place(manipulator.mark),
        "convention": {"value": manipulator.convention.value, "place": place.get("convention")},
        "base": _placement(manipulator.base, place.get("base"), unsaid),
        "tool": _placement(manipulator.tool, place.get("tool"), unsaid),
        "units": [{"of": of, "unit": each.text or "", "place": _place(each.mark)} for of, each in units.items()],
        "stated": {key: {"value": value, "place": place.get(key)} for key, value in _stated(manipulator)},
        "joints": [
            {
                "name": row.joint,
                "link": row.link,
                "type": row.type.value,
                "place": _place(row.mark),
                "fields": [
                    {**entry, "from": unsaid} if entry["from"] == DEFAULT else entry
                    for entry in _fields(row, cells, joints.get(row.joint), masses.get(row.link))
                ],
            }
            for row, cells in zip(manipulator.rows, said, strict=True)
        ],
        "pose_at_zero": [*frame, [0.0, 0.0, 0.0, 1.0]],
        "largest_distance": largest_distance(manipulator, joints),
        "axes": axes_entry(manipulator),
        "mass": {
            "total": robot.mass if robot else None,
            "unit": "kg",
            "computed": ["base" if name == BASE else name for name in computed],
        },
        "notices": [notice.as_json() for notice in (*manipulator.notices, *(robot.notices if robot else ()))],
        "errors": [error.as_json() for error in errors],
    }


def _fields(row: DHRow, cells: Mapping[str, Said], joint: Joint | None, mass: float | None) -> Iterator[FieldEntry]:
    """Every field of a row that has a value, in the order of the page of tables."""
    values: dict[str, Any] = {"joint": row.joint, "link": row.link, "type": str(row.type)}
    values |= {name: getattr(row, name) for name in ("a", "alpha", "d", "theta")}
    filled: dict[str, Any] = {"mass": mass}
    told = dict(cells)
    if row.type is not JointType.FIXED:
        # Offset and sign may be written as ``q2 + pi/2`` or ``-q2``.
        home = cells.get("d" if row.type is JointType.PRISMATIC else "theta")
        if home and row.offset:
            told.setdefault("offset", home)
        if flip := cells.get("flip") or (home if row.sign < 0 else None):
            told.setdefault("sign", flip)
        values |= {"offset": row.offset, "sign": row.sign}
        values |= {name: getattr(row.limits, name) for name in LIMITS}
        filled |= {name: getattr(joint.limits, name) for name in LIMITS} if joint else {}
    values |= {"mass": row.mass, **dict(zip(COM, row.com or (), strict=False))}
    values |= {name: getattr(row.inertia, name, None) for name in INERTIA}
    values |= {name: getattr(row, name) for name in _OPTIONAL}
    for name, value in values.items():
        if value is not None:
            yield _field(row, name, value, told.get(name))
        elif filled.get(name) is not None:
            yield {**_field(row, name, filled[name], None), "from": COMPUTED}
    for name in ("visual", "collision"):
        if (shape := getattr(row, name)) is not None:
            field = _field(row, name, shape.file.path, cells.get(name))
            yield {**field, "from": CELL, "place": _place(shape.mark)}


def _field(row: DHRow, name: str, value: float | str, said: Said | None) -> FieldEntry:
    unit = unit_of(name, row.type)
    return {
        "field": name,
        "value": value,
        "unit": unit,
        "from": CELL if said else DEFAULT,
        "typed": said.text if said else None,
        "read_in": said.unit or (unit if said.unit == "" else None) if said else None,
        "place": _place(said.mark) if said else None,
    }


def largest_distance(manipulator: Manipulator, joints: Mapping[str, Joint]) -> DistanceEntry:
    """A bound of the distance of tool0 from the origin of the first DH frame, at whatever joint values.

    The origin of a DH frame is √(a² + d²) from the one before, whatever theta and alpha are; the bound is the sum of
    these distances and of the tool's. No joint vector within the limits leads further; whether one leads as far is
    another question.

    Args:
        manipulator: the table.
        joints: the joints of its robot, whose limits replace those that the table leaves open.
    """
    bound, open_ends = norm(manipulator.tool.translation), []
    for row in manipulator.rows:
        ends: tuple[float | None, ...] = (0.0,)
        if row.type is JointType.PRISMATIC:
            given, filled = row.limits, joints[row.joint].limits if row.joint in joints else row.limits
            ends = (
                given.lower if given.lower is not None else filled.lower,
                given.upper if given.upper is not None else filled.upper,
            )
        values = [q for q in ends if q is not None]
        if len(values) < len(ends):
            open_ends.append(row.joint)
        else:
            bound += max(math.hypot(row.a, joint_variables(row, q)[1]) for q in values)
    return {
        "bound": None if open_ends else bound,
        "unit": "m",
        "of": "tool0 from the origin of the first DH frame",
        "without_limits": open_ends,
    }


def _stated(manipulator: Manipulator) -> Iterator[tuple[str, Any]]:
    """What else the table declares about the whole arm, by key."""
    for name in _STATED:
        value = getattr(manipulator, name, None)
        if is_dataclass(value) and not isinstance(value, type):
            value = {key: entry for key, entry in asdict(value).items() if entry is not None}
        if value not in (None, {}):
            yield name, value


def _placement(transform: RigidTransform, place: str | None, unsaid: Literal["default", "read"]) -> Placement:
    xyz, rpy = list(transform.translation), list(transform.rpy)
    return {"xyz": xyz, "rpy": rpy, "from": unsaid if place is None else CELL, "place": place}


def _place(mark: Mark | None) -> str | None:
    return str(mark) if mark else None
