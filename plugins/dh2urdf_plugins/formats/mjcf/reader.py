"""Reads an MJCF model back into a robot: the other half of the proof of the emitter `mjcf`.

Nothing here comes from the writer. It is written from MuJoCo's documentation
(https://mujoco.readthedocs.io/en/stable/XMLreference.html and modeling.html): bodies are nested, a frame moves what is
in it, attributes may come from default classes, joints have reference values. What would need MuJoCo's compiler to be
known, such as ``<replicate>``, is refused rather than passed over.

The robot's root is ``world``. A site becomes a link, unless a body has its name. A joint that is not in its body's
origin, and each of several joints of a body, gets a link of its own.
"""

from __future__ import annotations

from collections import defaultdict
from functools import partial
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import DYNAMICS
from dh2urdf.errors import ProofError
from dh2urdf.kinematics import axis_rotation
from dh2urdf.kinematics.mass import rotated
from dh2urdf.manipulator import WORLD, Inertia, JointType
from dh2urdf.robot import Inertial, Joint, Link, Origin, Robot
from dh2urdf.rotations import IDENTITY_ROTATION, Z_AXIS, ZERO, RigidTransform, Vec3, norm, rotate, scale
from dh2urdf.source import Messages, shown
from dh2urdf_plugins.formats.mjcf.elements import SMALLEST, include_files
from dh2urdf_plugins.formats.mjcf.shapes import Shapes
from dh2urdf_plugins.formats.xml_files import BOUNDS, Model, fixed, mark_of, read_file, tree_of, written_tree_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from lxml import etree

say = Messages(__file__)


_NOT_READ = ("include", "replicate", "composite", "flexcomp", "attach")
_CHANGING_MASSES = frozenset(("balanceinertia", "boundinertia", "boundmass", "settotalmass"))
"""Options by which MuJoCo changes masses."""
_HOLDING_BODIES = ("connect", "weld")
"""Constraints that hold bodies together besides the joints."""
_LOOSE = {"ball": "ball", "free": "floating"}
"""Joints that no table has, by their names in MJCF: as other formats call them."""


def parse_mjcf(content: bytes, file: str) -> Robot:
    """The robot of an MJCF text; `file` is what messages call it."""
    return model_of(written_tree_of(content, file, is_deep=True), file).whole("hinge, slide")


read_mjcf = partial(read_file, parse_mjcf)
"""The robot of an MJCF file."""


def whole_tree_of(content: bytes, path: Path) -> etree._Element:
    """The elements of an MJCF and of the files that it includes."""
    root = tree_of(content, str(path), is_deep=True)
    missing = include_files(root, path)
    if missing:
        raise ProofError(say("include-refused", mark_of(each.include), reason=each.message) for each in missing)
    return root


def model_of(root: etree._Element, file: str) -> Model:
    """The model of a tree of elements."""
    return _Reader(root, file).model()


class _Reader(Shapes):
    """Reads one tree."""

    def __init__(self, root: etree._Element, file: str) -> None:
        super().__init__(root, file)
        if root.tag != "mujoco":
            raise self.error(root, "root-element-other", found=str(root.tag), accepted="mujoco")
        self._nameless_in = defaultdict[str, int](lambda: 1)  # by their place, the bodies and sites without a name
        for element in root.iter(*_NOT_READ):
            how = "mujoco.mj_saveLastXML writes a model without it"
            raise ProofError(say("not-read", self.mark(element), what=f"the element {element.tag}", suggestion=how))
        if (where := self.compiler.get("coordinate", "local")) != "local":
            mark = self.mark(root.findall("compiler")[-1])
            raise ProofError(say("coordinates-not-local", mark, found=f"coordinate={where}"))
        self._references: dict[str, float] = {}

    def model(self) -> Model:
        root = self.root
        self.child(root, "worldbody")
        worlds = root.findall("worldbody")
        names = dict.fromkeys(worlds, WORLD)
        links, joints = [self._link(worlds, WORLD)], []
        bodies = {body.get("name") for world in worlds for body in world.iter("body")}
        taken = set(bodies)
        # Parents come before children; not by recursion, for an arm may have more links than Python's stack has places.
        for element in (each for world in worlds for each in world.iter("body", "site")):
            name = element.get("name") or self._nameless(element, taken)
            above = next(above for above in element.iterancestors() if above.tag != "frame")
            if above not in names:
                raise self.error(element, "element-misplaced", tag=element.tag, above=above.tag)
            if element.tag == "body":
                names[element] = name
                held = self._held(element, name, names[above])
                links += [Link(name=joint.child) for joint in held[:-1]]
                links.append(self._link([element], name))
                joints += held
            elif name not in bodies:
                links.append(Link(name=name))
                joints.append(fixed(name, names[above], self.pose(element)))
        for name in sorted(_CHANGING_MASSES & self.compiler.keys()):
            self.not_read(root.findall("compiler")[-1], f"the option {name} of the compiler")
        doubly = {names[body] for body in self._looped(worlds)}
        robot = Robot(name=root.get("model") or "MuJoCo Model", links=tuple(links), joints=tuple(joints))
        return Model(robot, self.loose, self.unread, self.faulty, doubly, references=self._references)

    def _looped(self, worlds: Sequence[etree._Element]) -> Iterator[etree._Element]:
        """The bodies with which constraints close loops: those of one tree, and not what a mouse drags (mocap)."""
        named = {(each.tag, each.get("name")): each for world in worlds for each in world.iter("body", "site")}
        for constraint in self.root.iterfind("equality/*"):
            if constraint.tag == "joint" or not self.is_active(constraint):
                continue
            self.not_read(constraint, f"the constraint {constraint.tag}")
            if constraint.tag not in _HOLDING_BODIES:
                continue
            keys = [(tag, constraint.get(f"{tag}{number}")) for number in "12" for tag in ("body", "site")]
            found = [named[key] for key in keys if key[1] and key in named]
            bodies = [each if each.tag == "body" else next(each.iterancestors("body"), None) for each in found]
            held = [body for body in bodies if body is not None]
            trees = {self._free(body) for body in held} | ({None} if len(held) == 1 else set())
            if len(trees) <= 1 and not any(body.get("mocap") == "true" for body in held):
                yield from held

    def _free(self, body: etree._Element) -> etree._Element | None:
        """The body that moves freely and holds a body, or is the body; None where the world holds it."""
        for each in (body, *body.iterancestors("body")):
            if any(_type(joint, dict(joint.items())) == "free" for joint in self.held(each, "joint", "freejoint")):  # type: ignore[arg-type]
                return each
        return None

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
        pose = self.pose(body)
        moving = list(self.held(body, "joint", "freejoint"))
        held: list[Joint] = []
        for number, element in enumerate(moving, start=1):
            attributes = self.attributes(element)
            # A frame turns the axis and moves the anchor.
            anchor = self.vector(element, attributes, "pos", ZERO)
            turn, anchor = self.around(element, RigidTransform(IDENTITY_ROTATION, anchor))
            kind, axis = self._motion(element, attributes)
            axis = axis if turn == IDENTITY_ROTATION else rotate(turn, axis)
            is_sliding = kind is JointType.PRISMATIC
            unit = 1.0 if is_sliding else self.angle
            # A ball and a free joint have no reference value, whatever is written.
            (value,) = (0.0,) if kind is JointType.FIXED else self.numbers(element, attributes, "ref", (0.0,))
            # At the reference value the body is where it is written, so at 0 it has moved back by that value.
            turned = IDENTITY_ROTATION if is_sliding or not value else axis_rotation(axis, -unit * value)
            back = RigidTransform(turned, scale(-value, axis) if is_sliding else ZERO)
            child = name if number == len(moving) and anchor == ZERO else f"{name} after joint {number}"
            joint = Joint(
                name=attributes.get("name") or f"joint of {child}",
                type=kind,
                parent=holder,
                child=child,
                origin=Origin.of(pose @ RigidTransform(IDENTITY_ROTATION, anchor) @ back),
                axis=axis,
                mark=self.mark(element),
                **self._numbers(element, attributes, kind, unit),
            )
            if kind is JointType.FIXED:
                self.loose[joint.name] = _LOOSE[_type(element, attributes)]
            else:
                self._references[joint.name] = unit * value
            held.append(joint)
            pose, holder = RigidTransform(IDENTITY_ROTATION, scale(-1.0, anchor)), child
        if not held or held[-1].child != name:
            held.append(fixed(name, holder, pose))
        return held

    def _motion(self, element: etree._Element, attributes: dict[str, str]) -> tuple[JointType, Vec3]:
        """How a joint moves, and about or along which unit vector; one that no table has is fixed."""
        kind = _type(element, attributes)
        if kind in _LOOSE:
            return JointType.FIXED, Z_AXIS
        axis = self.vector(element, attributes, "axis", Z_AXIS)
        if (length := norm(axis)) < SMALLEST:
            raise self.error(element, "axis-of-length-0")
        axis = axis if length == 1.0 else scale(1.0 / length, axis)
        if kind == "slide":
            return JointType.PRISMATIC, axis
        if kind != "hinge":
            raise self.error(element, "joint-type-unknown", kind=kind)
        is_bounded = self.limits(element, attributes, "range", "limited") is not None
        return (JointType.REVOLUTE if is_bounded else JointType.CONTINUOUS), axis

    def _numbers(
        self, element: etree._Element, attributes: dict[str, str], kind: JointType, unit: float
    ) -> dict[str, Any]:
        """The limits of a joint and what resists its motion."""
        bounds = None if kind is JointType.FIXED else self.limits(element, attributes, "range", "limited")

        def number(field: str, joint: etree._Element) -> float | None:
            if field in BOUNDS:
                return unit * bounds[BOUNDS.index(field)] if bounds else None
            if field == "effort":
                limits = self.limits(joint, attributes, "actuatorfrcrange", "actuatorfrclimited")
                return limits[1] if limits else None
            word = "frictionloss" if field == "friction" else field
            return self.numbers(joint, attributes, word, (0.0,), most=3)[0] if word in attributes else None

        return self.numbers_of_joint(element, number, DYNAMICS)

    # Bodies

    def _link(self, bodies: Sequence[etree._Element], name: str) -> Link:
        """The link of a body; of several that are one, such as the world."""
        shapes = [self.shapes_of(body) for body in bodies]
        return Link(
            name=name,
            inertial=self.part(bodies[0], self._inertial, None, f"the mass of {shown(name)}"),
            visuals=tuple(visual for visuals, _ in shapes for visual in visuals),
            collisions=tuple(collision for _, collisions in shapes for collision in collisions),
        )

    def _inertial(self, body: etree._Element) -> Inertial | None:
        element = body.find("inertial")
        whence = self.compiler.get("inertiafromgeom")
        if body.tag == "body" and whence != "false" and (element is None or whence == "true"):
            return self.mass_of_shapes(body)
        if element is None:
            return None
        attributes = self.attributes(element)
        R, com = self.pose(element)
        (mass,) = self.numbers(element, attributes, "mass", (0.0,))
        name, count = ("fullinertia", 6) if "fullinertia" in attributes else ("diaginertia", 3)
        ixx, iyy, izz, *others = self.numbers(element, attributes, name, (0.0,) * count)
        ixy, ixz, iyz = others or ZERO
        inertia = Inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz)
        return Inertial(mass=mass, com=com, inertia=inertia if R == IDENTITY_ROTATION else rotated(inertia, R))


def _type(element: etree._Element, attributes: dict[str, str]) -> str:
    return "free" if element.tag == "freejoint" else attributes.get("type", "hinge")
