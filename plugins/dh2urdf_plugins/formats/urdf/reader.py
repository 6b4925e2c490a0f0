"""Reads URDF back into a robot: the other half of the proof, and the ground of lint.

Nothing here comes from the emitter. It is written from what URDF says (wiki.ros.org/urdf/XML), takes files of any
origin, and trusts none: `dh2urdf.documents.xml_elements` parses it, numbers must be finite. It
fixes nothing either: an axis that is no unit vector stays as it is, for the proof to find.
Elements that URDF leaves to others (``mujoco``, ``gazebo``, ``transmission``) are passed over.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from lxml import etree

from dh2urdf.columns import INERTIA, LIMITS
from dh2urdf.kinematics.mass import rotated
from dh2urdf.manipulator import JointType, new_inertia
from dh2urdf.robot import Follower, Inertial, Joint, Link, Material, Origin, Robot, new_inertial, new_link, new_origin
from dh2urdf.rotations import X_AXIS, Z_AXIS, ZERO, Vec3, rotation_from_rpy
from dh2urdf_plugins.formats.xml_files import FileElements, Model, number_of, read_file, written_tree_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.robot import Geometry

_LOOSE = ("floating", "planar")
"""Joints that no table has."""


def parse_urdf(content: bytes, file: str) -> Robot:
    """The robot of a URDF text; `file` is what messages call it."""
    return model_of(written_tree_of(content, file), file).whole()


read_urdf = partial(read_file, parse_urdf)
"""The robot of a URDF file."""


def model_of(root: etree._Element, file: str) -> Model:
    """The model of a tree of elements of any origin."""
    return _UrdfReader(file).model(root)


class _UrdfReader(FileElements):
    """Reads one tree; it knows the materials that were defined so far."""

    def __init__(self, file: str) -> None:
        super().__init__(file)
        self._materials: dict[str, Material | None] = {}

    def model(self, root: etree._Element) -> Model:
        if root.tag != "robot":
            raise self.error(root, "root-element-other", found=str(root.tag), accepted="robot")
        for element in root.iterchildren("material"):
            self._material(element)
        robot = Robot(
            name=self.text(root, "name"),
            links=tuple([self._link(element) for element in root.iterchildren("link")]),
            joints=tuple([self._joint(element) for element in root.iterchildren("joint")]),
        )
        return Model(robot, self.loose, self.unread, self.faulty)

    def _link(self, element: etree._Element) -> Link:
        inertial = element.find("inertial")
        return new_link(
            name=self.text(element, "name"),
            inertial=None if inertial is None else self.part(inertial, self._inertial, None),
            **self.shapes(element, self._placed, lambda visual: self._material(visual.find("material"))),
        )

    def _joint(self, element: etree._Element) -> Joint:
        parent = self.text(self.child(element, "parent"), "link")
        child = self.text(self.child(element, "child"), "link")
        return self.joint(element, self.text(element, "name"), parent, child, self._motion)

    def _motion(self, element: etree._Element) -> dict[str, Any]:
        """How a joint moves."""
        kind = self.kind(element, self.text(element, "type"), _LOOSE)
        axis, mimic = element.find("axis"), element.find("mimic")
        direction = Z_AXIS  # What the field holds of a fixed joint, which has none.
        if kind is not JointType.FIXED:
            direction = X_AXIS if axis is None else self._vector(axis, "xyz", X_AXIS)
        return {
            "type": kind,
            "origin": self._origin(element),
            "axis": direction,
            "follows": None if mimic is None else _follower(mimic),
            **self.numbers_of_joint(element, self._number, ("damping", "friction")),
        }

    def _number(self, field: str, joint: etree._Element) -> float | None:
        element = joint.find("limit" if field in LIMITS else "dynamics")
        if element is None or element.get(field) is None:
            return None
        return self._numbers(element, field, 1)[0]

    def _inertial(self, element: etree._Element) -> Inertial:
        tensor, origin = self.child(element, "inertia"), self._origin(element)
        inertia = new_inertia(**{name: self._numbers(tensor, name, 1)[0] for name in INERTIA})
        if origin.rpy != ZERO:
            inertia = rotated(inertia, rotation_from_rpy(origin.rpy))
        mass = self._numbers(self.child(element, "mass"), "value", 1)[0]
        return new_inertial(mass=mass, com=origin.xyz, inertia=inertia)

    def _material(self, element: etree._Element | None) -> Material | None:
        """A material that is defined here or was defined above, white where it has a texture only; None without."""
        if element is None:
            return None
        name, color, texture = element.get("name", ""), element.find("color"), element.find("texture")
        if color is not None or texture is not None:
            r, g, b, a = (1.0, 1.0, 1.0, 1.0) if color is None else self._numbers(color, "rgba", 4)
            address = "" if texture is None else texture.get("filename", "")
            self._materials[name] = Material(name=name, rgba=(r, g, b, a), texture=address)
        elif name not in self._materials:
            raise self.error(element, "material-undefined", name=name)
        return self._materials[name]

    def _placed(self, element: etree._Element) -> list[tuple[Geometry, Origin]]:
        """The parts of a shape, and where they are in the link."""
        geometry = self.child(element, "geometry")
        shape = next(geometry.iterchildren(etree.Element), None)
        if shape is None:
            raise self.error(geometry, "geometry-unknown")

        def numbers(name: str, count: int) -> Sequence[float]:
            if name == "scale" and shape.get(name) is None:
                return (1.0, 1.0, 1.0)
            return self._numbers(shape, name, count)

        return self.parts(shape, self._origin(element), numbers, partial(self.text, shape, "filename"))

    def _origin(self, parent: etree._Element) -> Origin:
        origin = parent.find("origin")
        if origin is None:
            return new_origin()
        return new_origin(xyz=self._vector(origin, "xyz", ZERO), rpy=self._vector(origin, "rpy", ZERO))

    def _vector(self, element: etree._Element, attribute: str, default: Vec3) -> Vec3:
        if element.get(attribute) is None:
            return default
        x, y, z = self._numbers(element, attribute, 3)
        return (x, y, z)

    def _numbers(self, element: etree._Element, attribute: str, count: int) -> list[float]:
        return self.read(element, attribute, self.text(element, attribute), count)


def _follower(mimic: etree._Element) -> Follower:
    multiplier, offset = mimic.get("multiplier", "1"), mimic.get("offset", "0")
    return Follower(mimic.get("joint", ""), number_of(multiplier), number_of(offset))
