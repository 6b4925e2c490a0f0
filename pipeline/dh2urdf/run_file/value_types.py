"""What the keys of a run file accept: texts, numbers, words, paths, and vectors with or without units."""

from __future__ import annotations

import glob
import os
import re
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.documents.measures import measured
from dh2urdf.documents.text_files import LONG_PATH, check_file, is_folder, is_there, tidy_path
from dh2urdf.errors import ConfigError
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.output.file_patterns import matching
from dh2urdf.quantities.quantity import Dimension, QuantityError
from dh2urdf.run_file.validator import JsonSchema, Validator, ValueType
from dh2urdf.source import did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from dh2urdf.documents.document import Node
    from dh2urdf.rotations import Vec3
    from dh2urdf.source import Problem

T = TypeVar("T")

MOST = 10**9
"""Largest whole number of a setting that counts manipulators."""
_SHELL = re.compile(r"~(?=/|$)|~[A-Za-z]\w*(?=/)|\$[A-Za-z_]\w*|\$\{\w+\}")
"""What a shell would put something else in place of."""


# --- Values that are accepted or not ----------------------------------------------------------------------------------


def plain(
    take: Callable[[Node], T | None],
    accepted: str,
    keywords: JsonSchema,
    *,
    subject: str = "{key}",
    null_is_absent: bool = True,
    words: tuple[str, ...] = (),
    meant: Callable[[str], str | None] = lambda _text: None,
) -> ValueType[T]:
    """A value that needs no look at anything else.

    Args:
        take: gives the value, or None where it is not accepted.
        accepted: what is accepted.
        keywords: its JSON Schema.
        subject: what messages call it.
        null_is_absent: whether an empty value is the same as none.
        words: what may have been meant.
        meant: what to write in place of a text that is not accepted.
    """

    def read(node: Node, field: str, to: Validator) -> T | None:
        if (value := take(node)) is None:
            message = f"{subject.format(key=field.rpartition('.')[2].replace('_', ' '))} cannot be {node.describe()}"
            near = did_you_mean(node.text or "", words) if words else meant(node.text or "")
            to.add_problem(message, node, field, accepted=accepted, suggestion=near)
        return value

    return ValueType(read, keywords, null_is_absent=null_is_absent)


def as_written(keywords: JsonSchema) -> ValueType[Node]:
    """A value of which only its JSON Schema is known here: what has it looks at it."""
    return ValueType(lambda node, _field, _to: node, keywords)


def _text(node: Node) -> str | None:
    """A text; a number or a truth value is the text that it is written as."""
    return None if isinstance(node.value, (dict, list)) or node.value is None else node.text or None


def text(*, null_is_absent: bool = False, **keywords: Any) -> ValueType[str]:  # noqa: ANN401 - of a JSON Schema
    """A text that is not empty, and more keywords of its schema."""
    schema = {"type": "string", "minLength": 1, **keywords}
    return plain(_text, "a text, not empty", schema, subject="this", null_is_absent=null_is_absent)


TEXT = text()
ANY_TEXT: ValueType[str] = plain(
    lambda node: None if isinstance(node.value, (dict, list)) else node.text,
    'a text, also ""',
    {"type": "string"},
    subject="this",
    null_is_absent=False,
)
SWITCH: ValueType[bool] = plain(
    lambda node: node.value if isinstance(node.value, bool) else None, "true, false", {"type": "boolean"}
)
OPTIONS: ValueType[Node] = plain(
    lambda node: node if isinstance(node.value, dict) else None, "a mapping such as {frames: dh}", {}
)
"""The options of a stage; `dh2urdf.plugin_system.options.make_options` checks them."""


def word(*words: str) -> ValueType[str]:
    """One of some words."""
    words = tuple(map(str, words))  # without the names that members of an enumeration have
    return plain(
        lambda node: node.value if isinstance(node.value, str) and node.value in words else None,
        ", ".join(words),
        {"enum": list(words)},
        subject="the {key}",
        words=words,
    )


def whole(least: int, most: int) -> ValueType[int]:
    """A whole number within bounds."""

    def take(node: Node) -> int | None:
        value = node.value
        return value if isinstance(value, int) and not isinstance(value, bool) and least <= value <= most else None

    def meant(text: str) -> str | None:
        try:
            number = float(text)  # which reads 1e6, 1_000 and 10.0
        except ValueError:
            return None
        return f"write {number:.0f}" if number.is_integer() and least <= number <= most else None

    schema = {"type": "integer", "minimum": least, "maximum": most}
    return plain(take, f"a whole number from {least} to {most}", schema, meant=meant)


def seconds(what: str) -> ValueType[float]:
    """A time [s]."""

    def take(node: Node) -> float | None:
        value = node.value
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        return float(value) if is_number and 0 < value < MOST else None  # type: ignore[arg-type, operator]

    schema = {"type": "number", "exclusiveMinimum": 0}
    return plain(take, f"{what}, a number greater than 0", schema, subject="the {key}")


# --- Paths ------------------------------------------------------------------------------------------------------------


def path_of(resolve: Callable[[str, Node, str, Validator], T | None]) -> ValueType[T]:
    """A path, absolute or from the run file's folder, and what `resolve` makes of it."""

    def read(node: Node, field: str, to: Validator) -> T | None:
        if (path := TEXT.read(node, field, to)) is None:
            return None
        if "\0" in path:
            to.add_problem("a path cannot hold the character U+0000", node, field)
            return None
        if (found := _SHELL.search(path)) and (found.start() == 0 or found[0].startswith("$")):
            message = f"nothing takes the place of {shown(found[0])} in a path of a run file"
            to.add_problem(message, node, field, accepted="an absolute path, or one from the run file's folder")
            return None
        return resolve(path, node, field, to)

    return ValueType(read, {"type": "string", "minLength": 1})


class FoundFiles(NamedTuple):
    """Files, the findings about their pattern, and the pattern; None where a path names one file."""

    paths: tuple[Path, ...]
    notices: tuple[Problem, ...]
    pattern: str | None


def _files(path: str, node: Node, field: str, to: Validator) -> FoundFiles:
    """The files of a path or pattern, in the order of their names."""
    folder = to.folder_of(node)
    candidates, notices, pattern = [tidy_path(folder / path)], [], None
    if glob.has_magic(path) and not is_there(candidates[0]):
        candidates, pattern = [], path
        with to.noting(node, field):
            found = matching(folder, path)
            candidates = [tidy_path(file) for file in found.paths]
            notices = [found.notice.about(mark=node.mark)] if found.notice else []
    files = []
    for file in candidates:
        try:
            check_file(file)
        except ConfigError as error:
            why = error.problems[0]
            advice = why.suggestion
            if is_folder(file):
                advice = f"name the tables in it, such as {os.path.join(path, '*.csv')}"  # noqa: PTH118 - as it is written
            elif "{" in path and not advice:
                advice = "no pattern has braces: write a list of paths, or a pattern such as *.csv"
            to.add_problem(f"{shown(str(file), LONG_PATH)}: {why.message}", node, field, suggestion=advice)
        else:
            files.append(file)
    return FoundFiles(tuple(files), tuple(notices), pattern)


INPUT_FILES = path_of(_files)
DIRECTORY: ValueType[Path | str] = path_of(
    lambda path, node, _field, to: path if "://" in path else tidy_path(to.folder_of(node) / path)
)
"""A folder, or an address such as ``s3://bucket/prefix``."""
PATH_NODE: ValueType[Node] = path_of(lambda _path, node, _field, _to: node)
"""A path among the options of a stage, which make it relative to the right folder."""


# --- Numbers with units -----------------------------------------------------------------------------------------------

NUMBER: JsonSchema = {"type": ["number", "string"], "minLength": 1}
"""A number, or the text of an expression."""


def numbers(count: int) -> JsonSchema:
    """A list of so many numbers."""
    return {"type": "array", "items": NUMBER, "minItems": count, "maxItems": count}


def measure(dimension: Dimension) -> ValueType[float]:
    """A number that may be an expression with units."""

    def read(node: Node, field: str, to: Validator) -> float | None:
        try:
            return measured(node, dimension)
        except QuantityError as error:
            to.add_problem(error.message, node, field, accepted=error.accepted, suggestion=error.suggestion)
            return None

    return ValueType(read, NUMBER)


def triple(dimension: Dimension) -> ValueType[Vec3]:
    """Three lengths [m], angles [rad] or plain numbers."""

    def read(node: Node, field: str, to: Validator) -> Vec3 | None:
        if not isinstance(node.value, list) or len(node.value) != 3:  # noqa: PLR2004 - the space has three dimensions
            to.add_problem(f"this cannot be {node.describe()}", node, field, accepted="a list of three numbers")
            return None
        x, y, z = (measure(dimension).read(item, field, to) or 0.0 for item in node.value)
        return (x, y, z)

    return ValueType(read, numbers(3))
