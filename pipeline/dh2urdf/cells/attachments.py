"""Robots from descriptions that are bolted to other robots: grippers, tools, cameras and bases.

The tree of such a robot goes into the whole one as it is: the same frames, axes, limits and numbers. Every name gets a
prefix, and so does every reference to one. Nothing is made into a DH table.
"""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.documents import SRDF_NAMES, is_folder, lost_references, read_bytes, srdf_elements
from dh2urdf.errors import ConfigError, InputError, RobotError, TableError
from dh2urdf.fields import replace_unchecked
from dh2urdf.kinematics.mass import GRAVITY, SAFETY, inertia_problem, repaired, two_digits
from dh2urdf.manipulator import TOOL, WORLD, JointType
from dh2urdf.meshes.addresses import NamedFiles, file_address, mesh_finder, packages_in, with_its_own
from dh2urdf.meshes.files import find_mesh
from dh2urdf.meshes.named_files import picture_of, with_named_files
from dh2urdf.robot import WEIGHTLESS, Attachment, Joint, Link, Mesh, Origin, Robot
from dh2urdf.rotations import mapped, norm, scale
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, free_name, listed
from dh2urdf.stages import PACKAGE_FILE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from dh2urdf.manipulator import MeshFile
    from dh2urdf.robot import Collision, Visual
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.stages import ForeignRobot

    S = TypeVar("S", Visual, Collision)

__all__ = ["AttachmentCall", "attached", "attachment_of"]

say = Messages(__file__)

LARGEST_PICTURE = 2**26
"""Size of a picture or a file of materials that is copied with a mesh [B]."""
MOST_ELEMENTS = 10_000
"""Links, joints and other elements that an attachment may have."""
PACKAGE_VARIABLES = {"ROS_PACKAGE_PATH": "", "AMENT_PREFIX_PATH": "share"}
"""Variables of the environment that list folders with ROS packages, and where in each folder the packages are."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AttachmentCall:
    """An attachment as somebody asks for it.

    Attributes:
        name: what it is called.
        prefix: what stands before its names; None for its name and a ``_``.
        parent: the link that holds it.
        placement: the frame of its first link in the parent's.
        root: the link by which it is held; None for the root of its file.
        tip: the link of it that is the tool from now on.
        srdf: the SRDF of it.
        elements: whether elements beside links and joints are kept.
        repairs: whether an inertia that no body can have is changed by as little as makes it possible.
        missing_meshes: whether a mesh that is not there stays as an address.
        packages: folders of ROS packages by their names, which ``package://`` addresses mean.
        mesh_links: whether symbolic links to meshes may lead out of the folders that addresses name.
    """

    name: str
    prefix: str | None = None
    parent: str = TOOL
    placement: Origin = Origin()
    root: str | None = None
    tip: str | None = None
    srdf: Path | None = None
    elements: bool = True
    repairs: bool = False
    missing_meshes: bool = False
    packages: Mapping[str, Path] = field(default_factory=lambda: MappingProxyType({}))
    mesh_links: bool = False


# --- What a description becomes ---------------------------------------------------------------------------------------


def attachment_of(found: ForeignRobot, path: Path, call: AttachmentCall) -> tuple[Attachment, tuple[Problem, ...]]:
    """What a description of any origin is as an attachment, and notices about it.

    Args:
        found: what its file holds.
        path: the file, for messages and for the paths of meshes.
        call: what is asked of it.

    Raises:
        RobotError: it is no tree of links and joints that a table's robot can hold, or it or its SRDF names what is not
            there.
        TableError: the SRDF cannot be read.
    """
    elements = found.elements if call.elements else ()
    if problems := [*_problems(found, path, call, elements)]:
        raise RobotError(problems)
    notices = [*found.notices, *found.lost]
    robot, start = _without_world(found.robot, call.root)
    if start is not None:
        notices.append(say("attached-world-left-out", Mark(file=str(path)), child=robot.links[0].name))
    robot = _in_order(_hung_by(robot, call.root, path) if call.root else robot)
    robot = _with_files(robot, found, path, call, notices)
    robot = replace(robot, links=tuple(_bodies(robot, path, notices, repairs=call.repairs)))
    joints = tuple([_as_readers_have_it(joint) for joint in robot.joints])
    prefix = f"{call.name}_" if call.prefix is None else call.prefix
    placement = call.placement if start is None else Origin.of(call.placement.transform @ start)
    attachment = Attachment(
        name=call.name,
        prefix=prefix,
        parent=call.parent,
        placement=placement,
        robot=replace(robot, name=call.name, joints=joints),
        elements=elements,
        semantics=_semantics(call.srdf, robot, notices) if call.srdf else (),
        tip=call.tip,
    )
    return attachment, tuple(notices)


def _problems(found: ForeignRobot, path: Path, call: AttachmentCall, elements: tuple[str, ...]) -> Iterator[Problem]:
    """What keeps a description from being an attachment."""
    robot, file = found.robot, Mark(file=str(path))
    links, joints = [link.name for link in robot.links], [joint.name for joint in robot.joints]
    if (count := len(links) + len(joints) + len(elements)) > MOST_ELEMENTS:
        yield say("attached-too-large", file, count=count, most=MOST_ELEMENTS)
        return
    yield from found.faults
    for joint in robot.joints:
        yield from (problem.about(mark=joint.mark or file) for problem in _joint_problems(joint, found, links))
    yield from (problem.about(mark=file) for problem in _tree_problems(robot, links, joints))
    for option, link in (("root", call.root), ("tip", call.tip)):
        if link is not None and link not in links:
            yield say("attached-no-such-link", file, field=option, found=link, suggestion=did_you_mean(link, links))
    for tag, attribute, name in lost_references(elements, frozenset((*links, *joints))):
        near = did_you_mean(name, [*links, *joints])
        yield say("attached-reference", file, tag=tag, field=attribute, found=name, suggestion=near)


def _tree_problems(robot: Robot, links: list[str], joints: list[str]) -> Iterator[Problem]:
    """What keeps links and joints from being a tree with one root."""
    for kind, names in (("link", links), ("joint", joints)):
        for name in [name for name, times in Counter(names).items() if times > 1]:
            yield say("attached-name-twice", kind=kind, name=name)
    held = Counter(joint.child for joint in robot.joints)
    for name in [name for name, times in held.items() if times > 1]:
        yield say("attached-loop", link=name)
    roots = [name for name in dict.fromkeys(links) if name not in held]
    if len(roots) > 1:
        yield say("attached-roots", count=len(roots), roots=listed(roots, 5))
    elif circle := [name for name in links if name not in {*roots, *_below(robot, roots)}]:
        yield say("attached-circle", links=listed(circle, 5))


def _semantics(path: Path, robot: Robot, notices: list[Problem]) -> tuple[str, ...]:
    """The elements of an SRDF that names nothing but what a robot has."""
    file = Mark(file=str(path))
    known = {"link": {each.name for each in robot.links}, "joint": {each.name for each in robot.joints}}
    try:
        elements, unknown = srdf_elements(read_bytes(path, TableError), known)
    except SyntaxError as error:  # those of lxml are
        raise RobotError(say("attached-srdf-wrong", file, reason=error.msg)) from error
    if unknown:
        raise RobotError(
            say(
                "attached-srdf-reference",
                replace(file, line=each.line),
                field=each.attribute,
                found=each.name,
                suggestion=did_you_mean(each.name, known.get(each.kind, ())),
                tag=each.tag,
                kind=each.kind,
            )
            for each in unknown
        )
    if others := [tag for tag in elements.values() if tag not in SRDF_NAMES]:
        notices.append(say("attached-srdf-left-out", file, tags=listed([*dict.fromkeys(others)])))
    return tuple([text for text, tag in elements.items() if tag in SRDF_NAMES])


def _joint_problems(joint: Joint, found: ForeignRobot, links: list[str]) -> Iterator[Problem]:
    """What is wrong with a joint: it moves as no table has it, names what is not there, or follows nothing."""
    name, moving = joint.name, [each.name for each in found.robot.moving_joints]
    if name in found.loose:
        yield say("attached-joint-loose", joint=name, type=found.loose[name])
    for end, link in (("parent", joint.parent), ("child", joint.child)):
        if link not in links:
            near = did_you_mean(link, links)
            yield say("attached-joint-of-no-link", joint=name, end=end, found=link, suggestion=near)
    if joint.type is not JointType.FIXED and not norm(joint.axis):
        yield say("attached-axis-0", joint=name)
    if joint.follows and name in moving and name not in found.robot.followers:
        leader = joint.follows.leader
        yield say("attached-leader", joint=name, found=leader, suggestion=did_you_mean(leader, moving))


def _without_world(robot: Robot, root: str | None) -> tuple[Robot, RigidTransform | None]:
    """A robot without a root link `world` that is empty and holds one link by a fixed joint, and where that link is."""
    held = [joint for joint in robot.joints if joint.parent == WORLD]
    world = next((link for link in robot.links if link.name == WORLD), None)
    is_empty = world is not None and world.inertial is None and not world.shapes
    is_root = all(joint.child != WORLD for joint in robot.joints)
    if root == WORLD or not (is_empty and is_root and len(held) == 1 and held[0].type is JointType.FIXED):
        return robot, None
    (joint,) = held
    first = next(link for link in robot.links if link.name == joint.child)
    others = [link for link in robot.links if link.name not in {WORLD, joint.child}]
    joints = tuple([each for each in robot.joints if each is not joint])
    return replace(robot, links=(first, *others), joints=joints), joint.origin.transform


def _hung_by(robot: Robot, root: str, path: Path) -> Robot:
    """A robot that is held by another link: the joints above that link, which are fixed, are turned round."""
    above = {joint.child: joint for joint in robot.joints}
    turned: dict[str, Joint] = {}
    link = root
    while (joint := above.get(link)) is not None:
        if joint.type is not JointType.FIXED:
            mark = joint.mark or Mark(file=str(path))
            raise RobotError(say("attached-root-moves", mark, field="root", found=root, joint=joint.name))
        origin = Origin.of(joint.origin.transform.inverse)
        turned[joint.name] = replace(joint, parent=joint.child, child=joint.parent, origin=origin)
        link = joint.parent
    return replace(robot, joints=tuple([turned.get(joint.name, joint) for joint in robot.joints]))


def _in_order(robot: Robot) -> Robot:
    """A robot whose links come behind those that hold them, each joint as its child; siblings as in the file."""
    links = {link.name: link for link in robot.links}
    held = {joint.child for joint in robot.joints}
    (root,) = (name for name in links if name not in held)
    below = _below(robot, [root])
    ordered = (links[root], *(links[name] for name in below))
    return replace(robot, links=ordered, joints=tuple(below.values()))


def _below(robot: Robot, roots: list[str]) -> dict[str, Joint]:
    """The links below some links by their names, each with the joint that holds it, parents before children."""
    held_by: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        held_by.setdefault(joint.parent, []).append(joint)
    below: dict[str, Joint] = {}
    waiting = [*roots]
    while waiting:
        joints = [joint for joint in held_by.get(waiting.pop(), []) if joint.child not in below]
        below |= {joint.child: joint for joint in joints}
        waiting += [joint.child for joint in reversed(joints)]
    return below


def _as_readers_have_it(joint: Joint) -> Joint:
    """A joint whose axis has the length 1, which all readers make it; one that turns without end has no ends.

    A fixed joint with a `<mimic>` stays where it is: Drake alone refuses it.
    """
    length = norm(joint.axis)
    if joint.type is JointType.FIXED and joint.follows:
        joint = replace(joint, follows=None)
    if joint.type is not JointType.FIXED and not abs(length - 1.0) <= 1e-9:  # noqa: PLR2004 - as a robot's check has it
        joint = replace(joint, axis=scale(1.0 / length, joint.axis))
    if joint.type is JointType.CONTINUOUS:
        joint = replace(joint, limits=replace(joint.limits, lower=None, upper=None))
    return joint


def _with_files(robot: Robot, found: ForeignRobot, path: Path, call: AttachmentCall, notices: list[Problem]) -> Robot:
    """A robot whose meshes are the files that its addresses mean."""
    packages = {**_environment_packages(), **call.packages}
    find = mesh_finder(found.folder or path.resolve().parent, with_its_own(path, packages))
    problems: dict[str, Problem] = {}
    known: dict[Path, MeshFile] = {}

    def at_hand(shape: S) -> S:
        mesh = shape.geometry
        if not isinstance(mesh, Mesh):
            return shape
        mark, file = Mark(file=str(path)), find(mesh.filename)
        if file is None:
            code = "attached-mesh-kept" if call.missing_meshes else "attached-mesh-missing"
            folders = listed([str(folder) for folder in (path.resolve().parent, *packages.values())], 4)
            problems.setdefault(mesh.filename, say(code, mark, found=mesh.filename, folders=folders))
            return shape
        try:
            if (at := file.absolute()) not in known:
                files = NamedFiles(at, LARGEST_PICTURE, packages.values(), links=call.mesh_links)
                known[at] = with_named_files(find_mesh(at.name, at.parent, links=call.mesh_links), files)
                for name, reason in files.unread.items():
                    about = {"found": mesh.filename, "name": name, "reason": reason}
                    problems[f"{at} {name}"] = say("attached-mesh-names-files", mark, **about)
            return replace(shape, geometry=replace(mesh, filename=file_address(str(at)), file=known[at]))
        except ConfigError as error:
            problems.setdefault(mesh.filename, error.problems[0].about(mark=mark))
            return shape

    def picture(address: str) -> MeshFile | None:
        """The picture of an address, from the package of the description or from another one that is named."""
        file = find(address)
        homes = [folder / PACKAGE_FILE for folder in packages.values() if file and file.is_relative_to(folder)]
        files = NamedFiles([*homes, path][0], LARGEST_PICTURE, links=call.mesh_links)
        found = picture_of(str(file), files) if file else None
        if found is None:
            (reason,) = files.unread.values() or ["there is no such file"]
            about = {"found": address, "reason": reason}
            problems[address] = say("attached-texture-left-out", Mark(file=str(path)), **about)
        return found

    links = [
        replace_unchecked(
            link,
            visuals=tuple([_with_picture(at_hand(shape), picture) for shape in link.visuals]),
            collisions=tuple(map(at_hand, link.collisions)),
        )
        for link in robot.links
    ]
    if errors := [each for each in problems.values() if each.severity == "error"]:
        raise RobotError(errors)
    notices += problems.values()
    return replace(robot, links=tuple(links))


def _with_picture(visual: Visual, picture: Callable[[str], MeshFile | None]) -> Visual:
    """A visual whose material has a picture, or none, where its file gives the address of one."""
    if visual.material is None or not visual.material.texture:
        return visual
    found = picture(visual.material.texture)
    texture = file_address(found.path) if found else ""
    return replace(visual, material=replace(visual.material, texture=texture, picture=found))


def _environment_packages() -> dict[str, Path]:
    """The ROS packages that the environment names, by their names."""
    found: dict[str, Path] = {}
    for variable, inner in PACKAGE_VARIABLES.items():
        folders = [Path(each) / inner for each in os.environ.get(variable, "").split(os.pathsep) if each]
        for folder in reversed([each for each in folders if is_folder(each)]):
            with suppress(InputError):  # a folder of an overlay that holds no package
                found |= packages_in([folder])
    return found


def _bodies(robot: Robot, path: Path, notices: list[Problem], *, repairs: bool) -> Iterator[Link]:
    """The links with inertials that readers take as they are meant.

    A link without a mass on a fixed joint is a frame. PyBullet takes one without an inertial for 1 kg, so it has mass
    properties of 0; but sdformat loses a whole robot in which what weighs nothing holds such a frame.
    """
    holder = {joint.child: joint for joint in robot.joints}
    weighs = {link.name: link.inertial is not None and link.inertial.mass > 0.0 for link in robot.links}
    laden = dict(weighs)  # also what has a mass of others by the time that it is lumped itself
    for link in reversed(robot.links):
        joint = holder.get(link.name)
        if joint and joint.type is JointType.FIXED and laden[link.name]:
            laden[joint.parent] = True
    for link in robot.links:
        joint, body = holder.get(link.name), link.inertial
        if body is None or not weighs[link.name]:
            is_frame = joint is None or joint.type is JointType.FIXED
            is_counted = laden[link.name] or (joint is not None and weighs[joint.parent])
            yield replace(link, inertial=WEIGHTLESS if is_counted else None) if is_frame else link
            continue
        if reason := inertia_problem(body.inertia):
            if repairs and max(body.inertia.ixx, body.inertia.iyy, body.inertia.izz) > 0.0:
                yield replace(link, inertial=replace(body, inertia=repaired(body.inertia)))
                continue
            notices.append(say("attached-inertia", Mark(file=str(path)), link=link.name, reason=reason))
        yield link


# --- What the whole robot becomes -------------------------------------------------------------------------------------


def attached(robot: Robot, attachment: Attachment, mark: Mark | None = None) -> Robot:
    """A robot with an attachment, whose links and joints come last; efforts that nobody gave carry it, too.

    Takes columns.

    Raises:
        RobotError: no link has the name of its parent, or two names are the same.
    """
    known = [link.name for link in robot.links]
    if attachment.parent not in known:
        near = did_you_mean(attachment.parent, known)
        about: dict[str, Any] = {"field": "parent", "found": attachment.parent, "suggestion": near}
        raise RobotError(say("attached-to-no-link", mark, name=attachment.name, links=listed(known, 20), **about))
    taken = {*known, *(joint.name for joint in robot.joints)}
    prefix, part = attachment.prefix, attachment.robot
    if clash := sorted(taken & {prefix + name for name in attachment.names}):
        about = {"name": attachment.name, "found": clash[0], "own": clash[0].removeprefix(prefix)}
        raise RobotError(say("attached-name-taken", mark, field="prefix", **about))
    taken |= {prefix + name for name in attachment.names}
    mounting = Joint(
        name=free_name(f"{attachment.name}_joint", taken),
        type=JointType.FIXED,
        parent=attachment.parent,
        child=prefix + part.root,
        origin=attachment.placement,
    )
    joints = (*_carrying(robot, attachment), mounting, *(prefixed_joint(joint, prefix) for joint in part.joints))
    links = (*robot.links, *(prefixed_link(link, prefix) for link in part.links))
    return replace(robot, links=links, joints=joints, attachments=(*robot.attachments, attachment))


def prefixed_joint(joint: Joint, prefix: str) -> Joint:
    """A joint with a prefix before its name and before those that it names."""
    names = {name: prefix + getattr(joint, name) for name in ("name", "parent", "child")}
    follows = joint.follows and joint.follows._replace(leader=joint.follows.leader and prefix + joint.follows.leader)
    return replace(joint, **names, follows=follows)


def prefixed_link(link: Link, prefix: str) -> Link:
    """A link with a prefix before its name and those of its materials."""
    visuals = tuple(
        [
            replace(shape, material=shape.material and replace(shape.material, name=prefix + shape.material.name))
            for shape in link.visuals
        ]
    )
    return replace(link, name=prefix + link.name, visuals=visuals)


def _carrying(robot: Robot, attachment: Attachment) -> list[Joint]:
    """The joints of a robot, of which those whose effort follows from what they carry also carry an attachment.

    As for a table's own links, the load is bounded for every joint vector and every way the arm may be mounted: a
    joint that turns bears at most the weight times the length of the way from its axis, one that slides the weight.
    """
    mass, moment = _load(attachment.robot)
    if not robot.loaded or not mass:
        return [*robot.joints]
    moment += mass * norm(attachment.placement.xyz)
    above = {joint.child: joint for joint in robot.joints}
    loads: dict[str, Any] = {}
    link = attachment.parent
    while (joint := above.get(link)) is not None:
        if joint.type is not JointType.FIXED:
            loads[joint.name] = mass if joint.type is JointType.PRISMATIC else moment
        moment = moment + mass * (norm(joint.origin.xyz) + _travel(joint))
        link = joint.parent
    for name, law in robot.followers.items():  # a leader bears what its followers do, too
        if name in loads:
            loads[law.leader] = loads.get(law.leader, 0.0) + abs(law.multiplier) * loads[name]
    efforts = {
        joint.name: mapped(_rounded_up, joint.limits.effort, SAFETY * GRAVITY * loads[joint.name])
        for joint in robot.joints
        if joint.name in loads and joint.name in robot.loaded and joint.limits.effort is not None
    }
    return [
        replace_unchecked(each, limits=replace_unchecked(each.limits, effort=efforts[each.name]))
        if each.name in efforts
        else each
        for each in robot.joints
    ]


def _rounded_up(effort: float, more: float) -> float:
    needed = effort + more
    return two_digits(needed, math.ceil, -1e-9) if 0.0 < needed < math.inf else needed


def _load(part: Robot) -> tuple[float, float]:
    """The mass of a robot [kg], and an upper bound of its moment about the origin of its first link [kg·m]."""
    mass = moment = 0.0
    above = {joint.child: joint for joint in part.joints}
    away: dict[str, float] = {}
    for link in part.links:  # Parents before children.
        joint = above.get(link.name)
        away[link.name] = away[joint.parent] + norm(joint.origin.xyz) + _travel(joint) if joint else 0.0
        if link.inertial:
            mass += link.inertial.mass
            moment += link.inertial.mass * (away[link.name] + norm(link.inertial.com))
    return mass, moment


def _travel(joint: Joint) -> Any:  # noqa: ANN401 - a number or a column
    """How far a joint moves its link along its axis at most [m]."""
    limits = joint.limits
    if joint.type is not JointType.PRISMATIC or limits.lower is None or limits.upper is None:
        return 0.0
    return mapped(lambda lower, upper: max(abs(lower), abs(upper)), limits.lower, limits.upper)
