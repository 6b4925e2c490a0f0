"""Tables as YAML, which JSON is too: the joints become rows of cells, and what holds for all of them statements.

A document is one manipulator, or a list of them under `robots`. Its joints are a list of mappings under `joints` or the
like or at the top, a mapping by name, columns, or lists of numbers whose order is declared.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.columns import COM, INERTIA, LIMITS, ManipulatorGroups
from dh2urdf.documents import Node, decoded, read_bytes, stream_yaml
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, shown
from dh2urdf.stages import Rejected
from dh2urdf.table_text import STATEMENTS, CellRow, Said
from dh2urdf_plugins.readers.comments.declared import declared_key
from dh2urdf_plugins.readers.comments.top import read_top
from dh2urdf_plugins.readers.header.header_rows import text_in
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.options import TableOptions, ignored_columns
from dh2urdf_plugins.readers.rows.cells import PARTS, split_cell
from dh2urdf_plugins.readers.sources.texts import named_columns, without_name
from dh2urdf_plugins.readers.statements.statements import flow_text
from dh2urdf_plugins.readers.statements.values import MESH_KEYS, MESHES, Values, meshes_of
from dh2urdf_plugins.readers.tables.cell_rows import CellRows, choose
from dh2urdf_plugins.readers.tables.row_table import RowTable
from dh2urdf_plugins.readers.words.bounds import MAX_JOINTS
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS, IGNORED, flip_of, near

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from dh2urdf.documents import Item
    from dh2urdf.table_text import Trace

KEYS = (*STATEMENTS, "visuals", "collisions", "joints")
"""Keys of a manipulator."""
NOT_IN_A_JOINT = ("robot", "convention")
"""Fields that a table of one manipulator has no column for."""
_JOINTS = (
    "joints",
    *("dh_parameters", "dh_params", "dh_table", "dh", "links", "parameters", "params", "rows", "table", "chain"),
)
"""What the joints are called, in dh2urdf and in other programs."""
_UNIT_KEY = r"(?i)(?:(length|angle)_units?|units?_(length|angle))"
_OF_OTHER_PROGRAMS = ("columns", "dof", "version")
"""Keys that declare nothing of the arm."""
_LAW = ("joint", "multiplier", "offset")
"""What a mapping under `follows` says."""
_PARTS = {"limits": LIMITS, "com": COM, "inertia": INERTIA}
_OTHERS = (
    ("ur-kinematics", "a calibration of Universal Robots' ROS packages", "kinematics", "shoulder"),
    ("franka-kinematics", "a kinematics.yaml of Franka's ROS package", "joint1", "kinematic"),
    *(("screws", "a file of screw axes", key, other) for key, other in (("Slist", ""), ("Blist", ""), ("H", "P"))),
)
"""Readers of other YAML files: what they read, and a key that shows it, perhaps with another one beside it or in it."""
_COMMENT = r"#+(?!>)\s*(.*)"
_SENTENCE = r"#+(?!>)\s*(?![\w .-]{1,40}:)(.*)"
"""A comment of YAML, and no key that somebody took out by making it one; a program has no other way to declare one."""
_NUMBER = "a number or an expression"

say = Messages(__file__)


def read_documents(path: Path, options: TableOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a YAML or JSON file; see `read` of the stage ``yaml``."""
    file, count = str(path), 0
    choose([path], ["line 1"], options.table_number, path)
    content = decoded(read_bytes(path, TableError), file, TableError)
    text = without_name(content)
    comments = _comments(text, file, _SENTENCE if text == content else _COMMENT)
    previous: Item | None = None
    for item in stream_yaml(text, file, TableError, items_of="robots", longest_list=MAX_JOINTS):
        if previous is not None:
            count += 1
            above = [each for each in comments if count == 1 and (each.mark.line or 0) < previous.node.line]
            yield read_table(previous, f"{path.stem}_{count}", options, trace, above)
        previous = item
    if previous is None:
        return
    root, problems = previous.node, list(previous.problems)
    if (robots := root.entry("robots")) is None:
        if other := _other_reader(root):
            raise TableError(other)
        first = root.value[0] if isinstance(root.value, list) and root.value else root
        if not root.value or not isinstance(first.value, dict | list):
            raise TableError([*problems, say("no-mapping", root.mark, what=root.describe(), keys=KEYS)])
        yield read_table(previous, path.stem, options, trace, comments)
        return
    problems += [_unknown_key(root, key, ("robots",)) for key in root.plain() if key != "robots"]
    if not count and not problems:
        what = "an empty list" if isinstance(robots.value, list) else robots.describe()
        problems.append(say("no-robots", robots.mark, field="robots", what=what))
    if problems:
        raise TableError(problems)


def _comments(text: str, file: str, pattern: str) -> list[CellRow]:
    """The comments that are lines of their own and of a pattern."""
    lines = enumerate(text.splitlines(), start=1) if "#" in text else ()
    found = ((number, re.match(pattern, line.strip())) for number, line in lines if line.lstrip().startswith("#"))
    return [CellRow([f"# {match[1]}"], Mark(file=file, line=number)) for number, match in found if match]


def read_table(
    item: Item,
    default_name: str,
    options: TableOptions | None = None,
    trace: Trace | None = None,
    comments: Iterable[CellRow] = (),
) -> Manipulator | Rejected:
    """The manipulator of a mapping, or everything that is wrong with it."""
    options = options or TableOptions()
    table, rows = Document(item), list[CellRow]()
    place = item.node.mark
    try:
        rows = table.rows(options)
        source = CellRows([*comments, *rows], prose=False)
        top = read_top(source, place, table.said, convention=options.convention, ignore=ignored_columns(options))
        reader = RowTable(Cell(default_name, place), options, top, source, trace, one=True)
        (found,) = reader.manipulators()
    except TableError as error:
        name = (table.said["name"].text if "name" in table.said else "") or default_name
        problems = tuple(each.about(robot=name) for each in (*table.problems, *error.problems))
        if trace is not None and rows:  # What was typed is shown where it is corrected.
            fields = [_field(text_in(cell)) for cell in rows[0].cells]
            trace.rows = tuple(
                {
                    field: Said(text=text_in(cell), mark=mark)
                    for field, cell, mark in zip(fields, row.cells, row.marks or (), strict=True)
                    if field and cell
                }
                for row in rows[1:]
            )
            trace.table = {key: Said(text=flow_text(node), mark=node.mark) for key, node in table.said.items()}
        return Rejected(name=name, problems=problems, mark=place, notices=(*table.notices, *error.notices))
    assert not isinstance(found, ManipulatorGroups)  # noqa: S101 - it is read with care
    return table.with_meshes(found, reader)


class _Value(NamedTuple):
    """What a joint says under a key: the header of its column with its place, and a text or what is wrong with it."""

    header: str
    key: Mark
    cell: str | Problem
    mark: Mark


class Document:
    """A document that is one manipulator."""

    def __init__(self, item: Item) -> None:
        self.node = item.node
        self.problems: list[Problem] = list(item.problems)
        self.notices: list[Problem] = []
        self.said: dict[str, Node] = {}  # what holds for all rows, by key
        self.meshes: list[dict[str, Node]] = []  # of each joint, its entries that are meshes
        self.common: dict[str, _Value] = {}  # what a joint says that says nothing else
        self.entries = item.node.value if isinstance(item.node.value, dict) else {}
        self.joints = self._joints()
        left_out: list[str] = []
        for key, node in self.entries.items():
            if node is not self.joints and not (self.joints is self.node and _is_row_of(key, node)):
                left_out += self._state(key, node)
        if left_out:
            words = ("the key", "is") if len(left_out) == 1 else ("the keys", "are")
            what, mark = f"{words[0]} {', '.join(map(shown, left_out))} {words[1]}", item.node.key_mark(left_out[0])
            self.notices.append(say("keys-left-out", mark, found=left_out[0], what=what))
        defaults = self.said.get("defaults")
        if defaults is not None and isinstance(defaults.value, dict):  # fields of joints are common to all joints
            named = {key for key in defaults.value if _field(key) not in (None, "index", "joint", "link")}
            for key in (key for key in defaults.value if key in named):
                self.common |= self._values(defaults, key, defaults.value[key])
            others = {key: node for key, node in defaults.value.items() if key not in named}
            self.said["defaults"] = replace(defaults, value=others)

    def _joints(self) -> Node | None:
        """What holds the joints: the value of a key, or the document itself."""
        for key in _JOINTS:
            for written, node in self.entries.items():
                if written.casefold().replace(" ", "_").replace("-", "_") == key and node.value is not None:
                    return node
        has_rows = any(_is_row_of(key, node) for key, node in self.entries.items())
        return self.node if isinstance(self.node.value, list) or has_rows else None

    def _state(self, key: str, node: Node) -> list[str]:
        """Takes what holds for all rows; gives the keys of texts that are left out."""
        if key.startswith(IGNORED):
            return []
        if match := re.fullmatch(_UNIT_KEY, key):
            units = self.said.get("units")
            known = units.value if units is not None and isinstance(units.value, dict) else {}
            self.said["units"] = replace(node, value={**known, (match[1] or match[2]).casefold(): node}, text=None)
        elif key in KEYS:
            self.said[key] = node
        elif declared := declared_key(key):
            self.said.setdefault(declared, node)
        elif isinstance(node.value, dict | list | int | float) or near(key.casefold(), KEYS):
            if key.casefold() not in _OF_OTHER_PROGRAMS:
                self.problems.append(_unknown_key(self.node, key, KEYS))
        elif node.text:
            return [key]
        return []

    def with_meshes(self, found: Manipulator | Rejected, table: RowTable) -> Manipulator | Rejected:
        """What was read, with the meshes of its links and what is wrong with them and with the document."""
        rows = list(found.rows) if isinstance(found, Manipulator) else []
        for number, entries in ((number, entries) for number, entries in enumerate(self.meshes) if entries):
            wrong: list[Problem] = []
            values = Values(table.statements.units(), wrong.append, links=table.statements.mesh_links)
            drawn = meshes_of(values.entries(entries, MESHES))
            joint = rows[number].joint if rows else f"joint_{number + 1}"
            self.problems += [replace(each, joint=joint) for each in wrong]
            if rows and drawn:
                rows[number] = replace(rows[number], **drawn)
        own = [problem.about(robot=found.name) for problem in (*self.problems, *self.notices)]
        errors = tuple(problem for problem in own if problem.severity == "error")
        notices = (*found.notices, *(problem for problem in own if problem.severity == "notice"))
        if isinstance(found, Rejected) or errors:
            problems = errors + (found.problems if isinstance(found, Rejected) else ())
            return Rejected(name=found.name, problems=problems, mark=self.node.mark, notices=notices)
        return replace(found, rows=tuple(rows), notices=notices) if any(self.meshes) or notices else found

    # --- Rows ---------------------------------------------------------------------------------------------------------

    def rows(self, options: TableOptions) -> list[CellRow]:
        """The header and the rows."""
        joints = self.joints
        if joints is None or not joints.value or not isinstance(joints.value, dict | list):
            what = "there is no key joints" if joints is None else f"joints is {joints.describe()}"
            raise TableError(say("no-joints", (joints or self.node).mark, field="joints", what=what))
        if isinstance(joints.value, list) and all(isinstance(row.value, list) for row in joints.value):
            lists = [(row.mark, row.value if isinstance(row.value, list) else []) for row in joints.value]
            rows = [CellRow(list(map(_text, items)), mark, [item.mark for item in items]) for mark, items in lists]
            columns = options.column_names or [node.text or "" for node in self.node.entries("columns")]
            self.meshes = [{} for _ in rows]
            return [named_columns(rows, columns, self.node.file), *rows]
        records, values = list(self._records(joints)), list[dict[str, _Value]]()
        for number, node in enumerate(records, start=1):
            entries = node.value if isinstance(node.value, dict) else {}
            self.meshes.append({key: item for key, item in entries.items() if key in MESH_KEYS})
            if not isinstance(node.value, dict):
                what = f"joint {number} is {node.describe()}"
                self.problems.append(say("joint-no-mapping", node.mark, field="joints", found=node.text, what=what))
            found: dict[str, _Value] = {}
            for key, item in entries.items():
                for column, value in self._values(node, key, item).items() if key not in MESH_KEYS else ():
                    found[f"{column} {key}" if column in found else column] = value
            values.append(self.common | found)
        headers = {key: value for own in values for key, value in own.items()}
        named = [each.header for each in headers.values()]
        rows = [CellRow(named, joints.mark, [each.key for each in headers.values()])]
        for own, node in zip(values, records, strict=True):
            cells, mark = [own.get(key) for key in headers], node.mark
            marks = [cell.mark if cell else mark for cell in cells]
            rows.append(CellRow([cell and cell.cell for cell in cells], mark, marks))
        return rows

    def _records(self, joints: Node) -> Iterator[Node]:
        """The joints as mappings: of a list, of a mapping by name, or of columns."""
        if isinstance(joints.value, list):
            yield from joints.value
            return
        entries = joints.value if isinstance(joints.value, dict) else {}
        entries = {key: node for key, node in entries.items() if _is_row_of(key, node)}
        named = {key: node.value for key, node in entries.items() if isinstance(node.value, dict)}
        for key, own in named.items():
            node = entries[key]
            has_name = any(_field(each) == "joint" for each in own)
            yield node if has_name else replace(node, value={"name": replace(node, value=key, text=key), **own})
        if named:
            return
        columns = {key: node.value for key, node in entries.items() if isinstance(node.value, list)}
        for index in range(max(map(len, columns.values()), default=0)):
            cells = {key: column[index] for key, column in columns.items() if index < len(column)}
            places = {key: joints.key_places[key] for key in cells if key in joints.key_places}
            yield replace(next(iter(cells.values())), value=cells, text=None, key_places=places)

    def _values(self, mapping: Node, key: str, node: Node) -> dict[str, _Value]:  # noqa: PLR0911 - forms of values
        """What a key of a joint says, by column: several where the value is of several fields."""
        header, place = read_header(key), mapping.key_mark(key)
        field = header.field
        if header.ignored:
            return {key: _Value(key, place, "", node.mark)}
        if field is None and isinstance(node.value, dict) and key.casefold() in _JOINTS:
            inner = [self._values(node, each, item) for each, item in node.value.items()]
            return {column: value for values in inner for column, value in values.items()}
        if field is None and not isinstance(node.value, dict | list):
            return {key: _Value(key, place, _text(node), node.mark)}
        if field is None or field.name in NOT_IN_A_JOINT:
            self.problems.append(_unknown_key(mapping, key, (*FIELDS, *MESH_KEYS)))
            return {}
        if field.name in GROUPS and not header.unit:
            return self._parts(field.name, place, node)
        if field.name in GROUPS:
            self.problems.append(say("key-with-a-unit", place, field=field.name, found=key))
            return {}
        if field.name == "follows" and isinstance(node.value, dict):
            return {"follows": _Value(key, place, self._law(node), node.mark)}
        turned = flip_of(_text(node)) if field.name == "flip" and not mapping.entry("sign") else None
        if turned is not None:  # one column with `sign`
            return {"sign": _Value("sign", place, "-1" if turned else "1", node.mark)}
        cell = _cell(node, field.name, "a text" if field.dimension is None else _NUMBER)
        if isinstance(node.value, bool) and field.dimension is not None:
            cell = say("truth-value", node.mark, field=field.name, found=node.text, what=node.describe())
        column = f"{field.name}{header.link or ''}{header.unit or ''}"  # keys of one field have one column
        return {column: _Value(key, place, cell, node.mark)}

    def _law(self, node: Node) -> str | Problem:
        """Whom a joint follows, given as a mapping, as the text of a cell."""
        self.problems += [_unknown_key(node, key, _LAW) for key in node.plain() if key not in _LAW]
        joint, factor, added = (_text(item) if (item := node.entry(key)) else "" for key in _LAW)
        if not joint:
            about = {"what": "a mapping without `joint`", "wanted": "{joint: j2, multiplier: -1}"}
            return say("wrong-value", node.mark, field="follows", **about)
        return f"({factor or 1}) * {joint} + ({added or 0})"

    def _parts(self, group: str, place: Mark, node: Node) -> dict[str, _Value]:
        """Several fields at once: as a mapping, as a list, or as the text of a cell."""
        if isinstance(node.value, dict):
            found: dict[str, _Value] = {}
            for key, item in node.value.items():
                if (name := PARTS.get(key, key)) in _PARTS[group]:
                    found[name] = _Value(name, place, _cell(item, name, _NUMBER), item.mark)
                else:
                    self.problems.append(_unknown_key(node, key, _PARTS[group]))
            return found
        names, items = GROUPS[group].parts, node.value if isinstance(node.value, list) else []
        if group != "inertia" and len(items) == len(names) and all(item.text is not None for item in items):
            return {name: _Value(name, place, _text(item), item.mark) for name, item in zip(names, items, strict=True)}
        parts = split_cell(GROUPS[group], flow_text(node) if items else _text(node), node.mark)
        if isinstance(parts, Problem):
            self.problems.append(parts)
            return {}
        return {name: _Value(name, place, part, node.mark) for name, part in parts.items()}


# --- Keys and values --------------------------------------------------------------------------------------------------


def _field(key: str) -> str | None:
    """The field that a key means."""
    header = read_header(key)
    return header.field.name if header.field and header.field.name not in NOT_IN_A_JOINT else None


def _text(node: Node) -> str:
    """The text of a scalar; empty where it is nothing."""
    return "" if node.value is None else node.text or ""


def _cell(node: Node, name: str, accepted: str) -> str | Problem:
    """The cell of a field, or what is wrong with a mapping or a list in its place."""
    if isinstance(node.value, dict | list):
        return say("wrong-value", node.mark, field=name, what=node.describe(), wanted=accepted)
    return _text(node)


def _is_row_of(key: str, node: Node) -> bool:
    """Whether an entry of a document is a column of numbers, or a joint by its name."""
    if isinstance(node.value, list):
        return _field(key) is not None
    geometry = ("a", "alpha", "d", "theta")
    return isinstance(node.value, dict) and key not in KEYS and sum(_field(k) in geometry for k in node.value) > 1


def _unknown_key(mapping: Node, key: str, keys: Iterable[str]) -> Problem:
    known = list(keys)
    near = did_you_mean(key, known)
    return say("unknown-key", mapping.key_mark(key), field=key, found=key, keys=known, suggestion=near)


def _other_reader(root: Node) -> Problem | None:
    """A mapping that is no table, and that another reader of YAML files reads; None for any other."""
    entries = root.value if isinstance(root.value, dict) else {}
    for reader, what, key, inner in _OTHERS:
        if key in entries and (not inner or inner in entries or entries[key].entry(inner)):
            return say("other-reader", root.mark, what=what, reader=reader)
    return None
