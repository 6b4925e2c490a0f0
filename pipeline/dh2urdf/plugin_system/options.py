"""Options of a stage: from what a person wrote to an instance of the stage's options dataclass.

A run file gives nodes, the command line gives words; both come through `make_options`.
"""

from __future__ import annotations

import math
import re
from contextlib import suppress
from dataclasses import fields, is_dataclass
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.documents.document import Node, expect_mapping, load_yaml
from dh2urdf.errors import BrokenPluginError, InputError
from dh2urdf.isolation.attribution import UNKNOWN, reason_of, traceback_of
from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from dh2urdf.isolation.attribution import Plugin

O = TypeVar("O")  # noqa: E741 - the options type of a stage
COMMAND_LINE = Mark(file="command line")
_STRUCTURED = re.compile(r"""^[\[{"']|:\s|:$""")
"""What a word has where its writer meant more than a plain text."""


def make_options(
    options_type: type[O],
    given: Node | Mapping[str, str] | None = None,
    *,
    mark: Mark | None = None,
    where: str,
    plugin: Plugin | None = None,
    folder: Path | None = None,
) -> O:
    """The options of a stage, checked.

    Args:
        options_type: the stage's options dataclass.
        given: what the user wrote: a mapping in a file, or words of the command line by option.
        mark: where the stage is named, for what has no place of its own, such as a word.
        where: the stage, for messages, such as ``emitter 'urdf'``.
        plugin: who provides the stage, for messages.
        folder: the folder of the file that `given` is in, which paths are relative to; else the working directory.

    Raises:
        BrokenPluginError: the stage's options type itself does not work.
    """
    try:
        if not given:
            with suppress(TypeError):  # An option has to be given.
                return options_type()
        from dh2urdf.plugin_system.validator import record_of  # which takes as long as the conversion of a table

        if not isinstance(given, Node):
            place = mark or COMMAND_LINE
            words = {name: word_node(word, place.file) for name, word in (given or {}).items()}
            given = Node(words, place.file, place.line or 0, place.column or 0, place=place.place)
        expect_mapping(given, f"the options of the {where}")
        return record_of(options_type, given, whose=f"the {where}", folder=folder)
    except (InputError, KeyboardInterrupt):
        raise
    except BaseException as error:
        told = reason_of(error).partition("; ")[0]
        reason = f"the options type {options_type.__name__} of the {where} does not work: {told}"
        name, whose = (plugin.name, plugin.distribution) if plugin else (options_type.__module__, UNKNOWN)
        raise BrokenPluginError(name, whose, reason, traceback_of(error)) from error


def broken_structure(word: str, file: str) -> str | None:
    """What is wrong with a word that is meant as a list, a mapping or a quoted text, and is none.

    `*.csv` is no YAML either, but a text.
    """
    if not _STRUCTURED.search(word):
        return None
    try:
        load_yaml(word, file)
    except InputError as error:
        return error.problems[0].message
    return None


def word_node(word: str, file: str = COMMAND_LINE.file) -> Node:
    """A word of the command line as a value: it is read as YAML, and is a text where it is none."""
    try:
        node = load_yaml(word, file)
    except InputError:
        return Node(word, file, 0, 0, word)
    if node.text is not None and not node.quoted and node.text != word.strip():
        return Node(word, file, 0, 0, word)  # `a #b`: nobody writes comments there
    if node.text is None:
        node.text = word  # for options that are texts with an inner form, such as a transform
    waiting = [node]
    while waiting:
        inner = waiting.pop()
        inner.line = inner.column = 0  # The command line has no places.
        inner.key_places = {}
        if isinstance(inner.value, dict):
            waiting += inner.value.values()
        elif isinstance(inner.value, list):
            waiting += inner.value
    return node


def plain(value: Any) -> Any:  # noqa: ANN401 - the value of any option
    """Options of a stage, or one of them, as plain data, as a run file gives them."""
    if value is None or type(value) in (bool, int, str) or (isinstance(value, float) and math.isfinite(value)):
        return value
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    if isinstance(value, dict):
        return {str(key): plain(entry) for key, entry in value.items()}
    if is_dataclass(value):
        found: dict[str, Any] = {}
        for each in fields(value):
            own = plain(getattr(value, each.name))
            found |= own if each.metadata.get("others") else {each.name: own}
        return found
    return str(value)
