"""Reads an SDF model back into a robot: the other half of the proof of the emitter `sdf`.

Nothing here comes from the emitter. It is written from the specification (http://sdformat.org/spec?ver=1.7 and
http://sdformat.org/tutorials, "Pose Frame Semantics"): the pose of a link, joint or frame is relative to the frame that
it names, else a joint's to its child, a frame's to what it is attached to, and a link's to the model; the axis of a
joint is in the joint's frame.

The robot's root is ``world``, where the model stands. A frame becomes a link; whatever is rigidly held by its body and
posed relative to it hangs below it. A joint apart from its child's origin gets a link of its own between the two.
"""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.errors import ProofError
from dh2urdf.manipulator import JOINT_TYPES, WORLD, Inertia, JointType, Limits
from dh2urdf.robot import Box, Collision, Cylinder, Inertial, Joint, Link, Material, Mesh, Origin, Robot, Sphere, Visual
from dh2urdf.rotations import (
    IDENTITY,
    IDENTITY_ROTATION,
    Z_AXIS,
    RigidTransform,
    multiply,
    rotate,
    transpose,
)
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.formats.sdf.elements import IN_MODEL, SdfElements, modernise
from dh2urdf_plugins.formats.sdf.places import AT_INCLUDED, Places, flatten, leave_out_attached
from dh2urdf_plugins.formats.xml_files import (
    Placed,
    capsule,
    content_of,
    not_of_a_manipulator,
    tree_of,
    whole,
    written_tree_of,
)

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.robot import Geometry

UNLIMITED = 1e16
"""A limit from which on SDF means that there is none [rad or m]."""

_ACCEPTED = ", ".join(JOINT_TYPES)
_LOOSE = ("ball", "gearbox", "revolute2", "screw", "universal", AT_INCLUDED)
"""Joints that no table has."""


class Model(NamedTuple):
    """What is in an SDF.

    Attributes:
        robot: the links and joints of its first model; joints that no table has are fixed in it.
        mimics: how joints follow others, by their names.
        loose: the types of those joints, by name.
        unread: what could not be read, by the words for it: the places.
        doubly: links that several joints hold, which closes a loop.
    """

    robot: Robot
    mimics: Mapping[str, etree._Element]
    loose: Mapping[str, str]
    unread: Mapping[str, Sequence[Mark]]
    doubly: Collection[str]


def read_sdf(path: Path) -> Robot:
    """The robot of the first model in an SDF file.

    Raises:
        ProofError: the file cannot be read, or holds no model of a manipulator.
    """
    return parse_sdf(content_of(path), str(path))


def parse_sdf(content: bytes, file: str) -> Robot:
    """The robot of the first model in an SDF text.

    Args:
        content: the text, in the encoding that it declares.
        file: what messages call it.

    Raises:
        ProofError: the text holds no model of a manipulator, or something in it cannot be read.
    """
    model = model_of(written_tree_of(content, file), file)
    return whole(model.robot, model.loose, model.unread, _ACCEPTED)


def read_model(path: Path) -> Model:
    """The first model of an SDF file of any origin.

    Raises:
        ProofError: the file cannot be read, or holds no model of a robot.
    """
    return model_of(tree_of(content_of(path), str(path)), str(path))


def model_of(root: etree._Element, file: str) -> Model:
    """The first model in a tree of elements.

    Raises:
        ProofError: the elements hold no model of a robot.
    """
    models = [*root.iterchildren("model"), *root.iterfind("world/model")] if root.tag == "sdf" else []
    if not models:
        included = next(
            (f"it includes {shown((uri.text or '').strip())}" for uri in root.iterfind(".//include/uri")), ""
        )
        how = f"{included}: give the file of that model" if included else None
        raise ProofError(Problem(message="there is no model in it", suggestion=how, mark=Mark(file=file)))
    is_nested = any(each is not None for model in models for each in (model.find("model"), model.find("include")))
    return _Reader(deepcopy(root) if is_nested else root, file).model()


class _Reader(SdfElements):
    """Reads the first model of one tree, which it changes."""

    def __init__(self, root: etree._Element, file: str) -> None:
        super().__init__(file)
        modernise(root)
        self._loose: dict[str, str] = {}
        self._model, *others = [*root.iterchildren("model"), *root.iterfind("world/model")]
        for other in others:
            self.not_read(other, "a model besides the first one")
        included = [*self._model.iter("include")]
        for include in (*included, *root.iterfind("include"), *root.iterfind("world/include")):
            self.not_read(include, "an included model")
        for joint in root.iterfind("world/joint"):
            self.not_read(joint, "a joint of the world")
        for word in self._model.iterfind(f".//joint/axis/{IN_MODEL}"):
            self.not_read(word, f"{IN_MODEL}, which SDF has no more since version 1.7,")
        canonical = flatten(self._model)
        if included:
            leave_out_attached(self._model, self.not_read)
        self._places = Places(self, self._model, canonical)
        # A joint holds the link that its child is, or is rigidly joined to.
        self._joint_to: dict[str, etree._Element] = {}
        self._doubly = set[str]()
        for joint in self._model.iterchildren("joint"):
            if (body := self._places.body(self.word(joint, "child"))) == WORLD:
                raise self.error(joint, "the joint moves the world", "a child that is a link, or is attached to one")
            if self._joint_to.setdefault(body, joint) is not joint:
                self.not_read(joint, "a second joint of a link")
                self._doubly.add(body)
        if self._is_at_rest(canonical):  # Then what is in the model is in the world.
            self._places.rest_in_world()

    def model(self) -> Model:
        links, joints = [Link(name=WORLD)], []
        for element in self._model.iterchildren("link", "frame"):
            if element.get("name") == WORLD:  # Old versions take a link of this name for the world.
                links[0] = self._link(element)
                continue
            held = self._held(element)
            links += [Link(name=joint.child) for joint in held[:-1]]
            links.append(self._link(element) if element.tag == "link" else Link(name=self.name(element)))
            joints += held
        robot = Robot(name=self.name(self._model), links=tuple(links), joints=tuple(joints))
        joints_of_model = self._model.iterchildren("joint")
        found = {
            self.name(joint): mimic for joint in joints_of_model if (mimic := joint.find("axis/mimic")) is not None
        }
        return Model(robot, found, self._loose, self.unread, self._doubly)

    # Frames

    def _is_at_rest(self, link: str | None) -> bool:
        """Whether no joint moves a link; what nothing holds is at rest in the world."""
        way = set[str]()
        while link is not None and link not in way and (joint := self._joint_to.get(link)) is not None:
            if _type(joint) != JointType.FIXED.value:
                return False
            way.add(link)
            link = self._places.body(self.word(joint, "parent"))
        return True

    def _held(self, element: etree._Element) -> list[Joint]:
        """The joints, one after the other, that hold a link or frame."""
        name, places = self.name(element), self._places
        joint = self._joint_to.get(name)
        if element.tag == "frame" or joint is None:  # What nothing holds is in the model, and that in the world.
            body = places.body(name) if element.tag == "frame" else WORLD
            return [self._fixed(name, places.holder(name, body))]
        holder = places.holder(name, places.body(self.word(joint, "parent")))
        joint_name = places.key(joint)
        to_link = places.between(joint_name, name)
        if to_link == IDENTITY:
            return [self._joint(joint, name, holder, places.between(holder, name))]
        moved = f"{self.name(joint)} frame"
        origin = places.between(holder, joint_name)
        return [self._joint(joint, moved, holder, origin), self._fixed(name, moved, to_link)]

    def _fixed(self, name: str, holder: str, pose: RigidTransform | None = None) -> Joint:
        origin = Origin.of(pose or self._places.between(holder, name))
        return Joint(name=f"{holder} holds {name}", type=JointType.FIXED, parent=holder, child=name, origin=origin)

    # Links and joints

    def _joint(self, element: etree._Element, child: str, parent: str, pose: RigidTransform) -> Joint:
        word = _type(element)
        kind = JointType.FIXED if word in _LOOSE else JOINT_TYPES.get(word)
        if kind is None:
            raise ProofError(not_of_a_manipulator(word, _ACCEPTED, self.mark(element)))
        if word in _LOOSE:
            self._loose[self.name(element)] = word
        limits = {name: self._limit(element, name) for name in ("lower", "upper", "velocity", "effort")}
        if kind is JointType.REVOLUTE and limits["lower"] is None and limits["upper"] is None:
            kind = JointType.CONTINUOUS
        axis = Z_AXIS
        if kind is not JointType.FIXED:
            x, y, z = self.numbers(element, "axis/xyz", 3, Z_AXIS)
            axis = (x, y, z)
            xyz = element.find("axis/xyz")
            if xyz is not None and (frame := xyz.get("expressed_in")):
                axis = rotate(self._places.between(self._places.key(element), frame).rotation, axis)
        return Joint(
            name=self.name(element),
            type=kind,
            parent=parent,
            child=child,
            origin=Origin.of(pose),
            axis=axis,
            limits=Limits(**limits),
            damping=self.optional(element, "axis/dynamics/damping"),
            friction=self.optional(element, "axis/dynamics/friction"),
            mark=self.mark(element),
        )

    def _limit(self, joint: etree._Element, name: str) -> float | None:
        """A limit; None where there is none: no word of it, an endless one, or the −1 of an endless effort or speed."""
        value = self.optional(joint, f"axis/limit/{name}")
        if value is None or abs(value) >= UNLIMITED or (value < 0 and name in {"velocity", "effort"}):
            return None
        return value

    def _link(self, element: etree._Element) -> Link:
        inertial = element.find("inertial")
        # SDF gives a link without mass properties 1 kg, and 1 kg·m² about each axis.
        unsaid = Inertial(mass=1.0, inertia=Inertia(ixx=1.0, iyy=1.0, izz=1.0))
        return Link(
            name=self.name(element),
            inertial=unsaid if inertial is None else self._inertial(inertial),
            visuals=tuple(
                Visual(geometry=geometry, origin=origin, material=self._material(shape))
                for shape in element.iterchildren("visual")
                for geometry, origin in self._placed(shape)
            ),
            collisions=tuple(
                Collision(geometry=geometry, origin=origin)
                for shape in element.iterchildren("collision")
                for geometry, origin in self._placed(shape)
            ),
        )

    def _inertial(self, element: etree._Element) -> Inertial:
        if element.get("auto") == "true":
            self.not_read(element, "a mass that follows from shapes")
        ixx, iyy, izz = (self.numbers(element, f"inertia/{name}", 1, (1.0,))[0] for name in ("ixx", "iyy", "izz"))
        ixy, ixz, iyz = (self.numbers(element, f"inertia/{name}", 1, (0.0,))[0] for name in ("ixy", "ixz", "iyz"))
        R, com = self.pose(element)
        if R != IDENTITY_ROTATION:  # Turn the tensor into axes that are parallel to the link's: R I R^T.
            turned = multiply(multiply(R, (ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz)), transpose(R))
            ixx, ixy, ixz, _, iyy, iyz, _, _, izz = turned
        return Inertial(
            mass=self.numbers(element, "mass", 1, (1.0,))[0],
            com=com,
            inertia=Inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz),
        )

    def _shape_origin(self, element: etree._Element) -> Origin:
        pose = element.find("pose")
        reference = None if pose is None else pose.get("relative_to")
        link = self.name(element.getparent())  # type: ignore[arg-type]  # it has one
        if reference is None or reference == link:
            return self.origin(element)
        return Origin.of(self._places.between(link, reference) @ self.pose(element))

    def _material(self, element: etree._Element) -> Material | None:
        """The colour of a shape; colours have no names in SDF."""
        if element.find("material/diffuse") is None:
            return None
        is_opaque = len((element.findtext("material/diffuse") or "").split()) == 3  # noqa: PLR2004 - red, green, blue
        r, g, b, *a = self.numbers(element, "material/diffuse", 3 if is_opaque else 4)
        return Material(name="", rgba=(r, g, b, *(a or (1.0,))))

    def _placed(self, element: etree._Element) -> Iterator[tuple[Geometry, Origin]]:
        """The parts of a shape, and where they are in the link."""
        origin = self._shape_origin(element)
        for geometry, pose in self._parts(element):
            yield geometry, origin if pose is IDENTITY else Origin.of(origin.transform @ pose)

    def _parts(self, element: etree._Element) -> list[Placed]:
        geometry = element.find("geometry")
        shape = None if geometry is None else next(geometry.iterchildren(etree.Element), None)
        if shape is None or shape.tag == "empty":
            return []
        # Sizes that are not there are those of http://sdformat.org/spec?elem=geometry.
        match shape.tag:
            case "box":
                x, y, z = self.numbers(shape, "size", 3, (1.0, 1.0, 1.0))
                parts = [Placed(Box(size=(x, y, z)))]
            case "cylinder":
                (radius,), (length,) = (
                    self.numbers(shape, "radius", 1, (1.0,)),
                    self.numbers(shape, "length", 1, (1.0,)),
                )
                parts = [Placed(Cylinder(radius=radius, length=length))]
            case "sphere":
                parts = [Placed(Sphere(radius=self.numbers(shape, "radius", 1, (1.0,))[0]))]
            case "mesh":
                x, y, z = self.numbers(shape, "scale", 3, (1.0, 1.0, 1.0))
                parts = [Placed(Mesh(filename=self.word(shape, "uri"), scale=(x, y, z)))]
            case "capsule":
                (radius,), (length,) = (
                    self.numbers(shape, "radius", 1, (0.5,)),
                    self.numbers(shape, "length", 1, (1.0,)),
                )
                parts = capsule(radius, length)
            case word:
                self.not_read(shape, f"a shape {shown(str(word))}")
                parts = []
        return parts


def _type(joint: etree._Element) -> str:
    return joint.get("type", "").lower()
