"""A robot description laid upon the arm of the table: how far the two are from each other, and taking its numbers.

The description comes as files that a browser sent: alone or with the mesh files that it names, or all of it as a ZIP.
"""

from __future__ import annotations

import math
import os
import tempfile
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.documents import BROKEN_ARCHIVE
from dh2urdf.errors import ConfigError, Dh2UrdfError, InputError
from dh2urdf.kinematics.chain import (
    KinematicChain,
    angle_error,
    forward_kinematics,
    link_poses,
    position_error,
    screws_of_chain,
    screws_of_table,
)
from dh2urdf.kinematics.comparison import DECIMALS, POSES, TOLERANCE, Agreement, compare
from dh2urdf.kinematics.expected_poses import ExpectedPoses, proof_vectors
from dh2urdf.kinematics.screws import axis_error
from dh2urdf.manipulator import Convention, JointType, Manipulator
from dh2urdf.meshes import addresses
from dh2urdf.plugin_system.calls import default_call
from dh2urdf.quantities import number_in
from dh2urdf.quantities.units import UNITS
from dh2urdf.rotations import IDENTITY, RigidTransform
from dh2urdf.source import Messages
from dh2urdf.stages import PACKAGE_FILE, Emitter, ReadsForeign
from dh2urdf.table_text.texts import dimension_of, table_text, unit_of
from dh2urdf_studio.drawing.mesh_files import LARGEST, SUFFIXES
from dh2urdf_studio.drawing.parts import BESIDE
from dh2urdf_studio.drawing.scene import Figure, meshes_of
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.reading import read_whole
from dh2urdf_studio.viewing import description

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.robot import Robot
    from dh2urdf.table_text import TableText

say = Messages(__file__)

V = TypeVar("V")
MOST_FILES = 1000  # files that are kept of those that were sent
NAME = "description/"  # what stands before the names of the description's nodes and joints in the scene
_SAME = TOLERANCE / 10  # numbers that differ less [m] and [rad] are left as they are


class Apart(NamedTuple):
    """How far a joint axis, or the tip, is from where the table has it: a distance [m] and an angle [rad]."""

    distance: float
    angle: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Beside:
    """A description beside a table."""

    figure: Figure  # as it is drawn, its base link where the table's is
    agreement: Agreement | None = None  # None where the chain cannot be found
    refusal: str = ""  # why it cannot
    chain: KinematicChain | None = None  # from base link to tip link; None where joints cannot be compared one by one
    worst: tuple[Apart, ...] = ()  # of each joint axis and the tip, the largest differences at the vectors of a proof

    def named(self, values: Sequence[V]) -> dict[str, V]:
        """What belongs to the joints of the table in order, by the names of the description's joints in the scene."""
        if self.agreement is None or self.chain is None:
            return {}
        return {NAME + name: value for name, value in zip(self.agreement.joints, values, strict=True)}


def beside(figure: Figure, table: Manipulator, robot: Robot, *, base_link: str = "", tip_link: str = "") -> Beside:
    """Lay a description upon the arm of a table."""
    figure = replace(figure, name=NAME, tint=BESIDE, opacity=0.45, link_frames=False)
    try:
        agreement = compare(figure.robot, table, base_link=base_link or None, tip_link=tip_link or None)
    except ConfigError as error:
        return Beside(figure=figure, refusal="; ".join(problem.message for problem in error.problems))
    figure = replace(figure, place=link_poses(figure.robot, {})[agreement.base_link].inverse)
    if agreement.difference is None:
        return Beside(figure=figure, agreement=agreement)
    chain = KinematicChain.between(figure.robot, agreement.base_link, agreement.tip_link)
    every = [differences(chain, table, q) for q in proof_vectors(ExpectedPoses.of(table), robot, POSES)]
    worst = tuple(Apart(*map(max, zip(*of_one, strict=True))) for of_one in zip(*every, strict=True))
    return Beside(figure=figure, agreement=agreement, chain=chain, worst=worst)


def differences(chain: KinematicChain, table: Manipulator, q: Sequence[float]) -> tuple[Apart, ...]:
    """How far the moving joints' axes of a description, and its tip, are from those of a table at a joint vector.

    A description places the frames of its links as it likes along the axes; so of a joint its axis is compared: the
    distance of the description's joint from the table's axis, and the angle between the two axes.
    """
    (given, found), wanted = screws_of_chain(chain, q), forward_kinematics(table, q)
    axes = zip(given, screws_of_table(table, q), strict=True)
    tip = Apart(position_error(wanted, found), angle_error(wanted, found))
    return (*(Apart(*axis_error(one, other)) for one, other in axes), tip)


# --- Taking the numbers of a description: as few cells as make the two the same arm -----------------------------------


def own_table(path: Path, catalog: Catalog, like: Manipulator, ends: tuple[str, str]) -> Manipulator | None:
    """The table of the chain of a description between two links, in the convention of a table; None if it has none."""
    try:
        call = default_call(catalog, catalog.reader_for(path))
        chain = {"convention": str(like.convention), "base_link": ends[0], "tip_link": ends[1]}
        found = list(read_items(replace(call, options=replace(call.options, **chain)), path))
    except (Dh2UrdfError, TypeError):  # a reader without these options reads no chains
        return None
    return found[0] if len(found) == 1 and isinstance(found[0], Manipulator) else None


def adopted(
    table: TableText, arm: Manipulator, found: Beside, own: Manipulator | None, catalog: Catalog
) -> TableText | None:
    """The table with the numbers that make it the arm of a description; None where no table of these rows is.

    The numbers are those of the description's own table, or the base, tool, signs and offsets that the comparison has
    found: whichever are fewer. Every cell whose number is the same keeps its text.
    """
    agreement = found.agreement
    if agreement is None or found.chain is None:
        return None
    zero = found.chain.forward_kinematics((0.0,) * len(arm.actuated_rows))
    right = []
    for wanted in (own, own and _in_these_rows(own, arm, zero), agreement.corrected):
        if wanted is None or _kinds(wanted) != _kinds(arm):
            continue
        changed = _with_numbers(table, arm, wanted)
        made = read_whole(changed, catalog).manipulator
        ends = {"base_link": agreement.base_link, "tip_link": agreement.tip_link}
        if made is not None and compare(found.figure.robot, made, **ends).holds:
            right.append(changed)
    return min(right, key=lambda each: changed_cells(table, each), default=None)


def changed_cells(table: TableText, other: TableText) -> int:
    """How many cells of a table are others, base and tool included."""
    rows = zip(table.rows, other.rows, strict=True)
    cells = sum(one.get(field, "") != row.get(field, "") for one, row in rows for field in {*one, *row})
    return cells + (table.base != other.base) + (table.tool != other.tool)


def _kinds(arm: Manipulator) -> tuple[Convention, list[tuple[bool, bool]]]:
    return arm.convention, [(row.type is JointType.FIXED, row.type is JointType.PRISMATIC) for row in arm.rows]


def _in_these_rows(own: Manipulator, arm: Manipulator, zero: RigidTransform) -> Manipulator | None:
    """A description's own table with the fixed rows of another one, and a tool that makes up for what that moves.

    What comes after the last axis is that of the other one too: it only moves the tool, which leads to tool0 where all
    joint values are 0.
    """
    if len(own.moving_rows) != len(arm.moving_rows):
        return None
    kept = ("a", "alpha", "d") if arm.convention is Convention.STANDARD else ("d",)
    new, rows = list(own.moving_rows), []
    new[-1:] = [replace(last, **{field: getattr(arm.moving_rows[-1], field) for field in kept}) for last in new[-1:]]
    for row in arm.rows:
        if row.type is not JointType.FIXED:
            moving = new.pop(0)
            numbers = ("a", "alpha", "d", "theta", "offset", "sign")
            row = replace(row, **{field: getattr(moving, field) for field in numbers})  # noqa: PLW2901 - the same row
        rows.append(row)
    bare = replace(arm, base=own.base, rows=tuple(rows), tool=IDENTITY)
    tool = forward_kinematics(bare, (0.0,) * len(arm.actuated_rows)).inverse @ zero
    xyz, rpy = (tuple(round(number, DECIMALS) for number in each) for each in (tool.translation, tool.rpy))
    return replace(bare, tool=RigidTransform.from_xyz_rpy(xyz, rpy))  # type: ignore[arg-type]  # three of them


def _with_numbers(table: TableText, arm: Manipulator, wanted: Manipulator) -> TableText:
    """The table with the numbers of another arm where they differ; an offset that is there is kept."""
    length, angle, cells = UNITS[table.length_unit], UNITS[table.angle_unit], dict[tuple[int, str], str]()
    for number, (row, new) in enumerate(zip(arm.rows, wanted.rows, strict=True)):
        moved = "d" if row.type is JointType.PRISMATIC else "theta"
        for field in ("a", "alpha", "d", "theta"):
            before, value = getattr(row, field), getattr(new, field)
            if field == moved:
                value += new.offset - row.offset
            apart = math.remainder(value - before, math.tau) if field in ("alpha", "theta") else value - before
            dimension = dimension_of(field, row.type)
            if abs(apart) > _SAME and dimension is not None:
                cells[number, field] = number_in(value, unit_of(dimension, length, angle))
        if row.sign != new.sign:
            cells[number, "sign"] = str(new.sign)
    texts = table_text(replace(arm, base=wanted.base, tool=wanted.tool), table.length_unit, table.angle_unit)
    ends = {
        name: getattr(texts, name)
        for name in ("base", "tool")
        if max(f(getattr(arm, name), getattr(wanted, name)) for f in (position_error, angle_error)) > _SAME
    }
    return replace(edits.with_cells(table, cells), **ends)


# --- Files that a browser sent ----------------------------------------------------------------------------------------


def description_suffixes(catalog: Catalog) -> tuple[str, ...]:
    """File name endings of robot descriptions that can be compared."""
    stages = (item.stage for item in catalog.provided("emitter"))
    readable = (stage for stage in stages if isinstance(stage, Emitter) and stage.can(ReadsForeign) is not None)
    return tuple(suffix for stage in readable for suffix in stage.suffixes)


def wanted_suffixes(catalog: Catalog) -> tuple[str, ...]:
    """File name endings of everything that is kept."""
    return (*description_suffixes(catalog), *SUFFIXES, *addresses.SUFFIXES, ".yaml", ".yml")


def too_much() -> InputError:
    """The error of more files, or larger ones, than are kept."""
    return InputError(say("too-many-files", files=MOST_FILES, size=LARGEST // 2**20))


class GivenFiles:
    """A folder for files that were sent, which is there until `close`."""

    def __init__(self, files: Iterable[tuple[str, bytes]], catalog: Catalog) -> None:
        self._catalog, self._wanted = catalog, wanted_suffixes(catalog)
        self._folder = tempfile.TemporaryDirectory(prefix="dh2urdf-")
        # One folder deeper: an MJCF may include files beside its folder, and nothing is there.
        self._root = Path(self._folder.name).resolve() / "files"
        self._paths: list[Path] = []
        self._left = LARGEST
        for name, content in files:
            self.add(name, content)

    @property
    def descriptions(self) -> Sequence[str]:
        """The descriptions among them, those in fewer folders first."""
        suffixes = description_suffixes(self._catalog)
        paths = [path.relative_to(self._root) for path in self._paths]
        found = [path for path in paths if path.name.lower().endswith(suffixes) and path.name != PACKAGE_FILE]
        return [path.as_posix() for path in sorted(found, key=lambda path: (len(path.parts), path))]

    def figure(self, name: str) -> Figure | str:
        """The robot of one of the descriptions, with the mesh files that are here; or what is wrong with it."""
        path = self.path(name)
        try:
            figure = description(path, self._catalog)
        except Dh2UrdfError as error:
            return str(error).replace(f"{path.parent}{os.sep}", "").replace(f"{self._root}{os.sep}", "")
        addresses = dict.fromkeys(mesh.filename for mesh in meshes_of(figure.robot))
        files = {address: file for address in addresses if (file := self._file(address, figure.files.get(address)))}
        return replace(figure, title=path.name, files=files)

    def path(self, name: str) -> Path:
        """Where one of the descriptions is."""
        return self._root / name

    def close(self) -> None:
        """Remove the files."""
        self._folder.cleanup()

    def _file(self, address: str, found: Path | None) -> Path | None:
        """The file that an address means: the one that was found, or that whose path ends most like the address."""
        if found is not None and (path := found.resolve()).is_relative_to(self._root):
            return path
        wanted = tuple(part for part in address.replace("\\", "/").split("/") if part)
        for length in range(len(wanted), 0, -1):
            for path in self._paths:
                if path.parts[-length:] == wanted[-length:]:
                    return path
        return None

    def add(self, name: str, content: bytes) -> None:
        """Keep a file by its name, with slashes where it is in folders. A ZIP is unpacked.

        Raises:
            InputError: the files are more than `MOST_FILES`, or larger than `LARGEST`, or a ZIP cannot be read.
        """
        if not name.lower().endswith(".zip"):
            self._write(name, content)
            return
        with tempfile.TemporaryFile() as packed:
            packed.write(content)
            try:
                with zipfile.ZipFile(packed) as archive:
                    for entry in archive.infolist():
                        if not entry.is_dir() and self._place(entry.filename) is not None:
                            with archive.open(entry) as file:
                                self._write(entry.filename, file.read(self._left + 1))
            except BROKEN_ARCHIVE as error:
                raise InputError(say("archive-broken", name=name, reason=error)) from error

    def _place(self, name: str) -> Path | None:
        """Where a file is written; None for one that nothing here reads, or whose name leads elsewhere."""
        parts = PurePosixPath(name.replace("\\", "/")).parts
        if not parts or not name.lower().endswith(self._wanted):
            return None
        if any(part in ("..", "/") or ":" in part or "\0" in part for part in parts):
            return None
        return self._root.joinpath(*parts)

    def _write(self, name: str, content: bytes) -> None:
        if (path := self._place(name)) is None:
            return
        self._left -= len(content)
        if self._left < 0 or len(self._paths) == MOST_FILES:
            raise too_much()
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        except OSError as error:
            raise InputError(say("file-not-kept", name=name, reason=error.strerror)) from error
        self._paths.append(path)
