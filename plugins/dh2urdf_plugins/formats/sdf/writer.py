"""SDF: the robot as a model for Gazebo, whose frames stay frames.

Gazebo reads a URDF through sdformat, which lumps what a fixed joint holds into the link that carries it: tool0 is gone.
Here a link without mass is a ``<frame>`` of its own name, so that plugins, sensors and other models can refer to it.
What is in the file is as old as SDF 1.7, the first with frame semantics (http://sdformat.org/tutorials, "Pose Frame
Semantics"): Gazebo 11, all versions of the new Gazebo, and Drake read it.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.manipulator import WORLD, JointType
from dh2urdf.robot import Visual
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.base_bodies import links_at_rest, with_base_bodies
from dh2urdf_plugins.formats.urdf.writer import Notation, mimic, primitive, refused, serialise

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Joint, Link, Origin, Robot
    from dh2urdf_plugins.formats.sdf import SdfOptions

VERSION = "1.7"
MODEL = "__model__"
DRAKE = "http://drake.mit.edu"
"""The namespace of what Drake adds to SDF."""

# Names that mean something to sdformat, and the separator of nested models.
_NOT_A_NAME = re.compile(r"world|__.*__|.*::.*", re.DOTALL)


def sdf_files(robot: Robot, stem: str, options: SdfOptions) -> tuple[EmittedFile]:
    """The SDF of a robot, as ``<stem>.sdf``."""
    content = serialise(_Model(robot, fixed=options.fixed).tree(), robot.comment)
    return (EmittedFile(name=f"{stem}.sdf", content=content),)


class _Model:
    """A robot on its way to SDF, which knows bodies and, fixed to them, frames."""

    def __init__(self, robot: Robot, *, fixed: bool) -> None:
        robot = with_base_bodies(robot)
        self._robot, self._fixed, self._notation = robot, fixed, Notation()
        self._joint_to = {joint.child: joint for joint in robot.joints}
        # Of every link the body that it is or, where it has no mass, is fixed to: a link, or the model itself.
        self._carriers: dict[str, str] = {}
        self._free = dict(self._free_bodies())
        for link in robot.links:  # Parents before children.
            joint = self._joint_to.get(link.name)
            held = joint is None or joint.type is JointType.FIXED
            if link.name in self._free:
                self._carriers[link.name] = self._free[link.name]
            elif link.inertial and link.inertial.mass:
                if not held and set(self._carriers.values()) <= {MODEL}:
                    # The model's own frame, and with it base_link, would move with the first body.
                    raise refused(robot, "sdf-without-body-at-rest", joint)
                self._carriers[link.name] = link.name
            elif held:
                self._carriers[link.name] = self._carriers[joint.parent] if joint else MODEL
            else:
                raise refused(robot, "sdf-link-without-mass", joint, link=link.name)
        if set(self._carriers.values()) <= {MODEL}:
            raise refused(robot, "sdf-without-body")
        # The frame of the model goes with a body: one that nothing moves, where there is one.
        bodies = {*self._carriers.values()} - {MODEL}
        still = bodies & links_at_rest(robot)
        inner = [name for name, carrier in self._carriers.items() if carrier == MODEL and name != WORLD]
        if inner and not still:
            raise refused(robot, "sdf-without-body-at-rest", self._joint_to.get(inner[0]))
        self._first = next(link.name for link in robot.links if link.name in (still or bodies))

    def _free_bodies(self) -> Iterator[tuple[str, str]]:
        """The links that float, each with the body that it is or, where it has no mass, is fixed to."""
        rigid: dict[str, str] = {link: link for link in self._robot.floating}
        for joint in self._robot.held_rigidly:  # Parents before children.
            if joint.parent in rigid:
                rigid[joint.child] = rigid[joint.parent]
        bodies = [link.name for link in self._robot.links if link.inertial and link.inertial.mass]
        for link in self._robot.floating:
            body = next((name for name in bodies if rigid.get(name) == link), None)
            if body is None:
                raise refused(self._robot, "sdf-link-without-mass", self._joint_to[link], link=link)
            yield link, body

    def tree(self) -> etree._Element:
        follow = any(joint.follows for joint in self._robot.joints)
        sdf = etree.Element("sdf", {"version": VERSION}, nsmap={"drake": DRAKE} if follow else None)
        model = etree.SubElement(sdf, "model", {"name": self._name(self._robot.name)})
        if self._free:
            model.set("canonical_link", self._first)
        bodies: dict[str, etree._Element] = {}
        for link in self._robot.links:
            joint, carrier = self._joint_to.get(link.name), self._carriers[link.name]
            if carrier == link.name:
                bodies[link.name] = self._append_link(model, link, joint)
                self._append_joint(model, link, joint)
            elif joint or link.name != WORLD:  # A root of this name is the world itself.
                frame = etree.SubElement(model, "frame", {"name": self._name(link.name, joint)})
                if joint:  # Attached to a body: Drake misplaces a frame that is attached to another one.
                    reference = _reference(joint.parent)
                    if carrier != MODEL:
                        frame.set("attached_to", carrier)
                        reference = reference or MODEL
                    self._append_pose(frame, joint.origin, None if reference == carrier else reference)
        bodies[MODEL] = bodies[self._first]
        for link in self._robot.links:
            self._append_shapes(bodies[self._carriers[link.name]], link)
        return sdf

    def _append_link(self, model: etree._Element, link: Link, joint: Joint | None) -> etree._Element:
        element = etree.SubElement(model, "link", {"name": self._name(link.name, joint)})
        if joint:
            self._append_pose(element, joint.origin, _reference(joint.parent))
        if link.inertial:
            inertial, numbers = etree.SubElement(element, "inertial"), self._notation.body(link.name, link.inertial)
            etree.SubElement(inertial, "pose").text = f"{numbers.pop('com')} 0 0 0"
            etree.SubElement(inertial, "mass").text = numbers.pop("mass")
            inertia = etree.SubElement(inertial, "inertia")
            for name, number in numbers.items():
                etree.SubElement(inertia, name).text = number
        return element

    def _append_joint(self, model: etree._Element, link: Link, joint: Joint | None) -> None:
        """Appends the joint that holds a body; on the world none, where nothing is to hold it there."""
        if link.name in self._free.values():
            return
        parent = self._carriers[joint.parent] if joint else MODEL
        if parent == MODEL:
            if not self._fixed and link.name == self._first:
                return
            parent = WORLD if self._fixed else self._first
        name = joint.name if joint else self._robot.mounting
        kind = joint.type if joint else JointType.FIXED
        element = etree.SubElement(model, "joint", {"name": self._name(name, joint), "type": kind.value})
        etree.SubElement(element, "parent").text = parent
        etree.SubElement(element, "child").text = link.name
        if joint is None or kind is JointType.FIXED:
            return
        axis = etree.SubElement(element, "axis")
        self._append_numbers(axis, "xyz", *joint.axis)
        limits = [(name, getattr(joint.limits, name)) for name in ("lower", "upper", "effort", "velocity")]
        losses = [(name, getattr(joint, name)) for name in ("damping", "friction")]
        for tag, numbers in (("limit", limits), ("dynamics", losses)):
            said = [(name, value) for name, value in numbers if value is not None]
            element = etree.SubElement(axis, tag) if said or tag == "limit" else axis
            for name, value in said:
                self._append_numbers(element, name, value)
        if law := mimic(joint, self._notation):  # in the words of SDF 1.11 and in those of Drake
            of_sdf = etree.SubElement(axis, "mimic", {"joint": law["joint"]})
            for name in ("multiplier", "offset"):
                etree.SubElement(of_sdf, name).text = law[name]
            self._append_numbers(of_sdf, "reference", 0.0)
            etree.SubElement(axis.getparent(), f"{{{DRAKE}}}mimic", law)  # type: ignore[arg-type]  # it has one

    def _append_shapes(self, body: etree._Element, link: Link) -> None:
        """Appends the shapes of a link to the body that carries it."""
        relative_to = None
        if self._carriers[link.name] != link.name:
            relative_to = _reference(link.name) or MODEL
        for shape in link.shapes:
            kind = "visual" if isinstance(shape, Visual) else "collision"
            element = etree.SubElement(body, kind, {"name": f"{kind}_{len(body.findall(kind)) + 1}"})
            self._append_pose(element, shape.origin, relative_to)
            tag, sizes = primitive(shape.geometry, self._notation)
            geometry = etree.SubElement(etree.SubElement(element, "geometry"), tag)
            for name, text in sizes.items():
                etree.SubElement(geometry, "uri" if name == "filename" else name).text = text
            if isinstance(shape, Visual) and shape.material:
                material = etree.SubElement(element, "material")
                for light in ("ambient", "diffuse"):
                    self._append_numbers(material, light, *shape.material.rgba)

    def _append_pose(self, parent: etree._Element, origin: Origin, relative_to: str | None = None) -> None:
        self._append_numbers(parent, "pose", *origin.xyz, *origin.rpy)
        if relative_to is not None:
            parent[-1].set("relative_to", relative_to)

    def _append_numbers(self, parent: etree._Element, tag: str, *numbers: float) -> None:
        etree.SubElement(parent, tag).text = self._notation.numbers(numbers)

    def _name(self, name: str, joint: Joint | None = None) -> str:
        if _NOT_A_NAME.fullmatch(name):
            raise refused(self._robot, "sdf-name-wrong", joint, found=name)
        return self._notation.text(name)


def _reference(link: str) -> str | None:
    """What a pose in the frame of a link is relative to; None for the model, which stands for the world."""
    return None if link == WORLD else link
