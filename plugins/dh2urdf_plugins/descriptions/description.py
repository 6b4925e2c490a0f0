"""A robot description of any origin as the ground of a table: its robot, and what no table has a place for."""

from __future__ import annotations

import tomllib
from copy import deepcopy
from dataclasses import dataclass, field, replace
from functools import partial
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from lxml import etree

from dh2urdf.documents import is_file, read_bytes
from dh2urdf.errors import ProofError, TableError
from dh2urdf.robot import Link, Robot
from dh2urdf.source import Mark, Messages, Problem, listed
from dh2urdf.stages import Expansion
from dh2urdf.stages.foreign_robot import ForeignRobot
from dh2urdf_plugins.formats.mjcf import reader as mjcf_reader
from dh2urdf_plugins.formats.mjcf.elements import Elements, compiler_of
from dh2urdf_plugins.formats.sdf import reader as sdf_reader
from dh2urdf_plugins.formats.sdf.elements import is_true
from dh2urdf_plugins.formats.urdf import reader as urdf_reader
from dh2urdf_plugins.formats.xml_files import LARGEST, Unread, mark_of, number_of, tree_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.robot import Joint
    from dh2urdf_plugins.formats.xml_files import Model

say = Messages(__file__)

_LEFT_OUT: dict[str, dict[str, str]] = tomllib.loads((Path(__file__).parent / "left_out.toml").read_text("utf-8"))
_ACTUATORS = ("general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle")


class Rounded(NamedTuple):
    """A rounded part of π: the number as it is written, what it stands for, and the line of the file."""

    text: str
    word: str
    line: int | None


@dataclass(slots=True, kw_only=True)
class Description:
    """What is in a file, and `file` is what messages call it; the paths of its meshes lead from the folder."""

    file: str
    folder: Path
    robot: Robot = Robot(name="", links=(), joints=())  # joints that no table has are fixed in it
    loose: dict[str, str] = field(default_factory=dict)  # joints that no table has, with their types
    rounded: list[Rounded] = field(default_factory=list)  # numbers that were meant to be parts of π
    # The robot with these numbers as they were meant. Where that is asked for, it is `robot`, and this the written one.
    repaired: Robot | None = None
    notices: list[Problem] = field(default_factory=list)  # what to know about how the file was read
    left_out: list[Problem] = field(default_factory=list)  # what neither the robot nor a table has a place for
    lost: list[Problem] = field(default_factory=list)  # of a URDF what its robot and its elements do not have
    doubly: set[str] = field(default_factory=set)  # links that are held besides the joints, which closes a loop
    faulty: dict[str, Unread] = field(default_factory=dict)  # joints that could not be read, by name
    elements: tuple[str, ...] = ()  # of a URDF what is beside links, joints and materials, as XML

    def take(self, model: Model) -> Robot:
        """The robot of a model, what it lacks besides, and notices of what could not be read."""
        self.loose |= model.loose
        self.faulty |= model.faulty
        self.doubly |= set(model.doubly)
        self.notices += _notices(model.unread)
        return model.robot


def describe(form: str, path: Path, expansion: Expansion | None = None, *, colours: bool = False) -> Description:
    """The description of a file: ``urdf``, ``xacro`` (expanded where it can do no harm), ``sdf`` (model 1) or ``mjcf``.

    With `colours`, the robot of a URDF or xacro has the materials of the file, which a table has no place for.
    """
    content, file = read_bytes(path, TableError, limit=LARGEST), str(path)
    found = Description(file=file, folder=path.absolute().parent)
    try:
        if form == "xacro":
            from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

            content, file = expand_foreign(path, expansion or Expansion()).content, f"{path} (expanded)"
        root = mjcf_reader.whole_tree_of(content, path) if form == "mjcf" else tree_of(content, file)
        read = {"sdf": _read_sdf, "mjcf": _read_mjcf}.get(form, partial(_read_urdf, colours=colours))
        found.robot = read(root, file, found)
        meant = deepcopy(root)
        found.rounded = list(_repair_rounded(form, meant))
        if found.rounded:
            found.repaired = read(meant, file, Description(file=file, folder=path.absolute().parent))
    except ProofError as error:
        raise TableError(error.problems) from error
    except (ValueError, OverflowError) as error:  # a record that refuses what is written, such as a limit
        problems = getattr(error, "problems", None) or (say("record-refused", reason=error),)
        raise TableError(problem.about(mark=Mark(file=file)) for problem in problems) from error
    return found


def chain_description(path: Path, name: str, joints: Sequence[Joint], notices: Iterable[Problem] = ()) -> Description:
    """The description of a chain of joints, of a file that has no more."""
    links = [Link(name=name) for name in (joints[0].parent, *(joint.child for joint in joints))]
    robot = Robot(name=name, links=tuple(links), joints=tuple(joints))
    return Description(file=str(path), folder=path.absolute().parent, robot=robot, notices=[*notices])


def foreign_robot(form: str, path: Path, expansion: Expansion | None = None) -> ForeignRobot:
    """The robot of a file, as `dh2urdf view` shows it: with colours, and joints that follow others.

    Floating and planar joints are fixed, a URDF needs no name, and a colour that is defined nowhere is none.
    """
    found = describe(form, path, expansion, colours=True)
    parts = {name: getattr(found, name) for name in ("robot", "loose", "folder", "elements")}
    faults = tuple([each.fault for each in found.faulty.values() if each.fault])
    return ForeignRobot(**parts, notices=tuple(found.notices), faults=faults, lost=tuple(found.lost))


def _notices(unread: Iterable[Unread]) -> list[Problem]:
    """Notices of what is left out, each kind once, with what is wrong with it."""
    places: dict[tuple[str, str], list[Mark]] = {}
    for what, mark, fault in unread:
        places.setdefault((what, fault.message if fault else ""), []).append(mark)
    notices = []
    for (what, reason), marks in places.items():
        lines = listed([f"{mark.line}" for mark in marks])
        where = f", in {len(marks)} places (lines {lines})" if len(marks) > 1 else ""
        why = f": {reason}" if reason else ""
        notices.append(say("left-out", marks[0], what=what, where=where, why=why))
    return notices


def _left_out(form: str, root: etree._Element, file: str) -> list[Problem]:
    """Notices of what is in the elements of a robot and left out."""
    found = []
    for path, words in _LEFT_OUT[form].items():
        for hit in cast("list[Any]", root.xpath(path)):
            element, name = (hit, hit.tag) if isinstance(hit, etree._Element) else (hit.getparent(), hit.attrname)  # noqa: SLF001
            space, _, local = name.rpartition("}")
            prefix = next((prefix for prefix, address in element.nsmap.items() if address == space[1:]), None)
            as_written = f"{prefix}:{local}" if prefix else local
            found.append(Unread(words.format(name=as_written), mark_of(element, file)))
    return _notices(found)


def part_of_pi(text: str) -> tuple[float, str] | None:
    """The multiple of π/4 that a number of 3 to 14 decimals is, rounded or cut to its last digit, and its word.

    With fewer decimals it may be any angle, with more it is what a double holds.
    """
    places = len(text.partition(".")[2])
    number = number_of(text)
    quarters = round(abs(number) * 4 / pi) if abs(number) < 7 else 0  # noqa: PLR2004 - 2π and a little
    if not 3 <= places <= 14 or not text[-1:].isdecimal() or "e" in text.lower() or not 1 <= quarters <= 8:  # noqa: PLR2004
        return None
    exact, unit = quarters * pi / 4, 10**places
    if round(abs(number) * unit) not in (round(exact * unit), int(exact * unit)):
        return None
    word = {1: "pi/4", 2: "pi/2", 3: "3*pi/4", 4: "pi"}.get(quarters, f"{quarters}*pi/4")
    return (-exact, f"-{word}") if number < 0 else (exact, word)


def _repair_rounded(form: str, root: etree._Element) -> Iterator[Rounded]:
    """Writes the parts of π out that are rounded in the orientations of a tree, and tells which they are."""
    angles: list[tuple[etree._Element, str | None]] = []  # with the attribute; None for the text of a pose
    if form == "sdf":
        poses = [each for each in root.iter("pose") if each.get("rotation_format") != "quat_xyzw"]
        angles = [(pose, None) for pose in poses if not is_true(pose.get("degrees"))]
    elif form != "mjcf":
        angles = [(origin, "rpy") for origin in root.iter("origin")]
    elif compiler_of(root).get("angle") == "radian":
        angles = [(each, "euler") for each in root.iter(etree.Element)]
    for element, attribute in angles:
        words = ((element.text if attribute is None else element.get(attribute)) or "").split()
        meant = [part_of_pi(word) if attribute or place > 2 else None for place, word in enumerate(words)]  # noqa: PLR2004
        for word, part in zip(words, meant, strict=True):
            if part:
                yield Rounded(word, part[1], element.sourceline)  # type: ignore[arg-type]  # wrong in the stubs
        if any(meant):
            text = " ".join(repr(part[0]) if part else word for word, part in zip(words, meant, strict=True))
            if attribute is None:
                element.text = text
            else:
                element.set(attribute, text)


def _read_urdf(root: etree._Element, file: str, found: Description, *, colours: bool) -> Robot:
    root.set("name", root.get("name", ""))
    inner = _left_out("urdf", root, file)
    found.left_out += [*_left_out("urdf-elements", root, file), *inner]
    found.lost = inner
    others = [each for each in root.iterchildren(etree.Element) if each.tag not in {"link", "joint", "material"}]
    found.elements = tuple([etree.tostring(each, encoding="unicode", with_tail=False) for each in others])
    for joint in root.iterchildren("joint"):
        name, axis = joint.get("name", ""), joint.find("axis")
        if axis is not None and axis.get("xyz") is None and joint.get("type") != "fixed":
            found.notices.append(say("axis-without-xyz", mark_of(axis, file), name=name))
    defined = {each.get("name") for each in root.iter("material") if len(each)} if colours else set()
    for material in [*root.iter("material")]:  # colours, which may be defined nowhere
        if (parent := material.getparent()) is not None and material.get("name") not in defined:
            parent.remove(material)
    return found.take(urdf_reader.model_of(root, file))


def _read_sdf(root: etree._Element, file: str, found: Description) -> Robot:
    model = sdf_reader.model_of(root, file)
    of = next((each for path in ("model", "world/model") for each in root.iterfind(path)), root)
    found.left_out += _left_out("sdf", of, file)
    return found.take(model)


def _read_mjcf(root: etree._Element, file: str, found: Description) -> Robot:
    compiler = compiler_of(root)
    found.folder /= compiler.get("meshdir") or compiler.get("assetdir") or ""
    for mesh in root.iterfind("asset/mesh"):  # One that is not there may be beside the included file that names it.
        name = (mesh.get("file") or "").replace("\\", "/")
        beside = Path(mark_of(mesh, file).file).absolute().parent / name
        if name and not is_file(found.folder / name) and is_file(beside):
            mesh.set("file", str(beside))
    model = mjcf_reader.model_of(root, file)
    robot = found.take(model)
    elements = Elements(root, file)
    springs = []
    for joint in root.iterfind("worldbody//joint"):
        given = elements.attributes(joint)
        if "springdamper" in given or given.get("stiffness", "0").strip(" 0."):
            springs.append(Unread("the spring of a joint", elements.mark(joint)))
    found.left_out += [*_left_out("mjcf", root, file), *_notices(springs)]
    efforts, joints = _efforts(elements), list(robot.joints)
    for place, one in enumerate(joints):
        if one.name in efforts and one.limits.effort is None:
            joints[place] = replace(one, limits=replace(one.limits, effort=efforts[one.name]))
    return replace(robot, joints=tuple(joints))


def _efforts(elements: Elements) -> dict[str, float]:
    """The efforts of joints that one actuator drives, by the joint's name: what its force can reach [N or N·m].

    https://mujoco.readthedocs.io/en/stable/XMLreference.html#actuator-general: the effort at the joint is the force
    times the gear; the force of a motor is what controls it.
    """
    driven: dict[str, list[float | None]] = {}
    for actuator in elements.root.iterfind("actuator/*"):
        given = elements.attributes(actuator, *_ACTUATORS)
        if not (joint := given.get("joint") or given.get("jointinparent")):
            continue
        reaches = [("forcerange", "forcelimited")]
        reaches += [("ctrlrange", "ctrllimited")] if actuator.tag == "motor" else []
        effort = None
        try:
            gear = elements.numbers(actuator, given, "gear", (1.0,), most=6)[0]
            ranges = [elements.limits(actuator, given, name, limited) for name, limited in reaches]
        except ProofError:  # numbers that are none; the effort is unknown then
            ranges = []
        if any(ranges):
            effort = abs(gear) * min(max(map(abs, limits)) for limits in ranges if limits)
        driven.setdefault(joint, []).append(effort)
    return {joint: found[0] for joint, found in driven.items() if len(found) == 1 and found[0]}
