"""Changes of a run file from the command line or a program: ``--set transform.options.frames=dh``."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.documents.document import Node
from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.options import COMMAND_LINE, broken_structure, word_node
from dh2urdf.source import Messages, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.source import Mark

say = Messages(__file__)

MAX_KEYS = 16
"""Names in the key of a setting."""


class Asked(NamedTuple):
    """Where settings are given, for messages: the place, and what stands before a setting there."""

    mark: Mark = COMMAND_LINE
    before: str = "--set "


ON_THE_COMMAND_LINE = Asked()


def with_setting(root: Node, setting: str, sections: Sequence[str], asked: Asked = ON_THE_COMMAND_LINE) -> Node:
    """A run file with a setting put in its place; the file's own nodes stay as they are.

    A setting is KEY=VALUE, where KEY is a path of names and of indices from 0, which begins with one of the sections.
    """

    def error(code: str, **values: Any) -> ConfigError:  # noqa: ANN401 - of a message
        return ConfigError(say(code, asked.mark, found=setting, setting=f"{asked.before}{shown(setting)}", **values))

    def put(node: Node, keys: Sequence[str], value: Node) -> Node:
        """A copy of a node with a value put in its place; mappings on the way there are made."""
        if not keys:
            return value
        key, *rest = keys
        if isinstance(node.value, list):
            entries = list(node.value)
            if key not in map(str, range(len(entries))):
                raise error("setting-entry-unknown", key=key, count=len(entries))
            entries[int(key)] = put(entries[int(key)], rest, value)
            return replace(node, value=entries)
        if node.value is not None and not isinstance(node.value, dict):
            raise error("setting-leads-nowhere", key=key, kind=node.describe())
        mapping = dict(node.value or {})
        mapping[key] = put(mapping.get(key, Node(None, asked.mark.file, 0, 0)), rest, value)
        return replace(node, value=mapping)

    key, equals, word = setting.partition("=")
    keys = [part.strip() for part in key.split(".")]
    if not equals or not 0 < len(keys) <= MAX_KEYS:
        raise error("setting-without-value")
    if keys[0] not in sections:
        near = did_you_mean(keys[0], sections)
        raise error("setting-section-unknown", key=keys[0], sections=sections, suggestion=near)
    word = word.strip()
    if broken := broken_structure(word, asked.mark.file):
        raise error("setting-unreadable", reason=broken)
    return put(root, keys, word_node(word, asked.mark.file))
