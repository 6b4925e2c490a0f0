"""MJCF: the robot as a model for MuJoCo, with motors.

MuJoCo reads URDF too, but a URDF has no motors, no frames without bodies, and no contacts to leave out. The
elements are those of https://mujoco.readthedocs.io/en/stable/XMLreference.html; the layout is that of the models in
MuJoCo Menagerie: classes ``visual`` and ``collision``, collision shapes in group 3.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.columns import INERTIA
from dh2urdf.manipulator import WORLD, JointType
from dh2urdf.quantities import format_numbers
from dh2urdf.robot import Box, Cylinder, Follower, Mesh, Sphere, Visual, with_followers
from dh2urdf.rotations import ZERO, norm, quaternion_from_rotation, scale
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.formats.mjcf.bars import MASS, STIFF, THICKNESS, bars
from dh2urdf_plugins.formats.mjcf.home_contacts import touching_at_home
from dh2urdf_plugins.formats.mjcf.servos import servos
from dh2urdf_plugins.formats.urdf.writer import Notation, refused, serialise
from dh2urdf_plugins.home_pose import initial_position

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from dh2urdf.robot import Joint, Link, Origin, Robot
    from dh2urdf_plugins.formats.mjcf import MjcfOptions

DEEPEST = 490
"""Bodies, one within the other, that MuJoCo reads: its XML parser takes 500 elements, the outermost included."""

_JOINT_TYPES = {JointType.REVOLUTE: "hinge", JointType.CONTINUOUS: "hinge", JointType.PRISMATIC: "slide"}


def mjcf_files(robot: Robot, stem: str, options: MjcfOptions) -> tuple[EmittedFile]:
    """The MJCF of a robot, as ``<stem>.xml``."""
    touching = [] if options.excludes == "neighbours" else touching_at_home(robot)
    if options.excludes == "touching":  # at the start or always: the pairs of an SRDF, but for those that never do
        from dh2urdf_plugins.collision_pairs.options import PairOptions
        from dh2urdf_plugins.collision_pairs.search import robot_pairs

        found = robot_pairs(robot, PairOptions(trials=1)).disabled
        touching += [(pair.link1, pair.link2) for pair in found if pair.reason in {"Default", "Always"}]
    content = serialise(_Model(robot, options, touching).tree(), robot.comment)
    return (EmittedFile(name=f"{stem}.xml", content=content),)


class _Model:
    """A robot on its way to MJCF, which nests bodies, and has sites for frames that hold nothing."""

    def __init__(self, robot: Robot, options: MjcfOptions, touching: Iterable[tuple[str, str]]) -> None:
        self._robot, self._notation = robot, Notation()
        self._actuators, self._touching = options.actuators, touching
        self._servos = servos(robot) if options.actuators == "position" else {}
        self._bars = bars(robot) if options.followers == "connect" else {}
        self._carried = set(_carried(robot, self._servos))
        self._joint_to = {joint.child: joint for joint in robot.joints}
        self._holders = {joint.parent for joint in robot.joints}
        self._meshes: dict[Mesh, str] = {}

    def tree(self) -> etree._Element:
        root = etree.Element("mujoco", {"model": self._notation.text(self._robot.name)})
        # Roll, pitch and yaw as in URDF: about fixed axes, which are capital letters here.
        etree.SubElement(root, "compiler", {"angle": "radian", "eulerseq": "XYZ"})
        # A stiff servo on a light link makes an explicit integrator unstable.
        etree.SubElement(root, "option", {"integrator": "implicitfast"})
        # What joints have in common, shapes that are seen, and shapes that touch; no shape weighs anything.
        default = etree.SubElement(root, "default")
        if self._servos:  # They carry the weight within their efforts; without this word the arm would be weightless.
            etree.SubElement(default, "joint", {"actuatorgravcomp": "true"})
        seen = {"contype": "0", "conaffinity": "0", "group": "1", "mass": "0"}
        for name, attributes in (("visual", seen), ("collision", {"group": "3", "mass": "0"})):
            etree.SubElement(etree.SubElement(default, "default", {"class": name}), "geom", attributes)
        world = etree.Element("worldbody")
        self._append_bars(self._append_bodies(world))
        assets = etree.SubElement(root, "asset") if self._meshes else root
        for mesh, name in self._meshes.items():
            file = self._notation.text(mesh.filename)
            # MuJoCo refuses a mesh of little volume that is no shell. Its mass is none: bodies have inertias.
            form = {"name": name, "file": file, "scale": self._notation.numbers(mesh.scale), "inertia": "shell"}
            etree.SubElement(assets, "mesh", form)
        root.append(world)
        self._append_excludes(root)
        self._append_followers(root)
        if self._actuators != "none":
            self._append_actuators(root)
        self._append_home(root, world)
        return root

    def _append_bodies(self, world: etree._Element) -> dict[str, etree._Element]:
        """Appends the links, and returns the bodies by their names."""
        bodies: dict[str, etree._Element] = {}
        depth: dict[str, int] = {}
        for link in self._robot.links:  # Parents before children.
            joint = self._joint_to.get(link.name)
            if joint is None and link.name == WORLD:
                bodies[link.name], depth[link.name] = world, 0
                self._append_shapes(world, link)
                continue
            holder = bodies[joint.parent] if joint else world
            depth[link.name] = depth[joint.parent] + 1 if joint else 1
            if link.name == WORLD:
                raise refused(self._robot, "mujoco-link-world", joint)
            place = {"name": self._notation.name(link.name), **self._pose(joint.origin if joint else None)}
            # Whether a link is a mere frame on the one that holds it: flange and tool0.
            moves = joint is not None and (joint.type is not JointType.FIXED or link.name in self._robot.floating)
            is_body = link.inertial is not None and link.inertial.mass > 0.0
            is_frame = joint is not None and not (moves or is_body or link.visuals or link.collisions)
            if is_frame and link.name not in self._holders:
                etree.SubElement(holder, "site", place)
                continue
            if depth[link.name] > DEEPEST:
                raise refused(self._robot, "mujoco-chain-too-long", joint, most=DEEPEST)
            body = bodies[link.name] = etree.SubElement(holder, "body", place)
            if is_frame:  # It holds something, which a site cannot, and is looked for among the sites all the same.
                etree.SubElement(body, "site", {"name": place["name"]})
            if link.inertial and link.inertial.mass:
                if link.name in self._carried:
                    body.set("gravcomp", "1")
                numbers = self._notation.body(link.name, link.inertial)
                tensor = " ".join([numbers[name] for name in INERTIA])
                mass = {"pos": numbers["com"], "mass": numbers["mass"], "fullinertia": tensor}
                etree.SubElement(body, "inertial", mass)
            if moves and joint:
                etree.SubElement(body, *self._joint(joint))
            self._append_shapes(body, link)
        return bodies

    def _append_bars(self, bodies: dict[str, etree._Element]) -> None:
        """Appends the bars to the bodies that hold them, and to those of the followers the points where they end."""
        numbers = self._notation.numbers
        for bar in self._bars.values():
            name = self._notation.name(bar.name)
            body = etree.SubElement(bodies[bar.leader.parent], "body", {"name": name, "pos": numbers(bar.start)})
            middle, tensor = numbers(scale(0.5, bar.span)), numbers([MASS * norm(bar.span) ** 2] * 3)
            etree.SubElement(body, "inertial", {"pos": middle, "mass": numbers([MASS]), "diaginertia": tensor})
            hinge = {"name": name, "type": "hinge", "axis": numbers(bar.axis), "armature": numbers([bar.armature])}
            etree.SubElement(body, "joint", hinge)
            size, ends = numbers([THICKNESS * norm(bar.span)]), numbers((*ZERO, *bar.span))
            etree.SubElement(body, "geom", {"class": "visual", "type": "capsule", "size": size, "fromto": ends})
            etree.SubElement(body, "site", {"name": name, "pos": numbers(bar.span)})
            etree.SubElement(bodies[bar.link], "site", {"name": f"{name}_end", "pos": numbers(bar.end)})

    def _joint(self, joint: Joint) -> tuple[str, dict[str, str]]:
        if joint.type is JointType.FIXED:  # Its child floats.
            return "freejoint", {"name": self._notation.name(joint.name)}
        limits, numbers = joint.limits, self._notation.numbers
        attributes = {
            "name": self._notation.name(joint.name),
            "type": _JOINT_TYPES[joint.type],
            "axis": numbers(joint.axis),
        }
        if limits.lower is not None and limits.upper is not None:
            if not limits.lower < limits.upper:
                found = numbers((limits.lower, limits.upper))
                raise refused(self._robot, "mujoco-limits-of-no-way", joint, field="limits", found=found)
            attributes["range"] = numbers((limits.lower, limits.upper))
        if limits.effort:
            attributes["actuatorfrcrange"] = numbers((-limits.effort, limits.effort))
        servo = self._servos.get(joint.name)
        armature = servo.armature if servo else joint.armature
        dynamics = (("damping", joint.damping), ("frictionloss", joint.friction), ("armature", armature))
        for name, value in dynamics:
            if value is not None:
                attributes[name] = numbers((value,))
        return "joint", attributes

    def _append_shapes(self, body: etree._Element, link: Link) -> None:
        numbers = self._notation.numbers
        for shape in link.shapes:
            kind = "visual" if isinstance(shape, Visual) else "collision"
            match shape.geometry:  # MuJoCo counts sizes from the middle.
                case Box(size=(x, y, z)):
                    form = {"type": "box", "size": numbers((x / 2, y / 2, z / 2))}
                case Cylinder(radius=radius, length=length):
                    form = {"type": "cylinder", "size": numbers((radius, length / 2))}
                case Sphere(radius=radius):
                    form = {"type": "sphere", "size": numbers((radius,))}
                case Mesh() as mesh:
                    form = {"type": "mesh", "mesh": self._meshes.setdefault(mesh, f"mesh_{len(self._meshes) + 1}")}
            geom = etree.SubElement(body, "geom", {"class": kind, **form, **self._pose(shape.origin)})
            if isinstance(shape, Visual) and shape.material:
                geom.set("rgba", numbers(shape.material.rgba))

    def _pose(self, origin: Origin | None) -> dict[str, str]:
        """Where a body, site or shape is in the body that holds it; nothing where that is in its frame."""
        vectors = {"pos": origin.xyz, "euler": origin.rpy} if origin else {}
        return {name: self._notation.numbers(vector) for name, vector in vectors.items() if vector != ZERO}

    def _append_excludes(self, root: etree._Element) -> None:
        """Appends the pairs of neighbours, whose shapes may overlap at their joint, and those that touch.

        MuJoCo leaves out contacts between a body and its parent by itself, but not where the parent stands still: a
        base with a collision shape throws the arm.
        """
        pairs: dict[frozenset[str], tuple[str, str]] = {}
        for pair in (*self._neighbours(), *(pair for pair in self._touching if WORLD not in pair)):
            pairs.setdefault(frozenset(pair), pair)
        contact = etree.SubElement(root, "contact") if pairs else root
        for first, second in pairs.values():
            bodies = {"body1": self._notation.name(first), "body2": self._notation.name(second)}
            etree.SubElement(contact, "exclude", bodies)

    def _neighbours(self) -> Iterator[tuple[str, str]]:
        """The pairs of bodies that meet at a moving joint: those that it joins, and solid ones fixed to these."""
        rigid = {link.name: link.name for link in self._robot.links}
        for joint in self._robot.held_rigidly:
            rigid[joint.child] = rigid[joint.parent]
        solid: dict[str, list[str]] = {}
        for link in self._robot.links:
            if link.collisions:
                solid.setdefault(rigid[link.name], []).append(link.name)
        for joint in self._robot.moving_joints:
            firsts = dict.fromkeys([joint.parent, *solid.get(rigid[joint.parent], ())])
            seconds = dict.fromkeys([joint.child, *solid.get(joint.child, ())])
            yield from ((first, second) for first in firsts for second in seconds if first != WORLD)

    def _append_followers(self, root: etree._Element) -> None:
        """Appends a constraint for every joint that follows another one, and names the joint that leads both."""
        followers = self._robot.followers
        equality = etree.SubElement(root, "equality") if followers else root
        for name, law in followers.items():
            if bar := self._bars.get(name):
                own = self._notation.name(bar.name)
                ends = {"name": self._notation.name(name), "site1": own, "site2": f"{own}_end"}
                etree.SubElement(equality, "connect", {**ends, **STIFF})
                continue
            numbers = (*law.factors, 0.0, 0.0, 0.0)[:5]
            joints = {"joint1": self._notation.name(name)}
            joints |= {"joint2": self._notation.name(law.leader)} if law.leader else {}
            etree.SubElement(equality, "joint", {**joints, "polycoef": self._notation.numbers(numbers)})

    def _append_actuators(self, root: etree._Element) -> None:
        """Appends a motor or a servo for every joint that has an effort and follows no other, with the joint's name.

        The effort is its limit.

        The target of a servo stays inside the joint's limits.
        """
        joints = [joint for joint in self._robot.actuated_joints if joint.limits.effort]
        actuators = etree.SubElement(root, "actuator") if joints else root
        for joint in joints:
            name, effort = self._notation.name(joint.name), joint.limits.effort or 0.0
            force = self._notation.numbers((-effort, effort))
            attributes = {"name": name, "joint": name}
            if servo := self._servos.get(joint.name):
                attributes["kp"], attributes["kv"] = format_numbers((servo.stiffness, servo.damping))
                if joint.limits.lower is not None and joint.limits.upper is not None:
                    attributes["ctrlrange"] = self._notation.numbers((joint.limits.lower, joint.limits.upper))
            else:
                attributes["ctrlrange"] = force
            etree.SubElement(actuators, self._actuators, {**attributes, "forcerange": force})

    def _append_home(self, root: etree._Element, world: etree._Element) -> None:
        """Appends the pose in which the arm starts; the order of its numbers is that of joints and of actuators.

        What floats has seven of them: where it is, and a quaternion (w, x, y, z).
        """
        start = {joint.name: initial_position(joint) for joint in self._robot.actuated_joints}
        values = with_followers(start, self._robot.followers)
        values |= {bar.name: values[bar.leader.name] for bar in self._bars.values()}
        home: dict[str, tuple[float, ...]] = {self._notation.name(name): (value,) for name, value in values.items()}
        for link in self._robot.floating:
            joint = self._joint_to[link]
            *xyz, w = quaternion_from_rotation(joint.origin.transform.rotation)
            home[self._notation.name(joint.name)] = (*joint.origin.xyz, w, *xyz)
        if not home:
            return
        numbers = {
            "qpos": [number for joint in world.iter("joint", "freejoint") for number in home[joint.get("name", "")]]
        }
        if self._servos:
            servos = root.iterfind("actuator/position")
            numbers["ctrl"] = [number for servo in servos for number in home[servo.get("name", "")]]
        texts = {name: self._notation.numbers(values) for name, values in numbers.items()}
        etree.SubElement(etree.SubElement(root, "keyframe"), "key", {"name": "home", **texts})


def _carried(robot: Robot, servos: Collection[str]) -> Iterator[str]:
    """The links whose weight the servos carry: those that move, and that nothing lets fall.

    A joint without a servo does, and a base that floats.
    """
    moved, limp, followers = set[str](), set[str](), robot.followers
    for joint in robot.joints:  # Parents before children.
        moves = joint.type is not JointType.FIXED
        leader = followers.get(joint.name, Follower(joint.name)).leader
        if joint.parent in limp or joint.child in robot.floating or (moves and leader not in servos):
            limp.add(joint.child)
        elif moves or joint.parent in moved:
            moved.add(joint.child)
            yield joint.child
