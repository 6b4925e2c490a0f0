"""The values of statements, by one schema: numbers, transforms, shapes, payloads and meshes of YAML nodes."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

from dh2urdf.columns import INERTIA
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import Inertia, LinkGeometry, MeshShape, Payload
from dh2urdf.quantities import Dimension, QuantityError, evaluate
from dh2urdf.rotations import ZERO, RigidTransform, Vec3, nearest_rotation
from dh2urdf.source import Messages, Problem, did_you_mean
from dh2urdf_plugins.readers.header.units import refuse_doubt
from dh2urdf_plugins.readers.words.bounds import FULL_TURN, LARGEST_ANGLE, MEASURABLE_ARM
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.fields import said_of, words_for

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from dh2urdf.documents import Node
    from dh2urdf.source import Mark
    from dh2urdf_plugins.readers.header.units import Units

_MESSAGES = Messages(__file__)
ORTHONORMAL = 1e-9
"""Largest |RᵀR − 1| of a rotation that is taken without a word."""
NEARLY_ORTHONORMAL = 1e-4
"""Largest |RᵀR − 1| of one that is corrected, with a notice: four digits, as in 0.7071."""
_ROUNDED = 0.1
MORE_DIGITS = "write its elements with more digits, or as expressions such as sqrt(2)/2"
SHAPES = ("cylinder", "box", "capsule", "arm")


class Value(NamedTuple):
    """What a key takes: the method of `Values` that reads it, and what its numbers measure."""

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
BASE = PLACED | {"mass": Value("at_least_zero", Dimension.MASS), "geometry": Value("geometry"), **MESHES}
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


def say(code: str, at: Cell | Node, field: str, *, mark: Mark | None = None, **words: Any) -> Problem:  # noqa: ANN401
    """A problem of a statement, at the place and with the text of a cell or a node unless others are given."""
    return _MESSAGES(code, mark or at.mark, **{"field": field, "found": at.text, **words})


class _WrongError(Exception):
    """A value is wrong, and `add` has its problem."""


def refuse_unknown_keys(node: Node, keys: Iterable[str], what: str, add: Callable[[Problem], None]) -> None:
    """Notes the keys of a mapping that nothing reads."""
    keys = tuple(keys)
    for key in node.value if isinstance(node.value, dict) else ():
        if key not in keys:
            word = words_for("placements").get(key.casefold()) if "matrix" in keys else None
            advice = said_of("instead", word) if word else did_you_mean(key, keys)
            mark = node.key_mark(key)
            add(say("unknown-key", node, key, mark=mark, found=key, what=what, keys=keys, suggestion=advice))


class Values:
    """Reads values, and hands over what is wrong with them.

    Each public method but `read` and `entries` reads one kind of value, as `Value` names it.
    """

    def __init__(self, units: Units, add: Callable[[Problem], None], *, links: bool = False) -> None:
        """Takes the units of numbers, what is called with every problem, and whether meshes may be links elsewhere."""
        self.units, self.add, self._links = units, add, links

    def read(self, kind: str, node: Node, what: str, dimension: Dimension = Dimension.NUMBER) -> Any:  # noqa: ANN401
        """A value; None where something is wrong with it."""
        try:
            return getattr(self, kind)(node, what, dimension)
        except _WrongError:
            return None

    def entries(self, entries: Mapping[str, Node], keys: Mapping[str, Value], prefix: str = "") -> dict[str, Any]:
        """The values of some keys; None for each that is wrong."""
        known = {key: node for key, node in entries.items() if key in keys}
        return {key: self.read(keys[key].kind, node, prefix + key, keys[key].dimension) for key, node in known.items()}

    def _record(self, node: Node, what: str, keys: Mapping[str, Value], kind: str) -> dict[str, Any]:
        """The values of a mapping of some keys."""
        if not isinstance(node.value, dict):
            self._no_value(node, what, kind)
        refuse_unknown_keys(node, keys, what, self.add)
        found = self.entries(node.value, keys, f"{what}.")
        if None in found.values():
            raise _WrongError
        return found

    def _refuse(self, code: str, node: Node, what: str, **words: Any) -> NoReturn:  # noqa: ANN401 - of a sentence
        self.add(say(code, node, what, **words))
        raise _WrongError

    def _no_value(self, node: Node, what: str, kind: str, **words: Any) -> NoReturn:  # noqa: ANN401 - of a sentence
        self._refuse("no-value", node, what, is_a=node.describe(), accepted=said_of("accepted", kind), **words)

    # --- Numbers ------------------------------------------------------------------------------------------------------

    def number(self, node: Node, what: str, dimension: Dimension) -> float:
        """A number, in the table's unit where it names none."""
        if node.text is None or node.value is None or isinstance(node.value, bool):
            self._no_value(node, what, "number")
        units = self.units
        try:
            quantity = evaluate(node.text, dimension, units.unit_of(None, dimension), angle=units.in_functions)
            refuse_doubt(quantity, what, Cell(node.text, node.mark), dimension, units)
        except QuantityError as error:
            words = {"reason": error.message, "accepted": error.accepted, "suggestion": error.suggestion}
            self._refuse("no-quantity", node, what, **words)
        value, has_unit = abs(quantity.value), quantity.has_unit or units.angle
        if quantity.variable:
            self._refuse("nothing-moves", node, what)
        if dimension is Dimension.ANGLE and value > FULL_TURN and not has_unit:
            self._refuse("degrees-perhaps", node, what, text=node.text.strip())
        if dimension is Dimension.ANGLE and value > LARGEST_ANGLE:
            self._refuse("many-turns", node, what)
        return quantity.value

    def positive(self, node: Node, what: str, dimension: Dimension) -> float:
        """A number above 0."""
        number = self.number(node, what, dimension)
        return number if number > 0 else self._refuse("not-positive", node, what)

    def at_least_zero(self, node: Node, what: str, dimension: Dimension) -> float:
        """A number of 0 or more: a base of 0 kg has no body."""
        number = self.number(node, what, dimension)
        return number if number >= 0 else self._refuse("negative", node, what)

    def vector(self, node: Node, what: str, dimension: Dimension) -> Vec3:
        """A list of three numbers."""
        if not isinstance(node.value, list) or len(node.value) != 3:  # noqa: PLR2004 - the space has three dimensions
            self._no_value(node, what, "vector")
        x, y, z = (self.number(item, what, dimension) for item in node.value)
        return (x, y, z)

    def factors(self, node: Node, what: str, dimension: Dimension) -> Vec3:
        """One factor for all axes, or one for each."""
        return self.vector(node, what, dimension) if node.text is None else (self.number(node, what, dimension),) * 3

    # --- Transforms ---------------------------------------------------------------------------------------------------

    def placement(self, node: Node, what: str, dimension: Dimension) -> RigidTransform:
        """A rigid transform, as a mapping of xyz and rpy or as a matrix."""
        if isinstance(node.value, list):
            return self.matrix(node, what, dimension)
        return self._placed(node, what, self._record(node, what, PLACED, "placement"))

    def base(self, node: Node, what: str, dimension: Dimension) -> dict[str, Any]:
        """What `base` says, by attribute of a manipulator: the transform, and the base's body."""
        if not isinstance(node.value, dict):
            return {what: self.placement(node, what, dimension)}
        found = self._record(node, what, BASE, "placement")
        body = {f"{what}_{key}": value for key, value in meshes_of(found).items() if key not in PLACED}
        return body if found.keys().isdisjoint(PLACED) else {what: self._placed(node, what, found), **body}

    def _placed(self, node: Node, what: str, found: Mapping[str, Any]) -> RigidTransform:
        """The transform that values under the keys of `PLACED` say."""
        if "matrix" in found and (both := [key for key in ("xyz", "rpy") if key in found]):
            self._refuse("matrix-beside", node, what, mark=node.key_mark(both[0]), beside=both[0])
        matrix: RigidTransform | None = found.get("matrix")
        transform = matrix or RigidTransform.from_xyz_rpy(found.get("xyz", ZERO), found.get("rpy", ZERO))
        if (distance := math.hypot(*transform.translation)) > MEASURABLE_ARM:
            self._refuse("far-away", node, what, distance=f"{distance:.4g}", limit=f"{MEASURABLE_ARM:g}")
        return transform

    @staticmethod
    def _square(node: Node, size: int) -> list[Node]:
        """The elements of a square matrix, row by row; none where it is none."""
        rows = [row.value for row in node.value] if isinstance(node.value, list) else []
        items = [item for row in rows if isinstance(row, list) and len(row) == size for item in row]
        return items if len(rows) == size and len(items) == size * size else []

    def matrix(self, node: Node, what: str, _: Dimension) -> RigidTransform:
        """A rigid 4x4 matrix."""
        items, what = self._square(node, 4), what.removesuffix(".matrix")
        if not items:
            self._refuse("no-matrix", node, what, accepted=said_of("accepted", "placement"))
        kinds = 3 * (*3 * (Dimension.NUMBER,), Dimension.LENGTH) + 4 * (Dimension.NUMBER,)
        numbers = [self.number(item, what, kind) for item, kind in zip(items, kinds, strict=True)]
        a, b, c, x, d, e, f, y, g, h, i, z, *last = numbers
        if any(abs(number - wanted) > ORTHONORMAL for number, wanted in zip(last, (0, 0, 0, 1), strict=True)):
            self._refuse("not-rigid", items[12], what, found=", ".join(item.text or "" for item in items[12:]))
        rotation, deviation = nearest_rotation((a, b, c, d, e, f, g, h, i))
        if not deviation <= NEARLY_ORTHONORMAL:  # `not <=`: an overflow makes it NaN
            advice, limit = MORE_DIGITS if deviation < _ROUNDED else None, f"{NEARLY_ORTHONORMAL:g}"
            self._refuse("no-rotation", node, what, by=f"{deviation:.3g}", limit=limit, suggestion=advice)
        if deviation > ORTHONORMAL:
            self.add(say("rounded-rotation", node, what, found=None, by=f"{deviation:.1g}", suggestion=MORE_DIGITS))
        return self._placed(node, what, {"matrix": RigidTransform(rotation, (x, y, z))})

    # --- Bodies -------------------------------------------------------------------------------------------------------

    def defaults(self, node: Node, what: str, _: Dimension) -> dict[str, Any]:
        """The shape and the density of the links."""
        return self._record(node, what, DEFAULTS, "defaults")

    def geometry(self, node: Node, what: str, _: Dimension) -> LinkGeometry:
        """The shape of a link, such as ``{shape: cylinder, radius: 0.04}``."""
        return LinkGeometry(**self._record(node, what, _GEOMETRY, "geometry"))

    def shape(self, node: Node, what: str, _: Dimension) -> str:
        """The word for a shape."""
        text = node.text or ""
        return text if text in SHAPES else self._no_value(node, what, "shape", suggestion=did_you_mean(text, SHAPES))

    def payload(self, node: Node, what: str, _: Dimension) -> Payload:
        """What the arm carries at tool0: mass, centre of mass and inertia."""
        found = self._record(node, what, _PAYLOAD, "payload")
        if "mass" not in found:
            self._refuse("no-mass", node, "payload.mass", accepted=said_of("accepted", "payload"))
        return Payload(**found)

    def tensor(self, node: Node, what: str, dimension: Dimension) -> Inertia:
        """An inertia tensor, by its elements or as a symmetric matrix."""
        found: dict[str, float] = {}
        if isinstance(node.value, dict):
            found = self._record(node, what, _TENSOR, "tensor")
        elif not (items := self._square(node, 3)):
            self._no_value(node, what, "tensor")
        for name, item in zip(_MATRIX, items, strict=True) if not found else ():
            number = self.number(item, f"{what}.{name}", dimension)
            if found.setdefault(name, number) != number:
                one, other = f"{found[name]:.9g}", f"{number:.9g}"
                self._refuse("not-symmetric", item, what, element=name, one=one, other=other)
        if missing := next((name for name in INERTIA[:3] if name not in found), None):
            accepted = said_of("accepted", "tensor")
            self._refuse("half-a-tensor", node, f"{what}.{missing}", accepted=accepted, missing=missing)
        return Inertia(**found)

    # --- Meshes -------------------------------------------------------------------------------------------------------

    def mesh(self, node: Node, what: str, dimension: Dimension) -> MeshShape:
        """A mesh, as the path of its file or as a mapping with its place."""
        if isinstance(node.value, str):
            return self.file(node, what, dimension)
        if isinstance(node.value, dict) and "file" not in node.value:
            self._refuse("no-file", node, what, accepted=said_of("accepted", "mesh"))
        found = self._record(node, what, _MESH, "mesh")
        shape: MeshShape = found["file"]
        return replace(shape, pose=self._placed(node, what, found), scale=found.get("scale", shape.scale))

    def file(self, node: Node, what: str, _: Dimension) -> MeshShape:
        """The file of a mesh, beside the table or below its folder."""
        from dh2urdf.meshes import find_mesh

        if not node.text or not isinstance(node.value, str):
            self._no_value(node, what, "file")
        try:
            return MeshShape(file=find_mesh(node.text, Path(node.file).parent, links=self._links), mark=node.mark)
        except ConfigError as error:
            for problem in error.problems:
                self.add(replace(problem, mark=node.mark, field=what))
            raise _WrongError from None

    def drawn(self, node: Node, what: str, _: Dimension) -> bool:
        """What `visuals` or `collisions` of a table says: whether all links have them."""
        if node.value not in ("all", "none"):
            self._no_value(node, what, "drawn")
        return node.value == "all"


def meshes_of(found: Mapping[str, Any]) -> dict[str, Any]:
    """Values by key, with `mesh` as what is seen and what touches, where a key of these two does not give it."""
    others = {key: value for key, value in found.items() if key != "mesh"}
    return dict.fromkeys(MESH_KEYS[:2], found["mesh"]) | others if found.get("mesh") else others
