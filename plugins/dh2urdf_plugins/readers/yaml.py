"""Reads Denavit-Hartenberg tables as YAML, which JSON is too: one manipulator, or a list of them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.documents import stream_yaml
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.source import Problem, did_you_mean, shown
from dh2urdf.stages import Reader, Rejected
from dh2urdf.textfiles import read_bytes
from dh2urdf_plugins.readers import yaml_texts
from dh2urdf_plugins.readers.cells import Cell
from dh2urdf_plugins.readers.fields import COM_FIELDS, FIELDS, INERTIA_FIELDS, UNHELD_GEOMETRY, read_header
from dh2urdf_plugins.readers.meshes import MESH_KEYS, Meshes, MeshReader
from dh2urdf_plugins.readers.rows import RowReader
from dh2urdf_plugins.readers.shapes import refuse_unknown_keys
from dh2urdf_plugins.readers.statements import Statements, TableOptions
from dh2urdf_plugins.readers.tables import MAX_JOINTS, manipulator, stopped
from dh2urdf_plugins.readers.yaml_schema import table_schema

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.documents import Item, Node
    from dh2urdf.manipulator import DHRow
    from dh2urdf.source import Mark

KEYS = ("name", "convention", "units", "base", "tool", "defaults", "visuals", "collisions", "joints")
"""Keys of a manipulator."""

_LIMITS = ("lower", "upper", "velocity", "effort")
_NOT_IN_A_JOINT = ("robot", "convention", "index")
_JOINT_KEYS = (
    "name",
    *(name for name in FIELDS if name not in (*_NOT_IN_A_JOINT, *_LIMITS, *COM_FIELDS, *INERTIA_FIELDS, "joint")),
    "limits",
    "com",
    "inertia",
    *MESH_KEYS,
)
_NAMES = ("joint", "link")
_TENSOR = (("ixx", "ixy", "ixz"), ("ixy", "iyy", "iyz"), ("ixz", "iyz", "izz"))


def read(path: Path, options: TableOptions) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a YAML or JSON file.

    Args:
        path: the file.
        options: what the table does not say itself.

    Yields:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no YAML document, or one that holds no table.
    """
    file = str(path)
    count = 0
    previous: Item | None = None
    text = read_bytes(path, TableError)
    for item in stream_yaml(text, file, TableError, items_of="robots", longest_list=MAX_JOINTS):
        if previous is not None:
            count += 1
            yield _Table(previous, f"{path.stem}_{count}", options).manipulator()
        previous = item
    if previous is None:
        return
    root = previous.node
    if not isinstance(root.value, dict):
        raise TableError([*previous.problems, _no_mapping(root)])
    if "robots" not in root.value:
        yield _Table(previous, path.stem, options).manipulator()
        return
    problems = list(previous.problems)
    refuse_unknown_keys(root, ("robots",), "a file with several manipulators", problems.append)
    robots = root.value["robots"]
    if not count and not problems:
        problems.append(
            Problem(
                message=f"robots is {'an empty list' if isinstance(robots.value, list) else robots.describe()}",
                mark=robots.mark,
                field="robots",
                accepted="a list of manipulators, each with name, convention and joints",
            )
        )
    if problems:
        raise TableError(problems)


READER: Reader[TableOptions] = Reader(
    name="yaml",
    summary="tables as YAML or JSON, one manipulator or a list of them",
    read=read,
    options=TableOptions,
    suffixes=(".yaml", ".yml", ".json"),
    schema=table_schema,
    write=yaml_texts.write,
    texts=yaml_texts.texts,
)


def _no_mapping(root: Node) -> Problem:
    commas = isinstance(root.value, str) and "," in root.value
    return Problem(
        message=f"a table is a mapping with the key joints, and this is {root.describe()}",
        mark=root.mark,
        accepted=f"the keys {', '.join(KEYS)}, or robots with a list of such mappings",
        suggestion="this looks like CSV: give the file the suffix .csv" if commas else None,
    )


class _Table:
    """One manipulator that is being read."""

    def __init__(self, item: Item, default_name: str, options: TableOptions) -> None:
        self.node = item.node
        self.options = options
        self.statements = Statements()
        self.entries = item.node.value if isinstance(item.node.value, dict) else {}
        self.problems: list[Problem] = list(item.problems)
        self.name = self._word("name") or Cell(default_name, item.node.mark)

    def manipulator(self) -> Manipulator | Rejected:
        """The manipulator, or everything that is wrong with it."""
        if not isinstance(self.node.value, dict):
            problem = _no_mapping(self.node)
            return Rejected(name=self.name.text, problems=(*self.problems, problem), mark=self.node.mark)
        refuse_unknown_keys(self.node, KEYS, "a manipulator", self.problems.append)
        self._state()
        reader = RowReader(self.statements.units(), type_is_given=False)
        rows = self._rows(reader)
        for problem in self.problems:
            reader.add(problem)
        return manipulator(self.name, self.statements, rows, reader, self.node.mark)

    def _word(self, field: str) -> Cell | None:
        """A text as it stands in the file; numbers and truth values too, since names keep their source text."""
        node = self.entries.get(field)
        if node is None:
            return None
        if node.text is None:
            self._error(node.mark, field, f"{field} is {node.describe()}", accepted="a text")
            return None
        return Cell("" if node.value is None else node.text, node.mark)

    def _error(
        self,
        mark: Mark,
        field: str,
        message: str,
        *,
        accepted: str,
        found: str | None = None,
        suggestion: str | None = None,
    ) -> None:
        self.problems.append(
            Problem(message=message, mark=mark, field=field, found=found, accepted=accepted, suggestion=suggestion)
        )

    def _state(self) -> None:
        """Takes what holds for all rows."""
        add, entries, statements = self.problems.append, self.entries, self.statements
        if units := entries.get("units"):
            statements.say_units(units, add)
        if convention := self._word("convention"):
            statements.say_convention(convention, add)
        statements.say_options(self.options, add)
        for what in ("base", "tool"):
            if node := entries.get(what):
                statements.say_transform(node, what, add)
        statements.say_option_transforms(self.options, add)
        statements.say_what_is_drawn(entries, add)
        if defaults := entries.get("defaults"):
            statements.say_defaults(defaults, add, self._joint_keys(defaults))

    @staticmethod
    def _joint_keys(defaults: Node) -> list[str]:
        """The keys of defaults that are fields of a joint; a name cannot be the same for all."""
        keys = defaults.value if isinstance(defaults.value, dict) else ()
        return [key for key in keys if _joint_field(key) and _joint_field(key) not in _NAMES]

    # --- Rows ---------------------------------------------------------------------------------------------------------

    def _rows(self, reader: RowReader) -> list[DHRow | None]:
        joints = self.entries.get("joints")
        if joints is None:
            self._error(self.node.mark, "joints", "there is no key joints", accepted="a list with one entry per joint")
            return [None]
        if not isinstance(joints.value, list):
            self._error(
                joints.mark,
                "joints",
                f"joints is {joints.describe()}",
                found=joints.text,
                accepted="a list with one mapping for each joint, from the base outwards",
            )
            return [None]
        defaults = self.entries.get("defaults")
        common: dict[str, Cell] = {}
        if defaults is not None and isinstance(defaults.value, dict):
            for key in self._joint_keys(defaults):
                self._take(common, defaults, key, defaults.value[key], "defaults")
        rows: list[DHRow | None] = []
        for number, node in enumerate(joints.value, start=1):
            if not isinstance(node.value, dict):
                self._error(
                    node.mark,
                    "joints",
                    f"joint {number} is {node.describe()}, not a mapping",
                    found=node.text,
                    accepted="a mapping such as {name: shoulder, type: revolute, a: 0, alpha: pi/2, d: 0.1, theta: 0}",
                    suggestion="remove the dash if there is no such joint" if node.value is None else None,
                )
                rows.append(None)
                continue
            cells = self._cells(node, common, f"joint_{number}")
            row = reader.read(number, cells, node.mark)
            meshes = self._meshes(node.value, cells["joint"].text if "joint" in cells else f"joint_{number}")
            rows.append(row and replace(row, visual=meshes.visual, collision=meshes.collision))
            if stopped(reader):
                break
        return rows

    def _cells(self, node: Node, common: dict[str, Cell], default_name: str) -> dict[str, Cell]:
        """The entries of a joint by field."""
        own: dict[str, Cell] = {}
        before = len(self.problems)
        for key, item in node.value.items() if isinstance(node.value, dict) else ():
            if key not in MESH_KEYS:
                self._take(own, node, key, item, "a joint")
        cells = {**common, **own}
        if "flip" in own or "sign" in own:  # one field under two names
            cells = {name: cell for name, cell in cells.items() if name not in ("flip", "sign") or name in own}
        name = cells["joint"].text if "joint" in cells else default_name
        self.problems[before:] = [replace(problem, joint=name) for problem in self.problems[before:]]
        return cells

    def _meshes(self, entries: dict[str, Node], joint: str) -> Meshes:
        """The meshes of a joint's link."""
        before = len(self.problems)
        meshes = MeshReader(self.statements.units(), self.problems.append).read(entries)
        self.problems[before:] = [replace(problem, joint=joint) for problem in self.problems[before:]]
        return meshes

    def _take(self, cells: dict[str, Cell], mapping: Node, key: str, node: Node, what: str) -> None:
        """Takes one entry of a joint."""
        field = _joint_field(key)
        if field is None:
            self._unknown(mapping, key, node, what)
        elif field == "limits":
            self._take_mapping(cells, node, "limits", _LIMITS)
        elif field == "com":
            self._take_list(cells, node)
        elif field == "inertia":
            if isinstance(node.value, list):
                self._take_tensor(cells, node)
            else:
                self._take_mapping(cells, node, "inertia", INERTIA_FIELDS)
        else:
            if field in ("a", "alpha") and read_header(key).link == "i-1":
                self._is_modified(mapping, key)
            self._put(cells, field, node)

    def _is_modified(self, mapping: Node, key: str) -> None:
        cell = Cell(key, mapping.key_mark(key))
        self.statements.say_which(Convention.MODIFIED, cell, self.problems.append)

    def _put(self, cells: dict[str, Cell], field: str, node: Node) -> None:
        twin = {"flip": "sign", "sign": "flip"}.get(field, field)
        if field in cells or twin in cells:
            other = cells.get(field) or cells[twin]
            message = f"{field} is said a second time; the first is in line {other.mark.line}"
            self._error(node.mark, field, message, found=node.text, accepted="each field once")
        if node.text is None:
            accepted = "a text" if FIELDS[field].dimension is None else "a number or an expression"
            self._error(node.mark, field, f"{field} is {node.describe()}", accepted=accepted)
            cells[field] = Cell("0", node.mark)
        elif isinstance(node.value, bool) and FIELDS[field].dimension is not None:
            message = f"{field} is {node.describe()}, not a number"
            self._error(node.mark, field, message, found=node.text, accepted="a number or an expression")
            cells[field] = Cell("0", node.mark)
        else:
            cells[field] = Cell("" if node.value is None else node.text, node.mark)

    def _take_mapping(self, cells: dict[str, Cell], node: Node, what: str, fields: Sequence[str]) -> None:
        if node.value is None:
            return
        if not isinstance(node.value, dict):
            example = ", ".join(f"{name}: …" for name in fields)
            self._error(node.mark, what, f"{what} is {node.describe()}", found=node.text, accepted=f"{{{example}}}")
            return
        refuse_unknown_keys(node, fields, what, self.problems.append)
        for name in fields:
            if name in node.value:
                self._put(cells, name, node.value[name])

    def _take_list(self, cells: dict[str, Cell], node: Node) -> None:
        if node.value is None:
            return
        if not isinstance(node.value, list) or len(node.value) != len(COM_FIELDS):
            found = f"a list of {len(node.value)}" if isinstance(node.value, list) else node.describe()
            self._error(node.mark, "com", f"com is {found}", found=node.text, accepted="a list of three: [x, y, z]")
            return
        for name, item in zip(COM_FIELDS, node.value, strict=True):
            self._put(cells, name, item)

    def _take_tensor(self, cells: dict[str, Cell], node: Node) -> None:
        """A symmetric matrix of three rows."""
        rows = [row.value for row in node.value] if isinstance(node.value, list) else []
        size = len(_TENSOR)
        if len(rows) != size or any(not isinstance(row, list) or len(row) != size for row in rows):
            accepted = "{ixx: …, iyy: …, izz: …, ixy: …, ixz: …, iyz: …}, or three rows of three"
            self._error(
                node.mark, "inertia", "inertia is a list, and not one of three rows of three", accepted=accepted
            )
            return
        for names, row in zip(_TENSOR, rows, strict=True):
            for name, item in zip(names, row if isinstance(row, list) else (), strict=True):
                if name in cells and cells[name].text != item.text:
                    message = f"the inertia tensor is not symmetric: {name} is {shown(cells[name].text)} and here "
                    self._error(
                        item.mark,
                        "inertia",
                        message + shown(item.text or item.describe()),
                        found=item.text,
                        accepted="a symmetric matrix",
                    )
                elif name not in cells:
                    self._put(cells, name, item)

    def _unknown(self, mapping: Node, key: str, node: Node, what: str) -> None:
        reason = UNHELD_GEOMETRY.get(read_header(key).key)
        if reason and node.text is not None and node.text.strip("+-0.") == "":
            return
        header = read_header(key)
        near = did_you_mean(key, _JOINT_KEYS)
        if header.field and header.unit:
            near = f"write the key {header.field.name}, and the unit in the value or in `units`"
        self._error(
            mapping.key_mark(key),
            key,
            f"{shown(key)} is {reason}, which no key holds" if reason else f"{shown(key)} is no key of {what}",
            found=key,
            accepted=", ".join(_JOINT_KEYS),
            suggestion=None if reason else near,
        )


def _joint_field(key: str) -> str | None:
    """The field, or the group of fields, that a key of a joint means."""
    if key in ("limits", "com", "inertia"):
        return key
    header = read_header(key)
    if header.field is None or header.unit or header.field.name in _NOT_IN_A_JOINT:
        return None
    return header.field.name
