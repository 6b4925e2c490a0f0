"""Reads Denavit-Hartenberg tables as YAML, which JSON is too: one manipulator, or a list of them."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.documents import decoded, read_bytes, stream_yaml
from dh2urdf.errors import SCREENFUL, TableError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.row_fields import COM, INERTIA, LIMITS
from dh2urdf.source import Problem, shown
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.header.columns import number_beside_name, parts_beside_theta
from dh2urdf_plugins.readers.header.units import effort_notice
from dh2urdf_plugins.readers.header.unknown_columns import ignored, meant_key, refusal, refused
from dh2urdf_plugins.readers.header.words import bounds_theta, parts_of, read_header
from dh2urdf_plugins.readers.options import TableOptions, given_by
from dh2urdf_plugins.readers.rows.rows import RowReader
from dh2urdf_plugins.readers.sources import yaml_forms as forms
from dh2urdf_plugins.readers.statements.meshes import MESH_KEYS, Meshes, MeshReader
from dh2urdf_plugins.readers.statements.shapes import refuse_unknown_keys
from dh2urdf_plugins.readers.statements.statements import Statements
from dh2urdf_plugins.readers.tables.cell_groups import ACCEPTED, TENSOR, GroupError, are_equal, split_cell
from dh2urdf_plugins.readers.tables.tables import manipulator, read_rows
from dh2urdf_plugins.readers.words.bounds import MAX_JOINTS
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.documents import Item, Node
    from dh2urdf.manipulator import DHRow
    from dh2urdf.source import Mark
    from dh2urdf.table_text import Trace

KEYS = ("name", "convention", "units", "base", "tool", "payload", "defaults", "visuals", "collisions", "joints")
"""Keys of a manipulator."""

_JOINT_KEYS = (
    "name",
    *(name for name in FIELDS if name not in (*forms.NOT_IN_A_JOINT, *LIMITS, *COM, *INERTIA, *GROUPS, "joint")),
    *GROUPS,
    *MESH_KEYS,
)
_NAMES = ("index", "joint", "link")
_KEYS = {"limits": LIMITS, "com": COM, "inertia": INERTIA}
"""Keys of the mappings of several fields."""


def read_documents(path: Path, options: TableOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a YAML or JSON file.

    Args:
        path: the file.
        options: what the table does not say itself.
        trace: takes what the cells of each manipulator say, where it is wanted.

    Yields:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no YAML document, or one that holds no table.
    """
    file = str(path)
    count = 0
    previous: Item | None = None
    text = decoded(read_bytes(path, TableError), file, TableError)
    for item in stream_yaml(text, file, TableError, items_of="robots", longest_list=MAX_JOINTS):
        if previous is not None:
            count += 1
            yield _Table(previous, f"{path.stem}_{count}", options).manipulator(trace)
        previous = item
    if previous is None:
        return
    root = previous.node
    if not isinstance(root.value, dict):
        raise TableError([*previous.problems, forms.no_mapping(root, KEYS)])
    if "robots" not in root.value:
        if other := forms.other_reader(root):
            raise TableError(other)
        yield _Table(previous, path.stem, options).manipulator(trace)
        return
    problems = list(previous.problems)
    refuse_unknown_keys(root, ("robots",), "a file with several manipulators", problems.append)
    robots = root.value["robots"]
    if not count and not problems:
        problems.append(forms.no_robots(robots))
    if problems:
        raise TableError(problems)


def read_table(item: Item, default_name: str) -> Manipulator | Rejected:
    """The manipulator of a mapping, or everything that is wrong with it."""
    return _Table(item, default_name, TableOptions()).manipulator()


class _Table:
    """One manipulator that is being read."""

    def __init__(self, item: Item, default_name: str, options: TableOptions) -> None:
        self.node = item.node
        self.number: int | None = None  # of the joint that is being read
        self.options = options
        self.statements = Statements()
        self.entries = item.node.value if isinstance(item.node.value, dict) else {}
        self.problems: list[Problem] = list(item.problems)
        self.ignored: dict[str, Mark] = {}
        self.unknown: set[str] = set()  # keys that were refused: of the joints that have one, the first is enough
        self.name = self._word("name") or Cell(default_name, item.node.mark)

    def manipulator(self, trace: Trace | None = None) -> Manipulator | Rejected:
        """The manipulator, or everything that is wrong with it."""
        if not isinstance(self.node.value, dict):
            problem = forms.no_mapping(self.node, KEYS)
            return Rejected(name=self.name.text, problems=(*self.problems, problem), mark=self.node.mark)
        refuse_unknown_keys(self.node, KEYS, "a manipulator", self.problems.append, forms.MEANT)
        self._state()
        reader = RowReader(self.statements.units(), type_is_given=False, traced=trace is not None)
        rows = self._rows(reader)
        if effort := next((cell for (name, _), cell in reader.bare.items() if name == "effort"), None):
            self.problems += effort_notice(reader.units, effort.mark)
        if self.ignored:
            self.problems.append(ignored(self.ignored, next(iter(self.ignored.values())), "key"))
        for problem in self.problems:
            reader.add(problem)
        return manipulator(self.name, self.statements, rows, reader, self.node.mark, trace=trace)

    def _word(self, field: str) -> Cell | None:
        """A text as it is in the file; numbers and truth values too, since names keep their source text."""
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
            statements.declare_units(units, add)
        if convention := self._word("convention"):
            statements.declare_convention(convention, add)
        statements.declare_options(given_by(self.options), add)
        for what in ("base", "tool"):
            if node := entries.get(what):
                statements.declare_transform(node, what, add)
        if payload := entries.get("payload"):
            statements.declare_payload(payload, add)
        statements.declare_option_transforms(given_by(self.options), add)
        statements.declare_drawn(entries, add)
        if defaults := entries.get("defaults"):
            statements.declare_defaults(defaults, add, self._joint_keys(defaults))

    @staticmethod
    def _joint_keys(defaults: Node) -> list[str]:
        """The keys of defaults that are fields of a joint; a name cannot be the same for all."""
        keys = defaults.value if isinstance(defaults.value, dict) else ()
        return [key for key in keys if forms.joint_field(key) and forms.joint_field(key) not in _NAMES]

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
                suggestion=forms.as_entries(joints),
            )
            return [None]
        defaults = self.entries.get("defaults")
        common: dict[str, Cell] = {}
        if defaults is not None and isinstance(defaults.value, dict):
            for key in self._joint_keys(defaults):
                self._take(common, defaults, key, defaults.value[key], "defaults")
        found: list[tuple[dict[str, Cell] | None, Mark]] = []
        unused = set(common)
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
                found.append((None, node.mark))
                continue
            self.number = number
            cells = self._cells(node, common, f"joint_{number}")
            unused -= {name for name in unused if name in cells and cells[name].mark == common[name].mark}
            found.append((cells, node.mark))
        self.problems += [forms.unused_default(name, common[name]) for name in common if name in unused and found]
        rows: list[DHRow | None] = []
        for row, node in zip(read_rows(found, reader), joints.value, strict=False):
            entries = node.value if isinstance(node.value, dict) else {}
            meshes = self._meshes(entries, row.joint if row else f"joint_{len(rows) + 1}")
            rows.append(row and replace(row, visual=meshes.visual, collision=meshes.collision))
        return rows

    def _cells(self, node: Node, common: dict[str, Cell], default_name: str) -> dict[str, Cell]:
        """The entries of a joint by field."""
        own: dict[str, Cell] = {}
        before = len(self.problems)
        entries = node.value if isinstance(node.value, dict) else {}
        spare, counting = parts_beside_theta(entries), number_beside_name(entries)
        for key, item in entries.items():
            if key in spare:
                self._unknown(node, key, item, "a joint")
            elif key == counting:
                self._put(own, "index", item)
            elif key not in MESH_KEYS:
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
        meshes = MeshReader(self.statements.units(), self.problems.append, links=self.options.mesh_links).read(entries)
        self.problems[before:] = [replace(problem, joint=joint) for problem in self.problems[before:]]
        return meshes

    def _take(self, cells: dict[str, Cell], mapping: Node, key: str, node: Node, what: str) -> None:
        """Takes one entry of a joint."""
        field = forms.joint_field(key)
        if field is None:
            self._unknown(mapping, key, node, what)
        elif field in GROUPS:
            self._take_group(cells, node, field)
        else:
            if field in ("a", "alpha") and read_header(key).link == "i-1":
                cell = Cell(key, mapping.key_mark(key))
                self.statements.declare_implied_convention(Convention.MODIFIED, cell, self.problems.append)
            self._put(cells, field, node)
        if field and bounds_theta(read_header(key)):
            named = [part for part in parts_of(FIELDS[field]) if part in cells]
            cells |= {part: cells[part]._replace(of_theta=True) for part in named}

    def _put_cell(self, cells: dict[str, Cell], field: str, cell: Cell) -> None:
        twin = {"flip": "sign", "sign": "flip"}.get(field, field)
        if field in cells or twin in cells:
            other = cells.get(field) or cells[twin]
            message = f"{field} is given a second time; the first is in line {other.mark.line}"
            self._error(cell.mark, field, message, found=cell.text, accepted="each field once")
        cells[field] = cell

    def _put(self, cells: dict[str, Cell], field: str, node: Node) -> None:
        if node.text is None:
            accepted = "a text" if FIELDS[field].dimension is None else "a number or an expression"
            self._error(node.mark, field, f"{field} is {node.describe()}", accepted=accepted)
            text = "0"
        elif isinstance(node.value, bool) and FIELDS[field].dimension is not None:
            message = f"{field} is {node.describe()}, not a number"
            self._error(node.mark, field, message, found=node.text, accepted="a number or an expression")
            text = "0"
        else:
            text = "" if node.value is None else node.text
        self._put_cell(cells, field, Cell(text, node.mark))

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

    def _take_group(self, cells: dict[str, Cell], node: Node, field: str) -> None:
        """Takes several fields at once: as a mapping, a list, or a text as in a cell of CSV."""
        if node.value is None:
            return
        if isinstance(node.value, dict):
            self._take_mapping(cells, forms.with_full_names(node), field, _KEYS[field])
            return
        if isinstance(node.value, list):
            self._take_list(cells, node, field)
            return
        parts = split_cell(GROUPS[field], node.text or "")
        if isinstance(parts, GroupError):
            self._group_error(node, field, parts)
        else:
            for name, text in parts.items():
                self._put_cell(cells, name, Cell(text, node.mark))

    def _take_list(self, cells: dict[str, Cell], node: Node, field: str) -> None:
        """Two bounds, three coordinates, or a symmetric matrix of three rows."""
        names = GROUPS[field].parts
        items = node.value if isinstance(node.value, list) else []
        if field == "inertia":
            self._take_tensor(cells, node, items)
        elif len(items) == len(names):
            for name, item in zip(names, items, strict=True):
                self._put(cells, name, item)
        else:
            message = f"{field} is a list of {len(items)}, not of {len(names)}"
            self._error(node.mark, field, message, found=node.text, accepted=ACCEPTED[field])

    def _take_tensor(self, cells: dict[str, Cell], node: Node, items: Sequence[Node]) -> None:
        rows = [row.value if isinstance(row.value, list) else [] for row in items]
        size = len(COM)
        if [len(row) for row in rows] != [size] * size:
            texts = ", ".join(item.text or item.describe() for item in items)
            flat = split_cell(GROUPS["inertia"], texts) if all(item.text for item in items) else None
            said = flat if isinstance(flat, GroupError) else GroupError("inertia is no list of three rows of three")
            self._group_error(node, "inertia", said)
            return
        for names, row in zip(TENSOR, rows, strict=True):
            for name, item in zip(names, row, strict=True):
                if name in cells and not are_equal(cells[name].text, item.text or ""):
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

    def _group_error(self, node: Node, field: str, why: GroupError) -> None:
        self._error(node.mark, field, why.message, found=node.text, accepted=ACCEPTED[field], suggestion=why.suggestion)

    def _unknown(self, mapping: Node, key: str, node: Node, what: str) -> None:
        header = read_header(key)
        if header.ignored:
            self.ignored.setdefault(key, mapping.key_mark(key))
            return
        if key in self.unknown:
            return
        why = refusal(key, header, "key")
        if why and why.zero:
            cell = Cell("" if node.value is None else node.text or node.describe(), mapping.key_mark(key))
            if problem := refused(cell, key, why, None, number=self.number, what="key"):
                self.problems.append(problem)
                self.unknown.add(key)
            return
        self.unknown.add(key)
        self._error(
            mapping.key_mark(key),
            key,
            f"{shown(key)} is no key of {what}",
            found=key,
            accepted=", ".join(_JOINT_KEYS),
            suggestion=forms.in_the_joint(node)
            or (len(self.unknown) <= SCREENFUL and meant_key(key, header, why and why.field, _JOINT_KEYS))
            or None,  # of what is not printed nothing is looked for: it takes 20 ms
        )
