"""What `dh2urdf view` shows: robots of descriptions, of tables and of run files' cells, in one scene."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain, count
from typing import TYPE_CHECKING

from dh2urdf.cells.cell import Cell
from dh2urdf.commands.check import has_macros
from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.conversion.robots import make_item, make_robot
from dh2urdf.documents.text_files import check_file
from dh2urdf.errors import InputError, ManipulatorError
from dh2urdf.kinematics.chain import link_poses
from dh2urdf.manipulator import TOOL
from dh2urdf.meshes import mesh_finder, packages_in, with_its_own
from dh2urdf.plugin_system.calls import a_record, blaming, default_call
from dh2urdf.robot import Robot, with_followers
from dh2urdf.rotations import IDENTITY, RigidTransform, norm, scale
from dh2urdf.run_file.config import RUN_SUFFIXES, StageCall, is_run_file, load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.source import Mark, Messages, Problem, listed, shown
from dh2urdf.stages import Expansion, ReadsBack, ReadsForeign, Rejected
from dh2urdf.stages.foreign_robot import ForeignRobot
from dh2urdf.tasks.batch import Expected, items
from dh2urdf_studio import joints
from dh2urdf_studio.drawing.parts import GREY
from dh2urdf_studio.drawing.scene import Drawing, Figure, extent, meshes_of
from dh2urdf_studio.tab import Tab

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf_studio.drawing.mesh_files import DrawnMesh
    from dh2urdf_studio.drawing.parts import Colour
    from dh2urdf_studio.joints import Slider

say = Messages(__file__)

MOST_FIGURES = 50  # robots that one scene shows
TOLD_NAMES = 6  # names of robots that the page's head has room for


def load_figures(paths: Sequence[Path], catalog: Catalog, expansion: Expansion | None = None) -> tuple[Figure, ...]:
    """The robots of some files; an `InputError` has the problems of all files that cannot be read."""
    found: list[Figure] = []
    problems: list[Problem] = []
    notices: list[Problem] = []
    for path in paths:
        try:
            found += _figures(path, catalog, expansion)
        except (InputError, ManipulatorError) as error:
            problems += [problem.about(mark=Mark(file=str(path))) for problem in error.problems]
            notices += error.notices
    if problems:
        raise InputError(problems, notices)
    if expansion not in (None, Expansion()):
        readers = (item.stage for item in catalog.provided("emitter") if has_macros(item.stage))
        suffixes = tuple(suffix for each in readers for suffix in getattr(each, "suffixes", ()))
        if not any(path.name.lower().endswith(suffixes) for path in paths):
            raise InputError(say("files-without-macros", Mark(file=str(paths[0]))))
    if len(found) > MOST_FIGURES:
        raise InputError(say("too-many-robots", count=len(found), most=MOST_FIGURES))
    if len(found) == 1:
        return (replace(found[0], name="", title=""),)
    names = list[str]()  # one for each: no two nodes are called alike
    for figure in found:
        numbered = (f"{figure.title} {number}" for number in count(2))
        names.append(next(name for name in chain([figure.title], numbered) if name not in names))
    return tuple(replace(figure, name=f"{name}/", title=name) for figure, name in zip(found, names, strict=True))


def _figures(path: Path, catalog: Catalog, expansion: Expansion | None) -> Iterator[Figure]:
    check_file(path, InputError)
    if path.suffix.lower() in RUN_SUFFIXES and is_run_file(path):
        yield from _of_run(path, catalog)
    elif catalog.is_table(path):
        transform = default_call(catalog, catalog.usual("transform"))
        for arm in read_items(default_call(catalog, catalog.reader_for(path)), path):
            if isinstance(arm, Rejected):
                raise InputError(arm.problems, arm.notices)
            yield Figure(robot=make_robot(arm, transform), manipulator=arm, title=arm.name)
    else:
        yield description(path, catalog, expansion)


def description(path: Path, catalog: Catalog, expansion: Expansion | None = None) -> Figure:
    """The robot of a robot description."""
    emitter = catalog.emitter_for(path)
    reads = emitter.can(ReadsForeign) or emitter.can(ReadsBack)
    if reads is None:
        raise InputError(say("format-not-read-back", found=path.name, emitter=emitter.name))
    given = expansion or Expansion()
    with blaming(default_call(catalog, emitter), "read_back" if isinstance(reads, ReadsBack) else "read_foreign"):
        read = reads.read_back(path) if isinstance(reads, ReadsBack) else reads.read_foreign(path, given)
        read = a_record(read, ForeignRobot, Robot)
    found = read if isinstance(read, ForeignRobot) else ForeignRobot(robot=read)
    # Simulators make axes of the length 1, of any length but 0.
    unit_axes = (replace(each, axis=scale(1.0 / (norm(each.axis) or 1.0), each.axis)) for each in found.robot.joints)
    robot = replace(found.robot, joints=tuple(unit_axes))
    packages = with_its_own(path, packages_in(expansion.package_paths if expansion else ()))
    find = mesh_finder(found.folder or path.resolve().parent, packages)
    addresses = dict.fromkeys(mesh.filename for mesh in meshes_of(robot))
    files = {address: file for address in addresses if (file := find(address))}
    title = robot.name.strip() or path.stem
    return Figure(robot=robot, title=title, files=files, loose=found.loose, notices=found.notices)


def _of_run(path: Path, catalog: Catalog) -> Iterator[Figure]:
    """The cells of a run file; of one that has none, its manipulators with their meshes, and its variants."""
    config = load_config(path)
    # Nothing is written, loaded or handed to workers.
    looking = replace(config, loaders=(), execution=StageCall()).written_to(path.parent)
    plan = make_plan(looking, catalog)
    transform, edits = plan.recipe.transform, plan.recipe.edits
    every = (what for item in items(plan, Expected(plan)) for what in item.each)
    shown_only = (what for what in every if isinstance(what, Cell | Rejected) or not plan.cells)
    for number, what in enumerate(shown_only):
        if isinstance(what, Rejected):
            raise InputError(what.problems, what.notices)
        if number == MOST_FIGURES:
            raise InputError(say("too-many-robots", count=f"more than {MOST_FIGURES}", most=MOST_FIGURES))
        robot, _ = make_item(what, transform, edits)
        table = None if isinstance(what, Cell) else robot.manipulator
        yield Figure(robot=robot, manipulator=table, title=robot.name)


class View(Tab):
    """What a tab of `dh2urdf view` shows."""

    def __init__(self, figures: Sequence[Figure]) -> None:
        super().__init__("links", "axes", "outlines")
        self.figures = tuple(figures)
        self.apart = True  # whether the robots stand side by side, or all at one place
        self.as_in_ros = True  # whether the axis up of COLLADA files is not followed: see `dh2urdf.meshes.read_parts`
        self.plain = GREY  # the colour of links that have none
        self.followers = {  # the joints that follow others: they have no slider, but values in `q`
            figure.name + name: follower._replace(leader=figure.name + follower.leader)
            for figure in figures
            for name, follower in figure.robot.followers.items()
        }
        found: list[Slider] = []
        for figure in figures:
            named = [replace(joint, name=figure.name + joint.name) for joint in figure.robot.moving_joints]
            found += joints.sliders(named, angle_unit="deg", group=figure.title)
        self.sliders = tuple(slider for slider in found if slider.name not in self.followers)
        self.move({})
        self.place()
        if self.drawing.meshes:  # which joint axes would only lie on
            self.layers -= {"axes"}

    @property
    def told(self) -> str:
        """The robots in a line."""
        return listed([shown(figure.title or figure.robot.name)[1:-1] for figure in self.figures], TOLD_NAMES)

    @property
    def name(self) -> str:
        """The robots, as a file may be called."""
        return self.told.replace(", ", "-")

    def place(self, *, apart: bool | None = None, as_in_ros: bool | None = None, plain: Colour | None = None) -> None:
        """Puts the robots side by side or all at one place, their meshes as ROS or as their files have them."""
        self.apart = self.apart if apart is None else apart
        self.as_in_ros = self.as_in_ros if as_in_ros is None else as_in_ros
        self.plain = plain or self.plain
        figures = [replace(figure, as_in_ros=self.as_in_ros, plain=self.plain) for figure in self.figures]
        if self.apart:  # in a row along y, as far from each other as their arms do not touch when they are stretched
            edge = 0.0
            for number, figure in enumerate(figures):
                half = 0.6 * max(extent(figure.robot), 0.1)
                edge += half if number else 0.0
                figures[number] = replace(figure, place=RigidTransform(IDENTITY.rotation, (0.0, edge, 0.0)))
                edge += half
        self.drawing = Drawing.of(figures)

    @property
    def turns(self) -> bool:
        """Whether there are meshes whose files may say which axis is up, and need not be believed."""
        return any(mesh.as_in_ros and mesh.path.suffix.lower() == ".dae" for mesh in self.drawing.meshes.values())

    def meshes(self) -> dict[str, DrawnMesh]:
        """Every mesh file that the page may ask for, by its key."""
        return {
            key: mesh
            for as_in_ros in (True, False)
            for key, mesh in Drawing.of([replace(one, as_in_ros=as_in_ros) for one in self.figures]).meshes.items()
        }

    def move(self, values: Mapping[str, float]) -> None:
        """Joint values by name [rad or m]; they are kept inside the limits, and followers follow."""
        super().move(values)
        self.q = with_followers(self.q, self.followers)

    def tips(self) -> Iterator[tuple[str, RigidTransform]]:
        """The ends of the arms with their poses in the robots: links called tool0, or else those without a child."""
        for figure in self.figures:
            own = {joint.name: self.q[figure.name + joint.name] for joint in figure.robot.moving_joints}
            poses = link_poses(figure.robot, own)
            holding = {joint.parent for joint in figure.robot.joints}
            links = [link.name for link in figure.robot.links]
            tools = [name for name in links if name.endswith(TOOL)]
            for name in tools or [name for name in links if name not in holding]:
                yield figure.name + name, poses.get(name, IDENTITY)
