"""Changes of a run file from the command line or a program: ``--set transform.options.frames=dh``."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.documents.document import Node
from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.options import COMMAND_LINE, broken_structure, word_node
from dh2urdf.source import Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.source import Mark

MAX_KEYS = 16
"""Names in the key of a setting."""


class Asked(NamedTuple):
    """Where settings are given, for messages: the place, and what stands before a setting there."""

    mark: Mark = COMMAND_LINE
    before: str = "--set "


ON_THE_COMMAND_LINE = Asked()


def with_setting(root: Node, setting: str, sections: Sequence[str], asked: Asked = ON_THE_COMMAND_LINE) -> Node:
    """A run file with a setting put in its place; the file's own nodes stay as they are.

    Args:
        root: the run file.
        setting: KEY=VALUE, where KEY is a path of names and of indices from 0.
        sections: the sections that a run file has.
        asked: where the setting is given.

    Raises:
        ConfigError: the setting leads nowhere.
    """

    def error(message: str, accepted: str | None = None, suggestion: str | None = None) -> ConfigError:
        message = f"{asked.before}{shown(setting)} {message}"
        return ConfigError(
            Problem(message=message, mark=asked.mark, found=setting, accepted=accepted, suggestion=suggestion)
        )

    def put(node: Node, keys: Sequence[str], value: Node) -> Node:
        """A copy of a node with a value put in its place; mappings on the way there are made."""
        if not keys:
            return value
        key, *rest = keys
        if isinstance(node.value, list):
            entries = list(node.value)
            if key not in map(str, range(len(entries))):
                message = f"names the entry {shown(key)} of a list that has {len(entries)}"
                raise error(message, "the number of an entry: the first entry is 0")
            entries[int(key)] = put(entries[int(key)], rest, value)
            return replace(node, value=entries)
        if node.value is not None and not isinstance(node.value, dict):
            raise error(f"looks for {shown(key)} in {node.describe()}")
        mapping = dict(node.value or {})
        mapping[key] = put(mapping.get(key, Node(None, asked.mark.file, 0, 0)), rest, value)
        return replace(node, value=mapping)

    key, equals, word = setting.partition("=")
    keys = [part.strip() for part in key.split(".")]
    if not equals or not 0 < len(keys) <= MAX_KEYS:
        raise error("has no value", "KEY=VALUE, such as transform.options.frames=dh")
    if keys[0] not in sections:
        near = did_you_mean(keys[0], sections)
        advice = near or f"an option of a stage is below its section: {shown(f'transform.options.{setting}')}"
        message = f"begins with {shown(keys[0])}, which is no section of a run file"
        raise error(message, f"a key that begins with {', '.join(sections)}", advice)
    word = word.strip()
    if broken := broken_structure(word, asked.mark.file):
        advice = "a text with such characters is in quotes: 'KEY=\"TEXT\"'"
        raise error(f"cannot be read: {broken}", "a value as in a run file", advice)
    return put(root, keys, word_node(word, asked.mark.file))
