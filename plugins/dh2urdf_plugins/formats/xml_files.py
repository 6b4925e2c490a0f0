"""XML files as elements, and what is in them, for the readers of URDF, SDF and MJCF."""

from __future__ import annotations

import math
import re
from contextlib import suppress
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

from lxml import etree

from dh2urdf.columns import BOUNDS, LIMITS
from dh2urdf.documents import ACCEPTED_XML, ForbiddenXmlError, refuse_other_kind, xml_root
from dh2urdf.errors import Dh2UrdfError, ProofError
from dh2urdf.manipulator import JOINT_TYPES, JointType, new_limits
from dh2urdf.robot import Box, Cylinder, Joint, Mesh, Origin, Sphere, new_collision, new_joint, new_visual
from dh2urdf.rotations import IDENTITY, IDENTITY_ROTATION, RigidTransform, rotation_from_quaternion
from dh2urdf.source import Mark, Messages, Problem, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.robot import Geometry, Material, Robot
    from dh2urdf.rotations import Rotation

say = Messages(__file__)


T = TypeVar("T")
D = TypeVar("D")
ACCEPTED = ", ".join(JOINT_TYPES)
"""The types of joints that tables have."""
LARGEST = 2**26
"""Size of a robot description that is read, and of each file that it includes [B]."""
PASSED_OVER = frozenset(
    (
        "NS_ERR_UNDEFINED_NAMESPACE",  # prefixes such as `gz:` that are declared nowhere
        "ERR_UNKNOWN_VERSION",  # XML 0.0, which 26 of PyBullet's own files have
        "ERR_RESERVED_XML_NAME",  # blanks before the declaration
    )
)
"""What is no XML and is read all the same, by the names of libxml2: PyBullet, Gazebo and check_urdf read it."""
FILE = "{urn:dh2urdf}file"
"""An attribute of an element that is in another file than the element around it: its path."""


def read_file(parse: Callable[[bytes, str], Robot], path: Path) -> Robot:
    """The robot of a file, by what parses a text under the name of its file."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ProofError(say("description-unreadable", Mark(file=str(path)), reason=error.strerror)) from error
    return parse(content, str(path))


def written_tree_of(content: bytes, file: str, *, is_deep: bool = False) -> etree._Element:
    """The elements of a text that dh2urdf has written, without comments: it has to be XML to the letter."""
    try:
        return xml_root(content, is_deep=is_deep)
    except etree.XMLSyntaxError as error:
        log: Any = error.error_log  # The stubs of lxml say that it cannot be iterated over.
        raise _no_xml(error, file, list(log)) from error


def tree_of(content: bytes, file: str, *, is_deep: bool = False) -> etree._Element:
    """The elements of a text of any origin, without comments; what readers of robots take beside XML is read too.

    Deep elements are nested by the hundred, as the bodies of a long arm in MJCF are; lxml takes that for an attack.
    """
    refuse_other_kind(content, file, ProofError, "a robot description", "a robot description in XML")
    try:
        root = xml_root(content, is_deep=is_deep)
    except etree.XMLSyntaxError as error:
        # Comments leave their newlines alone: simulators take comments with ``--`` or ``--->``, and XML does not.
        newlines = lambda comment: b"\n" * comment[0].count(b"\n")  # noqa: E731
        content = re.sub(rb"<!--.*?-->", newlines, content, flags=re.DOTALL)
        parser = etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False, recover=True)
        with suppress(etree.XMLSyntaxError):  # of a text without an element; the log has it
            etree.fromstring(content, parser)
        log: Any = parser.error_log
        faults = [each for each in log if each.type_name not in PASSED_OVER]
        if faults or isinstance(error, ForbiddenXmlError):
            raise _no_xml(error, file, faults) from error
        try:
            root = xml_root(content, is_deep=is_deep, recover=True)
        except ForbiddenXmlError as forbidden:
            raise _no_xml(forbidden, file, []) from error
    # The elements without the namespace of all of them, as of Drake's files; readers of robots know none.
    if (namespace := root.nsmap.get(None)) is not None:
        for element in root.iter(f"{{{namespace}}}*"):
            element.tag = etree.QName(element).localname
    return root


def _no_xml(error: etree.XMLSyntaxError, file: str, faults: Sequence[Any]) -> ProofError:
    if isinstance(error, ForbiddenXmlError) or not faults:
        return ProofError(say("xml-refused", Mark(file=file), reason=error.msg, accepted=ACCEPTED_XML))
    fault = faults[0]
    mark = Mark(file=file, line=fault.line, column=fault.column)
    return ProofError(say("not-xml", mark, reason=fault.message.partition(chr(10))[0].strip()))


def mark_of(element: etree._Element, file: str = "") -> Mark:
    """The place of an element; what was included has the file that it is in, everything else the one given."""
    line: Any = element.sourceline  # the stubs of lxml say that it may be an ellipsis
    at: etree._Element | None = element
    while at is not None:
        if (own := at.get(FILE)) is not None:
            return Mark(file=str(own), line=line)
        at = at.getparent()
    return Mark(file=file, line=line)


class Unread(NamedTuple):
    """Something of a file that its robot lacks; the fault is None where it is nothing that is read here."""

    what: str
    mark: Mark
    fault: Problem | None = None


class FileElements:
    """The elements of a file, and what messages call it."""

    def __init__(self, file: str) -> None:
        self.file = file
        self.unread: list[Unread] = []  # what is in the file and could not be read
        self.loose: dict[str, str] = {}  # the types of joints that no table has, by name
        self.faulty: dict[str, Unread] = {}  # by name, what is wrong with joints

    def mark(self, element: etree._Element) -> Mark:
        """Where an element is."""
        return mark_of(element, self.file)

    def error(self, element: etree._Element, code: str, **about: Any) -> ProofError:  # noqa: ANN401 - of a message
        """What is wrong with an element."""
        return ProofError(say(code, self.mark(element), **about))

    def child(self, element: etree._Element, tag: str) -> etree._Element:
        """The first child of a name, which has to be there."""
        child = element.find(tag)
        if child is None:
            raise self.error(element, "element-missing", tag=element.tag, what=tag)
        return child

    def text(self, element: etree._Element, attribute: str) -> str:
        """The value of an attribute, which has to be there."""
        text = element.get(attribute)
        if text is None:
            raise self.error(element, "attribute-missing", tag=element.tag, attribute=attribute)
        return text

    def read(self, element: etree._Element, name: str, text: str, count: int, most: int = 0) -> list[float]:
        """The finite numbers of a text with spaces between them; of as many as `most`, further ones mean nothing.

        `float` also takes 1_000, nan and inf, which no reader of robots does.
        """
        with suppress(ValueError):
            numbers = [float(word) for word in text.split()]
            is_plain = "_" not in text and text.isascii() and all(map(math.isfinite, numbers[:count]))
            if is_plain and count <= len(numbers) <= max(count, most):
                return numbers[:count]
        accepted = "one finite number" if count == 1 else f"{count} finite numbers with spaces between them"
        raise self.error(element, "numbers-wrong", name=name, tag=element.tag, text=text, accepted=accepted)

    def quaternion(self, element: etree._Element, quaternion: Sequence[float]) -> Rotation:
        """The rotation of a quaternion (x, y, z, w) that an element has."""
        try:
            return rotation_from_quaternion(quaternion)
        except ZeroDivisionError:
            raise self.error(element, "quaternion-of-length-0", tag=element.tag) from None

    def not_read(self, element: etree._Element, what: str) -> None:
        """Notes that an element cannot be read."""
        self.unread.append(Unread(what, self.mark(element)))

    def part(self, element: etree._Element, read: Callable[[etree._Element], T], default: D, what: str = "") -> T | D:
        """Something that has no part in how the robot moves, such as a mass or a shape; the default where it is faulty.

        It is left out of a file of unknown origin then, with a notice; `Model.whole` raises the fault.
        """
        try:
            return read(element)
        except (Dh2UrdfError, ValueError, OverflowError) as error:  # a value that a record refuses is one, too
            mark, holder = self.mark(element), element.getparent()
            if holder is not None:
                what = what or f"the {element.tag} of {holder.tag} {shown(holder.get('name', ''))}"
            for problem in getattr(error, "problems", None) or (say("record-refused", reason=error),):
                self.unread.append(Unread(what, problem.mark or mark, problem.about(mark=problem.mark or mark)))
            return default

    def shapes(
        self,
        link: etree._Element,
        placed: Callable[[etree._Element], Iterable[tuple[Geometry, Origin]]],
        material_of: Callable[[etree._Element], Material | None],
    ) -> dict[str, Any]:
        """What a link is seen as and what it touches with, for its record: parts of shapes in the frame of the link."""

        def read(element: etree._Element) -> list[dict[str, Any]]:
            others = {"material": material_of(element)} if element.tag == "visual" else {}
            return [{"geometry": each, "origin": origin, **others} for each, origin in placed(element)]

        visuals = [new_visual(**one) for each in link.iterchildren("visual") for one in self.part(each, read, ())]
        touching = link.iterchildren("collision")
        collisions = [new_collision(**one) for each in touching for one in self.part(each, read, ())]
        return {"visuals": tuple(visuals), "collisions": tuple(collisions)}

    def parts(
        self,
        shape: etree._Element,
        origin: Origin,
        numbers: Callable[[str, int], Sequence[float]],
        filename: Callable[[], str],
    ) -> list[tuple[Geometry, Origin]]:
        """The parts of a shape, and where they are in the link; none of one that no robot has."""
        parts = parts_of(str(shape.tag), numbers, filename)
        if parts is None:
            self.not_read(shape, f"a shape {shown(shape.tag)}")
        return [
            (geometry, origin if within is IDENTITY else Origin.of(origin.transform @ within))
            for geometry, within in parts or ()
        ]

    def kind(self, joint: etree._Element, word: str, loose: Collection[str]) -> JointType:
        """The type of a joint; one of the loose ones, which no table has, is fixed."""
        if word in loose:
            self.loose[joint.get("name", "")] = word
            return JointType.FIXED
        if word not in JOINT_TYPES:
            raise self.error(joint, "joint-type-foreign", type=word, accepted=ACCEPTED)
        return JOINT_TYPES[word]

    def joint(
        self,
        element: etree._Element,
        name: str,
        parent: str,
        child: str,
        read: Callable[[etree._Element], dict[str, Any]],
    ) -> Joint:
        """A joint, by what reads how it moves; a faulty one holds its link, and no chain of a table may have it."""
        found = self.part(element, read, None, f"the joint {shown(name)}")
        if found is None:
            self.faulty[name], found = self.unread[-1], {"type": JointType.FIXED}
        return new_joint(name=name, parent=parent, child=child, mark=self.mark(element), **found)

    def numbers_of_joint(
        self, joint: etree._Element, number: Callable[[str, etree._Element], float | None], others: Iterable[str]
    ) -> dict[str, Any]:
        """The limits of a joint and the other fields, by what reads a number; faulty bounds make a faulty joint."""
        name = shown(joint.get("name", ""))
        found = {
            field: number(field, joint)
            if field in BOUNDS
            else self.part(joint, partial(number, field), None, f"the {field} of joint {name}")
            for field in (*LIMITS, *others)
        }
        limits = new_limits(**{field: found.pop(field) for field in LIMITS})
        return {"limits": limits, **found}


def number_of(text: str) -> float:
    """A number of a file; one that cannot be read is not a number."""
    try:
        return float(text)
    except ValueError:
        return math.nan


class Model(NamedTuple):
    """What is in a description; joints that no table has, and those that could not be read, are fixed in the robot."""

    robot: Robot
    loose: Mapping[str, str]  # the types of the former, by name
    unread: Sequence[Unread]
    faulty: Mapping[str, Unread] = MappingProxyType({})  # what is wrong with the latter, by name
    doubly: Collection[str] = ()  # links that are held by more than one joint, which closes a loop

    def whole(self, accepted: str = ACCEPTED) -> Robot:
        """The robot, of which nothing was left out; tables and the format have the accepted types of joints."""
        for joint in self.robot.joints if self.loose else ():
            if (kind := self.loose.get(joint.name)) is not None and joint.child not in self.robot.floating:
                raise ProofError(say("joint-type-foreign", joint.mark, type=kind, accepted=accepted))
        for what, mark, fault in self.unread:
            raise ProofError(fault or say("not-read", mark, what=what))
        return self.robot


def fixed(name: str, holder: str, pose: RigidTransform) -> Joint:
    """The joint by which a link holds another one, or a frame."""
    origin = Origin.of(pose)
    return Joint(name=f"{holder} holds {name}", type=JointType.FIXED, parent=holder, child=name, origin=origin)


class Placed(NamedTuple):
    """A part of a shape, and where it is in the frame of the shape."""

    geometry: Geometry
    pose: RigidTransform = IDENTITY


def parts_of(
    kind: str, numbers: Callable[[str, int], Sequence[float]], filename: Callable[[], str]
) -> list[Placed] | None:
    """The parts of a shape, by what reads some of its numbers or the file of a mesh; None of one that no robot has.

    The length of a capsule is between the middles of its ends, which are balls.
    """
    match kind:
        case "box":
            x, y, z = numbers("size", 3)
            return [Placed(Box(size=(x, y, z)))]
        case "cylinder" | "capsule":
            (radius,), (length,) = numbers("radius", 1), numbers("length", 1)
            ends = (0.5 * length, -0.5 * length) if kind == "capsule" else ()
            return [
                Placed(Cylinder(radius=radius, length=length)),
                *(Placed(Sphere(radius=radius), RigidTransform(IDENTITY_ROTATION, (0.0, 0.0, end))) for end in ends),
            ]
        case "sphere":
            return [Placed(Sphere(radius=numbers("radius", 1)[0]))]
        case "mesh":
            x, y, z = numbers("scale", 3)
            return [Placed(Mesh(filename=filename(), scale=(x, y, z)))]
    return None
