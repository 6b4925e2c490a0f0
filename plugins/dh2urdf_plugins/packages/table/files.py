"""The files of the stage ``table``: the DH tables of a robot, for papers and scripts.

A robot has its table from the pipeline (`Robot.manipulator`); a cell has one for each kind of arm. The pipeline reads
tables as YAML, CSV and JSON back and compares T(q); every other field is compared where the notices are made.

Tables as JSON: numbers in SI units under the keys that the reader ``yaml`` knows, and transforms as matrices.
"""

from __future__ import annotations

import json
from contextlib import contextmanager
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from dh2urdf.commands import left_out_of, table_content
from dh2urdf.errors import EmitterError, InputError, RecordValueError
from dh2urdf.manipulator import BASE, FLANGE, ROOT, TOOL, WORLD, Inertia, Limits, LinkGeometry, MeshShape, Payload
from dh2urdf.rotations import IDENTITY, RigidTransform
from dh2urdf.source import Messages, Problem, listed, shown
from dh2urdf.stages import EmittedFile
from dh2urdf.table_text import PARAMETERS
from dh2urdf_plugins.packages.table import SUFFIXES
from dh2urdf_plugins.packages.table.code import left_out_of_code, matlab_file, toolbox_file
from dh2urdf_plugins.packages.table.notation import latex_file, markdown_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf_plugins.packages.table import Format, TableOptions

say = Messages(__file__)


_READ_BACK = ("yaml", "csv", "json")
_LINKS = {WORLD, ROOT, BASE, "base", FLANGE, TOOL, "payload"}
"""Links beside those of the rows that a table says by itself, or that every robot has."""
_MOST_LINKS = 6


def tables_of(robot: Robot, stem: str, options: TableOptions) -> tuple[EmittedFile, ...]:
    """A file of tables in each format that is asked for, as ``<stem>.yaml``, ``<stem>.tex`` and so on."""
    arms = manipulators_of(robot)
    return tuple(
        EmittedFile(
            name=f"{stem}{SUFFIXES[name]}",
            content=_content(name, arms, options),
            is_robot=name in _READ_BACK and not robot.arms,
        )
        for name in _formats(options)
    )


def manipulators_of(robot: Robot) -> list[Manipulator]:
    """The table of a robot, or one of each kind of arm of a cell."""
    kinds = {id(arm.kind): arm.kind for arm in robot.arms}.values() if robot.arms else (robot,)
    arms: dict[int, Manipulator] = {}
    for kind in kinds:
        if kind.manipulator is None:
            raise EmitterError(say("table-unknown", robot=kind.name))
        arms[id(kind.manipulator)] = kind.manipulator
    return list(arms.values())


def _formats(options: TableOptions) -> tuple[Format, ...]:
    return tuple(dict.fromkeys(options.formats)) or ("yaml",)


def _content(name: Format, arms: Sequence[Manipulator], options: TableOptions) -> bytes:
    """A file in a format."""
    if name in _WRITERS:
        return _WRITERS[name](arms, options)
    with _as_emitter_errors():
        return table_content(name, arms, length_unit=options.length_unit, angle_unit=options.angle_unit)


@contextmanager
def _as_emitter_errors() -> Iterator[None]:
    try:
        yield
    except (InputError, RecordValueError) as error:
        raise EmitterError(error.problems) from error


def notices_of_tables(robot: Robot, options: TableOptions) -> list[Problem]:
    """What the formats leave out, that a table does not say where the arms of a cell are, and has no other links."""
    arms = manipulators_of(robot)
    found: list[Problem] = []
    for name in _formats(options):
        if name not in _READ_BACK:
            found += left_out_of_code(name, arms)
            continue
        with _as_emitter_errors():
            found += left_out_of("csv" if name == "csv" else "yaml", arms, _content(name, arms, options))
    if robot.arms:
        kinds = f"{len(arms)} kind{'' if len(arms) == 1 else 's'} of arms"
        found.append(say("tables-of-a-cell", kinds=kinds, count=len(robot.arms)))
    elif arms:
        known = {*_LINKS, *(row.link for row in arms[0].rows)}
        if others := [shown(link.name) for link in robot.links if link.name not in known]:
            found.append(say("links-of-no-row", links=listed(others, _MOST_LINKS)))
    return found


def json_file(arms: Sequence[Manipulator]) -> bytes:
    """One table, or several as a list of robots."""
    tables = [_table(arm) for arm in arms]
    document = tables[0] if len(tables) == 1 else {"robots": tables}
    return f"{json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)}\n".encode()


def _table(arm: Manipulator) -> dict[str, Any]:
    drawn = {None: None, True: "all", False: "none"}
    return _said(
        name=arm.name,
        convention=arm.convention,
        units={"length": "m", "angle": "rad"},
        base=_said(
            matrix=arm.base,
            **{name: getattr(arm, f"base_{name}") for name in ("mass", "geometry", "visual", "collision")},
        ),
        tool=_said(matrix=arm.tool),
        payload=arm.payload,
        defaults=_said(geometry=arm.geometry, density=arm.density),
        visuals=drawn[arm.visuals],
        collisions=drawn[arm.collisions],
        joints=[_row(row) for row in arm.rows],
    )


def _row(row: DHRow) -> dict[str, Any]:
    return _said(
        name=row.joint,
        link=row.link,
        type=row.type,
        **{name: getattr(row, name) for name in PARAMETERS},
        offset=row.offset or None,
        sign=row.sign if row.sign != 1 else None,
        **{name: getattr(row, name) for name in ("limits", "mass", "com", "inertia", "radius")},
        **{name: getattr(row, name) for name in ("damping", "friction", "armature", "visual", "collision")},
        follows=row.follows and dict(zip(("joint", "multiplier", "offset"), row.follows, strict=False)),
    )


def _said(**entries: object) -> dict[str, Any]:
    """The entries that say something, as JSON has them."""
    plain = {key: _plain(value) for key, value in entries.items()}
    return {key: value for key, value in plain.items() if value is not None and value != {}}


def _plain(value: Any) -> Any:  # noqa: ANN401 - any entry
    """An entry of a table as JSON has it: a transform is a matrix, and nothing where it is the identity."""
    match value:
        case RigidTransform(r, t):
            matrix = [[*r[0:3], t[0]], [*r[3:6], t[1]], [*r[6:9], t[2]], [0.0, 0.0, 0.0, 1.0]]
            return None if value == IDENTITY else matrix
        case Limits() | Inertia() | LinkGeometry() | Payload():
            return _said(**{each.name: getattr(value, each.name) for each in fields(value)})
        case MeshShape():
            scale = None if value.scale == (1.0, 1.0, 1.0) else value.scale
            return _said(file=value.file.path, scale=scale, matrix=value.pose)
    return value


_WRITERS: dict[Format, Callable[[Sequence[Manipulator], TableOptions], bytes]] = {
    "json": lambda arms, _: json_file(arms),
    "markdown": markdown_file,
    "latex": latex_file,
    "matlab": lambda arms, _: matlab_file(arms),
    "roboticstoolbox": lambda arms, _: toolbox_file(arms),
}
"""What writes the formats that no reader has."""
