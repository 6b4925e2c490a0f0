"""No cell without effect: what is changed in a table changes the arm there, or a notice or an error speaks of it.

One arm that says something in every field is written for every reader, in several dialects. Then one thing is changed
at a time: a cell, a header, a line above the rows, a key, an option, a row, a column. The arm that is read must differ
from the first in the fields that the change concerns and in no others, or a message must name the field or repeat the
text. Whatever has no effect in silence is a fault.
"""

import json
import random
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import yaml
from dialects import WRITERS
from effects import Outcome, has_effect, outcome
from file_texts import File, flow
from known_arms import KnownArm
from known_quantities import Text
from known_tables import Arm, Column, Table

FIELDS = (
    *("joint", "link", "type", "a", "alpha", "d", "theta", "offset", "sign", "lower", "upper", "velocity", "effort"),
    *("mass", "com_x", "com_y", "com_z", "ixx", "iyy", "izz", "ixy", "ixz", "iyz"),
    *("radius", "damping", "friction", "armature"),
)
ROWS = [
    dict(zip(FIELDS, line.split(","), strict=True))
    for line in (
        (
            "shoulder,upper_arm,revolute,120.5,85,89.25,15,31.5,-1,-170,165.5,121,152,3.7,10.5,-20.5,30.5,"
            "0.021,0.022,0.023,0.0011,0.0012,0.0013,45.5,0.51,0.26,0.0125"
        ),
        (
            "slide,carriage,prismatic,-30.5,-44,50.25,21,5.5,-1,2.5,250.5,301,81,2.6,11.5,-21.5,31.5,"
            "0.031,0.032,0.033,0.0021,0.0022,0.0023,46.5,0.61,0.36,0.225"
        ),
        (
            "wrist,hand,continuous,15.5,32,-70.25,22,33.5,-1,,,122,32,1.6,12.5,-22.5,32.5,"
            "0.041,0.042,0.043,0.0031,0.0032,0.0033,47.5,0.71,0.46,0.325"
        ),
    )
]
SAID: dict[str, Any] = {
    "convention": "standard",
    "units": {
        "length": "mm",
        "angle": "deg",
        "mass": "g",
        "inertia": "kg·m²",
        "effort": ["Nm", "N"],
        "velocity": ["deg/min", "mm/min"],
        "damping": ["N·m·s/rad", "N·s/m"],
    },
    "base": {"xyz": ["10.5", "-20.5", "300.5"], "rpy": ["10.5", "-20.5", "30.5"]},
    "tool": {"xyz": ["11.5", "-21.5", "90.5"], "rpy": ["11.5", "-21.5", "31.5"]},
    "defaults": {"geometry": {"shape": "box", "radius": "41.5"}, "density": "2701"},
}
OTHER_WORDS = {"conventions", "unit", "typ", "limit", "default"}
"""Slips that are words as well, of comments, of German and of YAML."""
DIALECTS = {"csv": 5, "yaml": 3, "json": 2, "parquet": 3, "xlsx": 12}
"""How many dialects of each reader: the writers choose one by a seed."""
TRIED = 3
"""Dialects of workbooks that are tried, of the twelve: they take long to write."""


def table() -> Table:
    columns = [Column(name, name) for name in ROWS[0]]
    rows = [{name: Text(text, text) for name, text in row.items()} for row in ROWS]
    return Table(columns, [Arm(KnownArm("arm one", "standard", []), {}, rows)], deepcopy(SAID), {})


# --- Changes ----------------------------------------------------------------------------------------------------------


@dataclass
class Change:
    """A change of a table, and what it may change in the arm."""

    name: str
    apply: Callable[[Table], Any]
    changes: str | None
    words: tuple[str, ...]


TENSOR = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def path_of(row: int, name: str) -> str:
    """The paths of a field of a row in the record."""
    place = rf"\.rows\.{row}"
    if name == "type":
        return rf"{place}\..*"
    if name in ("lower", "upper", "velocity", "effort"):
        return rf"{place}\.limits\.{name}"
    if name.startswith("com_"):
        return rf"{place}\.com\.{'xyz'.index(name[-1])}|{place}\.com"
    return rf"{place}\.inertia(\.{name})?" if name in TENSOR else rf"{place}\.{name}"


def cells() -> Iterator[Change]:
    """One cell changed in every way that a slip has."""
    for row, texts in enumerate(ROWS):
        for name, text in texts.items():
            where = f"{name} of row {row + 1}"
            for what, new in _other_texts(name, text):
                yield Change(
                    f"{where}: {what}", _put(row, name, new), path_of(row, name), (name, new or "\0", *_kin(name))
                )


def _kin(name: str) -> tuple[str, ...]:
    """What else a message may name where a field is wrong beside others."""
    if name in TENSOR:
        return ("inertia", "mass")
    return ("com",) if name.startswith("com_") else ("limits", "lower", "upper") if name in ("lower", "upper") else ()


def _other_texts(name: str, text: str) -> Iterator[tuple[str, str]]:
    if name in ("joint", "link"):
        yield from (("a letter more", text + "x"), ("its case", text.capitalize()), ("emptied", ""))
        return
    if name == "type":
        yield from (
            (f"{kind} written", kind) for kind in ("revolute", "prismatic", "continuous", "fixed") if kind != text
        )
        yield from (("a slip", text[:-1]), ("emptied", "") if text != "revolute" else ("misspelt", "revolut"))
        return
    if not text:
        yield from (("filled", "7.5"), ("a word", "none of these"))
        return
    yield "its last digit", text[:-1] + str((int(text[-1]) + 1) % 10)
    yield "its sign", text.removeprefix("-") if text.startswith("-") else f"-{text}"
    yield "a word", "perhaps"
    yield "a digit more", f"{text}{'3' if '.' in text else '.3'}"
    if name != "sign":
        yield "doubled", f"2*{text}" if not text.startswith("-") else f"-2*{text[1:]}"
        yield "emptied", ""
        yield "a unit of something else", f"{text} {'s' if name in ('mass', 'armature') or name in TENSOR else 'kg'}"
    if name in ("a", "d", "com_x", "com_y", "com_z", "radius"):
        yield "another unit", f"{text} cm"
    if name in ("alpha", "theta"):
        yield "another unit", "1.25 rad"


def _put(row: int, name: str, text: str) -> Callable[[Table], Any]:
    def put(content: Table) -> None:
        content.arms[0].rows[row][name] = Text(text, text)

    return put


def rows_and_columns() -> Iterator[Change]:
    """Rows and columns lost, doubled and exchanged."""
    count = len(ROWS)
    for row in range(count):
        yield Change(f"row {row + 1} lost", lambda content, row=row: content.arms[0].rows.pop(row), r"\.rows\..*", ())
        yield Change(
            f"row {row + 1} doubled",
            lambda content, row=row: content.arms[0].rows.insert(row, content.arms[0].rows[row]),
            None,
            (ROWS[row]["joint"],),
        )
    for index, name in enumerate(ROWS[0]):
        changes = "|".join(path_of(row, name) for row in range(count))
        yield Change(
            f"column {name} lost", lambda content, index=index: content.columns.pop(index), changes, (name, *_kin(name))
        )


def said() -> Iterator[Change]:
    """What is said above the rows: a digit, a word, a line lost, a key misspelt or unknown."""
    for key, value in SAID.items():
        if key not in ("units", "convention"):
            pattern = {"defaults": r"\.(geometry|density).*"}.get(key, rf"\.{key}.*")
            yield Change(f"{key} lost", lambda content, key=key: content.said.pop(key), pattern, (key,))
        slips = {key[:k] + key[k + 1 :] for k in range(len(key))} | {f"{key}s", f"my_{key}", key[::-1]}
        for slip in sorted(slips - OTHER_WORDS):
            yield Change(f"{key} called {slip}", _rename(key, slip), None, (slip, key.removesuffix("s")))
        for path, leaf in leaves(value):
            where = ".".join(map(str, (key, *path)))
            for new in _other_leaves(leaf):
                yield Change(
                    f"{where}: {new}",
                    _say((key, *path), new),
                    rf"\.{key}.*|\.geometry.*|\.density|{'.*' if key in ('units', 'convention') else 'x'}",
                    (key, new),
                )
            for k, part in enumerate(path):
                if isinstance(part, str):
                    name = f"{part}x"
                    yield Change(f"{where} called {name}", _rename_in((key, *path[: k + 1]), name), None, (name,))


def leaves(value: Any) -> Iterator[tuple[tuple[Any, ...], str]]:
    if isinstance(value, str):
        yield (), value
        return
    for key, item in value.items() if isinstance(value, dict) else enumerate(value):
        yield from (((key, *path), leaf) for path, leaf in leaves(item))


def _other_leaves(leaf: str) -> list[str]:
    if leaf[-1] not in "0123456789":
        return {"mm": ["cm", "mn", "deg"], "deg": ["rad", "dge", "mm"], "box": ["capsule", "bxo"]}.get(
            leaf, ["modified", "standart"]
        )
    return [
        leaf[:-1] + str((int(leaf[-1]) + 1) % 10),
        leaf.removeprefix("-") if leaf.startswith("-") else f"-{leaf}",
        "perhaps",
        f"{leaf} s",
    ]


def _rename(key: str, other: str) -> Callable[[Table], Any]:
    def rename(content: Table) -> None:
        content.said = {other if name == key else name: value for name, value in content.said.items()}

    return rename


def _reach(content: Table, path: tuple[Any, ...]) -> Any:
    value: Any = content.said
    for part in path:
        value = value[part]
    return value


def _say(path: tuple[Any, ...], text: str) -> Callable[[Table], Any]:
    def say(content: Table) -> None:
        _reach(content, path[:-1])[path[-1]] = text

    return say


def _rename_in(path: tuple[Any, ...], name: str) -> Callable[[Table], Any]:
    def rename(content: Table) -> None:
        mapping = _reach(content, path[:-1])
        mapping[name] = mapping.pop(path[-1])

    return rename


def options() -> Iterator[Change]:
    """What an option says beside what the table says: never without effect."""
    for name, value in (
        ("convention", "modified"),
        ("convention", "standart"),
        ("length_unit", "cm"),
        ("length_unit", "mn"),
        ("angle_unit", "rad"),
        ("units", {"length": "cm"}),
        ("units", {"inertia": "g·cm²"}),
        ("units", "mn"),
        ("payload", {"mass": 2}),
        ("payload", {"weight": 2}),
        ("base", {"xyz": [0, 0, 1]}),
        ("tool", {"xyz": [0, 0, 1]}),
        ("tool", {"xyz": [0, 0]}),
        ("tool", "perhaps"),
    ):
        changes = r"\.payload.*" if name == "payload" else None
        yield Change(f"option {name}={value}", _option(name, value), changes, (name, name.replace("_unit", "")))


def _option(name: str, value: Any) -> Callable[[Table], Any]:
    def option(content: Table) -> None:
        content.options[name] = value

    return option


KINDS = {"cells": cells, "rows and columns": rows_and_columns, "said": said, "options": options}


@pytest.mark.parametrize(
    ("kind", "reader", "seed"),
    [
        (kind, reader, seed)
        for kind in KINDS
        for reader, count in DIALECTS.items()
        for seed in range(TRIED if reader == "xlsx" else count)
    ],
)
def test_every_change_has_an_effect(kind: str, reader: str, seed: int, tmp_path: Path) -> None:
    """The arm differs in what was changed and in nothing else, or a message speaks of the change.

    Each dialect of a reader is given its share of the changes.
    """

    def read(content: Table) -> Outcome:
        file = WRITERS[reader](random.Random(seed), content, bulk=False)  # noqa: S311 - no secret
        return outcome(file, content.options, tmp_path)

    before = read(table())
    assert not before.refused, [str(problem) for problem in before.problems]
    silent = {}
    for change in list(KINDS[kind]())[seed :: DIALECTS[reader]]:
        content = table()
        change.apply(content)
        missing = has_effect(before, read(content), changes=change.changes, words=change.words)
        if missing:
            silent[change.name] = missing
    assert not silent, "\n".join(f"{name}: {missing}" for name, missing in silent.items())


# --- YAML and JSON: every key and every value -------------------------------------------------------------------------

DOCUMENT: dict[str, Any] = {
    "name": "arm one",
    **SAID,
    "base": {**SAID["base"], "mass": "12.5", "geometry": {"shape": "box", "radius": "61.5"}},
    "defaults": {**SAID["defaults"], "friction": "0.75", "limits": {"velocity": "77"}},
    "visuals": "none",
    "collisions": "none",
    "joints": yaml.load(
        """
        - {name: shoulder, link: upper_arm, type: revolute, a: 120.5, alpha: 85, d: 89.25, theta: 15, offset: 31.5,
           flip: true, limits: {lower: -170, upper: 165.5, velocity: 121, effort: 152}, mass: 3.7,
           com: [10.5, -20.5, 30.5], radius: 45.5, damping: 0.51, friction: 0.26, armature: 0.0125,
           inertia: {ixx: 0.021, iyy: 0.022, izz: 0.023, ixy: 0.0011, ixz: 0.0012, iyz: 0.0013}}
        - {name: slide, link: carriage, type: prismatic, a: -30.5, alpha: -44, d: 50.25}
        """,
        yaml.BaseLoader,  # noqa: S506 - texts, as a person types them
    ),
}


def every_leaf() -> Iterator[tuple[tuple[Any, ...], str, list[str]]]:
    """Every value of the document, by its path, and what else it could be."""
    for path, leaf in leaves(DOCUMENT):
        others = (
            _other_leaves(leaf)
            if leaf[-1] in "0123456789"
            else {
                "none": ["all", "nothing"],
                "true": ["false", "perhaps"],
                "revolute": ["prismatic", "revolut"],
                "prismatic": ["revolute", "?"],
            }.get(leaf, _other_leaves(leaf) if path[0] in ("units", "convention") or leaf == "box" else [f"{leaf}_x"])
        )
        yield path, leaf, others


def every_key() -> Iterator[tuple[tuple[Any, ...], list[str]]]:
    """Every key of the document, by its path, and how it could be misspelt."""
    paths = {path[: k + 1] for path, _ in leaves(DOCUMENT) for k in range(len(path)) if isinstance(path[k], str)}
    for path in sorted(paths, key=str):
        key = path[-1]
        slips = {key[:k] + key[k + 1 :] for k in range(len(key))} | {
            key + key[-1],
            f"my {key}",
            f"{key} [kg]",
            key.upper(),
        }
        yield path, sorted(slips - {"", key, *OTHER_WORDS})


def documents(what: str) -> Iterator[tuple[str, Any, tuple[str, ...], str | None]]:
    """The document with one thing changed: the change, the document, the words of a message, and what may change."""
    if what == "values":
        for path, leaf, others in every_leaf():
            for other in others:
                words = (other, *(part for part in path[-2:] if isinstance(part, str)))
                yield f"{path}: {leaf} as {other}", _changed(path, {path[-1]: other}), words, ".*"
    for path, slips in every_key():
        if what == "entries" and path != ("joints", 0, "type"):  # revolute is what a joint is that has no type
            asked = (
                ("no unit is declared",) if path[0] == "units" else ()
            )  # of a number that is an angle of a turn or more
            yield f"{path} lost", _changed(path, {}), (path[-1], *asked), ".*"
        for slip in slips if what == "keys" else ():
            if slip.casefold() != path[-1]:  # keys of joints are read in any case, as headers are
                # A unit that is none of the field's is named alone; so is the convention, which is missing then.
                asked = ("'kg' is a unit",) if slip.endswith("[kg]") else ()
                asked += ("field 'convention'",) if path == ("convention",) else ()
                yield f"{path} as {slip}", _changed(path, {slip: _inside(path)}), (slip, *asked), None


def _inside(path: tuple[Any, ...]) -> Any:
    value: Any = DOCUMENT
    for part in path:
        value = value[part]
    return value


def _changed(path: tuple[Any, ...], new: dict[Any, Any]) -> Any:
    """The document with the entry at a path replaced by others, or by none."""
    document = deepcopy(DOCUMENT)
    holder: Any = document
    for part in path[:-1]:
        holder = holder[part]
    if isinstance(holder, list):
        holder[path[-1]] = new[path[-1]]
        return document
    entries = list(holder.items())
    holder.clear()
    for key, value in entries:
        holder.update(new if key == path[-1] else {key: value})
    return document


@pytest.mark.parametrize("suffix", [".yaml", ".json"])
@pytest.mark.parametrize("what", ["values", "keys", "entries"])
def test_every_key_and_value_of_yaml_has_an_effect(what: str, suffix: str, tmp_path: Path) -> None:
    """A value changed, a key misspelt or an entry lost is another arm, or a message speaks of it."""

    def read(document: Any) -> Outcome:
        text = flow(document) if suffix == ".yaml" else json.dumps(document)
        return outcome(File(suffix, text.encode(), ""), {}, tmp_path)

    before = read(DOCUMENT)
    assert not before.refused, [str(problem) for problem in before.problems]
    silent = {}
    for name, document, words, changes in documents(what):
        if missing := has_effect(before, read(document), changes=changes, words=words):
            silent[name] = missing
    assert not silent, "\n".join(f"{name}: {missing}" for name, missing in silent.items())
