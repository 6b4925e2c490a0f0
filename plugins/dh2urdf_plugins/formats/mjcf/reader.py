"""Reads an MJCF model back into a robot: the other half of the proof of the emitter `mjcf`.

Nothing here comes from the writer. It is written from MuJoCo's documentation
(https://mujoco.readthedocs.io/en/stable/XMLreference.html and modeling.html): bodies are nested, a frame moves what is
in it, attributes may come from default classes, joints have reference values. What would need MuJoCo's compiler to be
known, such as ``<replicate>``, is refused rather than passed over.

The robot's root is ``world``. A site becomes a link, unless a body has its name. A joint that is not in its body's
origin, and each of several joints of a body, gets a link of its own. Shapes are made of those that a robot has: box,
cylinder, sphere and mesh.
"""

from __future__ import annotations

import math
from collections import defaultdict
from dataclasses import replace
from functools import partial
from math import comb
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.columns import BOUNDS, DYNAMICS
from dh2urdf.errors import ProofError
from dh2urdf.kinematics import axis_rotation
from dh2urdf.kinematics.mass import compound, placed, rotated, scaled, solid
from dh2urdf.manipulator import WORLD, Inertia, JointType
from dh2urdf.robot import Collision, Cylinder, Follower, Inertial, Joint, Link, Material, Mesh, Origin, Robot, Visual
from dh2urdf.rotations import (
    IDENTITY,
    IDENTITY_ROTATION,
    Z_AXIS,
    ZERO,
    RigidTransform,
    Vec3,
    cross,
    dot,
    norm,
    rotate,
    rotation_from_quaternion,
    scale,
    subtract,
    total,
    transpose,
)
from dh2urdf.source import Messages, shown
from dh2urdf_plugins.formats.mjcf.elements import SMALLEST, Elements, include_files
from dh2urdf_plugins.formats.xml_files import (
    Model,
    Placed,
    fixed,
    mark_of,
    number_of,
    parts_of,
    read_file,
    tree_of,
    written_tree_of,
)

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
_GRAY = (0.5, 0.5, 0.5, 1.0)
"""The colour of a shape that has none."""
_HIDDEN = ("3", "4", "5")
"""Groups that MuJoCo's viewer does not draw unless it is asked."""
_ROUND = ("cylinder", "capsule")
_LONG = (*_ROUND, "box", "ellipsoid")
"""Shapes that may be placed by their ends."""
_SIZES = {"box": 3, "ellipsoid": 3, "cylinder": 2, "capsule": 2, "sphere": 1}
"""How many sizes a shape has."""
_WATER = 1000.0
"""The density of a shape that has none [kg/m³]."""
PARALLELOGRAM = 1e-9
"""What the sides of a parallelogram may differ [m], and its axes [rad]."""
_WITHOUT_MASS = ("plane", "hfield")
"""Shapes that have no mass."""


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


class _Geom(NamedTuple):
    """A shape of a body."""

    element: etree._Element
    attributes: dict[str, str]  # of the element, those of its class included
    kind: str
    size: Vec3  # half of a box's sides or an ellipsoid's axes; else radius, and half of the length [m]
    pose: RigidTransform  # its frame in the body

    @property
    def touches(self) -> bool:
        """Whether it is more than what is seen."""
        return not self.attributes.get("contype") == self.attributes.get("conaffinity") == "0"


class _Bar(NamedTuple):
    """A bar by which a joint follows another one."""

    constraint: etree._Element  # that holds its end
    body: etree._Element
    hinge: etree._Element
    tip: etree._Element  # the site at its end
    link: etree._Element  # of the joint that follows
    end: etree._Element  # the site of the link where it ends


class _Reader(Elements):
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
        # A mesh without a name has that of its file.
        self._meshes = {
            mesh.get("name") or PurePosixPath((mesh.get("file") or "").replace("\\", "/")).stem: mesh
            for mesh in root.iterfind("asset/mesh")
        }
        self._materials = {each.get("name", ""): each for each in root.iterfind("asset/material")}

    def model(self) -> Model:
        root = self.root
        self.child(root, "worldbody")
        worlds = root.findall("worldbody")
        names = dict.fromkeys(worlds, WORLD)
        links, joints = [self._link(worlds, WORLD)], []
        bodies = {body.get("name") for world in worlds for body in world.iter("body")}
        taken, bars = set(bodies), self._bars(worlds)
        of_bars = {each for bar in bars for part in (bar.body, bar.end) for each in part.iter("body", "site")}
        # Parents come before children; not by recursion, for an arm may have more links than Python's stack has places.
        for element in (each for world in worlds for each in world.iter("body", "site") if each not in of_bars):
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
        doubly = {names[body] for body in self._looped(worlds, [bar.constraint for bar in bars])}
        followers = {
            joint.get("joint1", ""): self._follower(joint)
            for joint in root.iterfind("equality/joint")
            if self.is_active(joint)
        }
        holding = {joint.child: joint for joint in joints}
        followers |= {bar.constraint.get("name", ""): self._by_bar(bar, names, holding) for bar in bars}
        joints = [replace(each, follows=followers.get(each.name)) for each in joints] if followers else joints
        free = [each.child for each in joints if each.parent == WORLD and self.loose.get(each.name) == "floating"]
        name, floating = root.get("model") or "MuJoCo Model", tuple(free)
        robot = Robot(name=name, links=tuple(links), joints=tuple(joints), floating=floating)
        return Model(robot, self.loose, self.unread, self.faulty, doubly)

    def _follower(self, joint: etree._Element) -> Follower:
        """How a joint follows another: a polynomial of the distance from the reference values of both.

        https://mujoco.readthedocs.io/en/stable/XMLreference.html#equality-joint
        """
        leader = joint.get("joint2", "")
        factors = [*map(number_of, joint.get("polycoef", "0 1 0 0 0").split()), *[0.0] * 5][:5]
        own, reference = (self._references.get(name, 0.0) for name in (joint.get("joint1", ""), leader))
        # The same polynomial of the leader's value, by the binomial theorem: Σ c_k (x - r)^k.
        constant, multiplier, *higher = (
            total(factors[k] * comb(k, n) * (-reference) ** (k - n) for k in range(n, 5) if factors[k])
            for n in range(5)
        )
        if not leader:  # It keeps the value that it has where every joint has its reference value.
            constant, multiplier, higher = factors[0], 0.0, []
        return Follower(leader, multiplier, own + constant, tuple(higher) if any(higher) else ())

    def _bars(self, worlds: Sequence[etree._Element]) -> list[_Bar]:
        """The bars by which joints follow: those of constraints that have the name of a joint, ``<joint>_bar``."""
        named = [*filter(self.is_active, self.root.iterfind("equality/connect[@name]"))]
        sites = {each.get("name"): each for world in worlds for each in world.iter("site")} if named else {}
        found = []
        for each in named:
            tip, end = (sites.get(each.get(name)) for name in ("site1", "site2"))
            body, link = (None if site is None else site.getparent() for site in (tip, end))
            if tip is None or end is None or body is None or link is None or link.tag != "body":
                continue
            hinge, held = body.find("joint"), body.find("body")
            if hinge is not None and held is None and body.get("name", "").rstrip("_") == f"{each.get('name')}_bar":
                found.append(_Bar(each, body, hinge, tip, link, end))
        return found

    def _by_bar(self, bar: _Bar, names: dict[etree._Element, str], above: dict[str, Joint]) -> Follower:
        """How a joint follows by a bar: the link of its leader turns with the bar, and its own link not at all.

        With a unit vector u along the axis and p from the leader's axis to the joint's, the bar is p, and its hinge is
        at a vector v from the leader's axis. Its end is at v from the joint's axis, where the joint has turned its link
        by the angle from there to v, and back by the leader's value.
        """
        joint, holder = above[names[bar.link]], next(bar.body.iterancestors("body", "worldbody"))
        pose, leader = joint.origin.transform, above.get(joint.parent)
        while leader and leader.type is JointType.FIXED:
            pose, leader = leader.origin.transform @ pose, above.get(leader.parent)
        if leader is None or leader.parent != names[holder] or joint.name != bar.constraint.get("name"):
            raise self.error(bar.constraint, "bar-without-parallelogram")
        origin, start = leader.origin.transform, self.pose(bar.body)
        pose = origin @ pose
        u, own = rotate(origin.rotation, leader.axis), rotate(pose.rotation, joint.axis)
        apart = subtract(pose.translation, origin.translation)
        along = scale(dot(apart, u), u)
        hinge = rotate(start.rotation, self.vector(bar.hinge, self.attributes(bar.hinge), "axis", Z_AXIS))
        span = rotate(start.rotation, self.pose(bar.tip).translation)
        v = subtract(subtract(start.translation, origin.translation), along)
        reached = rotate(pose.rotation, self.pose(bar.end).translation)
        sign = -1.0 if dot(u, own) < 0.0 else 1.0
        angle = math.atan2(dot(u, cross(reached, v)), dot(reached, v) - dot(reached, u) * dot(v, u))
        off = (
            norm(cross(u, own)),
            norm(cross(u, hinge)),
            norm(subtract(span, subtract(apart, along))),
            norm(subtract(rotate(axis_rotation(u, angle), reached), v)),
        )
        if not max(off) <= PARALLELOGRAM or JointType.PRISMATIC in {leader.type, joint.type}:
            raise self.error(bar.constraint, "bar-without-parallelogram")
        return Follower(leader.name, -sign, sign * round(angle, 12) + 0.0)

    def _looped(self, worlds: Sequence[etree._Element], known: Sequence[etree._Element]) -> Iterator[etree._Element]:
        """The bodies with which constraints close loops: those of one tree, and not what a mouse drags (mocap)."""
        named = {(each.tag, each.get("name")): each for world in worlds for each in world.iter("body", "site")}
        for constraint in self.root.iterfind("equality/*"):
            if constraint.tag == "joint" or constraint in known or not self.is_active(constraint):
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
        shapes = [self._shapes(body) for body in bodies]
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
            return self._mass_of_shapes(body)
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

    # Shapes

    def _shapes(self, body: etree._Element) -> tuple[tuple[Visual, ...], tuple[Collision, ...]]:
        """What a body is seen as, and what it touches with.

        A shape that touches is seen, too, unless it is hidden, or the body has shapes that are only seen.
        """
        visuals: list[Visual] = []
        collisions: list[Collision] = []
        elements = self.held(body, "geom")
        drawn = [found for element in elements if (found := self.part(element, self._drawn, None))]
        has_own_look = not all(geom.touches for geom, _, _ in drawn)
        for geom, parts, material in drawn:
            is_seen = not geom.touches or not (has_own_look or geom.attributes.get("group", "0") in _HIDDEN)
            for geometry, pose in parts:
                origin = Origin.of(geom.pose if pose is IDENTITY else geom.pose @ pose)
                if geom.touches:
                    collisions.append(Collision(geometry=geometry, origin=origin))
                if is_seen:
                    visuals.append(Visual(geometry=geometry, origin=origin, material=material))
        return tuple(visuals), tuple(collisions)

    def _geom(self, element: etree._Element) -> _Geom:
        """A shape of a body."""
        attributes = self.attributes(element)
        kind = attributes.get("type", "sphere")
        is_long = "fromto" in attributes and kind in _LONG
        count = 1 if is_long else 0 if "mesh" in attributes else _SIZES.get(kind, 0)
        numbers = self.numbers(element, attributes, "size", (0.0,) * count, most=3)
        if count and min(numbers) <= 0.0:
            accepted = "above 0" if is_long else f"{count} numbers above 0"
            text = shown(attributes.get("size", ""))
            raise self.error(element, "geom-size-wrong", text=text, accepted=accepted)
        x, y, z, *_ = (*numbers, 0.0, 0.0, 0.0)
        size = (x, y, z)
        if is_long:
            own, half = self.between_ends(element, attributes)
            size = (x, half if kind in _ROUND else x, half)
        else:
            own = self.own_pose(element, attributes)
        return _Geom(element, attributes, kind, size, self.around(element, own))

    def _drawn(self, element: etree._Element) -> tuple[_Geom, list[Placed], Material | None]:
        """A shape of a body, its parts, and its colour."""
        geom = self._geom(element)
        parts = self._mesh(geom) if "mesh" in geom.attributes else _parts(geom)
        if parts is None:
            self.not_read(element, f"a shape {shown(geom.kind)}")
        return geom, parts or [], self._colour(geom)

    def _mesh(self, geom: _Geom) -> list[Placed]:
        mesh = self._meshes.get(name := geom.attributes["mesh"])
        if mesh is None:
            raise self.error(geom.element, "mesh-undefined", name=name)
        attributes = self.attributes(mesh)
        if geom.kind != "mesh":
            self.not_read(geom.element, f"a shape {shown(geom.kind)} that is fitted to a mesh")
            return []
        if not (file := attributes.get("file", "")):
            self.not_read(mesh, "a mesh without a file")
            return []
        if self.compiler.get("strippath") == "true":
            file = PurePosixPath(file.replace("\\", "/")).name
        factors = self.vector(mesh, attributes, "scale", (1.0, 1.0, 1.0))
        w, x, y, z = self.numbers(mesh, attributes, "refquat", (1.0, 0.0, 0.0, 0.0))
        back = transpose(rotation_from_quaternion((x, y, z, w))) if (x, y, z) != ZERO else IDENTITY_ROTATION
        if back != IDENTITY_ROTATION and len(set(factors)) > 1:
            self.not_read(mesh, "a mesh that is turned by refquat and scaled")
            return []
        moved = rotate(back, self.vector(mesh, attributes, "refpos", ZERO))
        x, y, z = (0.0 - factor * value for factor, value in zip(factors, moved, strict=True))
        return [Placed(Mesh(filename=file, scale=factors), RigidTransform(back, (x, y, z)))]

    def _colour(self, geom: _Geom) -> Material | None:
        """The colour of a shape: its own unless that is the usual gray, else that of its material."""
        given = geom.attributes
        own = tuple(self.numbers(geom.element, given, "rgba", _GRAY))
        material = self._materials.get(given.get("material", ""))
        if material is not None and own == _GRAY:
            own = tuple(self.numbers(material, self.attributes(material), "rgba", (1.0, 1.0, 1.0, 1.0)))
        elif "rgba" not in given:
            return None
        r, g, b, a = own
        return Material(name="", rgba=(r, g, b, a))

    def _mass_of_shapes(self, body: etree._Element) -> Inertial | None:
        """The mass of a body that follows from its shapes, as MuJoCo computes it; None where it has none.

        https://mujoco.readthedocs.io/en/stable/XMLreference.html#body-inertial
        """
        bodies: list[Inertial] = []
        first, last = self.numbers(self.root, self.compiler, "inertiagrouprange", (0.0, 5.0))
        for geom in map(self._geom, self.held(body, "geom")):
            group, mass, density = (
                self.numbers(geom.element, geom.attributes, name, (default,))[0]
                for name, default in (("group", 0.0), ("mass", -1.0), ("density", _WATER))
            )
            is_weightless = geom.kind in _WITHOUT_MASS or mass == 0.0 or (mass < 0.0 and density == 0.0)
            if is_weightless or not first <= group <= last:
                continue
            shape = None if "mesh" in geom.attributes else _solid(geom)
            if shape is None or not shape.mass or geom.attributes.get("shellinertia") == "true":
                self.not_read(geom.element, "a mass that follows from a mesh or a shell")
                return None
            factor = density if mass < 0.0 else mass / shape.mass
            shape = Inertial(mass=factor * shape.mass, com=shape.com, inertia=scaled(shape.inertia, factor))
            bodies.append(placed(shape, geom.pose))
        return compound(bodies) if bodies else None


def _type(element: etree._Element, attributes: dict[str, str]) -> str:
    return "free" if element.tag == "freejoint" else attributes.get("type", "hinge")


def _parts(geom: _Geom) -> list[Placed] | None:
    """The parts of a shape, whose sizes MuJoCo counts from the middle; None of one that no robot has."""
    x, y, z = (2.0 * half for half in geom.size)
    numbers = {"size": (x, y, z), "radius": (geom.size[0],), "length": (y,)}
    kind = "sphere" if geom.kind == "ellipsoid" and x == y == z else geom.kind
    return None if kind == "mesh" else parts_of(kind, lambda name, _: numbers[name], str)


def _solid(geom: _Geom) -> Inertial | None:
    """A shape as a body of 1 kg/m³, in its own frame."""
    x, y, z = geom.size
    match geom.kind:
        case "box" | "cylinder" | "sphere" if parts := _parts(geom):
            return solid(parts[0].geometry, 1.0)
        case "ellipsoid":
            mass = 4.0 / 3.0 * math.pi * x * y * z
            ixx, iyy, izz = (mass / 5.0 * square for square in (y * y + z * z, x * x + z * z, x * x + y * y))
            return Inertial(mass=mass, inertia=Inertia(ixx=ixx, iyy=iyy, izz=izz))
        case "capsule":  # The half of a ball has 83/320 m r² across its axis about its centre of mass.
            mass, square = 2.0 / 3.0 * math.pi * x**3, x * x
            across = 83.0 / 320.0 * mass * square
            inertia = Inertia(ixx=across, iyy=across, izz=0.4 * mass * square)
            half = Inertial(mass=mass, com=(0.0, 0.0, 0.375 * x), inertia=inertia)
            turned = (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0)
            ends = [
                placed(half, RigidTransform(turn, (0.0, 0.0, end)))
                for turn, end in ((IDENTITY_ROTATION, y), (turned, -y))
            ]
            return compound([solid(Cylinder(radius=x, length=2.0 * y), 1.0), *ends])
    return None
