"""A robot description of any origin as the ground of a table: its robot, and what the robot does not hold.

What a description holds besides the links and joints of a robot: no table has it, and a notice names it.

The shapes of a URDF that its reader has no word for: capsules become what robots have, and others are left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import partial
from math import comb, nan
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.documents import is_file, read_bytes
from dh2urdf.elementwise import total
from dh2urdf.errors import ProofError, TableError
from dh2urdf.foreign_robot import Follower
from dh2urdf.robot import Cylinder, Origin, Robot
from dh2urdf.source import Mark, Problem, listed, shown
from dh2urdf_plugins.descriptions.rounded_pi import Rounded, repaired
from dh2urdf_plugins.read_back import urdf_reader
from dh2urdf_plugins.read_back.mjcf import reader as mjcf_reader
from dh2urdf_plugins.read_back.mjcf.elements import Elements, compiler_of
from dh2urdf_plugins.read_back.sdf import reader as sdf_reader
from dh2urdf_plugins.read_back.sdf.elements import is_true
from dh2urdf_plugins.read_back.xml_files import LARGEST, capsule, mark_of, tree_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from dh2urdf.stages import Expansion


_URDF = {
    ".": "link joint material mujoco",
    "link": "inertial visual collision",
    "joint": "origin parent child axis limit dynamics mimic",
}
"""The elements that are read, or are no part of the robot, by what holds them."""
_URDF_ATTRIBUTES = {"limit": "lower upper effort velocity", "dynamics": "damping friction"}
_SDF = ("plugin", "gripper", "link/sensor", "link/battery", "link/light", "joint/sensor")
_MJCF = ("sensor", "tendon", "keyframe")
_ACTUATORS = ("general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle")


def of_urdf(root: etree._Element) -> Iterator[tuple[str, etree._Element]]:
    """What a URDF holds besides, in words, and where."""
    for path, known in _URDF.items():
        for holder in root.iterfind(path):
            for element in holder.iterchildren(etree.Element):
                if element.tag not in known.split():
                    yield f"the element {_name(element, element.tag)}{'' if path == '.' else f' of a {path}'}", element
    for tag, known in _URDF_ATTRIBUTES.items():
        for element in root.iterfind(f"joint/{tag}"):
            for name in map(str, element.attrib):
                if name not in known.split():
                    yield f"the attribute {_name(element, name)} of a {tag}", element


def _name(element: etree._Element, name: str) -> str:
    """A name as the file writes it, with its prefix."""
    if name[:1] != "{":
        return name
    space, _, local = name[1:].partition("}")
    prefix = next((prefix for prefix, address in element.nsmap.items() if address == space), None)
    return f"{prefix}:{local}" if prefix else local


def of_sdf(root: etree._Element) -> Iterator[tuple[str, etree._Element]]:
    """What the first model of an SDF holds besides, in words, and where."""
    model = next((each for path in ("model", "world/model") for each in root.iterfind(path)), None)
    if model is None:
        return
    for path in _SDF:
        holder, _, tag = path.rpartition("/")
        for element in model.iterfind(f".//{path}" if holder else path):
            yield f"the element {tag}{f' of a {holder}' if holder else ''}", element
    for spring in model.iterfind(".//joint/axis/dynamics/spring_stiffness"):
        if (spring.text or "").strip(" 0.\n"):
            yield "the spring of a joint", spring


def of_mjcf(elements: Elements) -> Iterator[tuple[str, etree._Element]]:
    """What an MJCF holds besides, in words, and where."""
    for section in elements.root.iterchildren("actuator"):
        for actuator in section.iterchildren(etree.Element):
            yield "an actuator, but for the effort of its joint,", actuator
    for section in elements.root.iterchildren(*_MJCF):
        for element in section.iterchildren(etree.Element):
            yield f"a {'keyframe' if section.tag == 'keyframe' else section.tag}", element
    for camera in elements.root.iterfind("worldbody//camera"):
        yield "a camera", camera
    for joint in elements.root.iterfind("worldbody//joint"):
        given = elements.attributes(joint)
        if "springdamper" in given or given.get("stiffness", "0").strip(" 0."):
            yield "the spring of a joint", joint


def efforts_of_mjcf(elements: Elements) -> Mapping[str, float]:
    """The efforts of joints that one actuator drives, by the joint's name: what its force can reach [N or N·m].

    https://mujoco.readthedocs.io/en/stable/XMLreference.html#actuator-general: the effort at the joint is the force
    times the gear; the force of a motor is what controls it.
    """
    driven: dict[str, list[float | None]] = {}
    for section in elements.root.iterchildren("actuator"):
        for actuator in section.iterchildren(etree.Element):
            given = elements.attributes(actuator, *_ACTUATORS)
            if joint := given.get("joint") or given.get("jointinparent"):
                driven.setdefault(joint, []).append(_effort(actuator, given, elements))
    return {joint: found[0] for joint, found in driven.items() if len(found) == 1 and found[0]}


def _effort(actuator: etree._Element, given: dict[str, str], elements: Elements) -> float | None:
    reaches = [("forcerange", "forcelimited")]
    if actuator.tag == "motor":
        reaches.append(("ctrlrange", "ctrllimited"))
    try:
        gear = elements.numbers(actuator, given, "gear", (1.0,), most=6)[0]
        ranges = [elements.limits(actuator, given, name, limited) for name, limited in reaches]
        found = [max(map(abs, limits)) for limits in ranges if limits]
    except ProofError:  # numbers that are none; the effort is unknown then
        return None
    return abs(gear) * min(found) if found else None


_READ = ("box", "cylinder", "sphere", "mesh")


def with_known_shapes(root: etree._Element) -> Iterator[tuple[str, etree._Element]]:
    """Changes the elements of a URDF so that every shape can be read.

    Args:
        root: the outermost element; it is changed.

    Yields:
        What is left out, in words, and where.
    """
    for shape in [*root.iterfind("link/visual"), *root.iterfind("link/collision")]:
        geometry = shape.find("geometry")
        kind = None if geometry is None else next(geometry.iterchildren(etree.Element), None)
        if kind is not None and kind.tag in _READ:
            continue
        link = shape.getparent()
        if link is None:  # It is the child of a link.
            continue
        parts = _capsule(shape, kind) if kind is not None and kind.tag == "capsule" else None
        if parts is None:
            yield f"a {shape.tag} without a shape" if kind is None else f"a shape {shown(str(kind.tag))}", shape
        for part in parts or ():
            shape.addprevious(part)
        link.remove(shape)


def _capsule(shape: etree._Element, kind: etree._Element) -> list[etree._Element] | None:
    """A cylinder and two balls in the place of a capsule; None where its numbers cannot be read."""
    origin = shape.find("origin")
    try:
        radius, length = (float(kind.get(name, "")) for name in ("radius", "length"))
        (x, y, z), (roll, pitch, yaw) = (
            map(float, ("0 0 0" if origin is None else origin.get(name, "0 0 0")).split()) for name in ("xyz", "rpy")
        )
    except ValueError:
        return None
    place = Origin(xyz=(x, y, z), rpy=(roll, pitch, yaw)).transform
    parts = []
    for geometry, pose in capsule(radius, length):
        part = deepcopy(shape)
        for old in [*part.iterchildren("origin", "geometry")]:
            part.remove(old)
        xyz, rpy = ((place @ pose).translation, (roll, pitch, yaw))
        etree.SubElement(part, "origin", xyz=" ".join(map(repr, xyz)), rpy=" ".join(map(repr, rpy)))
        attributes = {"radius": repr(radius)}
        if isinstance(geometry, Cylinder):
            attributes["length"] = repr(length)
        etree.SubElement(etree.SubElement(part, "geometry"), type(geometry).__name__.lower(), attributes)
        for element in part.iter():
            element.sourceline = shape.sourceline
        parts.append(part)
    return parts


_LOOSE = ("floating", "planar")
"""Joints of URDF that no table has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Description:
    """What is in a file.

    Attributes:
        robot: its links and joints; joints that no table has are fixed in it.
        file: the file, as messages name it.
        folder: from where the paths of its meshes lead.
        followers: joints that mimic another, by name, and how; the name of the leader is empty where it is missing.
        loose: joints that no table has, with their types.
        rounded: numbers that were meant to be parts of π.
        repaired: the robot with these numbers read as they were meant; None where there are none. Where it is asked
            for, it is `robot`, and this is the robot as it is written.
        notices: what a careful person would want to know about how the file was read.
        unheld: what is in the file besides, and neither the robot nor a table has a place for.
        doubly: links that are held besides the joints of the robot, which closes a loop.
    """

    robot: Robot
    file: str
    folder: Path
    followers: Mapping[str, Follower] = field(default_factory=dict)
    loose: Mapping[str, str] = field(default_factory=dict)
    rounded: tuple[Rounded, ...] = ()
    repaired: Robot | None = None
    notices: tuple[Problem, ...] = ()
    unheld: tuple[Problem, ...] = ()
    doubly: frozenset[str] = frozenset()


def urdf_description(path: Path, *, colours: bool = False) -> Description:
    """The description of a URDF file.

    Args:
        path: the file.
        colours: whether the robot has the materials of the file; a table has no place for them.

    Raises:
        TableError: it cannot be read, or is not the URDF of a robot.
    """
    return _of_urdf(read_bytes(path, TableError, limit=LARGEST), path, str(path), colours=colours)


def xacro_description(path: Path, expansion: Expansion, *, colours: bool = False) -> Description:
    """The description of a xacro file of unknown origin, expanded where it can do no harm.

    Args:
        path: the file.
        expansion: the values of its arguments, and the packages that it may read.
        colours: as of `urdf_description`.

    Raises:
        TableError: it cannot be expanded, or what comes out is not the URDF of a robot.
    """
    from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

    read_bytes(path, TableError, limit=LARGEST)
    try:
        content = expand_foreign(path, expansion).content
    except ProofError as error:
        raise TableError(error.problems) from error
    return _of_urdf(content, path, f"{path} (expanded)", colours=colours)


def sdf_description(path: Path) -> Description:
    """The description of the first model in an SDF file.

    Raises:
        TableError: it cannot be read, or holds no model.
    """
    content = read_bytes(path, TableError, limit=LARGEST)
    return _described(content, path, str(path), _Format(tree_of, _read_sdf, _meant_sdf))


def mjcf_description(path: Path) -> Description:
    """The description of an MJCF file.

    Raises:
        TableError: it cannot be read, or is not the MJCF of an arm.
    """
    content = read_bytes(path, TableError, limit=LARGEST)
    form = _Format(lambda content, _: mjcf_reader.whole_tree_of(content, path), _read_mjcf, _meant_mjcf)
    return _described(content, path, str(path), form)


def _of_urdf(content: bytes, path: Path, file: str, *, colours: bool) -> Description:
    return _described(content, path, file, _Format(tree_of, partial(_read_urdf, colours=colours), _meant_urdf))


@dataclass(slots=True)
class _Extras:
    """What a tree holds besides its robot."""

    folder: Path
    file: str
    followers: dict[str, Follower] = field(default_factory=dict)
    loose: dict[str, str] = field(default_factory=dict)
    rounded: list[Rounded] = field(default_factory=list)
    notices: list[Problem] = field(default_factory=list)
    unheld: list[Problem] = field(default_factory=list)
    doubly: set[str] = field(default_factory=set)

    def left_out(self, found: Iterable[tuple[str, etree._Element]]) -> list[Problem]:
        """Notices of what is left out, each kind once."""
        places: dict[str, list[Mark]] = {}
        for what, element in found:
            places.setdefault(what, []).append(mark_of(element, self.file))
        return [_left_out(what, marks) for what, marks in places.items()]


class _Format(NamedTuple):
    """What reads a format.

    Attributes:
        tree_of: the elements of a text.
        read: their robot; what it does not hold goes to the extras.
        meant: the same elements with their angles as they were meant; the numbers that were go to the extras.
    """

    tree_of: Callable[[bytes, str], etree._Element]
    read: Callable[[etree._Element, _Extras], Robot]
    meant: Callable[[etree._Element, _Extras], etree._Element]


def _described(content: bytes, path: Path, file: str, form: _Format) -> Description:
    folder = path.absolute().parent
    extras = _Extras(folder, file)
    try:
        root = form.tree_of(content, file)
        robot = form.read(root, extras)
        meant = form.meant(root, extras)
        return Description(
            robot=robot,
            file=str(path),
            folder=extras.folder,
            followers=extras.followers,
            loose=extras.loose,
            rounded=tuple(extras.rounded),
            repaired=form.read(meant, _Extras(folder, file)) if extras.rounded else None,
            notices=tuple(extras.notices),
            unheld=tuple(extras.unheld),
            doubly=frozenset(extras.doubly),
        )
    except ProofError as error:
        raise TableError(error.problems) from error
    except (ValueError, OverflowError) as error:  # a record that refuses what is written, such as a limit
        problems = getattr(error, "problems", None) or (Problem(message=str(error)),)
        raise TableError(problem.about(mark=Mark(file=file)) for problem in problems) from error


def _read_urdf(root: etree._Element, extras: _Extras, *, colours: bool) -> Robot:
    """Takes from a URDF what no table has a place for."""
    root.set("name", root.get("name", ""))
    extras.unheld += extras.left_out(of_urdf(root))
    extras.notices += extras.left_out(with_known_shapes(root))
    for joint in root.iterchildren("joint"):
        name = joint.get("name", "")
        if (mimic := joint.find("mimic")) is not None:
            extras.followers[name] = _follower(mimic)
        axis = joint.find("axis")
        if axis is not None and axis.get("xyz") is None and joint.get("type") != "fixed":
            message = f"the axis of joint {shown(name)} has no xyz, and is taken for 1 0 0"
            how = "write its direction: other readers take 0 0 0, or refuse the file"
            mark = mark_of(axis, extras.file)
            extras.notices.append(Problem(message=message, severity="notice", suggestion=how, mark=mark))
        if (word := joint.get("type")) in _LOOSE:
            extras.loose[name] = word
            joint.set("type", "fixed")
    defined = {each.get("name") for each in root.iter("material") if len(each)} if colours else set()
    for material in [*root.iter("material")]:  # colours, which may be defined nowhere
        if (parent := material.getparent()) is not None and material.get("name") not in defined:
            parent.remove(material)
    return urdf_reader.robot_of(root, extras.file)


def _meant_urdf(root: etree._Element, extras: _Extras) -> etree._Element:
    meant = deepcopy(root)
    for origin in meant.iter("origin"):
        if (rpy := origin.get("rpy")) is not None:
            words, found = repaired(rpy, origin.sourceline)  # type: ignore[arg-type]  # wrong in the stubs
            origin.set("rpy", words)
            extras.rounded += found
    return meant


def _follower(mimic: etree._Element) -> Follower:
    """How a joint of a URDF follows another; a number that cannot be read is not a number here."""
    return Follower(mimic.get("joint", ""), _number(mimic.get("multiplier", "1")), _number(mimic.get("offset", "0")))


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return nan


def _read_sdf(root: etree._Element, extras: _Extras) -> Robot:
    model = sdf_reader.model_of(root, extras.file)
    extras.unheld += extras.left_out(of_sdf(root))
    extras.loose.update(model.loose)
    extras.doubly.update(model.doubly)
    extras.notices += [_left_out(what, marks) for what, marks in model.unread.items()]
    extras.followers.update({name: _sdf_follower(mimic) for name, mimic in model.mimics.items()})
    return model.robot


def _meant_sdf(root: etree._Element, extras: _Extras) -> etree._Element:
    meant = deepcopy(root)
    for pose in meant.iter("pose"):
        if pose.get("rotation_format") == "quat_xyzw" or is_true(pose.get("degrees")):
            continue
        words, found = repaired(pose.text or "", pose.sourceline, first=3)  # type: ignore[arg-type]  # wrong in the stubs
        if found:
            pose.text = words
            extras.rounded += found
    return meant


def _sdf_follower(mimic: etree._Element) -> Follower:
    """Multiplier · (value of the leader - reference) + offset: http://sdformat.org/spec?ver=1.11&elem=joint."""
    multiplier, offset, reference = (
        _number(mimic.findtext(tag, default))
        for tag, default in (("multiplier", "1"), ("offset", "0"), ("reference", "0"))
    )
    return Follower(mimic.get("joint", ""), multiplier, offset - multiplier * reference)


def _read_mjcf(root: etree._Element, extras: _Extras) -> Robot:
    compiler = compiler_of(root)
    extras.folder /= compiler.get("meshdir") or compiler.get("assetdir") or ""
    for mesh in root.iterfind("asset/mesh"):  # One that is not there may be beside the included file that names it.
        file = (mesh.get("file") or "").replace("\\", "/")
        beside = Path(mark_of(mesh, extras.file).file).absolute().parent / file
        if file and not is_file(extras.folder / file) and is_file(beside):
            mesh.set("file", str(beside))
    model = mjcf_reader.model_of(root, extras.file)
    extras.loose.update(model.loose)
    extras.doubly.update(model.doubly)
    extras.notices += [_left_out(what, marks) for what, marks in model.unread.items()]
    elements = Elements(root, extras.file)
    for joint in root.iterfind("equality/joint"):
        if elements.is_active(joint):
            extras.followers[joint.get("joint1", "")] = _mjcf_follower(joint, model.references)
    extras.unheld += extras.left_out(of_mjcf(elements))
    efforts = efforts_of_mjcf(elements)
    joints = tuple(
        replace(joint, limits=replace(joint.limits, effort=efforts[joint.name]))
        if joint.name in efforts and joint.limits.effort is None
        else joint
        for joint in model.robot.joints
    )
    return replace(model.robot, joints=joints)


def _meant_mjcf(root: etree._Element, extras: _Extras) -> etree._Element:
    if compiler_of(root).get("angle") != "radian":
        return root
    meant = deepcopy(root)
    for element in meant.iter():
        if isinstance(element.tag, str) and (euler := element.get("euler")) is not None:
            words, found = repaired(euler, element.sourceline)  # type: ignore[arg-type]  # wrong in the stubs
            element.set("euler", words)
            extras.rounded += found
    return meant


def _left_out(what: str, marks: Sequence[Mark]) -> Problem:
    """A notice of something that could not be read."""
    lines = listed([f"{mark.line}" for mark in marks])
    places = f", in {len(marks)} places (lines {lines})" if len(marks) > 1 else ""
    return Problem(message=f"{what} is left out{places}", severity="notice", mark=marks[0])


def _mjcf_follower(joint: etree._Element, places: Mapping[str, float]) -> Follower:
    """How a joint of an MJCF follows another: a polynomial of the distance from the reference values of both.

    https://mujoco.readthedocs.io/en/stable/XMLreference.html#equality-joint
    """
    leader = joint.get("joint2", "")
    factors = [*map(_number, joint.get("polycoef", "0 1 0 0 0").split()), *[0.0] * 5][:5]
    own, reference = places.get(joint.get("joint1", ""), 0.0), places.get(leader, 0.0)
    # The same polynomial of the leader's value, by the binomial theorem: Σ c_k (x - r)^k.
    constant, multiplier, *higher = (
        total(factors[k] * comb(k, n) * (-reference) ** (k - n) for k in range(n, 5) if factors[k]) for n in range(5)
    )
    if not leader:  # It keeps the value that it has where every joint has its reference value.
        constant, multiplier, higher = factors[0], 0.0, []
    return Follower(leader, multiplier, own + constant, tuple(higher) if any(higher) else ())
