"""A model as SDF has it: links, joints and frames, and where they are when the joints move.

Written from the specification (http://sdformat.org/spec and its page "Pose Frame Semantics"), for SDF 1.7 and later: a
pose is relative to the frame that it names, or else to the model's; a joint's to its child link. As sdformat has no
kinematics of its own, the poses of moved joints are computed here, from its numbers.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from lxml import etree

from dh2urdf.documents import xml_root
from dh2urdf.kinematics import axis_rotation
from dh2urdf.manipulator import WORLD, Inertia
from dh2urdf.mass_properties import placed
from dh2urdf.measuring import Body, tensor
from dh2urdf.robot import Inertial
from dh2urdf.rotations import IDENTITY, IDENTITY_ROTATION, Z_AXIS, ZERO, RigidTransform, Vec3, scale

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

MODEL = "__model__"
ENDLESS = 1e16
"""A limit from which on sdformat means that there is none [rad or m]."""


class SdfJoint(NamedTuple):
    """A joint of a model.

    Attributes:
        name: its name.
        type: its type, in SDF's words.
        parent: name of the link that holds it.
        child: name of the link that it moves.
        axis: unit vector in the joint's frame.
        lower: smallest value; None where there is none [rad or m].
        upper: largest value; None where there is none [rad or m].
        velocity: largest speed [rad/s or m/s].
        effort: largest torque or force [N·m or N].
    """

    name: str
    type: str
    parent: str
    child: str
    axis: Vec3
    lower: float | None
    upper: float | None
    velocity: float | None
    effort: float | None


@dataclass(frozen=True, slots=True)
class SdfModel:
    """The model of an SDF text.

    Attributes:
        links: the links by name.
        joints: the joints, in the order of the text.
        outwards: the joints, each after the one that moves its parent.
        poses: of every link, joint and frame, the frame that its pose is relative to, and the pose at q = 0.
    """

    links: dict[str, Body]
    joints: tuple[SdfJoint, ...]
    outwards: tuple[SdfJoint, ...]
    poses: dict[str, tuple[str, RigidTransform]]

    def frames(self, q: Mapping[str, float]) -> dict[str, RigidTransform]:
        """Where every link and frame is in the model, at joint values by the joint's name [rad or m]."""
        still = self._at_rest()
        moved = {MODEL: IDENTITY, WORLD: IDENTITY}
        held = {joint.child for joint in self.joints}
        moved |= {name: still[name] for name in self.links if name not in held}
        for joint in self.outwards:
            holder = moved[joint.parent]
            to_joint = self._between(joint.parent, joint.name, still)
            to_child = self._between(joint.name, joint.child, still)
            moved[joint.child] = holder @ to_joint @ _motion(joint, q.get(joint.name, 0.0)) @ to_child
        for name in self.poses:
            if name not in moved:
                base, pose = self._on_link(name)
                moved[name] = moved[base] @ pose
        return moved

    def _on_link(self, name: str) -> tuple[str, RigidTransform]:
        """The link (or the model) that a frame moves with, and its pose there."""
        base, pose = self.poses[name]
        while base not in self.links and base in self.poses:
            base, step = self.poses[base]
            pose = step @ pose
        return base, pose

    def _at_rest(self) -> dict[str, RigidTransform]:
        """The poses of everything in the model at q = 0."""
        known = {MODEL: IDENTITY, WORLD: IDENTITY}
        for name in self.poses:
            way = [name]
            while way[-1] not in known:
                way.append(self.poses[way[-1]][0])
            for each in reversed(way[:-1]):
                base, pose = self.poses[each]
                known[each] = known[base] @ pose
        return known

    def _between(self, base: str, name: str, still: Mapping[str, RigidTransform]) -> RigidTransform:
        """The pose of one frame in another at q = 0; where it is written so, without a rounding."""
        relative_to, pose = self.poses[name]
        return pose if relative_to == base else still[base].inverse @ still[name]


def parse_sdf(text: bytes) -> SdfModel:
    """The first model of an SDF text.

    Raises:
        ValueError: the text is not XML, holds no model, or joints that lead to no link or in a loop; in words, to
            follow "it wrote".
    """
    try:
        root = xml_root(text)
    except etree.XMLSyntaxError as error:
        raise ValueError(f"no XML: {error.msg}") from error
    model = root.find(".//model")
    if model is None:
        raise ValueError("no model in it")
    links = {str(link.get("name")): _body(link) for link in model.findall("link")}
    joints = tuple(_joint(element) for element in model.findall("joint"))
    poses = {
        str(element.get("name")): _placed_at(element, element.findtext("child"))
        for kind in ("link", "joint", "frame")
        for element in model.findall(kind)
    }
    if not {end for joint in joints for end in (joint.parent, joint.child)} <= {*links, WORLD}:
        raise ValueError("a joint between other things than links")
    return SdfModel(links, joints, _outwards(joints), poses)


def _placed_at(element: Any, default: str | None) -> tuple[str, RigidTransform]:  # noqa: ANN401 - an element of lxml
    """The frame that the pose of a link, joint or frame is relative to, and the pose."""
    pose = element.find("pose")
    named = None if pose is None else pose.get("relative_to")
    return str(named or element.get("attached_to") or default or MODEL), _pose(element)


def _pose(element: Any) -> RigidTransform:  # noqa: ANN401 - an element of lxml
    words = (element.findtext("pose") or "0 0 0 0 0 0").split()
    x, y, z, roll, pitch, yaw = map(float, words)
    return RigidTransform.from_xyz_rpy((x, y, z), (roll, pitch, yaw))


def _body(link: Any) -> Body:  # noqa: ANN401 - an element of lxml
    """A link's mass properties; SDF gives a link without them 1 kg and the inertia 1, 1, 1."""
    inertial = link.find("inertial")
    if inertial is None:
        return Body(1.0, ZERO, IDENTITY_ROTATION)
    moments = {
        key: float(inertial.findtext(f"inertia/{key}") or (1.0 if key[1] == key[2] else 0.0))
        for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    }
    body = Inertial(mass=float(inertial.findtext("mass") or 1.0), inertia=Inertia(**moments))
    body = placed(body, _pose(inertial))
    return Body(body.mass, body.com, tensor(body.inertia))


def _joint(element: Any) -> SdfJoint:  # noqa: ANN401 - an element of lxml
    axis = element.find("axis")
    x, y, z = map(float, (element.findtext("axis/xyz") or "0 0 1").split()) if axis is not None else Z_AXIS
    return SdfJoint(
        name=str(element.get("name")),
        type=str(element.get("type")),
        parent=element.findtext("parent") or "",
        child=element.findtext("child") or "",
        axis=(x, y, z),
        lower=_limit(element, "lower"),
        upper=_limit(element, "upper"),
        velocity=_limit(element, "velocity"),
        effort=_limit(element, "effort"),
    )


def _limit(element: Any, name: str) -> float | None:  # noqa: ANN401 - an element of lxml
    """A limit; None where there is none: no word of it, an endless one, or the −1 of an endless effort or speed."""
    text = element.findtext(f"axis/limit/{name}")
    value = math.inf if text is None else float(text)
    endless = abs(value) >= ENDLESS or (value < 0 and name in {"velocity", "effort"})
    return None if endless else value


def _motion(joint: SdfJoint, q: float) -> RigidTransform:
    """How a joint value moves the child, in the joint's frame."""
    if joint.type == "fixed":
        return IDENTITY
    if joint.type == "prismatic":
        return RigidTransform(IDENTITY_ROTATION, scale(q, joint.axis))
    return RigidTransform(axis_rotation(joint.axis, q), ZERO)


def _outwards(joints: Sequence[SdfJoint]) -> tuple[SdfJoint, ...]:
    """The joints, each after the one that moves its parent.

    Raises:
        ValueError: some are in a loop.
    """
    held_by: dict[str, list[SdfJoint]] = {}
    for joint in joints:
        held_by.setdefault(joint.parent, []).append(joint)
    reached = [name for name in held_by if name not in {joint.child for joint in joints}]
    ordered: list[SdfJoint] = []
    for link in reached:  # It grows while it is read.
        ordered += held_by.get(link, [])
        reached += [joint.child for joint in held_by.get(link, [])]
    if len(ordered) < len(joints):
        raise ValueError("joints in a loop")
    return tuple(ordered)
