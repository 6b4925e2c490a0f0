"""What a table and the reader's options say about all rows: convention, units, base, tool, shapes."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from dh2urdf.documents import load_yaml
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, LinkGeometry, Manipulator, MeshShape, Payload
from dh2urdf.quantities import (
    UNITS,
    Dimension,
    QuantityError,
    Symbols,
    Unit,
    accepted_units,
    find_unit,
    is_unit,
    unit_word,
)
from dh2urdf.rotations import IDENTITY, RigidTransform
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.table_text import Said
from dh2urdf_plugins.readers.header.columns import Columns
from dh2urdf_plugins.readers.header.units import KEY_OF, SI, UNIT_KEYS, table_units
from dh2urdf_plugins.readers.words.cells import Cell, Units
from dh2urdf_plugins.readers.words.fields import (
    ACCEPTED_CONVENTIONS,
    convention_of,
    convention_words,
    key_of,
    keys_in,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from dh2urdf.documents import Node
    from dh2urdf.manipulator import DHRow
    from dh2urdf_plugins.calibrations.calibration import CalibrationFile  # noqa: TC004 - only the tables with one need it

_OF_SI = (Dimension.LENGTH, Dimension.ANGLE)
_BETWEEN = r"\s*[/&]\s*|\s+(?:and|und|et|y|e)\s+|\s+"
OPTIONS = "an option"
"""What marks name as the file of an option."""


@dataclass(slots=True)
class Statements:
    """What a table and the options say about all of its rows.

    Each may be declared more than once, with the same value; two values are an error that names both places.

    Attributes:
        convention: the convention and where it is declared.
        stated: the units that are declared, by what they measure, and where.
        columns: the headers of the table, where it has some.
        base: the base transform.
        tool: the tool transform.
        geometry: shape of the links.
        density: density of links without a mass [kg/m³].
        base_mass: mass of the base's body [kg]; 0 for none.
        payload: what the arm carries at tool0.
        base_geometry: shape of the base's body.
        base_meshes: meshes of the base's body: what is seen, and what touches.
        mesh_links: whether meshes may be links out of the table's folder.
        calibration: the file of what is added to the rows.
        visuals: whether links are seen.
        collisions: whether links touch.
        placed: where base, tool, payload, shapes, masses and visuals are declared.
        symbols: what names of lengths and angles stand for.
        in_convention: the convention that the table is rewritten in.
        repair_pi: whether an angle that is nearly a multiple of π/2 is one.
        bare: the numbers among them that are in the SI unit since nothing says their unit, as `Units` has them.
    """

    convention: tuple[Convention, Mark] | None = None
    stated: dict[Dimension, tuple[Unit, Mark]] = field(default_factory=dict)
    columns: Columns | None = None
    base: RigidTransform | None = None
    tool: RigidTransform | None = None
    geometry: LinkGeometry = LinkGeometry()
    density: float | None = None
    base_mass: float | None = None
    payload: Payload | None = None
    base_geometry: LinkGeometry = LinkGeometry()
    base_meshes: tuple[MeshShape | None, MeshShape | None] = (None, None)
    mesh_links: bool = False
    calibration: CalibrationFile | None = None
    visuals: bool | None = None
    collisions: bool | None = None
    placed: dict[str, Mark] = field(default_factory=dict)
    bare: dict[Dimension, tuple[str, Cell]] = field(default_factory=dict)
    symbols: Symbols = field(default_factory=Symbols)
    repair_pi: bool = False
    in_convention: Convention | None = None

    def manipulator(
        self, name: str, rows: tuple[DHRow, ...], mark: Mark | None, notices: tuple[Problem, ...] = ()
    ) -> Manipulator:
        """The manipulator of some rows; the convention is known."""
        base_visual, base_collision = self.base_meshes
        return Manipulator(
            name=name,
            convention=self.convention[0] if self.convention else Convention.STANDARD,
            rows=rows,
            base=self.base or IDENTITY,
            tool=self.tool or IDENTITY,
            geometry=self.geometry,
            density=self.density,
            base_mass=self.base_mass,
            payload=self.payload,
            base_geometry=self.base_geometry,
            base_visual=base_visual,
            base_collision=base_collision,
            visuals=self.visuals,
            collisions=self.collisions,
            mark=mark,
            notices=notices,
        )

    def traced(self, name: Cell) -> dict[str, Said]:
        """What the table declares for all rows, and where."""
        said = {"name": Said(text=name.text, mark=name.mark)}
        if self.convention:
            said["convention"] = Said(text=str(self.convention[0]), mark=self.convention[1])
        for what, mark in self.placed.items():
            said[what] = Said(text=None, mark=mark)
        for dimension, (unit, mark) in self.stated.items():
            said[f"units.{dimension.name.lower()}"] = Said(text=unit.symbol, mark=mark)
        return said

    def units(self) -> Units:
        """The units of numbers that name none."""
        stated = {dimension: unit for dimension, (unit, _) in self.stated.items()}
        units = table_units(stated, self.columns)
        return replace(units, bare=self.bare, symbols=self.symbols, repair_pi=self.repair_pi)

    def declare_convention(self, cell: Cell, add: Callable[[Problem], None]) -> None:
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
                    suggestion=did_you_mean(cell.text, [word for word in convention_words() if len(word) > len("dh")])
                    if cell.text
                    else None,
                )
            )
        else:
            self.declare_implied_convention(convention, cell, add)

    def declare_implied_convention(self, convention: Convention, cell: Cell, add: Callable[[Problem], None]) -> None:
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

    def declare_unit(self, cell: Cell, key: str, add: Callable[[Problem], None], *, said: str | None = None) -> None:
        """Takes a declaration of a unit.

        Args:
            cell: the word for it.
            key: what it is the unit of, as `UNIT_KEYS` has it.
            add: takes what is wrong with it.
            said: the sentence that it is in.
        """
        unit: Unit | None = None
        fault: QuantityError | None = None
        for dimension in UNIT_KEYS[key]:
            try:
                unit = unit or find_unit(cell.text, dimension)
            except QuantityError as error:
                fault = fault or error
        if fault and not unit:
            add(
                Problem(
                    message=fault.message,
                    mark=cell.mark,
                    field=f"units.{key}",
                    found=cell.text,
                    accepted=", ".join(map(accepted_units, UNIT_KEYS[key])),
                    suggestion=fault.suggestion,
                )
            )
        if not unit:
            return
        earlier = self.stated.setdefault(unit.dimension, (unit, cell.mark))
        if earlier[0] != unit:
            add(
                Problem(
                    message=f"{shown(said or cell.text)} contradicts the unit {earlier[0].symbol} that "
                    f"{earlier[1]} declares",
                    mark=cell.mark,
                    field=f"units.{key}",
                    found=cell.text,
                    accepted=f"one unit of {key} for the whole table",
                )
            )

    def declare_units(self, node: Node, add: Callable[[Problem], None]) -> None:
        """Takes `units`: a mapping such as ``{length: mm, effort: [Nm, N]}``, or bare words such as ``mm, deg``."""
        if isinstance(node.value, dict):
            for key, item in node.value.items():
                if key not in UNIT_KEYS:
                    add(
                        Problem(
                            message=f"{shown(key)} is nothing that has a unit of its own",
                            mark=node.key_mark(key),
                            field=f"units.{key}",
                            found=key,
                            accepted=", ".join(UNIT_KEYS),
                            suggestion=_unit_key(key),
                        )
                    )
                    continue
                several = len(UNIT_KEYS[key]) > 1
                words = words_of_units(item) if several or not isinstance(item.value, list) else []
                if not words:
                    message = f"units.{key} is {item.describe()}"
                    add(Problem(message=message, mark=item.mark, field=f"units.{key}", accepted="the name of a unit"))
                for word in words:
                    self.declare_unit(word, key, add)
            return
        if isinstance(node.value, str) and key_of(node.value.casefold()) in keys_in("values", "si"):
            self.stated |= {UNITS[SI[each]].dimension: (UNITS[SI[each]], node.mark) for each in _OF_SI}
            return
        words = words_of_units(node)
        known = [UNITS.get(unit_word(word.text)) for word in words]
        for word, unit in zip(words, known, strict=True):
            if unit and all(known):
                self.declare_unit(word, KEY_OF.get(unit.dimension, "length"), add)
        if not words or not all(known):
            add(
                Problem(
                    message=f"units is {node.describe()}",
                    mark=node.mark,
                    field="units",
                    found=node.text,
                    accepted=f"units such as mm, deg, or a mapping such as {{length: mm, angle: deg}}, with the keys "
                    f"{', '.join(UNIT_KEYS)}",
                )
            )

    def declare_transform(self, node: Node, what: str, add: Callable[[Problem], None]) -> None:
        """Takes `base` or `tool`: a rigid transform, and the base's body."""
        from dh2urdf_plugins.readers.statements.meshes import MESH_KEYS
        from dh2urdf_plugins.readers.statements.placements import PLACED, TransformReader

        if _is_nothing(node):
            return
        body = ("mass", "geometry", *MESH_KEYS) if what == "base" else ()
        transform = TransformReader(self.units(), add).read(node, what, other_keys=body)
        if body:
            self.declare_body(node, add)
        only_body = body and isinstance(node.value, dict) and node.value.keys().isdisjoint(PLACED)
        if transform is None or only_body:
            return
        said = self.base if what == "base" else self.tool
        if said is not None and said != transform:
            self._said_twice(what, node, add)
        elif what == "base":
            self.base = transform
            self.placed[what] = node.mark
        else:
            self.tool = transform
            self.placed[what] = node.mark

    def declare_options(self, options: Mapping[str, Any], add: Callable[[Problem], None]) -> None:
        """Takes the convention and the units of the options; base and tool follow when the units are known."""
        mark = Mark(file=OPTIONS)
        self.mesh_links = options["mesh_links"]
        if options["calibration"] is not None:
            from dh2urdf_plugins.calibrations.calibration import CalibrationFile

            units = {name: options[name] for name in ("length_unit", "angle_unit", "units")}
            self.calibration = CalibrationFile(options["calibration"], units)
        self.repair_pi = options["rounded_pi"] == "repair"
        self.in_convention = Convention(options["in_convention"]) if options["in_convention"] else None
        if options["symbol"] is not None and (node := _option_node("symbol", options["symbol"], add)):
            self.declare_symbols(node, add)
        if options["convention"] is not None:
            self.declare_convention(Cell(options["convention"], mark), add)
        if options["length_unit"] is not None:
            self.declare_unit(Cell(options["length_unit"], mark), "length", add)
        if options["angle_unit"] is not None:
            self.declare_unit(Cell(options["angle_unit"], mark), "angle", add)
        if options["units"] is not None and (node := _option_node("units", options["units"], add)):
            self.declare_units(node, add)

    def declare_symbols(self, node: Node, add: Callable[[Problem], None]) -> None:
        """Takes `symbols`: a mapping such as ``{L1: 91 mm}``, or texts such as ``L1=91mm``."""
        items = node.value if isinstance(node.value, list) else [node]
        texts = [(item.text or "").partition("=") for item in items]
        named = [(name.strip(), text.strip(), item.mark) for (name, _, text), item in zip(texts, items, strict=True)]
        if isinstance(node.value, dict):
            named = [(key, item.text or item.describe(), item.mark) for key, item in node.value.items()]
        for name, text, mark in named:
            if problem := self.symbols.define(name, text, mark):
                add(problem)

    def declare_defaults(self, node: Node, add: Callable[[Problem], None], other_keys: Iterable[str] = ()) -> None:
        """Takes `defaults`: the links' geometry and density."""
        from dh2urdf_plugins.readers.statements.shapes import ShapeReader, refuse_unknown_keys

        if not isinstance(node.value, dict):
            message = f"defaults is {node.describe()}"
            add(Problem(message=message, mark=node.mark, field="defaults", accepted="{geometry: …, density: …}"))
            return
        refuse_unknown_keys(node, ("geometry", "density", *other_keys), "defaults", add)
        shapes = ShapeReader(self.units(), add)
        if geometry := node.value.get("geometry"):
            self.geometry = shapes.geometry(geometry, "defaults.geometry")
            self.placed["geometry"] = geometry.mark
        if density := node.value.get("density"):
            self.density = shapes.positive(density, "defaults.density", Dimension.DENSITY)
            self.placed["density"] = density.mark

    def declare_drawn(self, entries: Mapping[str, Node], add: Callable[[Problem], None]) -> None:
        """Takes `visuals` and `collisions`: all or none."""
        from dh2urdf_plugins.readers.statements.meshes import drawn_or_not

        if node := entries.get("visuals"):
            self.visuals, self.placed["visuals"] = drawn_or_not(node, "visuals", add), node.mark
        if node := entries.get("collisions"):
            self.collisions, self.placed["collisions"] = drawn_or_not(node, "collisions", add), node.mark

    def declare_body(self, node: Node, add: Callable[[Problem], None]) -> None:
        """Takes mass, geometry and meshes of the base's body from `base`."""
        if not isinstance(node.value, dict):
            return
        from dh2urdf_plugins.readers.statements.meshes import MeshReader
        from dh2urdf_plugins.readers.statements.shapes import ShapeReader

        shapes = ShapeReader(self.units(), add)
        if mass := node.value.get("mass"):
            self._declare_base_mass(shapes.positive(mass, "base.mass", Dimension.MASS, or_zero=True), mass, add)
        if geometry := node.value.get("geometry"):
            self.base_geometry = shapes.geometry(geometry, "base.geometry")
            self.placed["base_geometry"] = geometry.mark
        self.base_meshes = MeshReader(self.units(), add, links=self.mesh_links).read(node.value, "base.")

    def _declare_base_mass(self, mass: float | None, node: Node, add: Callable[[Problem], None]) -> None:
        if self.base_mass is not None and mass is not None and self.base_mass != mass:
            self._said_twice("base.mass", node, add)
        self.base_mass, self.placed["base_mass"] = mass, node.mark

    def declare_payload(self, node: Node, add: Callable[[Problem], None]) -> None:
        """Takes `payload`: what the arm carries at tool0."""
        from dh2urdf_plugins.readers.statements.payloads import PayloadReader

        if _is_nothing(node):
            return
        payload = PayloadReader(self.units(), add).read(node)
        if self.payload is not None and payload is not None and self.payload != payload:
            self._said_twice("payload", node, add)
        if payload is not None:
            self.payload, self.placed["payload"] = payload, node.mark

    @staticmethod
    def _said_twice(what: str, node: Node, add: Callable[[Problem], None]) -> None:
        message = f"{what} is given twice, with different values: in the table and in {OPTIONS}"
        add(Problem(message=message, mark=node.mark, field=what, found=node.text, accepted=f"one {what}"))

    def declare_option_transforms(self, options: Mapping[str, Any], add: Callable[[Problem], None]) -> None:
        """Takes base, tool and payload of the options."""
        for what, value in ((what, options[what]) for what in ("base", "tool", "payload")):
            if value is not None and (node := _option_node(what, value, add)):
                if what == "payload":
                    self.declare_payload(node, add)
                else:
                    self.declare_transform(node, what, add)


def _option_node(what: str, value: str | dict[str, Any] | list[Any], add: Callable[[Problem], None]) -> Node | None:
    """The value of an option as YAML; None where it is none."""
    import json

    text = value if isinstance(value, str) else json.dumps(value)
    try:
        return load_yaml(text if text.strip() else "~", OPTIONS, TableError)
    except TableError as error:
        for problem in error.problems:
            add(replace(problem, field=what))
        return None


def _is_nothing(node: Node) -> bool:
    """Whether a value says that there is no such thing: ``none``, ``identity``."""
    return isinstance(node.value, str) and key_of(node.value.casefold()) in keys_in("values", "identity")


def _unit_key(key: str) -> str | None:
    """What a key of `units` probably means."""
    word = key_of(key.casefold())
    meant = next((name for name in UNIT_KEYS if word in keys_in("unit_keys", name)), None)
    return f"did you mean {meant!r}?" if meant else did_you_mean(key, UNIT_KEYS)


def words_of_units(node: Node) -> list[Cell]:
    """The units that a text or a list names: at its commas, or at spaces and such where that makes units of all."""
    if isinstance(node.value, list):
        return [word for item in node.value for word in words_of_units(item)]
    return [Cell(word, node.mark) for word in unit_words(node.text or "")] if node.value else []


def unit_words(text: str) -> list[str]:
    """The units that a text names."""
    return [word for part in re.split("[,;]", text) if part.strip() for word in _units_of(part.strip())]


def _units_of(part: str) -> list[str]:
    """The units of a part: one, or several with spaces, with a slash as in ``mm/deg`` or with a word between them."""
    if is_unit(part):
        return [part]
    several = re.split(_BETWEEN, part)
    units = [UNITS.get(unit_word(word)) for word in several]
    return several if all(unit and unit.dimension in _OF_SI for unit in units) else part.split()
