"""A URDF as the rules see it: what its joints hold, its bodies, and the files that it names, as functions of XPath."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache, cached_property
from itertools import product
from typing import TYPE_CHECKING, Any

from lxml import etree

from dh2urdf.documents import is_file
from dh2urdf.errors import Dh2UrdfError
from dh2urdf.kinematics.mass import principal_moments
from dh2urdf.manipulator import WORLD
from dh2urdf.robot import Mesh
from dh2urdf.rotations import add, norm, rotate, scale
from dh2urdf_check.finders import Document, numbers_of, text_of
from dh2urdf_check.meshes import MeshFile, is_found_by_pybullet, read_meshes, resolved
from dh2urdf_plugins.formats.urdf.reader import model_of
from dh2urdf_plugins.loaders.measures import edges

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path

    from dh2urdf.robot import Collision, Link, Robot, Visual
    from dh2urdf_check.document import Text

MOVING = ("revolute", "continuous", "prismatic", "floating", "planar")
_MOST_BYTES = 2**27
"""Size of all mesh files of a description that are read [B]."""
_TOO_WIDE = 2.0
"""How much wider than the shapes a body may be: shapes are simplified, and motors have no shape."""
_SMALLEST = 0.05
"""What a body without larger shapes may measure [m]: a rotor that is not drawn, a frame with a placeholder."""


class Urdf(Document):
    """A URDF: its links and joints, what moves as one body, and the files that it names."""

    def __init__(self, text: Text, place: Callable[[etree._Element], str], packages: Mapping[str, Path]) -> None:
        self.root = root = text.root
        self._packages = packages
        self._files: dict[str, Path | None] = {}
        self._links: dict[str, etree._Element] = {}  # the first of each name
        for element in root.iterchildren("link"):
            self._links.setdefault(element.get("name") or "", element)
        self._holders: dict[str, etree._Element] = {}  # by the name of a link, the first joint that holds it
        self._weighs: dict[etree._Element, bool] = {}  # whether a link, or what is fixed to it, has a mass
        self._held: dict[str, list[etree._Element]] = {}  # by the name of a link, those that joints fix to it
        for joint in root.iterchildren("joint"):
            parent, child = _end(joint, "parent"), _end(joint, "child")
            if parent in self._links and child in self._links:
                self._holders.setdefault(child, joint)
                if joint.get("type") == "fixed":
                    self._held.setdefault(parent, []).append(self._links[child])
        super().__init__(root, text.path, self._functions_of(), place)
        self.text = text.plain

    def _functions_of(self) -> dict[str, Callable[..., Any]]:
        """The functions of XPath; those of links take the element of a link, or its name."""
        roots = [link for name, link in self._links.items() if name and name not in self._holders]
        kinds = {joint.get("name"): joint.get("type") or "" for joint in self.root.iterchildren("joint")}
        # MuJoCo merges what is fixed to the world into it, unless the file says otherwise.
        fuses = self.root.find("mujoco/compiler[@fusestatic='false']") is None
        ends = ("parent", "child")
        joints = [(each.get("type"), *(_end(each, end) for end in ends)) for each in self.root.iterchildren("joint")]
        lost = {child for _, parent, child in joints if parent not in self._links}  # by joints of a parent that is none
        bearing = {parent for kind, parent, _ in joints if kind in MOVING}
        static = {each.get("name") for root in roots for each in self._body(root)} if fuses else {WORLD}

        def of_link(tell: Callable[[etree._Element], Any]) -> Callable[..., Any]:
            def told(_: object, found: Any) -> Any:  # noqa: ANN401 - what XPath has
                at = found[0] if isinstance(found, list) and found else found
                link = at if etree.iselement(at) else self._links.get(text_of(at))
                return [] if link is None else tell(link)

            return told

        def of_file(tell: Callable[[str], Any]) -> Callable[..., Any]:
            told = cache(tell)
            return lambda _, address: told(text_of(address))

        return {
            "holder": of_link(self._holder),
            "moves": of_link(lambda link: any(joint.get("type") in MOVING for joint in self._holder(link))),
            "body": of_link(self._body),
            "weightless": of_link(self._is_weightless),
            "implausible": of_link(lambda link: self._implausible.get(link.get("name") or "", "")),
            "static": lambda _, name: text_of(name) in static,
            "kind": lambda _, name: kinds.get(text_of(name), ""),
            "root": lambda _: roots[:1],
            "roots": lambda _: float(len(roots)),
            "lost": lambda _, name: text_of(name) in lost,
            "bears": lambda _, name: text_of(name) in bearing,
            "defined": lambda _, name: self._defined.get(text_of(name), []),
            "file": of_file(self._state),
            "in-pybullet": of_file(lambda address: is_found_by_pybullet(address, self.path)),
            "mesh": lambda _, address, what: getattr(self._mesh(text_of(address)), what),
            "extent": self._extent,
        }

    def _holder(self, link: etree._Element) -> list[etree._Element]:
        """The joint that holds a link, if there is one."""
        joint = self._holders.get(link.get("name") or "")
        return [] if joint is None else [joint]

    def _body(self, link: etree._Element) -> list[etree._Element]:
        """A link and all that is fixed to it, directly or not: what moves as one body."""
        found = dict.fromkeys([link])
        waiting = [link]
        while waiting:
            for each in self._held.get(waiting.pop().get("name") or "", ()):
                if each not in found:
                    found[each] = None
                    waiting.append(each)
        return list(found)

    def _is_weightless(self, link: etree._Element) -> bool:
        """Whether a link weighs nothing, and nothing that is fixed to it does; a mass that is no number is none."""
        for each in reversed(self._body(link) if link not in self._weighs else ()):  # What is fixed to it comes first.
            masses = [mass.get("value") for mass in each.iterfind("inertial/mass")]
            weighs = any(numbers_of(text or "0", 1) not in {None, (0.0,)} for text in masses)
            held = self._held.get(each.get("name") or "", ())
            self._weighs.setdefault(each, weighs or any(self._weighs.get(other) for other in held))
        return not self._weighs[link]

    @cached_property
    def robot(self) -> Robot | None:
        """The links and joints as far as they can be read, with axes of length 1, as readers make them; or None."""
        try:
            robot = model_of(self.root, str(self.path)).robot
        except (Dh2UrdfError, ValueError, OverflowError):  # Findings report what is wrong.
            return None
        unit = (replace(each, axis=scale(1.0 / (norm(each.axis) or 1.0), each.axis)) for each in robot.joints)
        return replace(robot, joints=tuple(unit))

    @cached_property
    def _implausible(self) -> dict[str, str]:
        """What is hardly meant of the masses of links beside their shapes, by name, as a sentence."""
        return {link.name: said for link in (self.robot.links if self.robot else ()) if (said := implausible(link))}

    @cached_property
    def _defined(self) -> dict[str, list[etree._Element]]:
        """The first definition of each material."""
        found: dict[str, list[etree._Element]] = {}
        for material in (*self.root.iterfind("material"), *self.root.iterfind("link/visual/material")):
            if material.getparent() is self.root or len(material):
                found.setdefault(material.get("name") or "", [material])
        return found

    # --- Files --------------------------------------------------------------------------------------------------------

    def _resolved(self, address: str) -> Path | None:
        if address not in self._files:
            self._files[address] = resolved(address, self.path, self._packages)
        return self._files[address]

    def _state(self, address: str) -> str:
        """Of the file that an address means: `there`, `missing`, or `package` where its package is not found."""
        path = self._resolved(address)
        return "package" if path is None else "there" if is_file(path) else "missing"

    @cached_property
    def _meshes(self) -> dict[Path, MeshFile]:
        """What is in the mesh files that are there, up to a size of them all."""
        paths: dict[Path, None] = {}
        left = _MOST_BYTES
        for mesh in self.root.iter("mesh"):
            path = self._resolved(mesh.get("filename") or "")
            if path and path not in paths and is_file(path) and (left := left - path.stat().st_size) >= 0:
                paths[path] = None
        return read_meshes(paths)

    def _mesh(self, address: str) -> MeshFile:
        path = self._resolved(address)
        return self._meshes.get(path, MeshFile()) if path else MeshFile()

    def _extent(self, context: Any) -> float:  # noqa: ANN401 - what XPath has
        """The longest side of a mesh as it is used [m]; 0 where it is not known."""
        file = self._mesh(context.context_node.get("filename") or "")
        factors = numbers_of(context.context_node.get("scale"), 3) or (1.0, 1.0, 1.0)
        sides = file.sides or (0.0, 0.0, 0.0)
        return max(abs(file.unit * side * factor) for side, factor in zip(sides, factors, strict=True))


def _end(joint: etree._Element, tag: str) -> str:
    end = joint.find(tag)
    return "" if end is None else end.get("link") or ""


def implausible(link: Link) -> str:
    """What is hardly meant of a link's mass, beside its shapes: its centre or its inertia, as a sentence."""
    body = link.inertial
    shapes: tuple[Visual | Collision, ...] = (*link.visuals, *link.collisions)
    if body is None or body.mass <= 0.0 or not shapes or any(isinstance(each.geometry, Mesh) for each in shapes):
        return ""
    corners = [
        add(shape.origin.xyz, rotate(shape.origin.transform.rotation, (x, y, z)))
        for shape in shapes
        for x, y, z in product(*((-side / 2, side / 2) for side in edges(shape.geometry) or ()))
    ]
    sides = [(min(axis), max(axis)) for axis in zip(*corners, strict=True)]
    diagonal = max(math.hypot(*(high - low for low, high in sides)), _SMALLEST)
    outside = math.hypot(*(max(low - c, c - high, 0.0) for (low, high), c in zip(sides, body.com, strict=True)))
    if outside > _TOO_WIDE * diagonal:
        return f"the centre of mass is {outside:.3g} m outside its shapes, which measure {diagonal:.3g} m"
    # No point of a body is farther from its centre of mass than its radius of gyration asks for: I = m·k², k ≤ r.
    reach = max(*(math.dist(corner, body.com) for corner in corners), _SMALLEST)
    gyration = math.sqrt(max(*principal_moments(body.inertia), 0.0) / body.mass)
    if gyration <= _TOO_WIDE * reach:
        return ""
    return (
        f"the inertia is that of {body.mass:g} kg at a distance of {gyration:.3g} m, and its shapes reach {reach:.3g} m"
    )
