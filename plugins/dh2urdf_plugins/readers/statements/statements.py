"""What a table and the reader's options say about all rows: convention, units, base, tool, shapes."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import SI_UNITS
from dh2urdf.documents import load_yaml
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, Manipulator
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
from dh2urdf.source import Mark, did_you_mean
from dh2urdf.table_text import Said
from dh2urdf.table_text.texts import yaml_word
from dh2urdf_plugins.readers.header.columns import Columns
from dh2urdf_plugins.readers.header.units import KEY_OF, UNIT_KEYS, Units, table_units
from dh2urdf_plugins.readers.statements.values import Values, say
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.fields import convention_of, key_of, keys_in, said_of, words_for

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from dh2urdf.documents import Node  # noqa: TC004 - a dataclass never evaluates it
    from dh2urdf.manipulator import DHRow
    from dh2urdf.source import Problem
    from dh2urdf_plugins.calibrations.calibration import CalibrationFile  # noqa: TC004 - only the tables with one need it

KINDS = {
    "base": ("base", False),
    "tool": ("placement", True),
    "payload": ("payload", True),
    "visuals": ("drawn", True),
    "collisions": ("drawn", True),
    "defaults": ("defaults", False),
}
"""What a manipulator has beside its rows: how `Values` reads it, and whether it is one attribute, or several."""
PLACES = ("base", "tool", "payload")
"""Those that the options may have as well."""
OPTIONS = "an option"
"""What marks name as the file of an option."""
_OF_SI = (Dimension.LENGTH, Dimension.ANGLE)
_BETWEEN = r"\s*[/&]\s*|\s+(?:and|und|et|y|e)\s+|\s+"


@dataclass(slots=True)
class Statements:
    """What a table and the options say about all of its rows.

    Each may be declared more than once, with the same value; two values are an error that names both places.
    """

    convention: tuple[Convention, Mark] | None = None  # and where it is declared
    stated: dict[Dimension, tuple[Unit, Mark]] = field(default_factory=dict)
    columns: Columns | None = None
    values: dict[str, Any] = field(default_factory=dict)  # of a `Manipulator`, by attribute: ``base``, ``density``
    placed: dict[str, Mark] = field(default_factory=dict)  # where these are declared
    nodes: dict[str, Node] = field(default_factory=dict)  # what declares them, by key
    mesh_links: bool = False  # whether meshes may be links out of the table's folder
    calibration: CalibrationFile | None = None
    symbols: Symbols = field(default_factory=Symbols)
    in_convention: Convention | None = None  # the one that the table is rewritten in
    repair_pi: bool = False  # whether an angle that is nearly a multiple of π/2 is one
    bare: dict[Dimension, tuple[str, Cell]] = field(default_factory=dict)  # numbers of `values` without a unit

    def manipulator(
        self, name: str, rows: tuple[DHRow, ...], mark: Mark | None, notices: tuple[Problem, ...] = ()
    ) -> Manipulator:
        """The manipulator of some rows; the convention is known."""
        convention = self.convention[0] if self.convention else Convention.STANDARD
        return Manipulator(name=name, convention=convention, rows=rows, mark=mark, notices=notices, **self.values)

    def traced(self, name: Cell) -> dict[str, Said]:
        """What the table declares for all rows, and where."""
        said = {"name": Said(text=name.text, mark=name.mark)}
        if self.convention:
            said["convention"] = Said(text=str(self.convention[0]), mark=self.convention[1])
        said |= {what: Said(text=None, mark=mark) for what, mark in self.placed.items()}
        said |= {key: Said(text=flow_text(node), mark=node.mark) for key, node in self.nodes.items()}
        for dimension, (unit, mark) in self.stated.items():
            said[f"units.{dimension.name.lower()}"] = Said(text=unit.symbol, mark=mark)
        return said

    def units(self) -> Units:
        """The units of numbers that name none."""
        stated = {dimension: unit for dimension, (unit, _) in self.stated.items()}
        units = table_units(stated, self.columns)
        return replace(units, bare=self.bare, symbols=self.symbols, repair_pi=self.repair_pi)

    # --- Convention and units -----------------------------------------------------------------------------------------

    def declare_convention(self, cell: Cell, add: Callable[[Problem], None]) -> None:
        """Takes a word for the convention."""
        if convention := convention_of(cell.text):
            self.declare_implied_convention(convention, cell, add)
            return
        code, words = "no-convention" if cell.text else "empty-convention", words_for("conventions")
        advice = did_you_mean(cell.text, [word for word in words if len(word) > len("dh")]) if cell.text else None
        add(say(code, cell, "convention", accepted=said_of("accepted", "convention"), suggestion=advice))

    def declare_implied_convention(self, convention: Convention, cell: Cell, add: Callable[[Problem], None]) -> None:
        """Takes the convention from what only it writes."""
        self.convention = said, where = self.convention or (convention, cell.mark)
        if said is not convention:
            add(say("convention-twice", cell, "convention", means=convention, where=where, says=said))

    def declare_unit(self, cell: Cell, key: str, add: Callable[[Problem], None], *, said: str | None = None) -> None:
        """Takes a word for the unit of a key of `UNIT_KEYS`, perhaps in a sentence that said it."""
        name, faults = f"units.{key}", list[QuantityError]()
        for dimension in UNIT_KEYS[key]:
            try:
                unit = find_unit(cell.text, dimension)
            except QuantityError as error:
                faults.append(error)
                continue
            earlier, where = self.stated.setdefault(unit.dimension, (unit, cell.mark))
            if earlier != unit:
                what = said or cell.text
                add(say("unit-twice", cell, name, said=what, earlier=earlier.symbol, where=where, key=key))
            return
        units, advice = [accepted_units(dimension) for dimension in UNIT_KEYS[key]], faults[0].suggestion
        add(say("no-quantity", cell, name, reason=faults[0].message, accepted=units, suggestion=advice))

    def declare_units(self, node: Node, add: Callable[[Problem], None]) -> None:
        """Takes `units`: a mapping such as ``{length: mm, effort: [Nm, N]}``, or bare words such as ``mm, deg``."""
        if isinstance(node.value, str) and key_of(node.value.casefold()) in keys_in("values", "si"):
            self.stated |= {each: (UNITS[SI_UNITS[each]], node.mark) for each in _OF_SI}
            return
        if not isinstance(node.value, dict):
            words = words_of_units(node)
            known = [unit for word in words if (unit := UNITS.get(unit_word(word.text)))]
            if not words or len(known) < len(words):
                add(say("no-units", node, "units", is_a=node.describe(), keys=[*UNIT_KEYS]))
                return
            for word, unit in zip(words, known, strict=True):
                self.declare_unit(word, KEY_OF.get(unit.dimension, "length"), add)
            return
        for key, item in node.value.items():
            name = f"units.{key}"
            if key not in UNIT_KEYS:
                meant = next((name for name in UNIT_KEYS if key_of(key.casefold()) in keys_in("unit_keys", name)), None)
                advice = f"did you mean {meant!r}?" if meant else did_you_mean(key, UNIT_KEYS)
                mark = node.key_mark(key)
                add(say("no-unit-key", node, name, mark=mark, found=key, keys=[*UNIT_KEYS], suggestion=advice))
                continue
            words = words_of_units(item) if len(UNIT_KEYS[key]) > 1 or not isinstance(item.value, list) else []
            if not words:
                add(say("no-value", item, name, is_a=item.describe(), accepted="the name of a unit"))
            for word in words:
                self.declare_unit(word, key, add)

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

    # --- What is beside the rows --------------------------------------------------------------------------------------

    def declare(self, key: str, node: Node, add: Callable[[Problem], None]) -> None:
        """Takes the value of one of the keys of `KINDS`."""
        kind, is_whole = KINDS[key]
        is_word = isinstance(node.value, str) and key_of(node.value.casefold()) in keys_in("values", "identity")
        if is_word and key in PLACES:  # `tool: none`
            return
        found = Values(self.units(), add, links=self.mesh_links).read(kind, node, key)
        if found is None:
            return
        self.nodes.setdefault(key, node)
        for name, value in {key: found}.items() if is_whole else found.items():
            place = node.entry(name.removeprefix("base_")) or node
            if self.values.setdefault(name, value) != value:
                add(say("said-twice", node, name.replace("_", "."), option=OPTIONS))
            self.placed.setdefault(name, place.mark)

    # --- Options ------------------------------------------------------------------------------------------------------

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
        if node := _option_node("symbol", options, add):
            self.declare_symbols(node, add)
        if options["convention"] is not None:
            self.declare_convention(Cell(options["convention"], mark), add)
        for key in ("length", "angle"):
            if (unit := options[f"{key}_unit"]) is not None:
                self.declare_unit(Cell(unit, mark), key, add)
        if node := _option_node("units", options, add):
            self.declare_units(node, add)

    def declare_option_transforms(self, options: Mapping[str, Any], add: Callable[[Problem], None]) -> None:
        """Takes base, tool and payload of the options."""
        for key in PLACES:
            if node := _option_node(key, options, add):
                self.declare(key, node, add)


def _option_node(key: str, options: Mapping[str, Any], add: Callable[[Problem], None]) -> Node | None:
    """The value of an option as YAML; None where it is not given, or is none."""
    value = options[key]
    if value is None:
        return None
    import json

    text = value if isinstance(value, str) else json.dumps(value)
    try:
        return load_yaml(text if text.strip() else "~", OPTIONS, TableError)
    except TableError as error:
        for problem in error.problems:
            add(replace(problem, field=key))
        return None


def flow_text(node: Node) -> str:
    """A value of YAML in one line."""
    if isinstance(node.value, dict):
        return "{" + ", ".join(f"{yaml_word(key)}: {flow_text(value)}" for key, value in node.value.items()) + "}"
    if isinstance(node.value, list):
        return f"[{', '.join(map(flow_text, node.value))}]"
    return node.text or "" if node.value is None else yaml_word(node.text or "")


def words_of_units(node: Node) -> list[Cell]:
    """The units that a text or a list names: at its commas, or at spaces and such where that makes units of all."""
    if isinstance(node.value, list):
        return [word for item in node.value for word in words_of_units(item)]
    return [Cell(word, node.mark) for word in unit_words(node.text or "")] if node.value else []


def unit_words(text: str) -> list[str]:
    """The units that a text names, also several with spaces, a slash as in ``mm/deg`` or a word between them."""
    found: list[str] = []
    for part in filter(None, map(str.strip, re.split("[,;]", text))):
        several = re.split(_BETWEEN, part)
        units = [UNITS.get(unit_word(word)) for word in several]
        are_units = all(unit and unit.dimension in _OF_SI for unit in units)
        found += [part] if is_unit(part) else several if are_units else part.split()
    return found
