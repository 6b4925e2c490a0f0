"""The XML tree that URDF and xacro share: one structure, two notations.

The expanded xacro must have the tags, attributes and order of the URDF, so both are made by the same functions; what
differs is how a name and a number are written, and that is the `Notation`.
"""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any, TypeVar

from lxml import etree

from dh2urdf.documents import renamed
from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import JointType
from dh2urdf.meshes import has_meshes
from dh2urdf.quantities import format_numbers
from dh2urdf.robot import Box, Cylinder, Mesh, Sphere
from dh2urdf.rotations import RigidTransform
from dh2urdf.source import Messages, Problem, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from dh2urdf.robot import Attachment, Collision, Geometry, Inertial, Joint, Link, Material, Origin, Robot, Visual
    from dh2urdf_plugins.formats.urdf import UrdfVersion

say = Messages(__file__)
S = TypeVar("S", "Visual", "Collision")

LONGEST_LINE = 8000
"""Bytes of one line: PyBullet cuts a longer one in silence."""

LONGEST_COMMENT = 1000
"""Characters of one comment."""

# What XML 1.0 cannot hold (section 2.2, Char), and tab and line ends besides: an attribute's reader makes spaces of
# them (section 3.3.3), and minidom, which writes xacro's output, does not escape them.
_NOT_FOR_XML = "[^\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]"

READ_BY_MUJOCO = {"compiler", "option", "size"}
"""What MuJoCo reads of its element in a URDF."""
MESH_FOLDERS = {"meshdir", "texturedir", "assetdir"}
"""Options of MuJoCo that say where meshes are: they are elsewhere here."""

INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
"""The elements of an inertia, as URDF names and orders them."""

LIMITS_OF = {
    JointType.REVOLUTE: ("lower", "upper", "effort", "velocity"),
    JointType.PRISMATIC: ("lower", "upper", "effort", "velocity"),
    JointType.CONTINUOUS: ("effort", "velocity"),
    JointType.FIXED: (),
}
"""The limits that a joint must have."""
SINCE_1_2 = ("acceleration", "jerk")
"""The limits that a joint may have since URDF 1.2 (https://github.com/ros/urdfdom, *URDF Versioning*)."""
CAP = 1e-9
"""How far a ball may be from the end of a cylinder that it makes a capsule [m]."""


def refused(robot: Robot, code: str, joint: Joint | None = None, **words: Any) -> EmitterError:  # noqa: ANN401 - of a message
    """Why a robot, or a joint of it, cannot be written."""
    name, mark = (joint.name, joint.mark) if joint else (None, None)
    return EmitterError(say(code, mark, robot=robot.name, joint=name, **words))


class Notation:
    """How plain URDF writes names and numbers; xacro's notation overrides it.

    Args:
        version: the version of URDF that the file declares: 1.2 has limits of acceleration and jerk, and capsules.
    """

    def __init__(self, version: UrdfVersion = "1.0") -> None:
        self.is_extended = version == "1.2"

    def robot(self, name: str, **others: Any) -> etree._Element:  # noqa: ANN401 - lxml's
        """The root element, under a name that is written already; a file that declares no version is of version 1.0."""
        return etree.Element("robot", {"name": name, **({"version": "1.2"} if self.is_extended else {})}, **others)

    def text(self, text: str) -> str:
        """A text that is nobody's identifier: the robot's name, a file name."""
        if not (text.isascii() and text.isprintable()) and (culprit := re.search(_NOT_FOR_XML, text)):
            raise EmitterError(say("name-not-for-xml", found=shown(text), number=ord(culprit.group())))
        return text

    def verbatim(self, text: str) -> str:
        """A text of another program, which is written as it is."""
        return text

    def name(self, name: str) -> str:
        """The name of a link, a joint or a material."""
        return self.text(name)

    def numbers(self, numbers: Iterable[float]) -> str:
        """Numbers that follow no parameter."""
        return " ".join(format_numbers(numbers))

    def lengths(self, lengths: Sequence[float], _formulas: Sequence[str] | None = None) -> str:
        """Lengths [m], each with the formula that it follows."""
        return self.numbers(lengths)

    def angles(self, angles: Sequence[float], _formulas: Sequence[str] | None = None) -> str:
        """Angles [rad], each with the formula that it follows."""
        return self.numbers(angles)

    def number_of_joint(self, joint: Joint, name: str, value: float) -> str:
        """A number of a joint: lower, upper, velocity, effort, damping or friction."""
        is_angle = joint.type is not JointType.PRISMATIC and name in ("lower", "upper", "velocity")
        return self.angles((value,)) if is_angle else self.numbers((value,))

    def body(self, _link: str, inertial: Inertial) -> dict[str, str]:
        """The centre of mass, the mass and the elements of the inertia of a link, by their names."""
        com, mass = self.numbers(inertial.com), self.numbers((inertial.mass,))
        texts = self.numbers(getattr(inertial.inertia, name) for name in INERTIA)
        return {"com": com, "mass": mass, **dict(zip(INERTIA, texts.split(" "), strict=True))}


def mimic(joint: Joint, notation: Notation) -> dict[str, str]:
    """The leader, the multiplier and the offset of a joint that follows another one, as URDF and Drake name them.

    Raises:
        EmitterError: the joint follows otherwise: by powers of its leader's value, or none.
    """
    if (law := joint.follows) is None:
        return {}
    if law.higher or not law.leader:
        raise EmitterError(say("law-not-mimic", joint.mark, joint=joint.name, field="follows", found=law.leader))
    numbers = {name: notation.numbers((getattr(law, name),)) for name in ("multiplier", "offset")}
    return {"joint": notation.name(law.leader), **numbers}


def urdf_tree(
    robot: Robot, name: str, notation: Notation, *, mujoco: bool = True, shared_materials: bool = True
) -> etree._Element:
    """The whole tree of a URDF, under a name that is written already; with the settings for MuJoCo, if asked for."""
    root = notation.robot(name)
    if mujoco:
        append_mujoco(root, robot, notation)
    append_robot(root, robot, notation, shared_materials=shared_materials)
    return root


def append_robot(parent: etree._Element, robot: Robot, notation: Notation, *, shared_materials: bool = True) -> None:
    """Appends the materials, then the links from the base to the tip, each after the joint that holds it.

    Materials that are not shared are written into each visual.
    """
    materials = materials_of(robot)
    for material in materials.values() if shared_materials else ():
        _append_material(parent, material, notation)
    joint_to, foreign = {joint.child: joint for joint in robot.joints}, robot.foreign_names
    for link in robot.links:
        if joint := joint_to.get(link.name):
            _append_joint(parent, joint, notation, is_foreign=joint.name in foreign)
        _append_link(parent, link, notation, shared_materials=shared_materials)
    if robot.attachments:
        parent.extend([each for _, each in _carried(robot, notation, notation.name) if each.tag != "mujoco"])


def materials_of(robot: Robot) -> dict[str, Material]:
    """The materials of a robot by their names, each of which has one colour."""
    materials: dict[str, Material] = {}
    for link in robot.links:
        for visual in link.visuals:
            if (material := visual.material) and materials.setdefault(material.name, material) != material:
                raise refused(robot, "material-of-two-colours", material=material.name)
    return materials


def _carried(
    robot: Robot, notation: Notation, name: Callable[[str], str]
) -> Iterator[tuple[Attachment, etree._Element]]:
    """What the files of attachments have for other programs, whose names are those that links and joints have here."""
    for each in robot.attachments:
        names = each.names
        for text in each.elements:
            yield each, renamed(text, names, lambda own: name(each.prefix + own), notation.verbatim)  # noqa: B023 - at once


def append_mujoco(parent: etree._Element, robot: Robot, notation: Notation) -> list[Problem]:
    """Appends what keeps MuJoCo from fusing fixed links and dropping visuals; other readers pass over it.

    Of meshes it takes the file's name alone, without its folder, unless an option forbids it. It refuses a second
    element of its own, and in it a second one of those that it reads. So the settings of attachments are added, and
    where one is there already, it stays, with a notice.
    """
    whole, lost = etree.SubElement(parent, "mujoco"), list[Problem]()
    options = {"fusestatic": "false", "discardvisual": "false"}
    etree.SubElement(whole, "compiler", options | ({"strippath": "false"} if has_meshes(robot) else {}))
    for attachment, element in _carried(robot, notation, notation.text) if robot.attachments else ():
        for child in element if element.tag == "mujoco" else ():
            if child.tag in READ_BY_MUJOCO:
                lost += _merged(whole, child, attachment.name)
            else:
                whole.append(child)
    return lost


def _merged(parent: etree._Element, element: etree._Element, whose: str) -> Iterator[Problem]:
    """Merges an element of an attachment into the one of its tag, whose values stay, with a notice of each other."""
    tag = str(element.tag)
    there = parent.find(tag)
    there = etree.SubElement(parent, tag) if there is None else there
    for name, value in element.items():
        if there.get(name, value) != value:
            yield say("mujoco-setting-left-out", name=whose, setting=f"{tag} {name!s}={value!s}", kept=there.get(name))
        elif name not in MESH_FOLDERS:
            there.set(name, value)
    for child in element:
        yield from _merged(there, child, whose)


def append_inertial(parent: etree._Element, link: str, inertial: Inertial, notation: Notation) -> None:
    """Appends the mass properties of a link."""
    element, numbers = etree.SubElement(parent, "inertial"), notation.body(link, inertial)
    etree.SubElement(element, "origin", {"xyz": numbers.pop("com"), "rpy": "0 0 0"})
    etree.SubElement(element, "mass", {"value": numbers.pop("mass")})
    etree.SubElement(element, "inertia", numbers)


def append_comment(parent: etree._Element, text: str) -> None:
    """Appends a comment."""
    parent.append(_comment(text))


def serialise(root: etree._Element, comment: str = "") -> bytes:
    """The file of a tree: UTF-8, two spaces per level, one element per line, a comment above the root."""
    etree.indent(root, "  ")
    head = etree.tostring(_comment(comment), encoding="UTF-8") + b"\n" if comment else b""
    return b'<?xml version="1.0"?>\n' + head + etree.tostring(root, encoding="UTF-8", xml_declaration=False) + b"\n"


def check_lines(content: bytes) -> None:
    """Checks that readers take every line of a file whole."""
    for number, line in enumerate(content.splitlines(), start=1):
        if len(line) > LONGEST_LINE:
            found = shown(line.decode("utf-8").strip())
            raise EmitterError(say("line-too-long", found=found, number=number, size=len(line), most=LONGEST_LINE))


def _comment(text: str) -> etree._Comment:
    """A comment that ends where it should: XML 1.0, section 2.5, allows no ``--`` in it."""
    plain = re.sub("-(?=-)", "- ", shown(text, LONGEST_COMMENT)[1:-1])
    return etree.Comment(f" {plain} ")


def _append_material(parent: etree._Element, material: Material, notation: Notation) -> None:
    element = etree.SubElement(parent, "material", {"name": notation.name(material.name)})
    etree.SubElement(element, "color", {"rgba": notation.numbers(material.rgba)})
    if material.texture:
        etree.SubElement(element, "texture", {"filename": notation.text(material.texture)})


def _append_joint(parent: etree._Element, joint: Joint, notation: Notation, *, is_foreign: bool) -> None:
    element = etree.SubElement(parent, "joint", {"name": notation.name(joint.name), "type": joint.type.value})
    _append_origin(element, joint.origin, notation)
    etree.SubElement(element, "parent", {"link": notation.name(joint.parent)})
    etree.SubElement(element, "child", {"link": notation.name(joint.child)})
    if joint.type is not JointType.FIXED:
        etree.SubElement(element, "axis", {"xyz": notation.numbers(joint.axis)})
        given = {name: getattr(joint.limits, name) for name in LIMITS_OF[joint.type]}
        if is_foreign:
            given = {name: value for name, value in given.items() if value is not None}
        if notation.is_extended:
            others = {name: getattr(joint.limits, name) for name in SINCE_1_2}
            given |= {name: value for name, value in others.items() if value is not None}
        limit = etree.SubElement(element, "limit") if given else element
        for name, value in given.items():  # An incomplete limit is refused by most readers.
            if value is None:
                about = {"joint": joint.name, "field": f"limits.{name}", "type": joint.type.value, "name": name}
                raise EmitterError(say("limit-needed", joint.mark, **about))
            limit.set(name, notation.number_of_joint(joint, name, value))
    dynamics = {
        name: notation.number_of_joint(joint, name, value)
        for name, value in (("damping", joint.damping), ("friction", joint.friction))
        if value is not None
    }
    if dynamics:
        etree.SubElement(element, "dynamics", dynamics)
    if law := mimic(joint, notation):
        etree.SubElement(element, "mimic", law)


def _append_link(parent: etree._Element, link: Link, notation: Notation, *, shared_materials: bool) -> None:
    element = etree.SubElement(parent, "link", {"name": notation.name(link.name)})
    if link.inertial:
        append_inertial(element, link.name, link.inertial, notation)
    for visual, tag in _shapes(link.visuals, notation):
        shape = etree.SubElement(element, "visual")
        _append_shape(shape, visual, notation, tag)
        if visual.material and not shared_materials:
            _append_material(shape, visual.material, notation)
        elif visual.material:
            etree.SubElement(shape, "material", {"name": notation.name(visual.material.name)})
    for collision, tag in _shapes(link.collisions, notation):
        _append_shape(etree.SubElement(element, "collision"), collision, notation, tag)


def _shapes(shapes: Sequence[S], notation: Notation) -> list[tuple[S, str | None]]:
    """Shapes, each with the tag that takes the place of its own.

    Since URDF 1.1 a cylinder with a ball of its radius at each end is a capsule; the balls are left out then.
    """
    if not notation.is_extended:
        return [(shape, None) for shape in shapes]
    capsules: set[int] = set()
    covered: set[int] = set()
    for number, shape in enumerate(shapes):
        if isinstance(shape.geometry, Cylinder):
            caps = [_cap(shapes, shape, end * shape.geometry.length) for end in (-0.5, 0.5)]
            if None not in caps:
                capsules.add(number)
                covered.update(cap for cap in caps if cap is not None)
    kept = [number for number in range(len(shapes)) if number not in covered]
    return [(shapes[number], "capsule" if number in capsules else None) for number in kept]


def _cap(shapes: Sequence[S], body: S, height: float) -> int | None:
    """The number of the ball that closes a cylinder at a height [m] along its axis, if there is one."""
    end = (body.origin.transform @ RigidTransform.from_xyz_rpy((0.0, 0.0, height))).translation
    material = getattr(body, "material", None)
    for number, shape in enumerate(shapes):
        if isinstance(shape.geometry, Sphere) and isinstance(body.geometry, Cylinder):
            is_alike = shape.geometry.radius == body.geometry.radius and getattr(shape, "material", None) == material
            if is_alike and math.dist(shape.origin.xyz, end) <= CAP:
                return number
    return None


def _append_shape(
    element: etree._Element, shape: Visual | Collision, notation: Notation, tag: str | None = None
) -> None:
    _append_origin(element, shape.origin, notation)
    drawn = etree.SubElement(etree.SubElement(element, "geometry"), *primitive(shape.geometry, notation))
    drawn.tag = tag or drawn.tag


def _append_origin(parent: etree._Element, origin: Origin, notation: Notation) -> None:
    attributes = {
        "xyz": notation.lengths(origin.xyz, origin.xyz_formula),
        "rpy": notation.angles(origin.rpy, origin.rpy_formula),
    }
    etree.SubElement(parent, "origin", attributes)


def primitive(geometry: Geometry, notation: Notation) -> tuple[str, dict[str, str]]:
    """Tag and attributes of a shape, which are elements in SDF."""
    match geometry:
        case Box(size=size, size_formula=formulas):
            return "box", {"size": notation.lengths(size, formulas)}
        case Cylinder(radius=radius, length=length, length_formula=formula):
            length_text = notation.lengths((length,), (formula,) if formula else None)
            return "cylinder", {"radius": notation.numbers((radius,)), "length": length_text}
        case Sphere(radius=radius):
            return "sphere", {"radius": notation.numbers((radius,))}
        case Mesh(filename=filename, scale=scale):
            return "mesh", {"filename": notation.text(filename), "scale": notation.numbers(scale)}
