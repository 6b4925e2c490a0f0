"""The files of the stage ``table``: the DH tables of a robot, for papers and scripts.

A robot has its table from the pipeline (`Robot.manipulator`); a cell has one for each kind of arm. The pipeline reads
tables as YAML, CSV and JSON back and compares T(q); every other field is compared where the notices are made.

Tables as JSON: numbers in SI units under the keys that the reader ``yaml`` knows, and transforms as matrices.
"""

from __future__ import annotations

import json
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import INERTIA, LIMITS
from dh2urdf.commands import left_out_of, table_content
from dh2urdf.errors import EmitterError, InputError, RecordValueError
from dh2urdf.manipulator import BASE, FLANGE, ROOT, TOOL, WORLD
from dh2urdf.rotations import IDENTITY
from dh2urdf.source import Messages, Problem, listed, shown
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.packages.table import SUFFIXES
from dh2urdf_plugins.packages.table.code import left_out_of_code, matlab_file, toolbox_file
from dh2urdf_plugins.packages.table.notation import latex_file, markdown_file

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from dh2urdf.manipulator import DHRow, Inertia, LinkGeometry, Manipulator, MeshShape
    from dh2urdf.robot import Robot
    from dh2urdf.rotations import RigidTransform
    from dh2urdf_plugins.packages.table import Format, TableOptions

say = Messages(__file__)


_READ_BACK = ("yaml", "csv", "json")
_LINKS = {WORLD, ROOT, BASE, "base", FLANGE, TOOL, "payload"}
"""Links beside those of the rows that a table says by itself, or that every robot has."""
_MOST_LINKS = 6


def tables_of(robot: Robot, stem: str, options: TableOptions) -> tuple[EmittedFile, ...]:
    """A file of tables in each format that is asked for, as ``<stem>.yaml``, ``<stem>.tex`` and so on.

    Raises:
        EmitterError: no table of the robot is known, or a format cannot hold it.
    """
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
    """The table of a robot, or one of each kind of arm of a cell.

    Raises:
        EmitterError: one is not known.
    """
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


def _left_out(name: Format, arms: Sequence[Manipulator], options: TableOptions) -> Iterable[Problem]:
    """Notices of what a format leaves out; a file that our readers read is read back."""
    if name not in _READ_BACK:
        return left_out_of_code(name, arms)
    with _as_emitter_errors():
        return left_out_of("csv" if name == "csv" else "yaml", arms, _content(name, arms, options))


@contextmanager
def _as_emitter_errors() -> Iterator[None]:
    try:
        yield
    except (InputError, RecordValueError) as error:
        raise EmitterError(error.problems) from error


def notices_of_tables(robot: Robot, options: TableOptions) -> list[Problem]:
    """What the formats leave out, that a table does not say where the arms of a cell are, and has no other links."""
    arms = manipulators_of(robot)
    found = [notice for name in _formats(options) for notice in _left_out(name, arms, options)]
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
    payload, drawn = arm.payload, {None: None, True: "all", False: "none"}
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
        tool=_said(matrix=_matrix(arm.tool)),
        payload=payload and _said(mass=payload.mass, com=payload.com, inertia=_inertia(payload.inertia)),
        defaults=_said(geometry=_geometry(arm.geometry), density=arm.density),
        visuals=drawn[arm.visuals],
        collisions=drawn[arm.collisions],
        joints=[_row(row) for row in arm.rows],
    )


def _row(row: DHRow) -> dict[str, Any]:
    return _said(
        name=row.joint,
        link=row.link,
        type=str(row.type),
        **{name: getattr(row, name) for name in ("a", "alpha", "d", "theta")},
        offset=row.offset or None,
        sign=row.sign if row.sign != 1 else None,
        limits=_said(**{name: getattr(row.limits, name) for name in LIMITS}),
        mass=row.mass,
        com=row.com,
        inertia=_inertia(row.inertia),
        **{name: getattr(row, name) for name in ("radius", "damping", "friction", "armature")},
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


def _geometry(geometry: LinkGeometry) -> dict[str, Any]:
    return _said(shape=geometry.shape, radius=geometry.radius)


def _mesh(shape: MeshShape | None) -> dict[str, Any] | None:
    if shape is None:
        return None
    scale = None if shape.scale == (1.0, 1.0, 1.0) else shape.scale
    return _said(file=shape.file.path, scale=scale, matrix=_matrix(shape.pose))


_WRITERS: dict[Format, Callable[[Sequence[Manipulator], TableOptions], bytes]] = {
    "json": lambda arms, _: json_file(arms),
    "markdown": markdown_file,
    "latex": latex_file,
    "matlab": lambda arms, _: matlab_file(arms),
    "roboticstoolbox": lambda arms, _: toolbox_file(arms),
}
"""What writes the formats that no reader has."""
