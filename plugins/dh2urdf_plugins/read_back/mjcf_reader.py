"""Reads an MJCF model back into a robot: the other half of the proof of the emitter `mjcf`.

Nothing here comes from the emitter. It is written from MuJoCo's documentation
(https://mujoco.readthedocs.io/en/stable/XMLreference.html and, for orientations, defaults and reference positions,
modeling.html): bodies are nested, angles are in degrees unless the file says radians, Euler angles follow ``eulerseq``
(capital letters: about fixed axes), attributes may come from default classes. What would need MuJoCo's compiler to be
known, such as ``<include>`` or ``<frame>``, is refused rather than passed over.

The robot's root is ``world``. A site becomes a link, unless a body has its name. A joint that is not in its body's
origin, and each of several joints of a body, gets a link of its own.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.errors import ProofError
from dh2urdf.kinematics import axis_rotation
from dh2urdf.manipulator import Inertia, JointType, Limits
from dh2urdf.robot import Box, Collision, Cylinder, Inertial, Joint, Link, Material, Mesh, Origin, Robot, Sphere, Visual
from dh2urdf.rotations import (
    IDENTITY,
    IDENTITY_ROTATION,
    Z_AXIS,
    ZERO,
    RigidTransform,
    Vec3,
    multiply,
    norm,
    rotation_from_quaternion,
    scale,
    transpose,
)
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.read_back.xml_files import content_of, tree_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.robot import Geometry

WORLD = "world"

_AXES: dict[str, Vec3] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_NOT_READ = ("include", "frame", "replicate", "composite", "flexcomp", "attach", "freejoint")
_ORIENTATIONS_NOT_READ = ("axisangle", "xyaxes", "zaxis")


def read_mjcf(path: Path) -> Robot:
    """The robot of an MJCF file.

    Raises:
        ProofError: the file cannot be read, or is not the MJCF of a manipulator.
    """
    return parse_mjcf(content_of(path), str(path))


def parse_mjcf(content: bytes, file: str) -> Robot:
    """The robot of an MJCF text.

    Args:
        content: the text, in the encoding that it declares.
        file: what messages call it.

    Raises:
        ProofError: the text is not the MJCF of a manipulator.
    """
    return robot_of(tree_of(content, file, is_deep=True), file)


def robot_of(root: etree._Element, file: str) -> Robot:
    """The robot of a tree of elements.

    Raises:
        ProofError: the elements are not the MJCF of a manipulator.
    """
    if root.tag != "mujoco":
        message = f"the outermost element is {shown(str(root.tag))}"
        raise ProofError(Problem(message=message, accepted="mujoco", mark=Mark(file=file, line=1)))
    return _Reader(root, file).robot()


def references(root: etree._Element, file: str) -> dict[str, float]:
    """The reference values of the joints of a tree of elements, by name [rad or m].

    Raises:
        ProofError: as of `robot_of`.
    """
    return _Reader(root, file).references()


class _Reader:
    """Reads one tree."""

    def __init__(self, root: etree._Element, file: str) -> None:
        self._root, self._file = root, file
        for element in root.iter(*_NOT_READ):
            raise self._error(element, f"the element {element.tag} is not read here")
        compiler = root.find("compiler")
        self._angle = 1.0 if compiler is not None and compiler.get("angle") == "radian" else math.pi / 180.0
        self._eulerseq = (compiler.get("eulerseq") if compiler is not None else None) or "xyz"
        self._defaults = self._read_defaults()

    def robot(self) -> Robot:
        world = self._root.find("worldbody")
        if world is None:
            raise self._error(self._root, "there is no worldbody")
        names = {world: WORLD}
        links, joints = [self._link(world, WORLD)], []
        bodies = {body.get("name") for body in world.iter("body")}
        # Parents come before children; not by recursion, for an arm may have more links than Python's stack has places.
        for element in world.iter("body", "site"):
            name = element.get("name") or f"{element.tag} in line {element.sourceline}"
            holder = names[element.getparent()]  # type: ignore[index]  # it has one
            if element.tag == "body":
                names[element] = name
                held = self._held(element, name, holder)
                links += [Link(name=joint.child) for joint in held[:-1]]
                links.append(self._link(element, name))
                joints += held
            elif name not in bodies:
                links.append(Link(name=name))
                joints.append(_fixed(name, holder, self._pose(element)))
        return Robot(name=self._root.get("model") or "MuJoCo Model", links=tuple(links), joints=tuple(joints))

    def references(self) -> dict[str, float]:
        found: dict[str, float] = {}
        for element in self._root.iterfind("worldbody//joint"):
            attributes = self._attributes(element)
            found[attributes.get("name", "")] = self._reference(
                element, attributes, self._motion(element, attributes)[0]
            )
        return found

    # Default classes

    def _read_defaults(self) -> dict[str, dict[str, dict[str, str]]]:
        """The attributes that a class gives, by class and by tag."""
        found: dict[str, dict[str, dict[str, str]]] = {"main": {}}
        for element in self._root.iter("default"):  # Outer classes first.
            parent = element.getparent()
            outer = parent.get("class", "main") if parent is not None and parent.tag == "default" else "main"
            name = element.get("class") or "main"
            given = {tag: dict(attributes) for tag, attributes in found.get(outer, {}).items()}
            for each in element.iterchildren(etree.Element):
                if each.tag != "default":
                    given[each.tag] = {**given.get(each.tag, {}), **_attributes(each)}
            found[name] = given
        return found

    def _attributes(self, element: etree._Element) -> dict[str, str]:
        """The attributes of an element, those of its class included."""
        name = element.get("class")
        above = element.getparent()
        while name is None and above is not None:
            name, above = above.get("childclass"), above.getparent()
        if (name := name or "main") not in self._defaults:
            raise self._error(element, f"there is no class {shown(name)}")
        return {**self._defaults[name].get(str(element.tag), {}), **_attributes(element)}

    # Joints

    def _held(self, body: etree._Element, name: str, holder: str) -> list[Joint]:
        """The joints, one after the other, that hold a body."""
        pose = self._pose(body)
        moving = body.findall("joint")
        held: list[Joint] = []
        for number, element in enumerate(moving, start=1):
            attributes = self._attributes(element)
            anchor = self._vector(element, attributes, "pos", ZERO)
            kind, axis = self._motion(element, attributes)
            # At the reference value the body is where it is written, so at 0 it has moved back by that value.
            back = _moved(kind, axis, -self._reference(element, attributes, kind))
            direct = number == len(moving) and anchor == ZERO
            child = name if direct else f"{name} after joint {number}"
            origin = pose @ RigidTransform(IDENTITY_ROTATION, anchor) @ back
            held.append(self._joint(element, attributes, kind, axis, parent=holder, child=child, origin=origin))
            pose, holder = RigidTransform(IDENTITY_ROTATION, scale(-1.0, anchor)), child
        if not held or held[-1].child != name:
            held.append(_fixed(name, holder, pose))
        return held

    def _reference(self, element: etree._Element, attributes: dict[str, str], kind: JointType) -> float:
        (reference,) = self._numbers(element, attributes, "ref", (0.0,))
        return reference * (1.0 if kind is JointType.PRISMATIC else self._angle)

    def _motion(self, element: etree._Element, attributes: dict[str, str]) -> tuple[JointType, Vec3]:
        """How a joint moves, and about or along which unit vector."""
        axis = self._vector(element, attributes, "axis", Z_AXIS)
        if not (length := norm(axis)):
            raise self._error(element, "the axis of the joint has no length")
        axis = axis if length == 1.0 else scale(1.0 / length, axis)
        match attributes.get("type", "hinge"):
            case "slide":
                return JointType.PRISMATIC, axis
            case "hinge":
                limited = attributes.get("limited", "auto")
                bounded = limited == "true" or (limited == "auto" and "range" in attributes)
                return (JointType.REVOLUTE if bounded else JointType.CONTINUOUS), axis
            case word:
                raise self._error(element, f"joint type {shown(word)} is not one of a manipulator", "hinge, slide")

    def _joint(
        self,
        element: etree._Element,
        attributes: dict[str, str],
        kind: JointType,
        axis: Vec3,
        *,
        parent: str,
        child: str,
        origin: RigidTransform,
    ) -> Joint:
        lower, upper = None, None
        if "range" in attributes and kind is not JointType.CONTINUOUS:
            unit = 1.0 if kind is JointType.PRISMATIC else self._angle
            lower, upper = (unit * value for value in self._numbers(element, attributes, "range", (0.0, 0.0)))
        effort = None
        if "actuatorfrcrange" in attributes:
            _, effort = self._numbers(element, attributes, "actuatorfrcrange", (0.0, 0.0))
        damping, friction, armature = [
            self._numbers(element, attributes, name, (0.0,))[0] if name in attributes else None
            for name in ("damping", "frictionloss", "armature")
        ]
        return Joint(
            name=attributes.get("name") or f"joint of {child}",
            type=kind,
            parent=parent,
            child=child,
            origin=_origin(origin),
            axis=axis,
            limits=Limits(lower=lower, upper=upper, effort=effort),
            damping=damping,
            friction=friction,
            armature=armature,
            mark=self._mark(element),
        )

    # Bodies

    def _link(self, body: etree._Element, name: str) -> Link:
        inertial = body.find("inertial")
        visuals: list[Visual] = []
        collisions: list[Collision] = []
        for geom in body.iterchildren("geom"):
            attributes = self._attributes(geom)
            shape, origin = self._geometry(geom, attributes), _origin(self._pose(geom))
            if attributes.get("contype") == attributes.get("conaffinity") == "0":
                visuals.append(Visual(geometry=shape, origin=origin, material=self._colour(geom, attributes)))
            else:
                collisions.append(Collision(geometry=shape, origin=origin))
        return Link(
            name=name,
            inertial=None if inertial is None else self._inertial(inertial),
            visuals=tuple(visuals),
            collisions=tuple(collisions),
        )

    def _inertial(self, element: etree._Element) -> Inertial:
        attributes = self._attributes(element)
        R, com = self._pose(element)
        (mass,) = self._numbers(element, attributes, "mass", (0.0,))
        if "fullinertia" in attributes:
            ixx, iyy, izz, ixy, ixz, iyz = self._numbers(element, attributes, "fullinertia", (0.0,) * 6)
        else:
            ixx, iyy, izz = self._numbers(element, attributes, "diaginertia", ZERO)
            ixy = ixz = iyz = 0.0
        if R != IDENTITY_ROTATION:  # Turn the tensor into axes that are parallel to the body's: R I R^T.
            turned = multiply(multiply(R, (ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz)), transpose(R))
            ixx, ixy, ixz, _, iyy, iyz, _, _, izz = turned
        return Inertial(mass=mass, com=com, inertia=Inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz))

    def _geometry(self, element: etree._Element, attributes: dict[str, str]) -> Geometry:
        """A shape; MuJoCo counts its sizes from the middle."""
        match attributes.get("type", "sphere"):
            case "box":
                x, y, z = self._numbers(element, attributes, "size", ZERO)
                return Box(size=(2.0 * x, 2.0 * y, 2.0 * z))
            case "cylinder" if "fromto" not in attributes:
                radius, half = self._numbers(element, attributes, "size", (0.0, 0.0))
                return Cylinder(radius=radius, length=2.0 * half)
            case "sphere":
                return Sphere(radius=self._numbers(element, attributes, "size", (0.0,))[0])
            case "mesh":
                name = attributes.get("mesh", "")
                for mesh in self._root.iterfind("asset/mesh"):
                    if mesh.get("name") == name:
                        return Mesh(
                            filename=mesh.get("file", ""),
                            scale=self._vector(mesh, self._attributes(mesh), "scale", (1.0, 1.0, 1.0)),
                        )
                raise self._error(element, f"there is no mesh {shown(name)}")
            case word:
                raise self._error(element, f"a shape {shown(word)} is not read here", "box, cylinder, sphere, mesh")

    def _colour(self, element: etree._Element, attributes: dict[str, str]) -> Material | None:
        if "rgba" not in attributes:
            return None
        r, g, b, a = self._numbers(element, attributes, "rgba", (0.5, 0.5, 0.5, 1.0))
        return Material(name="", rgba=(r, g, b, a))

    # Frames and numbers

    def _pose(self, element: etree._Element) -> RigidTransform:
        """The frame of a body, site, shape or centre of mass in the body that holds it."""
        attributes = self._attributes(element)
        for name in _ORIENTATIONS_NOT_READ:
            if name in attributes:
                raise self._error(element, f"an orientation given by {name} is not read here", "quat or euler")
        rotation = IDENTITY_ROTATION
        if "quat" in attributes:
            w, x, y, z = self._numbers(element, attributes, "quat", (1.0, 0.0, 0.0, 0.0))
            rotation = rotation_from_quaternion((x, y, z, w))
        elif "euler" in attributes:
            for word, angle in zip(self._eulerseq, self._numbers(element, attributes, "euler", ZERO), strict=True):
                turn = axis_rotation(_AXES[word.lower()], angle * self._angle)
                # About axes that turn along, or about those that stand still.
                rotation = multiply(rotation, turn) if word.islower() else multiply(turn, rotation)
        return RigidTransform(rotation, self._vector(element, attributes, "pos", ZERO))

    def _vector(self, element: etree._Element, attributes: dict[str, str], name: str, default: Vec3) -> Vec3:
        x, y, z = self._numbers(element, attributes, name, default)
        return (x, y, z)

    def _numbers(
        self, element: etree._Element, attributes: dict[str, str], name: str, default: Sequence[float]
    ) -> Sequence[float]:
        """As many numbers as the default has."""
        if name not in attributes:
            return default
        text, count = attributes[name], len(default)
        try:
            numbers = [float(word) for word in text.split()]
        except ValueError:
            numbers = []
        # `float` also takes 1_000, nan and inf, which MuJoCo does not.
        if len(numbers) != count or "_" in text or not all(map(math.isfinite, numbers)):
            wanted = "one finite number" if count == 1 else f"{count} finite numbers with spaces between them"
            raise self._error(element, f"{name} of {element.tag} is {shown(text)}", accepted=wanted)
        return numbers

    def _mark(self, element: etree._Element) -> Mark:
        return Mark(file=self._file, line=element.sourceline)  # type: ignore[arg-type]  # wrong in the stubs

    def _error(self, element: etree._Element, message: str, accepted: str | None = None) -> ProofError:
        return ProofError(Problem(message=message, accepted=accepted, mark=self._mark(element)))


def _attributes(element: etree._Element) -> dict[str, str]:
    return {str(name): str(value) for name, value in element.attrib.items()}


def _fixed(name: str, holder: str, pose: RigidTransform) -> Joint:
    return Joint(name=f"{holder} holds {name}", type=JointType.FIXED, parent=holder, child=name, origin=_origin(pose))


def _origin(pose: RigidTransform) -> Origin:
    return Origin(xyz=pose.translation, rpy=pose.rpy)


def _moved(kind: JointType, axis: Vec3, value: float) -> RigidTransform:
    """How a joint moves its body [rad or m]."""
    if kind is JointType.PRISMATIC:
        return RigidTransform(IDENTITY_ROTATION, scale(value, axis))
    return RigidTransform(axis_rotation(axis, value), ZERO) if value else IDENTITY
