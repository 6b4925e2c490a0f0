"""What a table and the reader's options say about all rows: convention, units, base, tool, shapes."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from dh2urdf.documents import load_yaml
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, LinkGeometry, Manipulator
from dh2urdf.quantities import Dimension, QuantityError, Unit, find_unit, is_unit
from dh2urdf.rotations import IDENTITY, RigidTransform
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf_plugins.readers.cells import Cell, Units
from dh2urdf_plugins.readers.fields import ACCEPTED_CONVENTIONS, CONVENTION_CHOICES, convention_of
from dh2urdf_plugins.readers.meshes import MESH_KEYS, Meshes, MeshReader, drawn_or_not
from dh2urdf_plugins.readers.placements import TransformReader
from dh2urdf_plugins.readers.shapes import ShapeReader, refuse_unknown_keys

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from dh2urdf.documents import Node
    from dh2urdf.manipulator import DHRow

OPTIONS = "an option"
"""What marks name as the file of an option."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TableOptions:
    """What a table does not say itself; what it does say must not contradict it."""

    convention: str | None = field(
        default=None, metadata={"help": "standard (classic, distal) or modified (Craig, proximal)"}
    )
    length_unit: str | None = field(default=None, metadata={"help": "unit of lengths: m, cm, mm or µm; m by default"})
    angle_unit: str | None = field(default=None, metadata={"help": "unit of angles: rad or deg; rad by default"})
    base: str | dict[str, Any] | list[Any] | None = field(
        default=None, metadata={"help": "transform from base_link to the first DH frame: {xyz: [0, 0, 0.3], rpy: …}"}
    )
    tool: str | dict[str, Any] | list[Any] | None = field(
        default=None, metadata={"help": "transform from the last DH frame to tool0: {xyz: [0, 0, 0.1], rpy: …}"}
    )

    def __post_init__(self) -> None:
        """Refuses words that mean nothing in any table.

        Raises:
            TableError: the convention or a unit is none that is known; whoever reads options knows its place.
        """
        problems: list[Problem] = []
        Statements().say_options(self, problems.append)
        if problems:
            fields = {"units.length": "length_unit", "units.angle": "angle_unit"}
            raise TableError(
                replace(problem, mark=None, field=fields.get(problem.field or "", problem.field))
                for problem in problems
            )


@dataclass(slots=True)
class Statements:
    """What a table and the options say about all of its rows.

    Each may be said more than once, in the same sense; two senses are an error that names both places.

    Attributes:
        convention: the convention and where it is said.
        length: the unit of lengths and where it is declared.
        angle: the unit of angles and where it is declared.
        base: the base transform.
        tool: the tool transform.
        geometry: shape of the links.
        density: density of links without a mass [kg/m³].
        base_mass: mass of the base's body [kg].
        base_geometry: shape of the base's body.
        base_meshes: meshes of the base's body.
        visuals: whether links are seen.
        collisions: whether links touch.
    """

    convention: tuple[Convention, Mark] | None = None
    length: tuple[Unit, Mark] | None = None
    angle: tuple[Unit, Mark] | None = None
    base: RigidTransform | None = None
    tool: RigidTransform | None = None
    geometry: LinkGeometry = LinkGeometry()
    density: float | None = None
    base_mass: float | None = None
    base_geometry: LinkGeometry = LinkGeometry()
    base_meshes: Meshes = Meshes()
    visuals: bool | None = None
    collisions: bool | None = None

    def manipulator(
        self, name: str, rows: tuple[DHRow, ...], mark: Mark | None, notices: tuple[Problem, ...] = ()
    ) -> Manipulator:
        """The manipulator of some rows; the convention has been said."""
        return Manipulator(
            name=name,
            convention=self.convention[0] if self.convention else Convention.STANDARD,
            rows=rows,
            base=self.base or IDENTITY,
            tool=self.tool or IDENTITY,
            geometry=self.geometry,
            density=self.density,
            base_mass=self.base_mass,
            base_geometry=self.base_geometry,
            base_visual=self.base_meshes.visual,
            base_collision=self.base_meshes.collision,
            visuals=self.visuals,
            collisions=self.collisions,
            mark=mark,
            notices=notices,
        )

    def units(self) -> Units:
        """The units of numbers that name none."""
        return Units(length=self.length and self.length[0], angle=self.angle and self.angle[0])

    def say_convention(self, cell: Cell, add: Callable[[Problem], None]) -> None:
        """Takes a word for the convention."""
        convention = convention_of(cell.text)
        if convention is None:
            message = f"{shown(cell.text)} is no convention that is known" if cell.text else "the convention is empty"
            add(
                Problem(
                    message=message,
                    mark=cell.mark,
                    field="convention",
                    found=cell.text,
                    accepted=ACCEPTED_CONVENTIONS,
                    suggestion=did_you_mean(cell.text, [word for word in CONVENTION_CHOICES if len(word) > len("dh")])
                    if cell.text
                    else None,
                )
            )
        else:
            self.say_which(convention, cell, add)

    def say_which(self, convention: Convention, cell: Cell, add: Callable[[Problem], None]) -> None:
        """Takes the convention from what only it writes."""
        if self.convention is None:
            self.convention = (convention, cell.mark)
        elif self.convention[0] is not convention:
            add(
                Problem(
                    message=f"{shown(cell.text)} means the {convention} convention, and {self.convention[1]} says "
                    f"{self.convention[0]}",
                    mark=cell.mark,
                    field="convention",
                    found=cell.text,
                    accepted="one convention for the whole table",
                )
            )

    def say_unit(self, cell: Cell, dimension: Dimension, add: Callable[[Problem], None]) -> None:
        """Takes a declaration of the unit of lengths or of angles."""
        name = "angle" if dimension is Dimension.ANGLE else "length"
        try:
            unit = find_unit(cell.text, dimension)
        except QuantityError as error:
            add(
                Problem(
                    message=error.message,
                    mark=cell.mark,
                    field=f"units.{name}",
                    found=cell.text,
                    accepted=error.accepted,
                    suggestion=error.suggestion,
                )
            )
            return
        said = self.angle if name == "angle" else self.length
        if said and said[0] != unit:
            add(
                Problem(
                    message=f"{shown(cell.text)} contradicts the unit {said[0].symbol} that {said[1]} declares",
                    mark=cell.mark,
                    field=f"units.{name}",
                    found=cell.text,
                    accepted=f"one unit of {name} for the whole table",
                )
            )
        elif name == "angle":
            self.angle = (unit, cell.mark)
        else:
            self.length = (unit, cell.mark)

    def say_units(self, node: Node, add: Callable[[Problem], None]) -> None:
        """Takes `units`: a mapping of length and angle, or bare words such as ``mm, deg``."""
        keys = {"length": Dimension.LENGTH, "angle": Dimension.ANGLE}
        if isinstance(node.value, dict):
            for key, item in node.value.items():
                if key not in keys:
                    add(
                        Problem(
                            message=f"{shown(key)} is nothing that has a unit of its own",
                            mark=node.key_mark(key),
                            field=f"units.{key}",
                            found=key,
                            accepted="length, angle",
                            suggestion=did_you_mean(key, keys),
                        )
                    )
                elif item.text is None:
                    message = f"units.{key} is {item.describe()}"
                    add(Problem(message=message, mark=item.mark, field=f"units.{key}", accepted="the name of a unit"))
                else:
                    self.say_unit(Cell(item.text, item.mark), keys[key], add)
            return
        words = (node.text or "").replace(",", " ").replace(";", " ").split()
        for word in words if words and all(map(is_unit, words)) else ():
            angle = word.casefold() in ("rad", "deg", "°", "radian", "radians", "degree", "degrees")
            self.say_unit(Cell(word, node.mark), Dimension.ANGLE if angle else Dimension.LENGTH, add)
        if not words or not all(map(is_unit, words)):
            add(
                Problem(
                    message=f"units is {node.describe()}",
                    mark=node.mark,
                    field="units",
                    found=node.text,
                    accepted="{length: mm, angle: deg}, with m, cm, mm or µm and rad or deg",
                )
            )

    def say_transform(self, node: Node, what: str, add: Callable[[Problem], None]) -> None:
        """Takes `base` or `tool`: a rigid transform, and the base's body."""
        body = ("mass", "geometry", *MESH_KEYS) if what == "base" else ()
        transform = TransformReader(self.units(), add).read(node, what, other_keys=body)
        if body:
            self.say_body(node, add)
        if transform is None:
            return
        said = self.base if what == "base" else self.tool
        if said is not None and said != transform:
            message = f"{what} is said twice, and not alike: in the table and in {OPTIONS}"
            add(Problem(message=message, mark=node.mark, field=what, found=node.text, accepted=f"one {what}"))
        elif what == "base":
            self.base = transform
        else:
            self.tool = transform

    def say_options(self, options: TableOptions, add: Callable[[Problem], None]) -> None:
        """Takes the convention and the units of the options; base and tool follow when the units are known."""
        mark = Mark(file=OPTIONS)
        if options.convention is not None:
            self.say_convention(Cell(options.convention, mark), add)
        if options.length_unit is not None:
            self.say_unit(Cell(options.length_unit, mark), Dimension.LENGTH, add)
        if options.angle_unit is not None:
            self.say_unit(Cell(options.angle_unit, mark), Dimension.ANGLE, add)

    def say_defaults(self, node: Node, add: Callable[[Problem], None], other_keys: Iterable[str] = ()) -> None:
        """Takes `defaults`: the links' geometry and density."""
        if not isinstance(node.value, dict):
            message = f"defaults is {node.describe()}"
            add(Problem(message=message, mark=node.mark, field="defaults", accepted="{geometry: …, density: …}"))
            return
        refuse_unknown_keys(node, ("geometry", "density", *other_keys), "defaults", add)
        shapes = ShapeReader(self.units(), add)
        if geometry := node.value.get("geometry"):
            self.geometry = shapes.geometry(geometry, "defaults.geometry")
        if density := node.value.get("density"):
            self.density = shapes.positive(density, "defaults.density", Dimension.NUMBER)

    def say_what_is_drawn(self, entries: Mapping[str, Node], add: Callable[[Problem], None]) -> None:
        """Takes `visuals` and `collisions`: all or none."""
        if node := entries.get("visuals"):
            self.visuals = drawn_or_not(node, "visuals", add)
        if node := entries.get("collisions"):
            self.collisions = drawn_or_not(node, "collisions", add)

    def say_body(self, node: Node, add: Callable[[Problem], None]) -> None:
        """Takes mass, geometry and meshes of the base's body from `base`."""
        if not isinstance(node.value, dict):
            return
        shapes = ShapeReader(self.units(), add)
        if mass := node.value.get("mass"):
            self.base_mass = shapes.positive(mass, "base.mass", Dimension.MASS)
        if geometry := node.value.get("geometry"):
            self.base_geometry = shapes.geometry(geometry, "base.geometry")
        self.base_meshes = MeshReader(self.units(), add).read(node.value, "base.")

    def say_option_transforms(self, options: TableOptions, add: Callable[[Problem], None]) -> None:
        """Takes base and tool of the options."""
        for what, value in (("base", options.base), ("tool", options.tool)):
            if value is not None:
                text = value if isinstance(value, str) else json.dumps(value)
                try:
                    node = load_yaml(text if text.strip() else "~", OPTIONS, TableError)
                except TableError as error:
                    for problem in error.problems:
                        add(replace(problem, field=what))
                    continue
                self.say_transform(node, what, add)
