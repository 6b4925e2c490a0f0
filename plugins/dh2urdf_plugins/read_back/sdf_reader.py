"""Reads an SDF model back into a robot: the other half of the proof of the emitter `sdf`.

Nothing here comes from the emitter. It is written from the specification (http://sdformat.org/spec?ver=1.7 and
http://sdformat.org/tutorials, "Pose Frame Semantics"): the pose of a link, joint or frame is relative to the frame that
it names, else a joint's to its child, a frame's to what it is attached to, and a link's to the model; the axis of a
joint is in the joint's frame.

The robot's root is ``world``, where the model stands. A frame becomes a link; whatever is rigidly held by its body and
posed relative to it hangs below it. A joint apart from its child's origin gets a link of its own between the two.
"""

from __future__ import annotations

from math import isnan
from typing import TYPE_CHECKING, NamedTuple

from lxml import etree

from dh2urdf.errors import ProofError
from dh2urdf.manipulator import Inertia, JointType, Limits
from dh2urdf.robot import Box, Collision, Cylinder, Inertial, Joint, Link, Material, Mesh, Origin, Robot, Sphere, Visual
from dh2urdf.rotations import IDENTITY, IDENTITY_ROTATION, Z_AXIS, RigidTransform, multiply, rotate, transpose
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.read_back.xml_files import content_of, tree_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.robot import Geometry

WORLD, MODEL = "world", "__model__"
UNLIMITED = 1e16
"""A limit from which on SDF means that there is none [rad or m]."""

_JOINT_TYPES = {kind.value: kind for kind in JointType}


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
        ProofError: the text holds no model of a manipulator.
    """
    return robot_of(tree_of(content, file), file)


def robot_of(root: etree._Element, file: str) -> Robot:
    """The robot of the first model in a tree of elements.

    Raises:
        ProofError: the elements hold no model of a manipulator.
    """
    model = root.find(".//model") if root.tag == "sdf" else None
    if model is None:
        raise ProofError(Problem(message="there is no model in it", mark=Mark(file=file)))
    return _Reader(model, file).robot()


class _Place(NamedTuple):
    """Where a link, joint or frame of a model is.

    Attributes:
        kind: which of the three.
        reference: the frame that its pose is relative to.
        pose: its frame in that one.
        moves_with: what a joint or frame is rigidly joined to.
    """

    kind: str
    reference: str
    pose: RigidTransform
    moves_with: str


class _Reader:
    """Reads one model."""

    def __init__(self, model: etree._Element, file: str) -> None:
        self._model, self._file = model, file
        self._places = {
            self._name(element): self._place(element)
            for tag in ("link", "joint", "frame")
            for element in model.iterchildren(tag)
        }
        self._joint_to = {self._word(joint, "child"): joint for joint in model.iterchildren("joint")}

    def robot(self) -> Robot:
        links, joints = [Link(name=WORLD)], []
        for element in self._model.iterchildren("link", "frame"):
            held = self._held(element)
            links += [Link(name=joint.child) for joint in held[:-1]]
            links.append(self._link(element) if element.tag == "link" else Link(name=self._name(element)))
            joints += held
        return Robot(name=self._name(self._model), links=tuple(links), joints=tuple(joints))

    # Frames

    def _place(self, element: etree._Element) -> _Place:
        # A link has no such attribute, and is placed in the model; so is a frame that has none.
        moves_with = self._word(element, "child") if element.tag == "joint" else element.get("attached_to") or MODEL
        pose = element.find("pose")
        named = None if pose is None else pose.get("relative_to")
        return _Place(element.tag, named or moves_with, self._pose(element), moves_with)

    def _held(self, element: etree._Element) -> list[Joint]:
        """The joints, one after the other, that hold a link or frame."""
        name = self._name(element)
        place, joint = self._places[name], self._joint_to.get(name)
        if element.tag == "frame" or joint is None:  # What nothing holds is in the model, and that in the world.
            body = self._body(name) if element.tag == "frame" else WORLD
            return [self._fixed(name, self._holder(place, body))]
        holder = self._holder(place, self._body(self._word(joint, "parent")))
        joint_name = self._name(joint)
        to_link = self._between(joint_name, name)
        if to_link == IDENTITY:
            return [self._joint(joint, name, holder, self._between(holder, name))]
        moved = f"{joint_name} frame"
        return [self._joint(joint, moved, holder, self._between(holder, joint_name)), self._fixed(name, moved, to_link)]

    def _fixed(self, name: str, holder: str, pose: RigidTransform | None = None) -> Joint:
        origin = _origin(pose or self._between(holder, name))
        return Joint(name=f"{holder} holds {name}", type=JointType.FIXED, parent=holder, child=name, origin=origin)

    def _holder(self, place: _Place, body: str) -> str:
        """What holds a link or frame: the frame that it is posed in, where that is on the same body, else the body."""
        is_link = place.reference in self._places and self._places[place.reference].kind != "joint"
        return place.reference if is_link and self._body(place.reference) == body else body

    def _body(self, name: str) -> str:
        """The link, or the world, that a frame is rigidly joined to."""
        way = [name]
        while way[-1] not in {WORLD, MODEL}:
            place = self._known(way[-1])
            if place.kind == "link":
                return way[-1]
            if place.moves_with in way:
                raise self._error(self._model, f"frame {shown(place.moves_with)} is attached to itself")
            way.append(place.moves_with)
        return WORLD

    def _between(self, base: str, name: str) -> RigidTransform:
        """The pose of one frame in another at q = 0; where it is written so, without a rounding."""
        place = self._known(name)
        if place.reference == base or {place.reference, base} <= {WORLD, MODEL}:
            return place.pose
        if base in self._places and self._places[base].reference == name:
            return self._places[base].pose.inverse
        return self._at_rest(base).inverse @ self._at_rest(name)

    def _at_rest(self, name: str) -> RigidTransform:
        """The pose of a frame in the model at q = 0."""
        pose, way = IDENTITY, [name]
        while way[-1] not in {WORLD, MODEL}:
            place = self._known(way[-1])
            if place.reference in way:
                raise self._error(self._model, f"the pose of {shown(place.reference)} is relative to itself")
            pose = place.pose @ pose
            way.append(place.reference)
        return pose

    def _known(self, name: str) -> _Place:
        if name not in self._places:
            raise self._error(self._model, f"there is no link, joint or frame {shown(name)}")
        return self._places[name]

    # Links and joints

    def _joint(self, element: etree._Element, child: str, parent: str, pose: RigidTransform) -> Joint:
        word = element.get("type", "")
        kind = _JOINT_TYPES.get(word)
        if kind is None:
            raise self._error(element, f"joint type {shown(word)} is not one of a manipulator", ", ".join(_JOINT_TYPES))
        limits = {name: self._limit(element, name) for name in ("lower", "upper", "velocity", "effort")}
        if kind is JointType.REVOLUTE and limits["lower"] is None and limits["upper"] is None:
            kind = JointType.CONTINUOUS
        axis = Z_AXIS
        if kind is not JointType.FIXED:
            x, y, z = self._numbers(element, "axis/xyz", 3, Z_AXIS)
            axis = (x, y, z)
            expressed_in = element.find("axis/xyz")
            if expressed_in is not None and (frame := expressed_in.get("expressed_in")):
                axis = rotate(self._between(self._name(element), frame).rotation, axis)
        return Joint(
            name=self._name(element),
            type=kind,
            parent=parent,
            child=child,
            origin=_origin(pose),
            axis=axis,
            limits=Limits(**limits),
            damping=self._optional(element, "axis/dynamics/damping"),
            friction=self._optional(element, "axis/dynamics/friction"),
            mark=self._mark(element),
        )

    def _limit(self, joint: etree._Element, name: str) -> float | None:
        """A limit; None where there is none: no word of it, an endless one, or the −1 of an endless effort or speed."""
        value = self._optional(joint, f"axis/limit/{name}")
        if value is None or abs(value) >= UNLIMITED or (value < 0 and name in {"velocity", "effort"}):
            return None
        return value

    def _link(self, element: etree._Element) -> Link:
        inertial = element.find("inertial")
        # SDF gives a link without mass properties 1 kg, and 1 kg·m² about each axis.
        unsaid = Inertial(mass=1.0, inertia=Inertia(ixx=1.0, iyy=1.0, izz=1.0))
        return Link(
            name=self._name(element),
            inertial=unsaid if inertial is None else self._inertial(inertial),
            visuals=tuple(
                Visual(geometry=self._geometry(shape), origin=self._shape_origin(shape), material=self._material(shape))
                for shape in element.iterchildren("visual")
            ),
            collisions=tuple(
                Collision(geometry=self._geometry(shape), origin=self._shape_origin(shape))
                for shape in element.iterchildren("collision")
            ),
        )

    def _inertial(self, element: etree._Element) -> Inertial:
        ixx, iyy, izz = (self._numbers(element, f"inertia/{name}", 1, (1.0,))[0] for name in ("ixx", "iyy", "izz"))
        ixy, ixz, iyz = (self._numbers(element, f"inertia/{name}", 1, (0.0,))[0] for name in ("ixy", "ixz", "iyz"))
        R, com = self._pose(element)
        if R != IDENTITY_ROTATION:  # Turn the tensor into axes that are parallel to the link's: R I R^T.
            turned = multiply(multiply(R, (ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz)), transpose(R))
            ixx, ixy, ixz, _, iyy, iyz, _, _, izz = turned
        return Inertial(
            mass=self._numbers(element, "mass", 1, (1.0,))[0],
            com=com,
            inertia=Inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz),
        )

    def _shape_origin(self, element: etree._Element) -> Origin:
        pose = element.find("pose")
        reference = None if pose is None else pose.get("relative_to")
        link = self._name(element.getparent())  # type: ignore[arg-type]  # it has one
        if reference is None or reference == link:
            return self._origin(element)
        return _origin(self._between(link, reference) @ self._pose(element))

    def _material(self, element: etree._Element) -> Material | None:
        """The colour of a shape; colours have no names in SDF."""
        if element.find("material/diffuse") is None:
            return None
        r, g, b, a = self._numbers(element, "material/diffuse", 4)
        return Material(name="", rgba=(r, g, b, a))

    def _geometry(self, element: etree._Element) -> Geometry:
        geometry = element.find("geometry")
        shape = None if geometry is None else next(geometry.iterchildren(etree.Element), None)
        if shape is not None:
            match shape.tag:
                case "box":
                    x, y, z = self._numbers(shape, "size", 3)
                    return Box(size=(x, y, z))
                case "cylinder":
                    (radius,), (length,) = self._numbers(shape, "radius", 1), self._numbers(shape, "length", 1)
                    return Cylinder(radius=radius, length=length)
                case "sphere":
                    return Sphere(radius=self._numbers(shape, "radius", 1)[0])
                case "mesh":
                    x, y, z = self._numbers(shape, "scale", 3, (1.0, 1.0, 1.0))
                    return Mesh(filename=self._word(shape, "uri"), scale=(x, y, z))
        raise self._error(element, "the geometry has no known shape", "box, cylinder, sphere, mesh")

    # Words and numbers

    def _name(self, element: etree._Element) -> str:
        name = element.get("name")
        if name is None:
            raise self._error(element, f"{element.tag} lacks a name")
        return name

    def _word(self, element: etree._Element, tag: str) -> str:
        text = element.findtext(tag)
        if text is None:
            raise self._error(element, f"{element.tag} lacks {tag}")
        return text

    def _pose(self, element: etree._Element) -> RigidTransform:
        return self._origin(element).transform

    def _origin(self, element: etree._Element) -> Origin:
        x, y, z, roll, pitch, yaw = self._numbers(element, "pose", 6, (0.0,) * 6)
        return Origin(xyz=(x, y, z), rpy=(roll, pitch, yaw))

    def _optional(self, element: etree._Element, path: str) -> float | None:
        return None if element.find(path) is None else self._numbers(element, path, 1)[0]

    def _numbers(
        self, element: etree._Element, path: str, count: int, default: Sequence[float] | None = None
    ) -> Sequence[float]:
        found = element.find(path)
        if found is None and default is not None:
            return default
        text = (found.text if found is not None else None) or ""
        try:
            numbers = [float(word) for word in text.split()]
        except ValueError:
            numbers = []
        # `float` also takes 1_000 and nan; inf is a limit that there is none.
        if len(numbers) != count or "_" in text or any(map(isnan, numbers)):
            wanted = "one number" if count == 1 else f"{count} numbers with spaces between them"
            raise self._error(element, f"{path} of {element.tag} is {shown(text)}", accepted=wanted)
        return numbers

    def _mark(self, element: etree._Element) -> Mark:
        return Mark(file=self._file, line=element.sourceline)  # type: ignore[arg-type]  # wrong in the stubs

    def _error(self, element: etree._Element, message: str, accepted: str | None = None) -> ProofError:
        return ProofError(Problem(message=message, accepted=accepted, mark=self._mark(element)))


def _origin(pose: RigidTransform) -> Origin:
    return Origin(xyz=pose.translation, rpy=pose.rpy)
