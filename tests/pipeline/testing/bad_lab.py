"""Stages that each break one clause of a contract, in a module that child processes can import."""

from __future__ import annotations

import csv
import io
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import ManipulatorGroups, in_columns
from dh2urdf.errors import LoaderError
from dh2urdf.fields import replace_unchecked
from dh2urdf.hookspecs import hookimpl
from dh2urdf.manipulator import Convention, DHRow, Manipulator
from dh2urdf.robot import Link, Origin
from dh2urdf.source import Mark
from dh2urdf.stages import (
    Edit,
    EmittedFile,
    Emitter,
    Executor,
    Finding,
    Inspection,
    Loader,
    LoadReport,
    NoOptions,
    Reader,
    Transform,
)
from dh2urdf.table_text import Said
from dh2urdf.testing import plain_robot
from dh2urdf_plugins.readers.table import read_table

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.robot import Robot

# --- Records and options


@dataclass(frozen=True, kw_only=True)
class Unexplained:
    speed: float = 1.0


@dataclass(frozen=True, kw_only=True)
class Unmeasured:
    speed: float = field(default=1.0, metadata={"help": "how fast", "measures": "lenght"})


@dataclass(frozen=True, kw_only=True)
class Required:
    speed: float = field(metadata={"help": "how fast"})


@dataclass(kw_only=True)
class Thawed:
    speed: float = field(default=1.0, metadata={"help": "how fast"})


# --- Readers


def read(path: Path, _options: Any) -> Any:
    """A good reader: a line is a name, a and d."""
    from dh2urdf.documents import check_file
    from dh2urdf.errors import TableError

    check_file(path, TableError)
    with path.open("rb") as file:
        for number, line in enumerate(file, start=1):
            yield arm(line, Mark(file=str(path), line=number))


def arm(line: bytes, mark: Mark, **more: Any) -> Manipulator:
    from dh2urdf.errors import TableError

    try:
        name, a, d = line.decode().split()
        row = DHRow(joint="j", link="l", a=float(a), alpha=0.0, d=float(d), **more)
    except ValueError as error:
        raise TableError(f"{mark}: {error}") from error
    return Manipulator(name=name, convention=Convention.STANDARD, rows=(row,), mark=mark)


def read_without_marks(path: Path, options: Any) -> Any:
    return (replace(table, mark=None) for table in read(path, options))


def read_all_first(path: Path, options: Any) -> Any:
    return iter(list(read(path, options)))


def read_with_cache(path: Path, options: Any) -> Any:
    path.with_suffix(".cache").write_text("")
    return read(path, options)


def read_carelessly(path: Path, _options: Any) -> Any:
    for line in path.read_text().splitlines():
        name, a, d = line.split()
        row = DHRow(joint="j", link="l", a=float(a), alpha=0.0, d=float(d))
        yield Manipulator(name=name, convention=Convention.STANDARD, rows=(row,), mark=Mark(file=str(path)))


def read_elsewhere(path: Path, _options: Any) -> Any:
    """Its messages name the function that it calls, not the file."""
    rows = [
        dict(zip("ad", line.split()[1:], strict=False), alpha="0") for line in path.read_text("latin-1").splitlines()
    ]
    yield replace(Manipulator.from_dh(rows, convention="standard"), mark=Mark(file=str(path)))


def trace(path: Path, options: Any, its: Any) -> Any:
    """A good trace: a and d are in metres."""
    for table in read(path, options):
        (row,) = table.rows
        its.rows = ({name: Said(text=str(getattr(row, name)), mark=table.mark, unit="m") for name in ("a", "d")},)
        yield table


def trace_nothing(path: Path, options: Any, _its: Any) -> Any:
    return read(path, options)


def trace_in_millimetres(path: Path, options: Any, its: Any) -> Any:
    for table in trace(path, options, its):
        its.rows = tuple({name: replace(said, unit="mm") for name, said in row.items()} for row in its.rows)
        yield table


def read_columns(path: Path, options: Any) -> Any:
    """A good reading: all manipulators in groups."""
    tables = list(read(path, options))
    if tables:
        yield ManipulatorGroups(groups=tuple([(tuple(places), some) for places, some in in_columns(tables)]))


def read_columns_without_marks(path: Path, options: Any) -> Any:
    for item in read_columns(path, options):
        groups = [(places, replace(some, marks=(None,) * len(places))) for places, some in item.groups]
        yield ManipulatorGroups(groups=tuple(groups))


def read_cells_in_metres(rows: Any, file: str, options: Any) -> Any:
    return read_table((_without_units(row) for row in rows), file, options)


def _without_units(row: Any) -> Any:
    cells = [cell.replace(" [mm]", "") if isinstance(cell, str) else cell / 1e3 for cell in row.cells]
    return row._replace(cells=cells)


def read_cells_without_places(rows: Any, file: str, options: Any) -> Any:
    return read_table((row._replace(marks=None) for row in rows), file, options)


READER = Reader(name="bad", summary="bad", read=read, options=NoOptions, suffixes=(".bad",))

# --- Transforms


def transform(manipulator: Manipulator, _options: Any) -> Robot:
    """A good transform for good arms."""
    return plain_robot(manipulator)


def transform_without_masses(manipulator: Manipulator, _options: Any) -> Robot:
    robot = plain_robot(manipulator)
    return replace(robot, links=tuple(replace(link, inertial=None) for link in robot.links))


def transform_without_tool(manipulator: Manipulator, _options: Any) -> Robot:
    return plain_robot(replace(manipulator, tool=manipulator.base))


def transform_with_log(manipulator: Manipulator, _options: Any) -> Robot:
    subprocess.run([sys.executable, "-c", ""], check=True)
    return plain_robot(manipulator)


def transform_columns(columns: Any, options: Any) -> Any:
    import numpy as np

    from dh2urdf.columns import RobotColumns

    robot = transform(columns.pick(0), options)
    some = RobotColumns(
        robot=robot, names=columns.names, comments=("",) * len(columns), sure=np.ones(len(columns), dtype=bool)
    )
    return [(range(len(columns)), some)]


TRANSFORM = Transform(name="bad", summary="bad", transform=transform, options=NoOptions)

# --- Edits


def edit_table(manipulator: Manipulator, _options: Any) -> Manipulator:
    return manipulator


def edit_name(manipulator: Manipulator, _options: Any) -> Manipulator:
    return replace(manipulator, name=f"{manipulator.name}_2")


def edit_loosely(robot: Robot, _options: Any) -> Robot:
    return replace(robot, links=(*robot.links, Link(name="loose")))


def edit_tool(robot: Robot, _options: Any) -> Robot:
    last = robot.joints[-1]
    return replace(robot, joints=(*robot.joints[:-1], replace(last, origin=Origin(xyz=(0.0, 0.0, 0.25)))))


def edit_by_first(manipulator: Manipulator, _options: Any) -> Manipulator:
    def first(number: Any) -> Any:
        return float(number[0]) if hasattr(number, "ndim") else number

    return replace_unchecked(
        manipulator, rows=tuple(replace_unchecked(row, d=first(row.d)) for row in manipulator.rows)
    )


EDIT = Edit(name="bad", summary="bad", options=NoOptions, edit_table=edit_table)

# --- Emitters


def emit(robot: Robot, stem: str, _options: Any) -> list[EmittedFile]:
    """A good emitter of tables."""
    text = io.StringIO()
    csv.writer(text).writerows((joint.name, *joint.origin.xyz) for joint in robot.joints)
    return [EmittedFile(name=f"{stem}.bad", content=text.getvalue().encode())]


def emit_elsewhere(_robot: Robot, _stem: str, _options: Any) -> list[EmittedFile]:
    return [EmittedFile(name="../robot.bad", content=b"")]


def emit_two(robot: Robot, stem: str, options: Any) -> list[EmittedFile]:
    return [*emit(robot, stem, options), EmittedFile(name=f"{stem}_parts.bad", content=b"")]


def emit_unescaped(robot: Robot, stem: str, _options: Any) -> list[EmittedFile]:
    return [EmittedFile(name=f"{stem}.bad.xml", content=f"<robot name='{robot.name}'/>".encode())]


def emit_by_hash(robot: Robot, stem: str, _options: Any) -> list[EmittedFile]:
    names = {link.name for link in robot.links}
    return [EmittedFile(name=f"{stem}.bad", content=",".join(names).encode())]


_WRITTEN: dict[str, Robot] = {}


def emit_remembered(robot: Robot, stem: str, options: Any) -> list[EmittedFile]:
    rounded = [
        replace(joint, origin=replace(joint.origin, xyz=tuple(round(x, 2) for x in joint.origin.xyz)))  # type: ignore[arg-type]
        for joint in robot.joints
    ]
    _WRITTEN["robot"] = replace(robot, joints=tuple(rounded))
    return emit(robot, stem, options)


def read_back(_path: Path) -> Robot:
    return _WRITTEN["robot"]


def check(_path: Path, _expansion: Any) -> Inspection:
    return Inspection(consumers={}, findings=(Finding(rule="no-good", message="it is no good", fix="give up"),))


def emit_columns(robots: Any, stems: Any, options: Any) -> Any:
    return [emit(robots.pick(0), stem, options) for stem in stems]


EMITTER = Emitter(name="bad", summary="bad", emit=emit, options=NoOptions, suffixes=(".bad", ".bad.xml"))

# --- Loaders


def load(request: Any, _options: Any) -> LoadReport:
    """It declares about good files what is right, without looking."""
    if b"joint_6" not in request.path.read_bytes():
        raise LoaderError("this is no arm")
    return LoadReport(
        simulator="bad",
        version="1",
        joints=tuple({"name": joint.name} for joint in request.robot.moving_joints),
        position_error=0.0,
        angle_error=0.0,
        tolerance=1e-9,
        poses=len(request.poses),
    )


def load_some(request: Any, options: Any) -> LoadReport:
    return replace(load(request, options), poses=1, joints=())


def load_at_some_time(request: Any, options: Any) -> LoadReport:
    return replace(load(request, options), mass=time.time())


LOADED: list[Any] = []


def prepare_and_remember(_options: Any) -> None:
    LOADED.append(None)


def load_and_remember(request: Any, options: Any) -> LoadReport:
    LOADED.append(request)
    return replace(load(request, options), mass=float(len(LOADED)))


def load_in_place(request: Any, options: Any) -> LoadReport:
    report = load(request, options)
    request.path.write_bytes(request.path.read_bytes().replace(b"<robot", b"<robot ", 1))
    return report


def load_carelessly(request: Any, options: Any) -> LoadReport:
    request.path.read_bytes().index(b"joint_6")
    return load(request, options)


@dataclass(frozen=True)
class Three:
    poses = 3


@dataclass(frozen=True)
class Never:
    poses, time_limit = 3, 0.0


LOADER = Loader(name="bad", summary="bad", open=load, options=Three)

# --- Executors


def all_at_once(function: Any, tasks: Any, _options: Any) -> Any:
    with ThreadPoolExecutor(2) as pool:
        yield from pool.map(function, tasks)


def by_name(function: Any, tasks: Any, _options: Any) -> Any:
    name = function.__qualname__
    yield from (getattr(sys.modules[function.__module__], name)(task) for task in tasks)


def in_a_pool(function: Any, tasks: Any, _options: Any) -> Any:
    with ProcessPoolExecutor(2) as pool:
        futures = [pool.submit(function, task) for task in tasks]
        list(as_completed(futures))
        yield from (future.result() for future in futures)


def with_a_daemon(function: Any, tasks: Any, _options: Any) -> Any:
    subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"], start_new_session=True)
    yield from map(function, tasks)


EXECUTOR = Executor(name="bad", summary="bad", map=map, options=NoOptions)  # type: ignore[arg-type]


@hookimpl
def dh2urdf_emitters() -> Any:
    import numpy  # noqa: F401, ICN001 - this is what is wrong

    return (EMITTER,)
