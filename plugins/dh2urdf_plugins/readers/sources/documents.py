"""Tables as YAML, which JSON is too: the joints become rows of cells, and what holds for all of them statements.

A document is one manipulator, or a list of them under `robots`. Its joints are a list of mappings under `joints` or the
like or at the top, a mapping by name, columns, or lists of numbers whose order is declared.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.columns import ManipulatorGroups
from dh2urdf.documents import Node, decoded, read_bytes, stream_yaml
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.row_fields import COM, INERTIA, LIMITS
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.stages import Rejected
from dh2urdf.table_text import STATEMENTS, CellRow
from dh2urdf_plugins.readers.comments.declared import declared_key
from dh2urdf_plugins.readers.comments.top import read_top
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.options import TableOptions, ignored_columns
from dh2urdf_plugins.readers.sources.texts import named_columns
from dh2urdf_plugins.readers.statements.values import MESH_KEYS, MESHES, Values, meshes_of
from dh2urdf_plugins.readers.tables.cell_groups import ACCEPTED, PARTS, GroupError, split_cell
from dh2urdf_plugins.readers.tables.cell_rows import CellRows
from dh2urdf_plugins.readers.tables.row_table import RowTable
from dh2urdf_plugins.readers.words.bounds import MAX_JOINTS
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS, IGNORED, flip_of, near
from dh2urdf_plugins.readers.words.table_words import flow_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
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
_UNIT_KEYS = {f"{kind}_{word}": kind for kind in ("length", "angle") for word in ("unit", "units")}
_UNIT_KEYS |= {f"{word}_{kind}": kind for kind in ("length", "angle") for word in ("unit", "units")}
_NAMES = ("index", "joint", "link")
_PARTS = {"limits": LIMITS, "com": COM, "inertia": INERTIA}
_OTHERS = {
    "ur-kinematics": ("a calibration of Universal Robots' ROS packages", "kinematics", "shoulder"),
    "franka-kinematics": ("a kinematics.yaml of Franka's ROS package", "joint1", "kinematic"),
    "screws": ("a file of screw axes", None, None),
}
"""Readers of other YAML files: what they read, and a key with a key in it that shows it."""
_SENTENCE = r"#+(?!>)\s*(?![\w .-]{1,40}:)(.*)"
"""A comment, and no key that somebody took out by making it one."""


def read_documents(path: Path, options: TableOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a YAML or JSON file; see `read` of the stage ``yaml``."""
    file, count = str(path), 0
    previous: Item | None = None
    text = decoded(read_bytes(path, TableError), file, TableError)
    comments = _sentences(text, file)
    for item in stream_yaml(text, file, TableError, items_of="robots", longest_list=MAX_JOINTS):
        if previous is not None:
            count += 1
            above = [each for each in comments if count == 1 and (each.mark.line or 0) < previous.node.line]
            yield _manipulator(previous, f"{path.stem}_{count}", options, trace, above)
        previous = item
    if previous is None:
        return
    root = previous.node
    if not isinstance(root.value, dict) or "robots" not in root.value:
        if other := _other_reader(root):
            raise TableError(other)
        if not isinstance(root.value, dict | list) or not root.value or not isinstance(_first(root).value, dict | list):
            raise TableError([*previous.problems, _no_mapping(root)])
        yield _manipulator(previous, path.stem, options, trace, comments)
        return
    problems = list(previous.problems)
    problems += [_unknown_key(root, key, ("robots",)) for key in root.value if key != "robots"]
    robots = root.value["robots"]
    if not count and not problems:
        message = f"robots is {'an empty list' if isinstance(robots.value, list) else robots.describe()}"
        accepted = "a list of manipulators, each with name, convention and joints"
        problems.append(Problem(message=message, mark=robots.mark, field="robots", accepted=accepted))
    if problems:
        raise TableError(problems)


def read_table(item: Item, default_name: str) -> Manipulator | Rejected:
    """The manipulator of a mapping, or everything that is wrong with it."""
    return _manipulator(item, default_name, TableOptions())


def _first(root: Node) -> Node:
    """The first entry of a list, or a mapping itself."""
    return root.value[0] if isinstance(root.value, list) else root


def _sentences(text: str, file: str) -> list[CellRow]:
    """The comments that are lines of their own."""
    lines = enumerate(text.splitlines(), start=1) if "#" in text else ()
    found = ((number, re.match(_SENTENCE, line.strip())) for number, line in lines if line.lstrip().startswith("#"))
    return [CellRow([f"# {match[1]}"], Mark(file=file, line=number)) for number, match in found if match]


# --- A manipulator ----------------------------------------------------------------------------------------------------


def _manipulator(
    item: Item,
    default_name: str,
    options: TableOptions,
    trace: Trace | None = None,
    comments: Iterable[CellRow] = (),
) -> Manipulator | Rejected:
    """The manipulator of a document, or everything that is wrong with it."""
    table = _Document(item)
    place = item.node.mark
    try:
        source = CellRows([*comments, *table.rows(options)], prose=False)
        top = read_top(source, place, table.said, convention=options.convention, ignore=ignored_columns(options))
        reader = RowTable(Cell(default_name, place), options, top, source, trace, one=True)
        found = _one(reader)
    except TableError as error:
        name = table.said["name"].text if "name" in table.said else default_name
        problems = tuple(each.about(robot=name) for each in (*table.problems, *error.problems))
        return Rejected(
            name=name or default_name, problems=problems, mark=place, notices=(*table.notices, *error.notices)
        )
    return table.with_meshes(found, reader)


def _one(table: RowTable) -> Manipulator | Rejected:
    """The one manipulator of a table."""
    (found,) = table.manipulators()
    assert not isinstance(found, ManipulatorGroups)  # noqa: S101 - it is read with care
    return found


class _Value(NamedTuple):
    """What a joint says under a key.

    Attributes:
        header: the key, as the header of its column.
        key: its place.
        cell: the text, or what is wrong with the value.
        mark: the place of the value.
    """

    header: str
    key: Mark
    cell: str | Problem
    mark: Mark


class _Document:
    """A document that is one manipulator.

    Attributes:
        said: what holds for all rows, by key.
        problems: what is wrong with its form.
        notices: what is left out of it.
        meshes: for each joint, its entries that are meshes.
    """

    def __init__(self, item: Item) -> None:
        self.node = item.node
        self.problems: list[Problem] = list(item.problems)
        self.notices: list[Problem] = []
        self.said: dict[str, Node] = {}
        passed_over: list[str] = []
        self.meshes: list[dict[str, Node]] = []
        self.common: dict[str, _Value] = {}
        self.entries = item.node.value if isinstance(item.node.value, dict) else {}
        self.joints = self._joints()
        for key, node in self.entries.items():
            if node is not self.joints and not (self.joints is self.node and _is_row_of(key, node)):
                passed_over += self._state(key, node)
        if passed_over:
            self.notices.append(_passed_over(passed_over, item.node.key_mark(passed_over[0])))
        if defaults := self.said.get("defaults"):
            self.said["defaults"] = self._without_fields(defaults)

    def _joints(self) -> Node | None:
        """What holds the joints: the value of a key, or the document itself."""
        for key in _JOINTS:
            for written, node in self.entries.items():
                if written.casefold().replace(" ", "_").replace("-", "_") == key and node.value is not None:
                    return node
        rows = sum(_is_row_of(key, node) for key, node in self.entries.items())
        return self.node if isinstance(self.node.value, list) or rows else None

    def _state(self, key: str, node: Node) -> list[str]:
        """Takes what holds for all rows; gives the keys of texts that are left out."""
        if key.startswith(IGNORED):
            return []
        if kind := _UNIT_KEYS.get(key.casefold()):
            units = self.said.get("units")
            known = units.value if units is not None and isinstance(units.value, dict) else {}
            self.said["units"] = replace(node, value={**known, kind: node}, text=None)
        elif key in KEYS:
            self.said[key] = node
        elif declared := declared_key(key):
            self.said.setdefault(declared, node)
        elif isinstance(node.value, dict | list | int | float) or near(key.casefold(), KEYS):
            if key.casefold() not in ("columns", "dof", "version"):
                self.problems.append(_unknown_key(self.node, key, KEYS))
        elif node.text:
            return [key]
        return []

    def _without_fields(self, defaults: Node) -> Node:
        """The defaults without fields of joints, which are what a joint says that says nothing else."""
        if not isinstance(defaults.value, dict):
            return defaults
        entries = defaults.value
        fields = [key for key in entries if (field := _field(key)) and field not in _NAMES]
        for key in fields:
            self.common |= self._values(defaults, key, entries[key])
        return replace(defaults, value={key: node for key, node in entries.items() if key not in fields})

    def with_meshes(self, found: Manipulator | Rejected, table: RowTable) -> Manipulator | Rejected:
        """What was read, with the meshes of its links and what is wrong with them and with the document."""
        names = {number: row.joint for number, row in enumerate(found.rows)} if isinstance(found, Manipulator) else {}
        drawn: dict[int, dict[str, Any]] = {}
        for number, entries in enumerate(self.meshes):
            if entries:
                wrong: list[Problem] = []
                values = Values(table.statements.units(), wrong.append, links=table.statements.mesh_links)
                drawn[number] = meshes_of(values.entries(entries, MESHES))
                self.problems += [replace(each, joint=names.get(number, f"joint_{number + 1}")) for each in wrong]
        own = [problem.about(robot=found.name) for problem in (*self.problems, *self.notices)]
        errors = [problem for problem in own if problem.severity == "error"]
        notices = (*found.notices, *(problem for problem in own if problem.severity == "notice"))
        if isinstance(found, Rejected) or errors:
            more = found.problems if isinstance(found, Rejected) else ()
            return Rejected(name=found.name, problems=(*errors, *more), mark=self.node.mark, notices=notices)
        rows = list(found.rows)
        for number, mesh in drawn.items():
            rows[number] = replace(rows[number], **mesh)
        return replace(found, rows=tuple(rows), notices=notices) if drawn or notices else found

    # --- Rows ---------------------------------------------------------------------------------------------------------

    def rows(self, options: TableOptions) -> list[CellRow]:
        """The header and the rows.

        Raises:
            TableError: there are none, or nothing names the columns.
        """
        joints, file = self.joints, self.node.file
        if joints is None or not joints.value or not isinstance(joints.value, dict | list):
            found = "there is no key joints" if joints is None else f"joints is {joints.describe()}"
            accepted = "`joints:`, a list with one mapping for each joint, such as {a: 0, alpha: pi/2, d: 0.1}"
            mark = (joints or self.node).mark
            raise TableError(Problem(message=found, mark=mark, field="joints", accepted=accepted))
        if isinstance(joints.value, list) and all(isinstance(row.value, list) for row in joints.value):
            rows = [_list_row(row) for row in joints.value]
            named = self.entries.get("columns")
            columns = options.column_names or (
                [node.text or "" for node in named.value] if named and isinstance(named.value, list) else []
            )
            self.meshes = [{} for _ in rows]
            return [named_columns(rows, columns, file), *rows]
        records = [
            (mark, self._joint(number, node)) for number, (mark, node) in enumerate(self._records(joints), start=1)
        ]
        values = [
            {**{key: value for key, value in self.common.items() if not _is_twin(key, own)}, **own}
            for _, own in records
        ]
        values = _with_signs(values)
        headers = {key: value for own in values for key, value in own.items()}
        header = CellRow(
            [each.header for each in headers.values()], joints.mark, [each.key for each in headers.values()]
        )
        return [header, *(_row(own, headers, mark) for own, (mark, _) in zip(values, records, strict=True))]

    def _records(self, joints: Node) -> Iterator[tuple[Mark, Node]]:
        """The joints as mappings: of a list, of a mapping by name, or of columns."""
        if isinstance(joints.value, list):
            yield from ((node.mark, node) for node in joints.value)
            return
        entries = (
            {key: node for key, node in joints.value.items() if _is_row_of(key, node)}
            if isinstance(joints.value, dict)
            else {}
        )
        if any(isinstance(node.value, dict) for node in entries.values()):
            for key, node in entries.items():
                if isinstance(node.value, dict):
                    name = replace(node, value=key, text=key)
                    has_name = any(_field(each) == "joint" for each in node.value)
                    yield node.mark, node if has_name else replace(node, value={"name": name, **node.value})
            return
        count = max((len(node.value) for node in entries.values() if isinstance(node.value, list)), default=0)
        for index in range(count):
            cells = {
                key: node.value[index]
                for key, node in entries.items()
                if isinstance(node.value, list) and index < len(node.value)
            }
            places = {key: joints.key_places[key] for key in cells if key in joints.key_places}
            first = next(iter(cells.values()))
            yield first.mark, replace(first, value=cells, text=None, key_places=places)

    def _joint(self, number: int, node: Node) -> dict[str, _Value]:
        """What a joint says, by column."""
        self.meshes.append({})
        if not isinstance(node.value, dict):
            accepted = "a mapping such as {name: shoulder, type: revolute, a: 0, alpha: pi/2, d: 0.1, theta: 0}"
            message = f"joint {number} is {node.describe()}, not a mapping"
            self.problems.append(
                Problem(message=message, mark=node.mark, field="joints", found=node.text, accepted=accepted)
            )
            return {}
        found: dict[str, _Value] = {}
        for key, item in node.value.items():
            if key in MESH_KEYS:
                self.meshes[-1][key] = item
                continue
            for column, value in self._values(node, key, item).items():
                twin = column in found
                found[f"{column} {key}" if twin else column] = value
        return found

    def _values(self, mapping: Node, key: str, node: Node) -> dict[str, _Value]:  # noqa: PLR0911 - one for each form
        """What a key of a joint says, by column: several where the value is of several fields."""
        header, place, mark = read_header(key), mapping.key_mark(key), node.mark
        field = header.field
        if header.ignored:
            return {key: _Value(key, place, "", mark)}
        if field is None and isinstance(node.value, dict) and key.casefold() in _JOINTS:
            return {
                column: value
                for each, item in node.value.items()
                for column, value in self._values(node, each, item).items()
            }
        if field is not None and field.name in NOT_IN_A_JOINT:
            self.problems.append(_unknown_key(mapping, key, (*FIELDS, *MESH_KEYS)))
            return {}
        if field is not None and field.name in GROUPS:
            if header.unit:
                self.problems.append(_with_unit(mapping, key, field.name))
                return {}
            return self._parts(field.name, place, node)
        if isinstance(node.value, dict | list):
            if field is None:
                self.problems.append(_unknown_key(mapping, key, (*FIELDS, *MESH_KEYS)))
                return {}
            accepted = "a text" if field.dimension is None else "a number or an expression"
            problem = Problem(
                message=f"{field.name} is {node.describe()}", mark=mark, field=field.name, accepted=accepted
            )
            return {_column(key): _Value(key, place, problem, mark)}
        text = "" if node.value is None else node.text or ""
        if isinstance(node.value, bool) and field is not None and field.dimension is not None:
            message, accepted = f"{field.name} is {node.describe()}, not a number", "a number or an expression"
            return {
                _column(key): _Value(
                    key, place, Problem(message=message, mark=mark, found=text, accepted=accepted), mark
                )
            }
        return {_column(key): _Value(key, place, text, mark)}

    def _parts(self, group: str, place: Mark, node: Node) -> dict[str, _Value]:
        """Several fields at once: as a mapping, as a list, or as the text of a cell."""
        if isinstance(node.value, dict):
            names = {key: PARTS.get(key, key) for key in node.value}
            unknown = [key for key, name in names.items() if name not in _PARTS[group]]
            self.problems += [_unknown_key(node, key, _PARTS[group]) for key in unknown]
            cells = {names[key]: item for key, item in node.value.items() if key not in unknown}
            return {
                name: _Value(
                    name,
                    place,
                    "" if item.value is None else item.text if item.text is not None else _no_number(name, item),
                    item.mark,
                )
                for name, item in cells.items()
            }
        if node.value is None:
            return {}
        text = flow_text(node) if isinstance(node.value, list) else node.text or ""
        parts = split_cell(GROUPS[group], text)
        if isinstance(parts, GroupError):
            problem = Problem(
                message=parts.message,
                mark=node.mark,
                field=group,
                found=text,
                accepted=ACCEPTED[group],
                suggestion=parts.suggestion,
            )
            self.problems.append(problem)
            return {}
        return {name: _Value(name, place, part, node.mark) for name, part in parts.items()}


# --- Keys and values --------------------------------------------------------------------------------------------------


def _field(key: str) -> str | None:
    """The field that a key means."""
    header = read_header(key)
    return header.field.name if header.field and header.field.name not in NOT_IN_A_JOINT else None


def _column(key: str) -> str:
    """The column of a key: keys of one field have one column, but for those of the link before."""
    header = read_header(key)
    return f"{header.field.name}{header.link or ''}{header.unit or ''}" if header.field else key


def _is_row_of(key: str, node: Node) -> bool:
    """Whether an entry of a document is a column of numbers, or a joint by its name."""
    if isinstance(node.value, list):
        return _field(key) is not None
    return (
        isinstance(node.value, dict)
        and key not in KEYS
        and sum(_field(each) in ("a", "alpha", "d", "theta") for each in node.value) > 1
    )


def _is_twin(column: str, own: Mapping[str, _Value]) -> bool:
    """Whether a joint says the field of a default itself, under its other name."""
    return column in ("flip", "sign") and not {"flip", "sign"}.isdisjoint(own)


def _with_signs(joints: Sequence[dict[str, _Value]]) -> list[dict[str, _Value]]:
    """Joints of which some say `flip` and others `sign`, all with `sign`."""
    if not {"flip", "sign"} <= {key for own in joints for key in own}:
        return list(joints)
    return [_with_sign(own) if "flip" in own and "sign" not in own else own for own in joints]


def _with_sign(own: dict[str, _Value]) -> dict[str, _Value]:
    """A joint with `sign` in place of `flip`."""
    flip = own["flip"]
    turned = flip_of(str(flip.cell))
    others = {key: value for key, value in own.items() if key != "flip"}
    return own if turned is None else {**others, "sign": flip._replace(header="sign", cell="-1" if turned else "1")}


def _row(own: Mapping[str, _Value], headers: Iterable[str], mark: Mark) -> CellRow:
    values = [own.get(key) for key in headers]
    return CellRow(
        [value and value.cell for value in values], mark, [value.mark if value else mark for value in values]
    )


def _list_row(row: Node) -> CellRow:
    items = row.value if isinstance(row.value, list) else []
    return CellRow([item.text or "" for item in items], row.mark, [item.mark for item in items])


def _no_number(name: str, node: Node) -> Problem:
    message = f"{name} is {node.describe()}"
    return Problem(message=message, mark=node.mark, field=name, accepted="a number or an expression")


def _unknown_key(mapping: Node, key: str, keys: Iterable[str]) -> Problem:
    known = list(keys)
    return Problem(
        message=f"no key is called {shown(key)} here",
        mark=mapping.key_mark(key),
        field=key,
        found=key,
        accepted=", ".join(known),
        suggestion=did_you_mean(key, known) or f"to ignore this key, start it with `{IGNORED}`",
    )


def _with_unit(mapping: Node, key: str, field: str) -> Problem:
    """What is wrong with a key of several numbers that has a unit: it would hold for some of them only."""
    return Problem(
        message=f"the key {shown(key)} has a unit, and its value has several numbers",
        mark=mapping.key_mark(key),
        field=field,
        found=key,
        accepted=f"the key {field}",
        suggestion="write the unit behind each number, or declare it in `units`",
    )


def _passed_over(keys: Sequence[str], mark: Mark) -> Problem:
    """The notice of all keys with texts that are left out."""
    one = len(keys) == 1
    return Problem(
        message=f"the key{'' if one else 's'} {', '.join(map(shown, keys))} {'is' if one else 'are'} left out: "
        "nothing is called so",
        severity="notice",
        mark=mark,
        found=keys[0],
    )


def _no_mapping(root: Node) -> Problem:
    return Problem(
        message=f"a table is a mapping with the key joints, and this is {root.describe()}",
        mark=root.mark,
        accepted=f"the keys {', '.join(KEYS)}, or robots with a list of such mappings",
    )


def _other_reader(root: Node) -> Problem | None:
    """A mapping that is no table, and that another reader of YAML files reads; None for any other."""
    entries = root.value if isinstance(root.value, dict) else {}
    for name, (what, key, inner) in _OTHERS.items():
        node = entries.get(key or "")
        is_screws = key is None and (
            any(each in entries for each in ("Slist", "Blist")) or {"H", "P"} <= entries.keys()
        )
        if is_screws or (node is not None and isinstance(node.value, dict) and inner in node.value):
            return Problem(
                message=f"this is {what}, not a table",
                mark=root.mark,
                accepted="a mapping with the key joints",
                suggestion=f"`--from {name}` reads it; in a run file, `stage: {name}` beside the path",
            )
    return None
