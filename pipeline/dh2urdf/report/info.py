"""What was understood of a table: every value in SI units, as it was typed, and where; as data and as text."""

from __future__ import annotations

import math
from dataclasses import asdict, is_dataclass
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias

from dh2urdf._version import __version__
from dh2urdf.columns import COM, INERTIA, LIMITS, NUMBERS, ROW_FIELDS, SI_UNITS
from dh2urdf.kinematics.chain import forward_kinematics, joint_variables
from dh2urdf.kinematics.facts import kinematic_facts
from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf.quantities.number_text import number_in
from dh2urdf.quantities.units import UNITS
from dh2urdf.report.conversions import BASE, counted, filled_in
from dh2urdf.report.manifest import axes_entry
from dh2urdf.rotations import norm
from dh2urdf.source import markdown_text, printable
from dh2urdf.table_text import Trace
from dh2urdf.table_text.texts import law_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from dh2urdf.manipulator import DHRow
    from dh2urdf.results import BriefEntry, Detail, DistanceEntry, FieldEntry, InfoReport, Placement
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Mark, Problem
    from dh2urdf.stages import Rejected
    from dh2urdf.table_text import Said

SCHEMA: Final = "dh2urdf-info/1"
CELL: Final = "cell"
DEFAULT: Final = "default"
COMPUTED: Final = "computed"
READ: Final = "read"
"""Where a value comes from: a cell of the table, a default, or the transform, which computes what is left open; or a
reader that does not say what it read where, as most of plugins."""
_OPTIONAL = tuple(name for name in NUMBERS if name not in {"a", "alpha", "d", "theta", "offset", "mass"})
_STATED = ("geometry", "density", "base_mass", "base_geometry", "payload", "visuals", "collisions")
HEAD = ("joint", "field", "value", "as typed", "read in", "place")
MOST_ARMS = 40  # manipulators of a table that are listed; the rest are counted
WIDTH = 100  # characters of a line on a terminal
_KINDS = {"turn_rate": "angular speed", "linear_damping": "linear damping"}
"""Kinds of quantities, as a sentence names them."""
_CALLED = {"geometry": "shape of the links", "base_mass": "mass of the base", "base_geometry": "shape of the base"}
_STATED_UNITS = {"density": "kg/m³", "base_mass": "kg", "com": "m"}
_LONGEST = 11  # characters of an angle as a multiple of pi; a longer one is a number of nine digits
_MARK = "*"  # what is behind a value that the table does not say
_MATRIX = "T(base_link → tool0) at q = 0:"
Unsaid: TypeAlias = Literal["cell", "default", "computed", "read"]
_Lines: TypeAlias = "tuple[list[str], list[tuple[list[str], bool]], list[str]]"
"""A table as text: its header; its rows, and whether the table says what is in each; and the lines below them."""


def unit_of(field: str, kind: JointType) -> str:
    """The SI unit of a field in the row of a joint; empty for words and plain numbers."""
    dimension = ROW_FIELDS[field].of(kind) if field in ROW_FIELDS else None
    return SI_UNITS.get(dimension, "") if dimension else ""


def info_report(source: str, arms: Sequence[BriefEntry], detail: Detail | None) -> InfoReport:
    """What `dh2urdf info --json` prints: all manipulators of a table in short, and the one that is meant in full."""
    return {
        "schema": SCHEMA,
        "version": __version__,
        "exit_status": 1 if any(arm["errors"] for arm in (arms if detail is None else [detail])) else 0,
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
    """All that was understood of a manipulator, whose reader may know what its cells say, and may make a robot."""
    joints = {joint.name: joint for joint in robot.joints} if robot else {}
    masses = {link.name: link.inertial.mass for link in robot.links if link.inertial} if robot else {}
    unsaid: Literal["default", "read"] = READ if trace is None else DEFAULT
    trace = trace or Trace()
    said = [*trace.rows, *([{}] * (len(manipulator.rows) - len(trace.rows)))]
    place = {key: _place(each.mark) for key, each in trace.table.items()}
    units = {key.partition(".")[2]: each for key, each in trace.table.items() if key.startswith("units.")}
    at_zero = forward_kinematics(manipulator, [0.0] * len(manipulator.actuated_rows))
    frame = [[*at_zero.rotation[3 * i : 3 * i + 3], at_zero.translation[i]] for i in range(3)]
    stated: dict[str, Any] = {name: getattr(manipulator, name, None) for name in _STATED}
    for name, value in stated.items():
        if is_dataclass(value) and not isinstance(value, type):
            stated[name] = {key: entry for key, entry in asdict(value).items() if entry is not None}
    computed = filled_in(manipulator, robot).get("masses", ()) if robot else ()
    return {
        "name": manipulator.name,
        "place": _place(manipulator.mark),
        "convention": {"value": manipulator.convention.value, "place": place.get("convention")},
        "base": _placement(manipulator.base, place.get("base"), unsaid),
        "tool": _placement(manipulator.tool, place.get("tool"), unsaid),
        "units": [{"of": of, "unit": each.text or "", "place": _place(each.mark)} for of, each in units.items()],
        "stated": {k: {"value": v, "place": place.get(k)} for k, v in stated.items() if v not in (None, {})},
        "joints": [
            {
                "name": row.joint,
                "link": row.link,
                "type": row.type.value,
                "place": _place(row.mark),
                "fields": list(_fields(row, cells, joints.get(row.joint), masses.get(row.link), unsaid)),
            }
            for row, cells in zip(manipulator.rows, said, strict=True)
        ],
        "pose_at_zero": [*frame, [0.0, 0.0, 0.0, 1.0]],
        "largest_distance": largest_distance(manipulator, joints),
        "axes": axes_entry(kinematic_facts(manipulator)),
        "mass": {
            "total": robot.mass if robot else None,
            "unit": "kg",
            "computed": ["base" if name == BASE else name for name in computed],
        },
        "notices": [notice.as_json() for notice in (*manipulator.notices, *(robot.notices if robot else ()))],
        "errors": [error.as_json() for error in errors],
    }


def _fields(
    row: DHRow, cells: Mapping[str, Said], joint: Joint | None, mass: float | None, unsaid: Unsaid
) -> Iterator[FieldEntry]:
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
    if row.follows:
        values["follows"] = law_text(row.follows, _number(row.follows.offset, unit_of("offset", row.type)))
    for name, value in values.items():
        if value is not None:
            yield _field(row, name, value, told.get(name), unsaid)
        elif filled.get(name) is not None:
            yield _field(row, name, filled[name], None, COMPUTED)
    for name in ("visual", "collision"):
        if (shape := getattr(row, name)) is not None:
            yield {**_field(row, name, shape.file.path, cells.get(name), CELL), "place": _place(shape.mark)}


def _field(row: DHRow, name: str, value: float | str, said: Said | None, unsaid: Unsaid) -> FieldEntry:
    unit = unit_of(name, row.type)
    return {
        "field": name,
        "value": value,
        "unit": unit,
        "from": CELL if said else unsaid,
        "typed": said.text if said else None,
        "read_in": said.unit or (unit if said.unit == "" else None) if said else None,
        "place": _place(said.mark) if said else None,
    }


def largest_distance(manipulator: Manipulator, joints: Mapping[str, Joint]) -> DistanceEntry:
    """A bound of the distance of tool0 from the origin of the first DH frame, at whatever joint values.

    The origin of a DH frame is √(a² + d²) from the one before, whatever theta and alpha are; the bound is the sum of
    these distances and of the tool's. Limits that the table leaves open are those of the robot's joints.
    """
    bound, open_ends = norm(manipulator.tool.translation), []
    for row in manipulator.rows:
        ends: list[float | None] = [0.0]
        if row.type is JointType.PRISMATIC:
            limits = (row.limits, joints[row.joint].limits if row.joint in joints else row.limits)
            ends = [
                next((q for each in limits if (q := getattr(each, end)) is not None), None)
                for end in ("lower", "upper")
            ]
        if None in ends:
            open_ends.append(row.joint)
        else:
            bound += max(math.hypot(row.a, joint_variables(row, q or 0.0)[1]) for q in ends)
    return {
        "bound": None if open_ends else bound,
        "unit": "m",
        "of": "tool0 from the origin of the first DH frame",
        "without_limits": open_ends,
    }


def _placement(transform: RigidTransform, place: str | None, unsaid: Literal["default", "read"]) -> Placement:
    xyz, rpy = list(transform.translation), list(transform.rpy)
    return {"xyz": xyz, "rpy": rpy, "from": unsaid if place is None else CELL, "place": place}


def _place(mark: Mark | None) -> str | None:
    return str(mark) if mark else None


# --- As text ----------------------------------------------------------------------------------------------------------


def in_lines(report: InfoReport, *, terminal: bool, cells: bool = False) -> str:
    """A report in lines: the table as a paper prints it, facts, notices; on a terminal, what is filled in is dim.

    With `cells` there is a line for each field in place of a row for each joint.
    """
    from rich.console import Console
    from rich.table import Table

    detail = report["detail"]
    if detail is None:
        return "\n".join(_arms(report))
    console = Console(force_terminal=terminal, highlight=False)
    console.width = min(console.width, WIDTH) if terminal else 100_000
    head, rows, legend = _field_lines(detail) if cells else _as_printed(detail)
    table = Table(box=None, pad_edge=False)
    for name in head:
        table.add_column(name, overflow="fold")
    before = ""
    for (joint, *others), is_typed in rows:
        if terminal and before and joint != before and cells:
            table.add_section()
        named = "" if terminal and joint == before else joint
        before = joint
        table.add_row(named, *others, style=None if is_typed or not terminal else "dim")
    facts = "\n".join([*legend, *_facts(report["source"], detail)])
    with console.capture() as captured:
        for part in (facts, table) if cells else (table, f"\n{facts}"):
            console.print(part, markup=False)
        console.print("\n".join(_notices(detail)), markup=False)
    return "\n".join(line.rstrip() for line in captured.get().splitlines())


def markdown(report: InfoReport, *, cells: bool = False) -> Iterator[str]:
    """A report as Markdown."""
    detail = report["detail"]
    if detail is None:
        yield from (f"# {markdown_text(report['source'])}", "")
        yield from (f"- {markdown_text(line)}" for line in _arms(report))
        return
    facts = list(_facts(report["source"], detail))
    matrix = facts.index(_MATRIX)
    head, rows, legend = _field_lines(detail) if cells else _as_printed(detail)
    table = [f"| {' | '.join(map(markdown_text, head))} |", f"|{'---|' * len(head)}"]
    table += [f"| {' | '.join(map(markdown_text, row))} |" for row, _ in rows]
    yield from (f"# {markdown_text(detail['name'])}", "")
    if not cells:
        yield from (*table, "")
        yield from (f"\\{line}\n" for line in legend)
    yield from (f"- {markdown_text(line)}" for line in facts[:matrix])
    yield from ("", _MATRIX, "", "```text", *facts[matrix + 1 :], "```", "")
    if cells:
        yield from table
    if notices := [f"- {markdown_text(line)}" for line in _notices(detail) if line]:
        yield from ("", *notices)


def _as_printed(detail: Detail) -> _Lines:
    """The table as a paper prints it: a row for each joint, units in the header, what is filled in with a mark."""
    joints = [{field["field"]: field for field in joint["fields"]} for joint in detail["joints"]]
    typed = {name for joint in joints for name, field in joint.items() if field["from"] in (CELL, READ)}
    others = [name for name in (*LIMITS, "mass", *_OPTIONAL, "follows") if name in typed]
    units = {name: {joint[name]["unit"] for joint in joints if name in joint} for name in ("theta", "d", *others)}
    head = ["joint", "type", "theta [rad]", "d [m]", "a [m]", "alpha [rad]"]
    head += [f"{name} [{', '.join(sorted(units[name]))}]" if any(units[name]) else name for name in others]
    rows, moving = list[tuple[list[str], bool]](), 0
    for fields in joints:
        kind = JointType(str(fields["type"]["value"]))
        moving += kind is not JointType.FIXED and "follows" not in fields
        variable = f"q[{fields['joint']['value']}]" if "follows" in fields else f"q{moving}"
        home = None if kind is JointType.FIXED else "d" if kind is JointType.PRISMATIC else "theta"
        cells = [_printed(fields[name]) for name in ("joint", "type")]
        cells += [
            _variable(fields, name, variable) if name == home else _printed(fields[name])
            for name in ("theta", "d", "a", "alpha")
        ]
        cells += [_printed(fields[name]) if name in fields else "" for name in others]
        rows.append((list(map(printable, cells)), True))
    is_marked = any(cell.endswith(_MARK) for row, _ in rows for cell in row[1:])
    return head, rows, [f"{_MARK} filled in: the table does not say it"] if is_marked else []


def _printed(field: FieldEntry) -> str:
    """A value as a paper prints it, with a mark where it is filled in."""
    value = field["value"]
    is_filled = field["from"] in (DEFAULT, COMPUTED) and field["field"] != "joint"
    return f"{value if isinstance(value, str) else _number(value, field['unit'])}{_MARK if is_filled else ''}"


def _number(value: float, unit: str) -> str:
    text = number_in(value, UNITS["rad"]) if unit == "rad" else ""
    return text if 0 < len(text) <= _LONGEST else f"{value + 0.0:.9g}"


def _variable(fields: Mapping[str, FieldEntry], home: str, symbol: str) -> str:
    """A joint variable as a paper prints it: ``q2 + pi/2``."""
    names = (home, "offset", "sign")
    at, offset, sign = (float(fields[name]["value"]) if name in fields else 0.0 for name in names)
    variable = f"{'-' if sign < 0 else ''}{symbol}"
    if not (total := at + offset):
        return variable
    return f"{variable} {'-' if total < 0 else '+'} {_number(abs(total), fields[home]['unit'])}"


def _arms(report: InfoReport) -> Iterator[str]:
    """Several manipulators, a line each."""
    arms = report["manipulators"]
    yield f"{printable(report['source'])}: {counted(len(arms), 'manipulator')}; --robot NAME shows one of them"
    for arm in arms[:MOST_ARMS]:
        told = f"{counted(arm['joints'] or 0, 'row')}, {arm['moving']} of them moving, {arm['convention']} convention"
        if arm["joints"] is None:
            told = f"cannot be read: {arm['errors'][0]['message']}"
        yield printable(f"{arm['name']}: {told} ({arm['place'] or ''})")
    if (more := len(arms) - MOST_ARMS) > 0:
        yield f"and {more:,} more"


def _facts(source: str, detail: Detail) -> Iterator[str]:
    """A line for each fact of the whole arm."""
    convention, distance, axes, mass = detail["convention"], detail["largest_distance"], detail["axes"], detail["mass"]
    at = f" (said at {convention['place']})" if convention["place"] else ""
    facts = [f"{detail['name']}, from {source}", f"convention: {convention['value']}{at}"]
    for name, placement in (("base", detail["base"]), ("tool", detail["tool"])):
        xyz, rpy = _numbers(placement["xyz"]), _numbers(placement["rpy"])
        placed = f"xyz {xyz} m, rpy {rpy} rad ({placement['place'] or placement['from']})"
        facts.append(f"{name}: {'none (default)' if placement['from'] == DEFAULT else placed}")
    units = [(_KINDS.get(unit["of"], unit["of"]), unit["unit"], unit["place"]) for unit in detail["units"]]
    facts += [f"unit of {kind}: {unit} (said at {place})" for kind, unit, place in units]
    for key, said in detail["stated"].items():
        at = f" ({said['place']})" if said["place"] else ""
        facts.append(f"{_CALLED.get(key, key)}: {_in_words(key, said['value'])}{at}")
    if distance["bound"] is None:
        facts.append(f"reach: no bound, since {', '.join(distance['without_limits'])} slides without limits")
    else:
        bound = f"{_numbers([distance['bound']])} m from the origin of the first DH frame"
        facts.append(f"reach: tool0 is never further than {bound} (the sum of √(a² + d²) of all rows, and of the tool)")
    facts += [f"parallel axes: {', '.join(names)}" for names in axes["parallel"]]
    if axes["spherical_wrist"]:
        facts.append(f"spherical wrist: {', '.join(axes['spherical_wrist'])}")
    if opw := axes["opw"]:
        numbers: dict[str, Any] = {**opw}
        lengths = ", ".join(f"{name} {_numbers([numbers[name]])}" for name in ("a1", "a2", "b", "c1", "c2", "c3", "c4"))
        offsets, signs = _numbers(opw["offsets"], ", "), _numbers(opw["signs"], ", ")
        facts.append(f"OPW arm: {lengths} m, offsets {offsets} rad, signs {signs}")
    total = "no robot can be made" if mass["total"] is None else f"{_numbers([mass['total']])} kg"
    computed = f", of which computed from shapes: {', '.join(mass['computed'])}" if mass["computed"] else ""
    facts += [f"mass: {total}{computed}", _MATRIX]
    yield from map(printable, facts)
    for row in detail["pose_at_zero"]:
        yield "  " + " ".join(f"{_numbers([value]):>12}" for value in row)


def _in_words(key: str, value: object) -> str:
    """A value that holds for the whole arm, in SI units; the parts of one that has several."""
    if isinstance(value, dict):
        return ", ".join(
            f"{'' if isinstance(part, dict) else f'{name} '}{_in_words(name, part)}" for name, part in value.items()
        )
    if isinstance(value, bool):
        return "all" if value else "none"
    if isinstance(value, str):
        return value
    unit = _STATED_UNITS.get(key) or unit_of(key, JointType.REVOLUTE)
    return f"{_numbers(value if isinstance(value, list | tuple) else [value])} {unit}".rstrip()


def _field_lines(detail: Detail) -> _Lines:
    """A line for each field."""
    lines = list[tuple[list[str], bool]]()
    for name, field in ((joint["name"], field) for joint in detail["joints"] for field in joint["fields"]):
        value, unit, is_typed = field["value"], field["unit"], field["from"] == CELL
        if not isinstance(value, str):
            degrees = f" ({_numbers([math.degrees(value)])}°{unit.removeprefix('rad')})"
            value = f"{value + 0.0:.9g} {unit}".rstrip() + (degrees if unit in ("rad", "rad/s") and value else "")
        typed = (repr(field["typed"]) if field["typed"] is not None else "") if is_typed else field["from"]
        cells = (name, field["field"], value, typed, field["read_in"] or "", field["place"] or "")
        lines.append((list(map(printable, cells)), is_typed))
    return list(HEAD), lines, []


def _numbers(values: Iterable[Any], between: str = " ") -> str:
    return between.join(f"{value + 0.0:.6g}" for value in values)


def _notices(detail: Detail) -> Iterator[str]:
    for kind, problems in (("notice", detail["notices"]), ("error", detail["errors"])):
        for problem in problems:
            inner = (problem["place"],) if problem["place"] else (problem["line"], problem["column"])
            place = ":".join(str(part) for part in (problem["file"], *inner) if part is not None)
            about = f"joint {problem['joint']!r}: " if problem["joint"] else ""
            yield printable(f"{kind}: {place}{': ' if place else ''}{about}{problem['message']}")
