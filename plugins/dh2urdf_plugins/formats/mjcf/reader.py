"""Reads an MJCF model back into a robot: the other half of the proof of the emitter `mjcf`.

Nothing here comes from the emitter. It is written from MuJoCo's documentation
(https://mujoco.readthedocs.io/en/stable/XMLreference.html and modeling.html): bodies are nested, a frame moves what is
in it, attributes may come from default classes, joints have reference values. What would need MuJoCo's compiler to be
known, such as ``<replicate>``, is refused rather than passed over.

The robot's root is ``world``. A site becomes a link, unless a body has its name. A joint that is not in its body's
origin, and each of several joints of a body, gets a link of its own.
"""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.errors import ProofError
from dh2urdf.kinematics import axis_rotation
from dh2urdf.manipulator import WORLD, Inertia, JointType, Limits
from dh2urdf.robot import Inertial, Joint, Link, Origin, Robot
from dh2urdf.rotations import (
    IDENTITY,
    IDENTITY_ROTATION,
    Z_AXIS,
    ZERO,
    RigidTransform,
    Vec3,
    multiply,
    norm,
    rotate,
    scale,
    transpose,
)
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.formats.mjcf.elements import SMALLEST, Elements, include_files
from dh2urdf_plugins.formats.mjcf.shapes import Shapes, mass_of_shapes
from dh2urdf_plugins.formats.xml_files import content_of, mark_of, tree_of, whole, written_tree_of

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence
    from pathlib import Path

    from lxml import etree


_NOT_READ = ("include", "replicate", "composite", "flexcomp", "attach")
_CHANGING_MASSES = frozenset(("balanceinertia", "boundinertia", "boundmass", "settotalmass"))
"""Options by which MuJoCo changes masses."""
_HOLDING_BODIES = ("connect", "weld")
"""Constraints that hold bodies together besides the joints."""
_LOOSE = {"ball": "ball", "free": "floating"}
"""Joints that no table has, by their names in MJCF: as other formats call them."""


class Model(NamedTuple):
    """What is in an MJCF.

    Attributes:
        robot: its links and joints; joints that no table has are fixed in it.
        loose: their types, by name.
        references: the reference values of the joints that move, by name [rad or m].
        unread: what could not be read, by the words for it: the places.
        doubly: links of bodies that a constraint holds besides the joints, which closes a loop.
    """

    robot: Robot
    loose: Mapping[str, str]
    references: Mapping[str, float]
    unread: Mapping[str, Sequence[Mark]]
    doubly: Collection[str]


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
        ProofError: the text is not the MJCF of a manipulator, or something in it cannot be read.
    """
    model = model_of(written_tree_of(content, file, is_deep=True), file)
    return whole(model.robot, model.loose, model.unread, accepted="hinge, slide")


def read_model(path: Path) -> Model:
    """The model of an MJCF file of any origin, and of the files that it includes.

    Raises:
        ProofError: one of them cannot be read, or they are not the MJCF of a robot.
    """
    return model_of(whole_tree_of(content_of(path), path), str(path))


def whole_tree_of(content: bytes, path: Path) -> etree._Element:
    """The elements of an MJCF and of the files that it includes.

    Raises:
        ProofError: one of them is not XML, or is not there.
    """
    root = tree_of(content, str(path), is_deep=True)
    missing = include_files(root, path)
    if missing:
        raise ProofError(Problem(message=each.message, mark=mark_of(each.include)) for each in missing)
    return root


def model_of(root: etree._Element, file: str) -> Model:
    """The model of a tree of elements.

    Raises:
        ProofError: the elements are not the MJCF of a robot.
    """
    if root.tag != "mujoco":
        message = f"the outermost element is {shown(str(root.tag))}"
        raise ProofError(Problem(message=message, accepted="mujoco", mark=Mark(file=file, line=1)))
    return _Reader(root, file).model()


class _Reader:
    """Reads one tree."""

    def __init__(self, root: etree._Element, file: str) -> None:
        self._elements = Elements(root, file)
        self._nameless_in = defaultdict[str, int](lambda: 1)  # by their place, the bodies and sites without a name
        for element in root.iter(*_NOT_READ):
            message, how = (
                f"the element {element.tag} is not read here",
                "mujoco.mj_saveLastXML writes a model without it",
            )
            raise ProofError(Problem(message=message, suggestion=how, mark=self._elements.mark(element)))
        if self._elements.compiler.get("coordinate", "local") != "local":
            raise ProofError(
                Problem(
                    message="poses are not given in the bodies that hold them",
                    found=f"coordinate={self._elements.compiler['coordinate']}",
                    accepted="coordinate=local",
                    suggestion="MuJoCo 2.3.3 and older load such a model and save it so",
                    mark=self._elements.mark(root.findall("compiler")[-1]),
                )
            )
        self._shapes = Shapes(self._elements)
        self._loose: dict[str, str] = {}
        self._references: dict[str, float] = {}

    def model(self) -> Model:
        root = self._elements.root
        worlds = root.findall("worldbody")
        if not worlds:
            raise self._elements.error(root, "there is no worldbody")
        names = dict.fromkeys(worlds, WORLD)
        links, joints = [self._link(worlds, WORLD)], []
        bodies = {body.get("name") for world in worlds for body in world.iter("body")}
        taken = set(bodies)
        # Parents come before children; not by recursion, for an arm may have more links than Python's stack has places.
        for element in (each for world in worlds for each in world.iter("body", "site")):
            name = element.get("name") or self._nameless(element, taken)
            holder = self._holder(element, names)
            if element.tag == "body":
                names[element] = name
                held = self._held(element, name, holder)
                links += [Link(name=joint.child) for joint in held[:-1]]
                links.append(self._link([element], name))
                joints += held
            elif name not in bodies:
                links.append(Link(name=name))
                joints.append(_fixed(name, holder, self._elements.pose(element)))
        for name in sorted(_CHANGING_MASSES & self._elements.compiler.keys()):
            self._elements.not_read(root.findall("compiler")[-1], f"the option {name} of the compiler")
        doubly = set[str]()
        named = {(each.tag, each.get("name")): each for world in worlds for each in world.iter("body", "site")}
        for constraint in root.iterfind("equality/*"):
            if constraint.tag == "joint" or not self._elements.is_active(constraint):
                continue
            self._elements.not_read(constraint, f"the constraint {constraint.tag}")
            if constraint.tag in _HOLDING_BODIES:
                doubly |= {names[body] for body in self._looped(constraint, named)}
        robot = Robot(name=root.get("model") or "MuJoCo Model", links=tuple(links), joints=tuple(joints))
        return Model(robot, self._loose, self._references, self._elements.unread, doubly)

    def _looped(
        self, constraint: etree._Element, named: Mapping[tuple[str, str | None], etree._Element]
    ) -> list[etree._Element]:
        """The bodies with which a constraint closes a loop: those of one tree, and not what a mouse drags (mocap)."""
        keys = [(tag, constraint.get(f"{tag}{number}")) for number in "12" for tag in ("body", "site")]
        found = [named[key] for key in keys if key[1] and key in named]
        bodies = [each if each.tag == "body" else next(each.iterancestors("body"), None) for each in found]
        held = [body for body in bodies if body is not None]
        trees = {self._free(body) for body in held} | ({None} if len(held) == 1 else set())
        is_dragged = any(body.get("mocap") == "true" for body in held)
        return [] if is_dragged or len(trees) > 1 else held

    def _free(self, body: etree._Element) -> etree._Element | None:
        """The body that moves freely and holds a body, or is the body; None where the world holds it."""
        holders = (each for each in (body, *body.iterancestors("body")))
        return next(
            (each for each in holders if any(map(_is_free, self._elements.held(each, "joint", "freejoint")))), None
        )

    def _holder(self, element: etree._Element, names: Mapping[etree._Element, str]) -> str:
        """The name of the body that holds an element."""
        above = next(above for above in element.iterancestors() if above.tag != "frame")
        if above not in names:
            raise self._elements.error(element, f"a {element.tag} is in a {above.tag}", "a body, a frame or worldbody")
        return names[above]

    def _nameless(self, element: etree._Element, taken: set[str | None]) -> str:
        name = place = f"{element.tag} in line {element.sourceline}"
        while name in taken:
            self._nameless_in[place] += 1
            name = f"{place} ({self._nameless_in[place]})"
        taken.add(name)
        return name

    # Joints

    def _held(self, body: etree._Element, name: str, holder: str) -> list[Joint]:
        """The joints, one after the other, that hold a body."""
        pose = self._elements.pose(body)
        moving = list(self._elements.held(body, "joint", "freejoint"))
        held: list[Joint] = []
        for number, element in enumerate(moving, start=1):
            attributes = self._elements.attributes(element)
            # A frame turns the axis and moves the anchor.
            anchor = self._elements.vector(element, attributes, "pos", ZERO)
            turn, anchor = self._elements.around(element, RigidTransform(IDENTITY_ROTATION, anchor))
            kind, axis = self._motion(element, attributes)
            axis = axis if turn == IDENTITY_ROTATION else rotate(turn, axis)
            reference = self._reference(element, attributes, kind)
            # At the reference value the body is where it is written, so at 0 it has moved back by that value.
            back = _moved(kind, axis, -reference)
            direct = number == len(moving) and anchor == ZERO
            child = name if direct else f"{name} after joint {number}"
            origin = pose @ RigidTransform(IDENTITY_ROTATION, anchor) @ back
            joint = self._joint(element, attributes, kind, axis, parent=holder, child=child, origin=origin)
            if kind is JointType.FIXED:
                self._loose[joint.name] = _LOOSE[_type(element, attributes)]
            else:
                self._references[joint.name] = reference
            held.append(joint)
            pose, holder = RigidTransform(IDENTITY_ROTATION, scale(-1.0, anchor)), child
        if not held or held[-1].child != name:
            held.append(_fixed(name, holder, pose))
        return held

    def _reference(self, element: etree._Element, attributes: dict[str, str], kind: JointType) -> float:
        if kind is JointType.FIXED:  # A ball and a free joint have none, whatever is written.
            return 0.0
        (reference,) = self._elements.numbers(element, attributes, "ref", (0.0,))
        return reference * (1.0 if kind is JointType.PRISMATIC else self._elements.angle)

    def _motion(self, element: etree._Element, attributes: dict[str, str]) -> tuple[JointType, Vec3]:
        """How a joint moves, and about or along which unit vector; one that no table has is fixed."""
        kind = _type(element, attributes)
        if kind in _LOOSE:
            return JointType.FIXED, Z_AXIS
        axis = self._elements.vector(element, attributes, "axis", Z_AXIS)
        if (length := norm(axis)) < SMALLEST:
            raise self._elements.error(element, "the axis of the joint has no length")
        axis = axis if length == 1.0 else scale(1.0 / length, axis)
        match kind:
            case "slide":
                return JointType.PRISMATIC, axis
            case "hinge":
                is_bounded = self._elements.limits(element, attributes, "range", "limited") is not None
                return (JointType.REVOLUTE if is_bounded else JointType.CONTINUOUS), axis
        accepted = "hinge, slide, ball, free"
        raise self._elements.error(element, f"there is no joint type {shown(kind)}", accepted)

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
        bounds = self._elements.limits(element, attributes, "range", "limited")
        if bounds and kind is not JointType.FIXED:
            unit = 1.0 if kind is JointType.PRISMATIC else self._elements.angle
            lower, upper = (unit * value for value in bounds)
        _, effort = self._elements.limits(element, attributes, "actuatorfrcrange", "actuatorfrclimited") or (None, None)
        damping, friction, armature = [
            self._elements.numbers(element, attributes, name, (0.0,), most=3)[0] if name in attributes else None
            for name in ("damping", "frictionloss", "armature")
        ]
        return Joint(
            name=attributes.get("name") or f"joint of {child}",
            type=kind,
            parent=parent,
            child=child,
            origin=Origin.of(origin),
            axis=axis,
            limits=Limits(lower=lower, upper=upper, effort=effort),
            damping=damping,
            friction=friction,
            armature=armature,
            mark=self._elements.mark(element),
        )

    # Bodies

    def _link(self, bodies: Sequence[etree._Element], name: str) -> Link:
        """The link of a body; of several that are one, such as the world."""
        shapes = [self._shapes.of(body) for body in bodies]
        return Link(
            name=name,
            inertial=self._inertial(bodies[0]),
            visuals=tuple(visual for visuals, _ in shapes for visual in visuals),
            collisions=tuple(collision for _, collisions in shapes for collision in collisions),
        )

    def _inertial(self, body: etree._Element) -> Inertial | None:
        element = body.find("inertial")
        whence = self._elements.compiler.get("inertiafromgeom")
        if body.tag == "body" and whence != "false" and (element is None or whence == "true"):
            return mass_of_shapes(self._shapes.geoms(body), self._elements)
        if element is None:
            return None
        attributes = self._elements.attributes(element)
        R, com = self._elements.pose(element)
        (mass,) = self._elements.numbers(element, attributes, "mass", (0.0,))
        if "fullinertia" in attributes:
            ixx, iyy, izz, ixy, ixz, iyz = self._elements.numbers(element, attributes, "fullinertia", (0.0,) * 6)
        else:
            ixx, iyy, izz = self._elements.numbers(element, attributes, "diaginertia", ZERO)
            ixy = ixz = iyz = 0.0
        if R != IDENTITY_ROTATION:  # Turn the tensor into axes that are parallel to the body's: R I R^T.
            turned = multiply(multiply(R, (ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz)), transpose(R))
            ixx, ixy, ixz, _, iyy, iyz, _, _, izz = turned
        return Inertial(mass=mass, com=com, inertia=Inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz))


def _type(element: etree._Element, attributes: dict[str, str]) -> str:
    return "free" if element.tag == "freejoint" else attributes.get("type", "hinge")


def _is_free(joint: etree._Element) -> bool:
    return joint.tag == "freejoint" or joint.get("type") == "free"


def _fixed(name: str, holder: str, pose: RigidTransform) -> Joint:
    return Joint(name=f"{holder} holds {name}", type=JointType.FIXED, parent=holder, child=name, origin=Origin.of(pose))


def _moved(kind: JointType, axis: Vec3, value: float) -> RigidTransform:
    """How a joint moves its body [rad or m]."""
    if kind is JointType.PRISMATIC:
        return RigidTransform(IDENTITY_ROTATION, scale(value, axis))
    return RigidTransform(axis_rotation(axis, value), ZERO) if value else IDENTITY
