"""Reads an SDF model back into a robot: the other half of the proof of the emitter `sdf`.

Nothing here comes from the writer. It is written from the specification (http://sdformat.org/spec?ver=1.7 and
http://sdformat.org/tutorials, "Pose Frame Semantics"): the pose of a link, joint or frame is relative to the frame that
it names, else a joint's to its child, a frame's to what it is attached to, and a link's to the model; the axis of a
joint is in the joint's frame.

The robot's root is ``world``, where the model stands. A frame becomes a link; whatever is rigidly held by its body and
posed relative to it hangs below it. A joint apart from its child's origin gets a link of its own between the two.
"""

from __future__ import annotations

from copy import deepcopy
from functools import partial
from typing import TYPE_CHECKING, Any

from lxml import etree

from dh2urdf.columns import BOUNDS, INERTIA, LIMITS
from dh2urdf.errors import ProofError
from dh2urdf.kinematics.mass import rotated
from dh2urdf.manipulator import WORLD, Inertia, JointType
from dh2urdf.robot import Follower, Inertial, Joint, Link, Material, Origin, Robot
from dh2urdf.rotations import IDENTITY, IDENTITY_ROTATION, Z_AXIS, RigidTransform, rotate
from dh2urdf.source import Mark, Messages, shown
from dh2urdf_plugins.formats.sdf.elements import (
    AT_INCLUDED,
    IN_MODEL,
    Places,
    SdfElements,
    flatten,
    is_true,
    leave_out_attached,
    modernise,
)
from dh2urdf_plugins.formats.xml_files import Model, fixed, number_of, read_file, written_tree_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.robot import Geometry

say = Messages(__file__)

UNLIMITED = 1e16
"""A limit from which on SDF means that there is none [rad or m]."""

_LOOSE = ("ball", "gearbox", "revolute2", "screw", "universal", AT_INCLUDED)
"""Joints that no table has."""


def parse_sdf(content: bytes, file: str) -> Robot:
    """The robot of the first model in an SDF text; `file` is what messages call it."""
    return model_of(written_tree_of(content, file), file).whole()


read_sdf = partial(read_file, parse_sdf)
"""The robot of the first model in an SDF file."""


def model_of(root: etree._Element, file: str) -> Model:
    """The first model in a tree of elements."""
    return _Reader(deepcopy(root), file).model()


class _Reader(SdfElements):
    """Reads the first model of one tree, which it changes."""

    def __init__(self, root: etree._Element, file: str) -> None:
        super().__init__(file)
        models = [*root.iterchildren("model"), *root.iterfind("world/model")] if root.tag == "sdf" else []
        if not models:
            included = [shown((uri.text or "").strip()) for uri in root.iterfind(".//include/uri")]
            how = f"it includes {included[0]}: give the file of that model" if included else None
            raise ProofError(say("no-model", Mark(file=file), suggestion=how))
        modernise(root)
        self._model, *others = models
        includes = [*self._model.iter("include")]
        outside = [*root.iterfind("include"), *root.iterfind("world/include")]
        words = f"{IN_MODEL}, which SDF has no more since version 1.7,"
        for what, elements in (
            ("a model besides the first one", others),
            ("an included model", [*includes, *outside]),
            ("a joint of the world", root.iterfind("world/joint")),
            (words, self._model.iterfind(f".//joint/axis/{IN_MODEL}")),
        ):
            for element in elements:
                self.not_read(element, what)
        canonical = flatten(self._model)
        if includes:
            leave_out_attached(self._model, self.not_read)
        self._places = Places(self, self._model, canonical)
        # A joint holds the link that its child is, or is rigidly joined to.
        self._joint_to: dict[str, etree._Element] = {}
        self._doubly = set[str]()
        for joint in self._model.iterchildren("joint"):
            if (body := self._places.body(self.word(joint, "child"))) == WORLD:
                raise self.error(joint, "joint-moves-world")
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
        is_static = is_true(self._model.findtext("static"))
        free = [] if is_static else [self.name(each) for each in self._model.iterchildren("link")]
        floating = tuple([name for name in free if name not in self._joint_to and name != WORLD])
        robot = Robot(name=self.name(self._model), links=tuple(links), joints=tuple(joints), floating=floating)
        return Model(robot, self.loose, self.unread, self.faulty, self._doubly)

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
            holder = places.holder(name, places.body(name) if element.tag == "frame" else WORLD)
            return [fixed(name, holder, places.between(holder, name))]
        holder = places.holder(name, places.body(self.word(joint, "parent")))
        key = places.key(joint)
        to_link = places.between(key, name)
        if to_link == IDENTITY:
            return [self._joint(joint, name, holder, places.between(holder, name))]
        moved = f"{self.name(joint)} frame"
        return [self._joint(joint, moved, holder, places.between(holder, key)), fixed(name, moved, to_link)]

    # Links and joints

    def _joint(self, element: etree._Element, child: str, parent: str, pose: RigidTransform) -> Joint:
        return self.joint(element, self.name(element), parent, child, partial(self._motion, Origin.of(pose)))

    def _motion(self, origin: Origin, element: etree._Element) -> dict[str, Any]:
        """How a joint moves, and from where."""
        kind = self.kind(element, _type(element), _LOOSE)
        numbers = self.numbers_of_joint(element, self._number, ("damping", "friction"))
        limits = numbers["limits"]
        if kind is JointType.REVOLUTE and limits.lower is None and limits.upper is None:
            kind = JointType.CONTINUOUS
        axis = Z_AXIS
        if kind is not JointType.FIXED:
            x, y, z = self.numbers(element, "axis/xyz", 3, Z_AXIS)
            axis = (x, y, z)
            xyz = element.find("axis/xyz")
            if xyz is not None and (frame := xyz.get("expressed_in")):
                axis = rotate(self._places.between(self._places.key(element), frame).rotation, axis)
        return {"type": kind, "origin": origin, "axis": axis, "follows": _follower(element), **numbers}

    def _number(self, field: str, joint: etree._Element) -> float | None:
        """A number; None where there is no word of it, an endless limit, or the −1 of an endless effort or speed."""
        if field not in LIMITS:
            return self.number(joint, f"axis/dynamics/{field}", None)
        value = self.number(joint, f"axis/limit/{field}", None)
        if value is None or abs(value) >= UNLIMITED or (value < 0 and field not in BOUNDS):
            return None
        return value

    def _link(self, element: etree._Element) -> Link:
        # SDF gives a link without mass properties 1 kg, and 1 kg·m² about each axis.
        usual, given = Inertial(mass=1.0, inertia=Inertia(ixx=1.0, iyy=1.0, izz=1.0)), element.find("inertial")
        return Link(
            name=self.name(element),
            inertial=usual if given is None else self.part(given, self._inertial, None),
            **self.shapes(element, self._placed, self._material),
        )

    def _inertial(self, element: etree._Element) -> Inertial:
        if element.get("auto") == "true":
            self.not_read(element, "a mass that follows from shapes")
        moments = {name: self.number(element, f"inertia/{name}", float(name[1] == name[2])) for name in INERTIA}
        R, com = self.pose(element)
        inertia = Inertia(**moments) if R == IDENTITY_ROTATION else rotated(Inertia(**moments), R)
        return Inertial(mass=self.number(element, "mass", 1.0), com=com, inertia=inertia)

    def _material(self, element: etree._Element) -> Material | None:
        """The colour of a shape; colours have no names in SDF."""
        if element.find("material/diffuse") is None:
            return None
        is_opaque = len((element.findtext("material/diffuse") or "").split()) == 3  # noqa: PLR2004 - red, green, blue
        r, g, b, *a = self.numbers(element, "material/diffuse", 3 if is_opaque else 4)
        return Material(name="", rgba=(r, g, b, *(a or (1.0,))))

    def _placed(self, element: etree._Element) -> list[tuple[Geometry, Origin]]:
        """The parts of a shape, and where they are in the link."""
        geometry, pose = element.find("geometry"), element.find("pose")
        shape = None if geometry is None else next(geometry.iterchildren(etree.Element), None)
        if shape is None or shape.tag == "empty":
            return []
        reference = None if pose is None else pose.get("relative_to")
        link = self.name(element.getparent())  # type: ignore[arg-type]  # it has one
        origin = self.origin(element)
        if reference is not None and reference != link:
            origin = Origin.of(self._places.between(link, reference) @ self.pose(element))

        def numbers(name: str, count: int) -> Sequence[float]:
            # Sizes that are not there are those of http://sdformat.org/spec?elem=geometry.
            usual = 0.5 if name == "radius" and shape.tag == "capsule" else 1.0
            return self.numbers(shape, name, count, (usual,) * count)

        return self.parts(shape, origin, numbers, partial(self.word, shape, "uri"))


def _type(joint: etree._Element) -> str:
    return joint.get("type", "").lower()


def _follower(joint: etree._Element) -> Follower | None:
    """How a joint follows another one, by SDF (http://sdformat.org/spec?ver=1.11&elem=joint) or by Drake's word for it.

    SDF: multiplier · (value of the leader − reference) + offset. Drake: multiplier · value of the leader + offset.
    """
    if (mimic := joint.find("axis/mimic")) is not None:
        multiplier = number_of(mimic.findtext("multiplier", "1"))
        offset, reference = (number_of(mimic.findtext(tag, "0")) for tag in ("offset", "reference"))
        return Follower(mimic.get("joint", ""), multiplier, offset - multiplier * reference)
    if (mimic := joint.find("{*}mimic")) is None:
        return None
    multiplier, offset = number_of(mimic.get("multiplier", "1")), number_of(mimic.get("offset", "0"))
    return Follower(mimic.get("joint", ""), multiplier, offset)
