"""The values of statements, by one schema: numbers, transforms, shapes, payloads and meshes of YAML nodes."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import Inertia, LinkGeometry, MeshShape, Payload
from dh2urdf.quantities import Dimension, QuantityError, evaluate
from dh2urdf.rotations import ZERO, RigidTransform, Vec3, nearest_rotation
from dh2urdf.row_fields import INERTIA
from dh2urdf.source import Messages, did_you_mean
from dh2urdf_plugins.readers.header.units import refuse_doubt
from dh2urdf_plugins.readers.words.bounds import FULL_TURN, LARGEST_ANGLE, MEASURABLE_ARM
from dh2urdf_plugins.readers.words.cells import Cell

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from dh2urdf.documents import Node
    from dh2urdf.source import Problem
    from dh2urdf_plugins.readers.words.cells import Units

say = Messages(__file__)

ORTHONORMAL = 1e-9
"""Largest |RᵀR − 1| of a rotation that is taken without a word."""
NEARLY_ORTHONORMAL = 1e-4
"""Largest |RᵀR − 1| of one that is corrected, with a notice: four digits, as in 0.7071."""
_ROUNDED = 0.1
MORE_DIGITS = "write its elements with more digits, or as expressions such as sqrt(2)/2"
SHAPES = ("cylinder", "box", "capsule", "arm")


class Value(NamedTuple):
    """What a key takes.

    Attributes:
        kind: the method of `Values` that reads it.
        dimension: what its numbers measure.
    """

    kind: str
    dimension: Dimension = Dimension.NUMBER


MESH_KEYS = ("visual", "collision", "mesh")
"""Keys of a joint, and of the base, that hold meshes; `mesh` is both of the others."""
MESHES = dict.fromkeys(MESH_KEYS, Value("mesh"))
PLACED = {
    "xyz": Value("vector", Dimension.LENGTH),
    "rpy": Value("vector", Dimension.ANGLE),
    "matrix": Value("matrix"),
}
"""Keys that say where something stands: the matrix in place of the other two."""
BASE = PLACED | {
    "mass": Value("at_least_zero", Dimension.MASS),
    "geometry": Value("geometry"),
    **MESHES,
}
DEFAULTS = {"geometry": Value("geometry"), "density": Value("positive", Dimension.DENSITY)}
_GEOMETRY = {"shape": Value("shape"), "radius": Value("positive", Dimension.LENGTH)}
_PAYLOAD = {
    "mass": Value("positive", Dimension.MASS),
    "com": Value("vector", Dimension.LENGTH),
    "inertia": Value("tensor", Dimension.INERTIA),
}
_TENSOR = dict.fromkeys(INERTIA, Value("number", Dimension.INERTIA))
_MATRIX = ("ixx", "ixy", "ixz", "ixy", "iyy", "iyz", "ixz", "iyz", "izz")
_MESH = PLACED | {"file": Value("file"), "scale": Value("factors")}

ACCEPTED = {
    "number": "a number",
    "vector": "a list of three numbers",
    "placement": "{xyz: [0, 0, 0.3], rpy: [0, 0, pi]}, or a rigid 4x4 matrix as a list of four rows",
    "geometry": "{shape: cylinder, radius: 0.04}",
    "payload": "{mass: 2.5, com: [0, 0, 0.05], inertia: {ixx: 0.01, iyy: 0.01, izz: 0.004}}",
    "tensor": "{ixx: …, iyy: …, izz: …, ixy: …, ixz: …, iyz: …}, or three rows of three",
    "defaults": "{geometry: …, density: …}",
    "mesh": "the path of a file, or {file: link.stl, xyz: [0, 0, 0], rpy: [0, 0, 0], scale: 0.001}",
    "file": "the path of a file",
    "drawn": "all, none",
}
"""What is accepted for each kind of value, in words."""
_XYZ, _RPY = "write `xyz: [x, y, z]`", "write `rpy: [roll, pitch, yaw]`, or the whole as `matrix`"
_MEANT = dict.fromkeys(("x", "y", "z", "translation", "position", "offset", "origin", "trans", "pos"), _XYZ)
_MEANT |= dict.fromkeys(("rotation", "orientation", "quaternion", "quat", "euler", "roll", "pitch", "yaw", "rot"), _RPY)


def refuse_unknown_keys(node: Node, keys: Iterable[str], what: str, add: Callable[[Problem], None]) -> None:
    """Notes the keys of a mapping that nothing reads.

    Args:
        node: the mapping.
        keys: those that are read.
        what: what the mapping is.
        add: takes the problems.
    """
    keys = tuple(keys)
    meant = _MEANT if "matrix" in keys else {}
    for key in node.value if isinstance(node.value, dict) else ():
        if key not in keys:
            advice = meant.get(key.casefold()) or did_you_mean(key, keys)
            add(say("unknown-key", node.key_mark(key), field=key, found=key, what=what, keys=keys, suggestion=advice))


class Values:
    """Reads values, and hands over what is wrong with them.

    Every reader takes the node, the field as messages name it, and what its numbers measure. It returns None where
    something is wrong.
    """

    def __init__(self, units: Units, add: Callable[[Problem], None], *, links: bool = False) -> None:
        """Takes the units of numbers, what is called with every problem, and whether meshes may be links elsewhere."""
        self.units, self.add, self._links = units, add, links

    def no_value(self, node: Node, what: str, kind: str) -> None:
        """Notes that a value is of another kind than it has to be."""
        self.add(say("no-value", node.mark, field=what, found=node.text, is_a=node.describe(), accepted=ACCEPTED[kind]))

    def entries(self, entries: Mapping[str, Node], keys: Mapping[str, Value], prefix: str = "") -> dict[str, Any]:
        """The values of some keys; None for each that is wrong."""
        return {
            key: getattr(self, keys[key].kind)(node, prefix + key, keys[key].dimension)
            for key, node in entries.items()
            if key in keys
        }

    def record(self, node: Node, what: str, keys: Mapping[str, Value], kind: str) -> dict[str, Any] | None:
        """The values of a mapping, by key; None where one is wrong, or this is no mapping of these keys."""
        if not isinstance(node.value, dict):
            self.no_value(node, what, kind)
            return None
        refuse_unknown_keys(node, keys, what, self.add)
        found = self.entries(node.value, keys, f"{what}.")
        return None if None in found.values() else found

    # --- Numbers ------------------------------------------------------------------------------------------------------

    def number(self, node: Node, what: str, dimension: Dimension) -> float | None:
        """A number, in the table's unit where it names none."""
        if node.text is None or node.value is None or isinstance(node.value, bool):
            self.no_value(node, what, "number")
            return None
        try:
            quantity = evaluate(node.text, dimension, self.units.sure(dimension), angle=self.units.in_functions)
            refuse_doubt(quantity, what, Cell(node.text, node.mark), dimension, self.units)
        except QuantityError as error:
            self.add(
                say(
                    "no-quantity",
                    node.mark,
                    field=what,
                    found=node.text,
                    reason=error.message,
                    accepted=error.accepted,
                    suggestion=error.suggestion,
                )
            )
            return None
        value, has_unit = abs(quantity.value), quantity.has_unit or self.units.angle
        if quantity.variable:
            self.add(say("nothing-moves", node.mark, field=what, found=node.text))
        elif dimension is Dimension.ANGLE and value > FULL_TURN and not has_unit:
            self.add(say("degrees-perhaps", node.mark, field=what, found=node.text, text=node.text.strip()))
        elif dimension is Dimension.ANGLE and value > LARGEST_ANGLE:
            self.add(say("many-turns", node.mark, field=what, found=node.text))
        else:
            return quantity.value
        return None

    def positive(self, node: Node, what: str, dimension: Dimension) -> float | None:
        """A number above 0."""
        number = self.number(node, what, dimension)
        if number is not None and number <= 0:
            self.add(say("not-positive", node.mark, field=what, found=node.text))
        return number

    def at_least_zero(self, node: Node, what: str, dimension: Dimension) -> float | None:
        """A number of 0 or more: a base of 0 kg has no body."""
        number = self.number(node, what, dimension)
        if number is not None and number < 0:
            self.add(say("negative", node.mark, field=what, found=node.text))
        return number

    def vector(self, node: Node, what: str, dimension: Dimension) -> Vec3 | None:
        """A list of three numbers."""
        if not isinstance(node.value, list) or len(node.value) != 3:  # noqa: PLR2004 - the space has three dimensions
            self.no_value(node, what, "vector")
            return None
        x, y, z = (self.number(item, what, dimension) for item in node.value)
        return None if x is None or y is None or z is None else (x, y, z)

    def factors(self, node: Node, what: str, dimension: Dimension) -> Vec3 | None:
        """One factor for all axes, or one for each."""
        if isinstance(node.value, list):
            return self.vector(node, what, dimension)
        factor = self.number(node, what, dimension)
        return None if factor is None else (factor, factor, factor)

    # --- Transforms ---------------------------------------------------------------------------------------------------

    def placement(self, node: Node, what: str) -> RigidTransform | None:
        """A rigid transform, as a mapping of xyz and rpy or as a matrix."""
        if isinstance(node.value, list):
            return self.matrix(node, what)
        found = self.record(node, what, PLACED, "placement")
        return None if found is None else self.placed(node, what, found)

    def placed(self, node: Node, what: str, found: Mapping[str, Any]) -> RigidTransform | None:
        """The transform that values under the keys of `PLACED` say."""
        if "matrix" in found and (both := [key for key in ("xyz", "rpy") if key in found]):
            self.add(say("matrix-beside", node.key_mark(both[0]), field=what, beside=both[0]))
            return None
        matrix: RigidTransform | None = found.get("matrix")
        return matrix or self._near(
            RigidTransform.from_xyz_rpy(found.get("xyz", ZERO), found.get("rpy", ZERO)), node, what
        )

    def _near(self, transform: RigidTransform, node: Node, what: str) -> RigidTransform | None:
        """The transform, where it does not lead so far that nothing can be computed there."""
        distance = math.hypot(*transform.translation)
        if distance <= MEASURABLE_ARM:
            return transform
        limit = f"{MEASURABLE_ARM:g}"
        self.add(say("far-away", node.mark, field=what, distance=f"{distance:.4g}", limit=limit))
        return None

    def square(self, node: Node, size: int) -> list[Node]:
        """The elements of a square matrix, row by row; none where it is none."""
        rows = [row.value for row in node.value] if isinstance(node.value, list) else []
        items = [item for row in rows if isinstance(row, list) and len(row) == size for item in row]
        return items if len(rows) == size and len(items) == size * size else []

    def matrix(self, node: Node, what: str, _: Dimension = Dimension.NUMBER) -> RigidTransform | None:
        """A rigid 4x4 matrix."""
        items, what = self.square(node, 4), what.removesuffix(".matrix")
        if not items:
            self.add(say("no-matrix", node.mark, field=what, accepted=ACCEPTED["placement"]))
            return None
        kinds = (Dimension.NUMBER, Dimension.NUMBER, Dimension.NUMBER, Dimension.LENGTH)
        numbers = [self.number(item, what, kinds[index % 4]) for index, item in enumerate(items[:12])]
        last = [self.number(item, what, Dimension.NUMBER) for item in items[12:]]
        known = [number for number in (*numbers, *last) if number is not None]
        if len(known) < len(items):
            return None
        if any(abs(number - wanted) > ORTHONORMAL for number, wanted in zip(known[12:], (0, 0, 0, 1), strict=True)):
            text = ", ".join(item.text or "" for item in items[12:])
            self.add(say("not-rigid", items[12].mark, field=what, found=text))
            return None
        a, b, c, x, d, e, f, y, g, h, i, z = known[:12]
        rotation, deviation = nearest_rotation((a, b, c, d, e, f, g, h, i))
        if not deviation <= NEARLY_ORTHONORMAL:  # `not <=`: an overflow makes it NaN
            advice = MORE_DIGITS if deviation < _ROUNDED else None
            by, limit = f"{deviation:.3g}", f"{NEARLY_ORTHONORMAL:g}"
            self.add(say("no-rotation", node.mark, field=what, by=by, limit=limit, suggestion=advice))
            return None
        if deviation > ORTHONORMAL:
            self.add(say("rounded-rotation", node.mark, field=what, by=f"{deviation:.1g}", suggestion=MORE_DIGITS))
        return self._near(RigidTransform(rotation, (x, y, z)), node, what)

    # --- Bodies -------------------------------------------------------------------------------------------------------

    def geometry(self, node: Node, what: str, _: Dimension) -> LinkGeometry | None:
        """The shape of a link, such as ``{shape: cylinder, radius: 0.04}``."""
        found = self.record(node, what, _GEOMETRY, "geometry")
        return None if found is None else LinkGeometry(**found)

    def shape(self, node: Node, what: str, _: Dimension) -> str | None:
        """The word for a shape."""
        if node.text in SHAPES:
            return node.text
        advice = did_you_mean(node.text or "", SHAPES)
        kind = node.describe()
        self.add(say("no-value", node.mark, field=what, found=node.text, is_a=kind, accepted=SHAPES, suggestion=advice))
        return None

    def payload(self, node: Node, what: str) -> Payload | None:
        """What the arm carries at tool0: mass, centre of mass and inertia."""
        found = self.record(node, what, _PAYLOAD, "payload")
        if found is not None and "mass" not in found:
            self.add(say("no-mass", node.mark, field="payload.mass", accepted=ACCEPTED["payload"]))
            return None
        return None if found is None else Payload(**found)

    def tensor(self, node: Node, what: str, dimension: Dimension) -> Inertia | None:
        """An inertia tensor, by its elements or as a symmetric matrix."""
        if isinstance(node.value, dict):
            found = self.record(node, what, _TENSOR, "tensor")
        elif items := self.square(node, 3):
            found = {}
            for name, item in zip(_MATRIX, items, strict=True):
                number = self.number(item, f"{what}.{name}", dimension)
                if number is None:
                    return None
                if found.setdefault(name, number) != number:
                    one, other = f"{found[name]:.9g}", f"{number:.9g}"
                    self.add(say("not-symmetric", item.mark, field=what, element=name, one=one, other=other))
        else:
            self.no_value(node, what, "tensor")
            return None
        if missing := [name for name in INERTIA[:3] if name not in (found or INERTIA)]:
            name, accepted = f"{what}.{missing[0]}", ACCEPTED["tensor"]
            self.add(say("half-a-tensor", node.mark, field=name, accepted=accepted, missing=missing[0]))
            return None
        return None if found is None else Inertia(**found)

    # --- Meshes -------------------------------------------------------------------------------------------------------

    def mesh(self, node: Node, what: str, dimension: Dimension) -> MeshShape | None:
        """A mesh, as the path of its file or as a mapping with its place."""
        if isinstance(node.value, str):
            return self.file(node, what, dimension)
        if isinstance(node.value, dict) and "file" not in node.value:
            self.add(say("no-file", node.mark, field=what, accepted=ACCEPTED["mesh"]))
            return None
        found = self.record(node, what, _MESH, "mesh")
        pose = self.placed(node, what, found) if found else None
        if not found or pose is None:
            return None
        shape: MeshShape = found["file"]
        return replace(shape, pose=pose, scale=found.get("scale", shape.scale))

    def file(self, node: Node, what: str, _: Dimension) -> MeshShape | None:
        """The file of a mesh, beside the table or below its folder."""
        from dh2urdf.meshes import find_mesh

        if not node.text or not isinstance(node.value, str):
            self.no_value(node, what, "file")
            return None
        try:
            return MeshShape(file=find_mesh(node.text, Path(node.file).parent, links=self._links), mark=node.mark)
        except ConfigError as error:
            for problem in error.problems:
                self.add(replace(problem, mark=node.mark, field=what))
            return None

    def drawn(self, node: Node, what: str) -> bool | None:
        """What `visuals` or `collisions` of a table says: whether all links have them."""
        if node.value in ("all", "none"):
            return node.value == "all"
        self.no_value(node, what, "drawn")
        return None


def meshes_of(found: Mapping[str, Any]) -> dict[str, Any]:
    """Values by key, with `mesh` as what is seen and what touches, where a key of these two does not give it."""
    others = {key: value for key, value in found.items() if key != "mesh"}
    return dict.fromkeys(MESH_KEYS[:2], found["mesh"]) | others if found.get("mesh") else others
